//! Meshes: all primitives of a glTF mesh become one mesh with a material for each triangle.

use std::collections::HashMap;

use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use glam::{DVec3, Vec2, Vec3};

use super::accessor::Data;
use super::material::Coordinates;
use crate::geometry::repair_normals;
use crate::material::srgb_code;
use crate::{Material, Mesh, Scene, SceneError, Unsupported};

/// The colour of vertices of primitives without colours, in a mesh where others have them.
const WHITE: [u8; 4] = [255; 4];

/// Adds all meshes to the scene, index by index as in the file.
pub(super) fn read(
    data: &Data<'_>,
    coordinates: &[Coordinates],
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let default_material = scene.materials.len() as u32;
    for (i, source) in data.root.meshes.iter().enumerate() {
        let name = source.name.clone().unwrap_or_else(|| format!("mesh {i}"));
        let mut builder = Builder {
            data,
            coordinates,
            mesh: Mesh { name, ..Mesh::default() },
            with_normals: false,
            with_uvs: false,
            with_colours: false,
            shared: HashMap::new(),
            default_material,
        };
        let mut left_out = [0usize; 2];
        for primitive in &source.primitives {
            let triangles = matches!(
                primitive.mode,
                Checked::Valid(Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
            );
            if triangles {
                builder.add(primitive)?;
            } else {
                left_out[0] += 1;
            }
            left_out[1] += primitive.targets.iter().flatten().count();
        }
        let mesh = builder.finish();
        for (count, what) in left_out.into_iter().zip(["primitives of points or lines", "morph targets"]) {
            if count > 0 {
                let object = format!("mesh \"{}\"", mesh.name);
                scene.unsupported.push(Unsupported { object, what: format!("{count} {what}: left out") });
            }
        }
        scene.meshes.push(mesh);
    }
    if scene.meshes.iter().any(|m| m.triangle_materials.contains(&default_material)) {
        scene.materials.push(Material::default());
        scene.warnings.push("primitives without material: grey of albedo 0.5".into());
    }
    Ok(())
}

struct Builder<'a> {
    data: &'a Data<'a>,
    coordinates: &'a [Coordinates],
    mesh: Mesh,
    with_normals: bool,
    with_uvs: bool,
    with_colours: bool,
    /// First vertex and vertex count of attributes that several primitives share, by accessors and material where that
    /// matters to the texture coordinates.
    shared: HashMap<[Option<usize>; 5], (u32, u32)>,
    default_material: u32,
}

