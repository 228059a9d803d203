//! The meshes of a streamed scene, kept on the GPU from picture to picture.

use std::collections::HashSet;

use glam::Vec3;
use ivg_render::{GpuMesh, GpuRenderer, Image, RenderOptions, RenderScene};
use ivg_scene::Camera;
use ivg_stream::blocking::Session;

use crate::baking::LoadedScene;
use crate::failure::Failure;

/// A streamed scene: what came whole, and its progressive meshes on the device, each where a node has it.
#[derive(Debug)]
pub(crate) struct Live<'a> {
    renderer: &'a GpuRenderer,
    /// Without the meshes that follow.
    scene: RenderScene,
    /// With their places in the list of the manifest.
    meshes: Vec<(usize, GpuMesh)>,
}

impl<'a> Live<'a> {
    /// Of a session in which every mesh has begun. Meshes that emit light are drawn as they came with the scene.
    pub(crate) fn new(renderer: &'a GpuRenderer, session: &Session, camera: Camera) -> Result<Self, Failure> {
        let manifest = session.manifest();
        let mut scene = manifest.scene.clone();
        let emits = |material: &u32| {
            scene.materials.get(*material as usize).is_some_and(|material| material.emission != Vec3::ZERO)
        };
        let streamed: Vec<usize> = (0..manifest.meshes.len())
            .filter(|&index| session.replay(index).is_some())
            .filter(|&index| {
                let mesh = &scene.meshes[manifest.meshes[index].mesh];
                !mesh.triangle_materials.iter().any(emits)
            })
            .collect();
        let replaced: HashSet<usize> = streamed.iter().map(|&index| manifest.meshes[index].mesh).collect();
        scene.nodes.retain(|node| !replaced.contains(&(node.mesh as usize)));
        let LoadedScene { scene, flat, .. } = LoadedScene::from_scene(scene)?;
        let scene = RenderScene::from_scene(&scene, &flat, camera);
        let all: Vec<u32> = (0..scene.materials.len() as u32).collect();
        let mut meshes = Vec::new();
        for index in streamed {
            let entry = &manifest.meshes[index];
            let Some(replay) = session.replay(index) else { continue };
            let materials = entry.materials.as_ref().unwrap_or(&all);
            for node in manifest.scene.nodes.iter().filter(|node| node.mesh as usize == entry.mesh) {
                let place = entry.transform(&node.transform);
                let mesh = GpuMesh::new(renderer, replay.header(), materials, &place, scene.origin);
                meshes.push((index, mesh.map_err(Failure::new)?));
            }
        }
        Ok(Self { renderer, scene, meshes })
    }

    /// Brings each mesh to the level of a share of its vertices, or the highest that has arrived; how many bytes that took.
    pub(crate) fn go_to(&mut self, session: &mut Session, share: f64) -> Result<u64, Failure> {
        let mut uploaded = 0;
        for (index, mesh) in &mut self.meshes {
            let Some(level) = session.level_at(*index, share) else { continue };
            if let Some((replay, change)) = session.step(*index, mesh.level(), level) {
                uploaded += mesh.upload(self.renderer, replay, &change).map_err(Failure::new)?;
            }
        }
        Ok(uploaded)
    }

    /// What is not kept here: grid, camera, lights.
    pub(crate) fn scene_mut(&mut self) -> &mut RenderScene {
        &mut self.scene
    }

    /// Draws a picture.
    pub(crate) fn render(&self, options: &RenderOptions) -> Result<Image, Failure> {
        let meshes: Vec<&GpuMesh> = self.meshes.iter().map(|(_, mesh)| mesh).collect();
        self.renderer.render_with(&self.scene, options, &meshes).map_err(Failure::new)
    }
}
