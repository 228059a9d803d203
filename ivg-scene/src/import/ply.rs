//! PLY (Turk 1994): ascii and binary of both byte orders, faces as lists or triangle strips.
//!
//! The header only says what to expect: nothing is allocated from its counts, and data that ends early is an error.

mod header;
mod values;

use glam::{DAffine3, DVec3, Vec2, Vec3};

use super::channel as channel_byte;
use crate::geometry::{repair_normals, snapped_origin};
use crate::{Material, Mesh, Node, Scene, SceneError, Unsupported};
use header::{Element, Header, Kind, Property};
use values::Values;

/// Names of texture coordinates that programs write.
const UV_NAMES: [[&str; 2]; 4] =
    [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// Names of colours that programs write; the last one may be missing.
const COLOUR_NAMES: [[&str; 4]; 3] = [
    ["red", "green", "blue", "alpha"],
    ["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    ["r", "g", "b", "a"],
];

/// What is gathered while reading.
#[derive(Default)]
struct Gathered {
    positions: Vec<DVec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    colours: Vec<[u8; 4]>,
    triangles: Vec<[u32; 3]>,
    left_out: Vec<String>,
}

/// Reads a PLY file as one mesh with the default material.
pub(crate) fn read(name: &str, stem: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    let (header, body) = header::parse(name, bytes)?;
    let mut values = Values::new(name, bytes, body, header.encoding, header.lines);
    let mut gathered = Gathered::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => gathered.vertices(element, &mut values)?,
            "face" => gathered.polygons(element, &mut values)?,
            "tristrips" => gathered.strips(element, &mut values)?,
            other => {
                gathered.left_out.push(format!("element \"{other}\""));
                skip(element, &mut values)?;
            }
        }
    }
    gathered.into_scene(name, stem, &header)
}

/// The place of a property by name.
fn find(element: &Element, name: &str) -> Option<usize> {
    element.properties.iter().position(|p| p.name == name && matches!(p.kind, Kind::Scalar(_)))
}

/// A channel of a vertex's colour.
#[derive(Clone, Copy)]
struct Channel {
    property: usize,
    /// The value of full brightness.
    full: f64,
}

/// Where the colours of vertices are: red, green, blue and alpha, the last not always.
fn colour_channels(element: &Element) -> Option<([Channel; 3], Option<Channel>)> {
    let channel = |name: &str| {
        let property = find(element, name)?;
        let Kind::Scalar(scalar) = element.properties[property].kind else { return None };
        Some(Channel { property, full: scalar.full_brightness()? })
    };
    COLOUR_NAMES.iter().find_map(|[r, g, b, a]| Some(([channel(r)?, channel(g)?, channel(b)?], channel(a))))
}

