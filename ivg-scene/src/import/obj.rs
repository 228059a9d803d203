//! OBJ and MTL, parsed by tobj in f64.
//!
//! tobj names no line in its errors, takes polylines (`l`) for polygons and may panic on broken numbers, so every
//! line passes a check first ([`lines`], [`mtl`]). Objects (`o`, `g`) become meshes; all meshes share one f64 origin,
//! so that a scene far from the origin loses nothing and meshes that touch stay in touch.

mod lines;
mod mtl;

use std::cell::RefCell;
use std::collections::{BTreeMap, HashMap};

use glam::{DAffine3, DVec3, Vec2, Vec3};

use super::channel;
use super::compress::MAX_FILE_BYTES;
use super::folder::Folder;
use crate::geometry::{repair_normals, snapped_origin};
use crate::{Material, Mesh, Node, Scene, SceneError, Unsupported};
use lines::CheckedLines;

/// Reads an OBJ file and the material libraries and images it names.
pub(crate) fn read(name: &str, stem: &str, bytes: &[u8], folder: &Folder) -> Result<Scene, SceneError> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = CheckedLines::new(name, &text);
    let libraries = RefCell::new(Libraries::default());
    let options =
        tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let result = tobj::load_obj_buf(&mut reader, &options, |path| {
        Ok(libraries.borrow_mut().load(&path.to_string_lossy(), folder))
    });
    if let Some(error) = reader.error.take() {
        return Err(error);
    }
    let (models, materials) = result.map_err(|e| reader.explain(e))?;
    // The loader above never fails, so neither does the list.
    let materials = materials.unwrap_or_default();

    let mut scene = Scene::default();
    let libraries = libraries.into_inner();
    if let Some(error) = libraries.error {
        return Err(error);
    }
    scene.warnings = libraries.warnings;
    if reader.skipped_elements > 0 {
        scene.unsupported.push(Unsupported {
            object: name.into(),
            what: format!("{} lines, points or curves: left out", reader.skipped_elements),
        });
    }
    let colours = models.iter().flat_map(|m| &m.mesh.vertex_color);
    let bad_colours = colours.clone().any(|&value| channel(value, 1.0).is_none());
    let with_colours = colours.count() > 0 && !bad_colours;
    if bad_colours {
        scene.unsupported.push(Unsupported {
            object: name.into(),
            what: "vertex colours, as some are not from 0 to 1: left out".into(),
        });
    }
    if with_colours && reader.plain_vertices > 0 {
        let plain = reader.plain_vertices;
        scene.warnings.push(format!("{name}: {plain} vertices without a colour are white"));
    }
    add_materials(&mut scene, &materials, folder);
    let default_material = scene.materials.len() as u32;
    scene.materials.push(Material::default());
    let known: Vec<&str> = materials.iter().map(|m| m.name.as_str()).collect();
    let unknown: Vec<&String> =
        reader.used_materials.iter().filter(|m| !known.contains(&m.as_str())).collect();
    if !unknown.is_empty() {
        scene.warnings.push(format!(
            "{}: grey of albedo 0.5 instead of materials that no material library defines: {}",
            name,
            unknown.iter().map(|m| format!("\"{m}\"")).collect::<Vec<_>>().join(", ")
        ));
    }
    add_meshes(&mut scene, stem, &models, default_material, with_colours)?;
    drop_unused_default(&mut scene, default_material);
    if reader.unreferenced() > 0 {
        let count = reader.unreferenced();
        scene.warnings.push(format!("{name}: {count} vertices that no face uses: dropped"));
    }
    Ok(scene)
}

/// Material libraries as they are read.
#[derive(Default)]
struct Libraries {
    warnings: Vec<String>,
    error: Option<SceneError>,
}

impl Libraries {
    /// A material library, or nothing and a warning where it cannot be read.
    fn load(&mut self, file: &str, folder: &Folder) -> (Vec<tobj::Material>, HashMap<String, usize>) {
        let nothing = || (Vec::new(), HashMap::new());
        let bytes = match folder.read(file, MAX_FILE_BYTES) {
            Ok(bytes) => bytes,
            Err(why) => {
                self.warnings
                    .push(format!("material library {}: grey of albedo 0.5 instead of its materials", why.0));
                return nothing();
            }
        };
        match mtl::read(file, &bytes) {
            Ok(loaded) => loaded,
            Err(error) => {
                self.error.get_or_insert(error);
                nothing()
            }
        }
    }
}

fn add_materials(scene: &mut Scene, materials: &[tobj::Material], folder: &Folder) {
    let mut textures: BTreeMap<String, Option<u32>> = BTreeMap::new();
    for source in materials {
        let mut material = mtl::convert(source);
        if let Some(file) = mtl::texture_file(source) {
            material.albedo_texture = *textures.entry(file.clone()).or_insert_with(|| {
                let loaded = folder.read(&file, MAX_FILE_BYTES).map_err(|e| e.0).and_then(|bytes| {
                    super::image::decode(&file, &bytes).map_err(|e| format!("\"{file}\": {e}"))
                });
                match loaded {
                    Ok(texture) => {
                        scene.textures.push(texture);
                        Some(scene.textures.len() as u32 - 1)
                    }
                    Err(why) => {
                        scene.warnings.push(format!(
                            "material \"{}\": image {why}; its colour Kd is used alone",
                            source.name
                        ));
                        None
                    }
                }
            });
        }
        scene.unsupported.extend(
            mtl::ignored_maps(source)
                .into_iter()
                .map(|what| Unsupported { object: format!("material \"{}\"", source.name), what }),
        );
        scene.materials.push(material);
    }
}

