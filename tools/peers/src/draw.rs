//! A picture of a mesh with flat faces: orthographic, one light from the viewer's upper left, depth buffer.

use std::fs;
use std::path::Path;

use crate::Failure;
use crate::mesh::Mesh;

/// Where to look at the mesh from, and how large.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    /// Turn about the vertical axis \[degrees\], then tilt towards the viewer \[degrees\].
    pub(crate) turn: f32,
    pub(crate) tilt: f32,
    /// Centre of the picture and half of its smaller side, in the mesh's units.
    pub(crate) centre: [f32; 3],
    pub(crate) radius: f32,
    /// Pixels.
    pub(crate) width: usize,
    pub(crate) height: usize,
}

/// Samples along either side of a pixel.
const SAMPLES: usize = 3;
/// Direction to the light, as seen by the viewer (right, up, towards the viewer); of length 1.
const LIGHT: [f32; 3] = [-0.48, 0.64, 0.6];
/// Reflected light: of faces turned away from the light, and what is added towards it.
const SHADE: [f32; 2] = [0.18, 0.78];
const FRONT: [f32; 3] = [0.93, 0.89, 0.82];
/// Back faces, which show where a surface is turned over or open.
const BACK: [f32; 3] = [0.86, 0.35, 0.25];
const BACKGROUND: [f32; 3] = [0.055, 0.06, 0.075];

/// Writes the picture as PPM.
pub(crate) fn run(mesh: &Mesh, view: View, out: &Path) -> Result<(), Failure> {
    let (width, height) = (view.width * SAMPLES, view.height * SAMPLES);
    let mut depth = vec![f32::NEG_INFINITY; width * height];
    let mut colour = vec![BACKGROUND; width * height];
    let points: Vec<[f32; 3]> = mesh.positions.iter().map(|&p| seen(p, &view)).collect();
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|k| points[triangle[k] as usize]);
        fill(corners, width, height, &mut depth, &mut colour);
    }
    let mut bytes = format!("P6 {} {} 255\n", view.width, view.height).into_bytes();
    for y in 0..view.height {
        for x in 0..view.width {
            let samples = (0..SAMPLES * SAMPLES)
                .map(|k| colour[(y * SAMPLES + k / SAMPLES) * width + x * SAMPLES + k % SAMPLES]);
            let sum = samples.fold([0.0; 3], |a: [f32; 3], b| [a[0] + b[0], a[1] + b[1], a[2] + b[2]]);
            bytes.extend(sum.map(|x| encoded(x / (SAMPLES * SAMPLES) as f32)));
        }
    }
    fs::write(out, bytes).map_err(|error| format!("{}: {error}", out.display()).into())
}

/// Position in samples from the upper left corner; depth grows towards the viewer, in the same unit.
fn seen(p: [f32; 3], view: &View) -> [f32; 3] {
    let [x, y, z] = [0, 1, 2].map(|k| p[k] - view.centre[k]);
    let (sin, cos) = view.turn.to_radians().sin_cos();
    let (x, z) = (cos * x + sin * z, cos * z - sin * x);
    let (sin, cos) = view.tilt.to_radians().sin_cos();
    let (y, z) = (cos * y - sin * z, cos * z + sin * y);
    let samples = (view.width.min(view.height) * SAMPLES) as f32;
    let scale = 0.5 * samples / view.radius;
    let half = |pixels: usize| 0.5 * (pixels * SAMPLES) as f32;
    [half(view.width) + scale * x, half(view.height) - scale * y, scale * z]
}

fn fill([a, b, c]: [[f32; 3]; 3], width: usize, height: usize, depth: &mut [f32], colour: &mut [[f32; 3]]) {
    // y points down on the picture, so that a face turned to the viewer has a negative area here.
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area == 0.0 {
        return;
    }
    let light = shade([a, b, c], area < 0.0);
    let range = |axis: usize, most: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]) - 0.5;
        let high = a[axis].max(b[axis]).max(c[axis]) + 0.5;
        (low.max(0.0) as usize)..(high.max(0.0) as usize).min(most)
    };
    for y in range(1, height) {
        for x in range(0, width) {
            let (px, py) = (x as f32 + 0.5, y as f32 + 0.5);
            let weight =
                |p: [f32; 3], q: [f32; 3]| ((q[0] - p[0]) * (py - p[1]) - (q[1] - p[1]) * (px - p[0])) / area;
            let [u, v, w] = [weight(b, c), weight(c, a), weight(a, b)];
            if u < 0.0 || v < 0.0 || w < 0.0 {
                continue;
            }
            let z = u * a[2] + v * b[2] + w * c[2];
            let at = y * width + x;
            if z > depth[at] {
                depth[at] = z;
                colour[at] = light;
            }
        }
    }
}

/// Linear colour of a face.
fn shade([a, b, c]: [[f32; 3]; 3], front: bool) -> [f32; 3] {
    // In the viewer's axes, with y upwards.
    let edge = |p: [f32; 3]| [p[0] - a[0], a[1] - p[1], p[2] - a[2]];
    let (u, v) = (edge(b), edge(c));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = normal.iter().map(|x| x * x).sum::<f32>().sqrt();
    let towards = if front { 1.0 } else { -1.0 };
    let cosine = (0..3).map(|k| normal[k] * LIGHT[k]).sum::<f32>() / length * towards;
    let light = SHADE[0] + SHADE[1] * cosine.max(0.0);
    (if front { FRONT } else { BACK }).map(|x| x * light)
}

/// Linear light as a byte of sRGB (IEC 61966-2-1), by its power approximation.
fn encoded(x: f32) -> u8 {
    (255.0 * x.clamp(0.0, 1.0).powf(1.0 / 2.2) + 0.5) as u8
}
