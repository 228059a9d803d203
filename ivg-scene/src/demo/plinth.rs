//! The plinth: a turned profile whose middle tier is cut into lotus petals.

use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::Mesh;
use crate::geometry::area_weighted_normals;

/// Points around the plinth; a multiple of the petals.
const AROUND: usize = 224;
/// Petals of the lotus tier.
const PETALS: usize = 14;
/// Longer half axis of the foot (along x) and shorter one (along z) \[m\].
const FOOT: [f64; 2] = [0.37, 0.26];

/// Profile from the foot upwards: height (share of the whole), radius (share of the foot's), depth of the petals (share
/// of the radius). Steps between rows are small where the profile bends.
const PROFILE: [[f64; 3]; 25] = [
    [0.00, 1.000, 0.0],
    [0.10, 1.000, 0.0],
    [0.14, 0.992, 0.0],
    [0.16, 0.975, 0.0],
    [0.18, 0.940, 0.0],
    [0.20, 0.885, 0.0],
    [0.22, 0.840, 0.0],
    [0.24, 0.815, 0.005],
    [0.27, 0.805, 0.015],
    [0.31, 0.815, 0.03],
    [0.36, 0.845, 0.045],
    [0.42, 0.885, 0.06],
    [0.48, 0.920, 0.07],
    [0.54, 0.945, 0.075],
    [0.60, 0.958, 0.07],
    [0.66, 0.955, 0.06],
    [0.71, 0.935, 0.045],
    [0.75, 0.905, 0.025],
    [0.78, 0.880, 0.01],
    [0.80, 0.872, 0.0],
    [0.82, 0.885, 0.0],
    [0.85, 0.900, 0.0],
    [0.95, 0.900, 0.0],
    [0.985, 0.890, 0.0],
    [1.00, 0.868, 0.0],
];

/// The plinth, its foot on y = 0.
pub(super) fn mesh(name: &str, material: u32, height: f64) -> Mesh {
    let mut mesh = Mesh { name: name.into(), ..Mesh::default() };
    for [y, radius, depth] in PROFILE {
        for step in 0..AROUND {
            let (sin, cos) = (TAU * step as f64 / AROUND as f64).sin_cos();
            let across = (step * PETALS % AROUND) as f64 / AROUND as f64;
            // 0 in the notch between two petals, 1 on the back of a petal.
            let petal = (4.0 * across * (1.0 - across)).sqrt();
            let r = radius * (1.0 - depth * (1.0 - petal));
            mesh.positions.push(DVec3::new(FOOT[0] * r * cos, height * y, FOOT[1] * r * sin).as_vec3());
        }
    }
    let ring = |row: usize, step: usize| (row * AROUND + step % AROUND) as u32;
    for row in 1..PROFILE.len() {
        for step in 0..AROUND {
            let [a, b] = [ring(row - 1, step), ring(row - 1, step + 1)];
            let [c, d] = [ring(row, step), ring(row, step + 1)];
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    mesh.normals = area_weighted_normals(&mesh.positions, &mesh.triangles);
    for (row, normal) in [(PROFILE.len() - 1, Vec3::Y), (0, Vec3::NEG_Y)] {
        cap(&mut mesh, row, normal);
    }
    mesh.triangle_materials = vec![material; mesh.triangles.len()];
    mesh
}

/// Closes a ring with a fan around its centre, with its own vertices, so that the rim stays sharp.
fn cap(mesh: &mut Mesh, row: usize, normal: Vec3) {
    let base = mesh.positions.len() as u32;
    for step in 0..AROUND {
        mesh.positions.push(mesh.positions[row * AROUND + step]);
    }
    let y = mesh.positions[row * AROUND].y;
    mesh.positions.push(Vec3::new(0.0, y, 0.0));
    mesh.normals.resize(mesh.positions.len(), normal);
    let centre = base + AROUND as u32;
    for step in 0..AROUND as u32 {
        let (a, b) = (base + step, base + (step + 1) % AROUND as u32);
        mesh.triangles.push(if normal.y > 0.0 { [centre, b, a] } else { [centre, a, b] });
    }
}