/// One mesh and node for each run of models with the same object name.
fn add_meshes(
    scene: &mut Scene,
    stem: &str,
    models: &[tobj::Model],
    default_material: u32,
    with_colours: bool,
) -> Result<(), SceneError> {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for model in models {
        for p in positions(&model.mesh) {
            (min, max) = (min.min(p), max.max(p));
        }
    }
    let origin = snapped_origin(min, max);
    for run in models.chunk_by(|a, b| a.name == b.name) {
        let unnamed = run[0].name == "unnamed_object";
        let name = if unnamed { stem.to_owned() } else { run[0].name.clone() };
        let mesh = merge(run, name, origin, default_material, with_colours, &mut scene.warnings)?;
        if mesh.triangles.is_empty() {
            continue;
        }
        scene.nodes.push(Node {
            name: mesh.name.clone(),
            mesh: scene.meshes.len() as u32,
            transform: DAffine3::IDENTITY,
        });
        scene.meshes.push(mesh);
    }
    Ok(())
}

fn positions(mesh: &tobj::Mesh) -> impl Iterator<Item = DVec3> + '_ {
    mesh.positions.chunks_exact(3).map(|p| DVec3::new(p[0], p[1], p[2]))
}

/// Joins the models of one object, which tobj splits by material.
///
/// Vertices that are alike in position, normal, texture coordinate and colour become one again. Without normals they stay apart:
/// separate vertices at one place are then the only way a file can ask for a sharp edge.
fn merge(
    run: &[tobj::Model],
    name: String,
    origin: DVec3,
    default_material: u32,
    with_colours: bool,
    warnings: &mut Vec<String>,
) -> Result<Mesh, SceneError> {
    let complete = |values: usize, per: usize, m: &tobj::Mesh| values / per == m.positions.len() / 3;
    let drawn = || run.iter().map(|m| &m.mesh).filter(|m| !m.indices.is_empty());
    let with_normals = drawn().all(|m| complete(m.normals.len(), 3, m));
    let with_uvs = drawn().all(|m| complete(m.texcoords.len(), 2, m));
    if !with_normals && drawn().any(|m| !m.normals.is_empty()) {
        warnings
            .push(format!("mesh \"{name}\": some corners have no normal; all are computed from the faces"));
    }
    if !with_uvs && drawn().any(|m| !m.texcoords.is_empty()) {
        warnings.push(format!(
            "mesh \"{name}\": some corners have no texture coordinates; they count as (0, 0) throughout"
        ));
    }
    let mut mesh = Mesh { name, origin, ..Mesh::default() };
    let mut known: HashMap<([u32; 8], [u8; 4]), u32> = HashMap::new();
    for source in drawn() {
        let mut remap = Vec::with_capacity(source.positions.len() / 3);
        for (i, world) in positions(source).enumerate() {
            let p = (world - origin).as_vec3();
            let n = if with_normals {
                let n = &source.normals[3 * i..3 * i + 3];
                // Normalised in f64: the file's own length may overflow f32.
                DVec3::new(n[0], n[1], n[2]).normalize_or_zero().as_vec3()
            } else {
                Vec3::ZERO
            };
            // OBJ counts v upwards from the bottom row of the image.
            let uv = if with_uvs {
                Vec2::new(source.texcoords[2 * i] as f32, 1.0 - source.texcoords[2 * i + 1] as f32)
            } else {
                Vec2::ZERO
            };
            let colour = if with_colours {
                let colour = &source.vertex_color[3 * i..3 * i + 3];
                let byte = |k: usize| channel(colour[k], 1.0).unwrap_or(u8::MAX);
                [byte(0), byte(1), byte(2), u8::MAX]
            } else {
                [u8::MAX; 4]
            };
            let key = [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y].map(f32::to_bits);
            let next = mesh.positions.len() as u32;
            let index = if with_normals { *known.entry((key, colour)).or_insert(next) } else { next };
            if index == next {
                mesh.positions.push(p);
                if with_normals {
                    mesh.normals.push(n);
                }
                if with_uvs {
                    mesh.uvs.push(uv);
                }
                if with_colours {
                    mesh.colours.push(colour);
                }
            }
            remap.push(index);
        }
        let material = source.material_id.map_or(default_material, |m| m as u32);
        for corners in source.indices.chunks_exact(3) {
            mesh.triangles.push([0, 1, 2].map(|k| remap[corners[k] as usize]));
            mesh.triangle_materials.push(material);
        }
    }
    repair_normals(&mut mesh);
    Ok(mesh)
}

fn drop_unused_default(scene: &mut Scene, default_material: u32) {
    let used = scene.meshes.iter().any(|m| m.triangle_materials.contains(&default_material));
    if !used {
        scene.materials.pop();
    }
}

#[cfg(test)]
mod tests;
