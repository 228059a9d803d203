//! The scene that is built in: a Cornell box with a seated figure on a lotus plinth, all of it generated.
//!
//! The box is 1 m wide, high and deep, open towards the camera (+z), white but for a red left and a green right wall;
//! an area light hangs just below the ceiling. The figure has more than 100 000 triangles and stands close to both
//! coloured walls, so that the light they reflect shows on its flanks. Sizes and colours are this project's own.

mod figure;
mod plinth;
mod surface;

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::{Camera, Material, Mesh, Node, Scene};

/// Half the width and the depth of the box, and half its height \[m\].
const HALF: f32 = 0.5;
/// Height of the light below the ceiling \[m\]: enough to keep it apart from the ceiling in a coarse grid's arithmetic.
const LIGHT_GAP: f32 = 0.004;
/// Half edges of the light along x and z \[m\].
const LIGHT_HALF: [f32; 2] = [0.17, 0.13];
/// Height of the plinth \[m\].
const PLINTH_HEIGHT: f64 = 0.14;
/// Height of the figure \[m\].
const FIGURE_HEIGHT: f64 = 0.66;
/// How far the figure's flat underside reaches into the plinth \[m\], so that no gap shows.
const SEAT_DEPTH: f64 = 0.003;

const WHITE: u32 = 0;
const RED: u32 = 1;
const GREEN: u32 = 2;
const STONE: u32 = 3;
const LAMP: u32 = 4;

/// The built-in scene. Every call gives the same scene, bit for bit.
///
/// Its meshes are `box`, `figure`, `plinth`, `block` and `light`, each with a node of the same name; it has a camera.
#[must_use]
pub fn scene() -> Scene {
    let mut scene = Scene {
        name: "demo".into(),
        materials: vec![
            material("white", Vec3::new(0.76, 0.75, 0.72)),
            material("red", Vec3::new(0.62, 0.06, 0.05)),
            material("green", Vec3::new(0.12, 0.45, 0.10)),
            material("stone", Vec3::new(0.72, 0.70, 0.66)),
            Material {
                emission: Vec3::new(15.0, 13.0, 10.0),
                two_sided: false,
                ..material("lamp", Vec3::ZERO)
            },
        ],
        camera: Some(Camera {
            eye: DVec3::new(0.0, 0.5, 2.05),
            target: DVec3::new(0.0, 0.5, 0.0),
            up: DVec3::Y,
            // A square picture lies just inside the opening: 2 atan(0.5 / 1.55) is 0.624.
            vertical_fov: 0.615,
        }),
        ..Scene::default()
    };
    let figure_place = DAffine3::from_scale_rotation_translation(
        DVec3::splat(FIGURE_HEIGHT),
        glam::DQuat::IDENTITY,
        DVec3::new(0.0, PLINTH_HEIGHT - SEAT_DEPTH, -0.04),
    );
    let plinth_place = DAffine3::from_translation(DVec3::new(0.0, 0.0, -0.01));
    // Turned by the angle of the triangle 3-4-5, so that its sine and cosine are the same on every machine.
    let turned = DMat3::from_cols(DVec3::new(0.8, 0.0, -0.6), DVec3::Y, DVec3::new(0.6, 0.0, 0.8));
    let block_place = DAffine3::from_mat3_translation(turned, DVec3::new(0.37, 0.065, 0.36));
    for (mesh, place) in [
        (walls(), DAffine3::IDENTITY),
        (figure::mesh("figure", STONE), figure_place),
        (plinth::mesh("plinth", STONE, PLINTH_HEIGHT), plinth_place),
        (block(0.065), block_place),
        (light(), DAffine3::IDENTITY),
    ] {
        let name = mesh.name.clone();
        scene.nodes.push(Node { name, mesh: scene.meshes.len() as u32, transform: place });
        scene.meshes.push(mesh);
    }
    scene
}

fn material(name: &str, albedo: Vec3) -> Material {
    Material { name: name.into(), albedo, ..Material::default() }
}

/// Floor, ceiling, back, left and right wall; the fronts face inwards.
fn walls() -> Mesh {
    let mut mesh = Mesh { name: "box".into(), ..Mesh::default() };
    let up = Vec3::new(0.0, HALF, 0.0);
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| HALF * axis);
    quad(&mut mesh, up - y, z, x, WHITE);
    quad(&mut mesh, up + y, x, z, WHITE);
    quad(&mut mesh, up - z, x, y, WHITE);
    quad(&mut mesh, up - x, y, z, RED);
    quad(&mut mesh, up + x, z, y, GREEN);
    mesh
}

/// The lamp, shining down.
fn light() -> Mesh {
    let mut mesh = Mesh { name: "light".into(), ..Mesh::default() };
    let center = Vec3::new(0.0, 2.0 * HALF - LIGHT_GAP, 0.0);
    quad(&mut mesh, center, LIGHT_HALF[0] * Vec3::X, LIGHT_HALF[1] * Vec3::Z, LAMP);
    mesh
}

/// A cube of edge `2 * half` around the origin.
fn block(half: f32) -> Mesh {
    let mut mesh = Mesh { name: "block".into(), ..Mesh::default() };
    let [x, y, z] = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| half * axis);
    for (n, u, v) in [(x, y, z), (-x, z, y), (y, z, x), (-y, x, z), (z, x, y), (-z, y, x)] {
        quad(&mut mesh, n, u, v, WHITE);
    }
    mesh
}

/// Adds a rectangle with half edges `u` and `v`; its front is where u x v points.
fn quad(mesh: &mut Mesh, center: Vec3, u: Vec3, v: Vec3, material: u32) {
    let base = mesh.positions.len() as u32;
    mesh.positions.extend([center - u - v, center + u - v, center + u + v, center - u + v]);
    mesh.normals.extend([u.cross(v).normalize(); 4]);
    mesh.triangles.extend([[base, base + 1, base + 2], [base, base + 2, base + 3]]);
    mesh.triangle_materials.extend([material; 2]);
}

#[cfg(test)]
mod tests;