/// Reads an element's values into `row`, one a scalar property, and its list `list` into `items`.
fn read_row(
    element: &Element,
    values: &mut Values<'_>,
    list: Option<usize>,
    row: &mut [f64],
    items: &mut Vec<f64>,
) -> Result<(), SceneError> {
    for (i, Property { kind, .. }) in element.properties.iter().enumerate() {
        match *kind {
            Kind::Scalar(scalar) => row[i] = values.next(scalar)?,
            Kind::List { count, item } => {
                let length = values.next(count)?;
                if !(length >= 0.0 && length.fract() == 0.0) {
                    return Err(values.error(format!("list of {length} items")));
                }
                items.clear();
                let mut read = 0.0;
                while read < length {
                    let value = values.next(item)?;
                    if Some(i) == list {
                        items.push(value);
                    }
                    read += 1.0;
                }
                if Some(i) == list {
                    // A later list must not overwrite the one that is wanted.
                    row[i] = length;
                }
            }
        }
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values<'_>) -> Result<(), SceneError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    let (mut row, mut items) = (vec![0.0; element.properties.len()], Vec::new());
    for _ in 0..element.count {
        read_row(element, values, None, &mut row, &mut items)?;
    }
    Ok(())
}

impl Gathered {
    fn vertices(&mut self, element: &Element, values: &mut Values<'_>) -> Result<(), SceneError> {
        let place = ["x", "y", "z"].map(|n| find(element, n));
        let [Some(x), Some(y), Some(z)] = place else {
            return Err(values.error("element \"vertex\" without x, y, z".into()));
        };
        let normal = match ["nx", "ny", "nz"].map(|n| find(element, n)) {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        let uv = UV_NAMES.iter().find_map(|[u, v]| Some([find(element, u)?, find(element, v)?]));
        let mut channels = colour_channels(element);
        if channels.is_none() && find(element, "red").is_some() {
            self.left_out.push("vertex colours that are no red, green and blue of a known type".into());
        }
        let (mut row, mut items) = (vec![0.0; element.properties.len()], Vec::new());
        for i in 0..element.count {
            if i > u64::from(u32::MAX) {
                return Err(values.error("more than 2^32 vertices".into()));
            }
            read_row(element, values, None, &mut row, &mut items)?;
            self.positions.push(DVec3::new(row[x], row[y], row[z]));
            if let Some([x, y, z]) = normal {
                let n = DVec3::new(row[x], row[y], row[z]);
                self.normals.push(if n.is_finite() { n.normalize_or_zero() } else { n }.as_vec3());
            }
            if let Some([u, v]) = uv {
                // Like OBJ, PLY files count v upwards from the bottom row of the image.
                self.uvs.push(Vec2::new(row[u] as f32, 1.0 - row[v] as f32));
            }
            if let Some((colour, alpha)) = channels {
                let byte = |channel: Channel| channel_byte(row[channel.property], channel.full);
                let bytes = colour.map(byte);
                match (bytes, alpha.map_or(Some(u8::MAX), byte)) {
                    ([Some(r), Some(g), Some(b)], Some(a)) => self.colours.push([r, g, b, a]),
                    _ => {
                        self.left_out.push(format!("vertex colours, as that of vertex {i} is out of range"));
                        self.colours = Vec::new();
                        channels = None;
                    }
                }
            }
        }
        Ok(())
    }

    fn polygons(&mut self, element: &Element, values: &mut Values<'_>) -> Result<(), SceneError> {
        self.lists(element, values, "face", |corners| {
            let Some((&first, rest)) = corners.split_first() else { return Vec::new() };
            rest.windows(2).map(|pair| [first, pair[0], pair[1]]).collect()
        })
    }

    /// Strips: each corner makes a triangle with the two before it, every other one turned round; a negative index ends a
    /// strip, and the next corner starts another.
    fn strips(&mut self, element: &Element, values: &mut Values<'_>) -> Result<(), SceneError> {
        self.lists(element, values, "triangle strip", |corners| {
            let mut triangles = Vec::new();
            for strip in corners.split(|c| *c < 0.0) {
                for (i, c) in strip.windows(3).enumerate() {
                    let turned = if i % 2 == 0 { [c[0], c[1], c[2]] } else { [c[1], c[0], c[2]] };
                    // Strips repeat a corner to turn; such triangles have no area.
                    if c[0] != c[1] && c[1] != c[2] && c[0] != c[2] {
                        triangles.push(turned);
                    }
                }
            }
            triangles
        })
    }

    fn lists(
        &mut self,
        element: &Element,
        values: &mut Values<'_>,
        what: &str,
        triangles: impl Fn(&[f64]) -> Vec<[f64; 3]>,
    ) -> Result<(), SceneError> {
        let list = element.properties.iter().position(|p| {
            matches!(p.kind, Kind::List { .. })
                && matches!(p.name.as_str(), "vertex_indices" | "vertex_index")
        });
        let Some(list) = list else {
            return Err(values.error(format!("element \"{}\" without the list vertex_indices", element.name)));
        };
        let (mut row, mut items) = (vec![0.0; element.properties.len()], Vec::new());
        for i in 0..element.count {
            read_row(element, values, Some(list), &mut row, &mut items)?;
            let vertices = self.positions.len();
            for t in triangles(&items) {
                if let Some(bad) =
                    t.iter().find(|c| !(**c >= 0.0 && **c < vertices as f64 && c.fract() == 0.0))
                {
                    let text = format!("{what} {i} names vertex {bad}, but there are {vertices} before it");
                    return Err(values.error(text));
                }
                self.triangles.push(t.map(|c| c as u32));
            }
        }
        Ok(())
    }

    fn into_scene(self, name: &str, stem: &str, header: &Header) -> Result<Scene, SceneError> {
        if self.triangles.is_empty() {
            return Err(SceneError::file(name, "has no faces; a cloud of points is no scene"));
        }
        if let Some(i) = self.positions.iter().position(|p| !p.as_vec3().is_finite()) {
            return Err(SceneError::object("mesh", stem, format!("position of vertex {i} is not finite")));
        }
        let (min, max) = (self.positions.iter())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(*p), max.max(*p)));
        let origin = snapped_origin(min, max);
        let mut mesh = Mesh {
            name: stem.into(),
            origin,
            positions: self.positions.iter().map(|p| (*p - origin).as_vec3()).collect(),
            normals: self.normals,
            uvs: self.uvs,
            colours: self.colours,
            triangle_materials: vec![0; self.triangles.len()],
            triangles: self.triangles,
        };
        repair_normals(&mut mesh);
        let texture = header.texture.iter().map(|t| format!("image \"{t}\""));
        Ok(Scene {
            nodes: vec![Node { name: stem.into(), mesh: 0, transform: DAffine3::IDENTITY }],
            meshes: vec![mesh],
            materials: vec![Material::default()],
            unsupported: (self.left_out.into_iter().chain(texture))
                .map(|what| Unsupported { object: name.into(), what: format!("{what}: left out") })
                .collect(),
            ..Scene::default()
        })
    }
}

#[cfg(test)]
mod tests;