impl Builder<'_> {
    fn add(&mut self, primitive: &Primitive) -> Result<(), SceneError> {
        let material = primitive.material.map(|m| m.value());
        let place = material.and_then(|m| self.coordinates.get(m).copied()).unwrap_or_default();
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|i| i.value());
        let uv = attribute(Semantic::TexCoords(place.set));
        let moved = place.linear != Coordinates::default().linear || place.offset != Vec2::ZERO;
        let normal = attribute(Semantic::Normals);
        let position = attribute(Semantic::Positions);
        let colour = attribute(Semantic::Colors(0));
        let key = [position, normal, uv, colour, material.filter(|_| moved && uv.is_some())];
        let (base, count) = match self.shared.get(&key) {
            Some(known) => *known,
            None => {
                let added = self.vertices([position, normal, uv, colour], &place)?;
                self.shared.insert(key, added);
                added
            }
        };
        let order = match primitive.indices {
            Some(accessor) => self.data.indices(accessor.value())?,
            None => (0..count).collect(),
        };
        if let Some(index) = order.iter().find(|i| **i >= count) {
            let what = format!("a triangle names vertex {index}, but the primitive has only {count}");
            return Err(SceneError::object("mesh", &self.mesh.name, what));
        }
        let before = self.mesh.triangles.len();
        let mut triangle = |a: usize, b: usize, c: usize| {
            self.mesh.triangles.push([order[a], order[b], order[c]].map(|i| base + i));
        };
        let corners = order.len();
        match primitive.mode {
            Checked::Valid(Mode::TriangleStrip) => {
                for i in 2..corners {
                    // Every other triangle of a strip turns round (glTF 2.0, section 3.7.2.1).
                    if i % 2 == 0 { triangle(i - 2, i - 1, i) } else { triangle(i - 2, i, i - 1) }
                }
            }
            Checked::Valid(Mode::TriangleFan) => (2..corners).for_each(|i| triangle(i - 1, i, 0)),
            _ => (0..corners / 3).for_each(|t| triangle(3 * t, 3 * t + 1, 3 * t + 2)),
        }
        let material = material.map_or(self.default_material, |m| m as u32);
        let added = self.mesh.triangles.len() - before;
        self.mesh.triangle_materials.extend(std::iter::repeat_n(material, added));
        Ok(())
    }

    /// Adds the vertices of a primitive, of which these are the accessors; returns the first one's index and their number.
    fn vertices(
        &mut self,
        [position, normal, uv, colour]: [Option<usize>; 4],
        place: &Coordinates,
    ) -> Result<(u32, u32), SceneError> {
        let bad = |what: &str| SceneError::object("mesh", &self.mesh.name, what);
        let position = position.ok_or_else(|| bad("a primitive without positions"))?;
        let positions = self.data.values::<3>(position)?;
        let normals = normal.map(|n| self.data.values::<3>(n)).transpose()?;
        let uvs = uv.map(|t| self.data.values::<2>(t)).transpose()?;
        let colours = colour.map(|c| self.data.colours(c)).transpose()?;
        let count = positions.len();
        let lengths =
            [normals.as_ref().map(Vec::len), uvs.as_ref().map(Vec::len), colours.as_ref().map(Vec::len)];
        for other in lengths.into_iter().flatten() {
            if other != count {
                return Err(bad(&format!("attributes of {count} and {other} vertices in one primitive")));
            }
        }
        let base = self.mesh.positions.len();
        if base + count > u32::MAX as usize {
            return Err(bad("more than 2^32 vertices"));
        }
        self.mesh.positions.extend(positions.into_iter().map(Vec3::from_array));
        self.with_normals |= normals.is_some();
        self.with_uvs |= uvs.is_some();
        self.with_colours |= colours.is_some();
        // Zero marks a normal that is computed in the end. A normal that is not finite stays, for the check to name it.
        let unit = |n: [f32; 3]| {
            let n = Vec3::from_array(n);
            if n.is_finite() { n.as_dvec3().normalize_or(DVec3::ZERO).as_vec3() } else { n }
        };
        match normals {
            Some(normals) => self.mesh.normals.extend(normals.into_iter().map(unit)),
            None => self.mesh.normals.resize(base + count, Vec3::ZERO),
        }
        let moved = |uv: [f32; 2]| place.linear * Vec2::from_array(uv) + place.offset;
        match uvs {
            Some(uvs) => self.mesh.uvs.extend(uvs.into_iter().map(moved)),
            None => self.mesh.uvs.resize(base + count, Vec2::ZERO),
        }
        // Linear in glTF (2.0, section 3.7.2.1).
        let codes = |[r, g, b, alpha]: [f32; 4]| {
            [srgb_code(r), srgb_code(g), srgb_code(b), (alpha * 255.0).round() as u8]
        };
        match colours {
            Some(colours) => self.mesh.colours.extend(colours.into_iter().map(codes)),
            None => self.mesh.colours.resize(base + count, WHITE),
        }
        Ok((base as u32, count as u32))
    }

    fn finish(mut self) -> Mesh {
        if self.with_normals {
            repair_normals(&mut self.mesh);
        } else {
            self.mesh.normals.clear();
        }
        if !self.with_uvs {
            self.mesh.uvs.clear();
        }
        if !self.with_colours {
            self.mesh.colours.clear();
        }
        self.mesh
    }
}
