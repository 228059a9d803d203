//! A progressive mesh that stays on the device while its level changes.

mod buffer;
mod level;

use glam::{DAffine3, DVec3, Vec3};
use pmesh_format::{Header, LevelChange, Replay};
use wgpu::BufferUsages;

use super::device;
use crate::gpu::pipelines::Pipelines;
use crate::{GpuError, GpuRenderer, RenderError};
use buffer::Growing;
use level::{Array, Resident};

/// A progressive mesh on the device, placed in a scene.
///
/// Vertices are appended as finer levels come and stay when coarser ones follow; of the corners of faces only those are
/// written again that are others than before. So a step costs what it changes, not what the mesh has. Normals of a file
/// without any are those of the level ([`RenderMesh::from_indexed`](crate::RenderMesh::from_indexed)), and are written
/// again where they change.
///
/// A mesh that stands in several places has one of these for each.
#[derive(Debug)]
pub struct GpuMesh {
    resident: Resident,
    positions: Growing,
    normals: Growing,
    uvs: Growing,
    corners: Growing,
    materials: Growing,
    uploaded: u64,
}

impl GpuMesh {
    /// For the file with this header; nothing is on the device yet.
    ///
    /// `materials` holds the scene's material for each material number of the file. `transform` leads from mesh space to
    /// world space, `origin` is the world position of the origin of scene space \[m\].
    ///
    /// # Errors
    ///
    /// The transform or the origin is not finite.
    pub fn new(
        renderer: &GpuRenderer,
        header: &Header,
        materials: &[u32],
        transform: &DAffine3,
        origin: DVec3,
    ) -> Result<Self, GpuError> {
        let resident = Resident::new(header, materials, transform, origin)?;
        device::checked(&renderer.device, || {
            let growing = |label, usage| Growing::new(&renderer.device, label, usage);
            Ok(Self {
                resident,
                positions: growing("positions of a mesh", BufferUsages::VERTEX | BufferUsages::STORAGE)?,
                normals: growing("normals of a mesh", BufferUsages::STORAGE)?,
                uvs: growing("texture coordinates of a mesh", BufferUsages::STORAGE)?,
                corners: growing("corners of a mesh", BufferUsages::INDEX | BufferUsages::STORAGE)?,
                materials: growing("materials of a mesh", BufferUsages::STORAGE)?,
                uploaded: 0,
            })
        })
    }

    /// The level on the device \[vertices\]; 0 before the first upload.
    #[must_use]
    pub fn level(&self) -> u32 {
        self.resident.level()
    }

    /// Bytes written to the device since the beginning.
    #[must_use]
    pub fn uploaded_bytes(&self) -> u64 {
        self.uploaded
    }

    /// Takes over the level of `replay`; returns how many bytes were written.
    ///
    /// `change` is what the last step of `replay` reported. If it does not lead from [`GpuMesh::level`] to the level of
    /// `replay`, all that can differ is written.
    ///
    /// # Errors
    ///
    /// [`GpuError::Render`] if `replay` is of another file or names a material that was not given, [`GpuError::Limit`] or
    /// [`GpuError::Device`]. The next upload writes everything then.
    pub fn upload(
        &mut self,
        renderer: &GpuRenderer,
        replay: &Replay,
        change: &LevelChange,
    ) -> Result<u64, GpuError> {
        let before = self.uploaded;
        let outcome = device::checked(&renderer.device, || self.write(renderer, replay, change));
        if outcome.is_err() {
            self.resident.forget();
        }
        outcome.map(|()| self.uploaded - before)
    }

    fn write(
        &mut self,
        renderer: &GpuRenderer,
        replay: &Replay,
        change: &LevelChange,
    ) -> Result<(), GpuError> {
        let GpuRenderer { device, queue, .. } = renderer;
        let writes = self.resident.advance(replay, change)?;
        for write in &writes {
            let buffer = match write.array {
                Array::Positions => &mut self.positions,
                Array::Normals => &mut self.normals,
                Array::Uvs => &mut self.uvs,
                Array::Corners => &mut self.corners,
                Array::Materials => &mut self.materials,
            };
            buffer.write(device, queue, write.offset, &write.bytes)?;
            self.uploaded += write.bytes.len() as u64;
        }
        Ok(())
    }

    /// What every level lies in, in scene space \[m\].
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        self.resident.bounds()
    }

    /// Whether it fits a scene whose origin and materials are these; emissive ones, marked true, do not.
    pub(crate) fn check(&self, origin: DVec3, emissive: &[bool]) -> Result<(), RenderError> {
        self.resident.check(origin, emissive)
    }

    /// Draws all faces into a shadow map.
    pub(super) fn draw_depth(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.positions.slice());
        pass.set_index_buffer(self.corners.slice(), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..3 * self.resident.faces(), 0, 0..1);
    }

    /// Draws all faces, shaded; `materials` has a group for each material of the scene.
    pub(super) fn draw_shaded(
        &self,
        device: &wgpu::Device,
        pipelines: &Pipelines,
        pass: &mut wgpu::RenderPass<'_>,
        materials: &[wgpu::BindGroup],
    ) {
        let arrays = [&self.positions, &self.normals, &self.uvs, &self.corners, &self.materials];
        let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
            .zip(arrays)
            .map(|(binding, array)| wgpu::BindGroupEntry { binding, resource: array.binding() })
            .collect();
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("mesh"),
            layout: &pipelines.mesh_layout,
            entries: &entries,
        });
        pass.set_bind_group(2, &group, &[]);
        for draw in self.resident.draws() {
            pass.set_bind_group(1, &materials[draw.material as usize], &[]);
            // The shader takes the instance for what it is to draw.
            pass.draw(0..3 * self.resident.faces(), draw.instance..draw.instance + 1);
        }
    }
}
