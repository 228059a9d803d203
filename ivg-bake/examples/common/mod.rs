//! What the examples share: a scene, a plan, and which vertices are looked at.

use std::path::Path;

use glam::Vec3;
use ivg_bake::reference::Oracle;
use ivg_grid::IrradianceGrid;
use ivg_scene::import::{self, ImportOptions};
use ivg_scene::plan::{PlanOptions, analyse};
use ivg_scene::{EffectPlan, Material, Mesh, Node, Scene};

pub(crate) type AnyError = Box<dyn std::error::Error>;

/// At most `most` vertices that light reaches, half a step or more from every surface, or closer than that (`near`), in an
/// order scattered over the lattice.
pub(crate) fn vertices_at(oracle: &Oracle<'_>, grid: &IrradianceGrid, near: bool, most: usize) -> Vec<usize> {
    let lattice = grid.lattice();
    let half_step = 0.5 * lattice.step.into_iter().filter(|&s| s > 0.0).fold(f64::INFINITY, f64::min);
    let count = grid.vertex_count();
    // Multiples of the golden ratio's fraction scatter evenly; a stride coprime to the count visits every vertex once.
    let mut stride = (count as f64 * 0.618_033_988_749_895) as usize | 1;
    while gcd(stride, count) != 1 {
        stride += 2;
    }
    (0..count)
        .map(|n| n * stride % count)
        .filter(|&vertex| {
            let [i, j, k] = lattice.coords(vertex as u64);
            let is_near = || oracle.clearance(lattice.position(i, j, k).into()) < half_step;
            grid.is_valid(vertex) && is_near() == near
        })
        .take(most)
        .collect()
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Reflections that are followed at least: a thousandth of the light is left after so many in any room but one whose surfaces
/// absorb next to nothing.
const BOUNCES: u32 = 64;

/// What the scene calls for, all of which the oracle has too, followed until a thousandth of the light is left.
pub(crate) fn plan_of(scene: &Scene) -> EffectPlan {
    let options = PlanOptions { energy_cutoff: 1e-3, ..PlanOptions::default() };
    let plan = analyse(scene, &scene.flatten(), &options);
    EffectPlan { max_bounces: BOUNCES, ..plan }
}

/// The scene at `path` with the lights of `lights`; the built-in room without a path.
pub(crate) fn open(path: Option<&Path>, lights: Option<&Path>) -> Result<Scene, AnyError> {
    match path {
        Some(path) => Ok(import::load(path, &ImportOptions { lights: lights.map(Into::into) })?),
        None => Ok(lit_box()),
    }
}

/// A closed room of 2 m with two coloured walls, two boxes on its floor and a lit square under its ceiling.
fn lit_box() -> Scene {
    let mut mesh = Mesh { name: "room".into(), ..Mesh::default() };
    let mut add = |corner: [f32; 3], u: [f32; 3], v: [f32; 3], material: u32| {
        let [corner, u, v] = [corner, u, v].map(Vec3::from);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([corner, corner + u, corner + u + v, corner + v]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        mesh.triangle_materials.extend([material; 2]);
    };
    let mut add_box = |[x, y, z]: [f32; 3], [sx, sy, sz]: [f32; 3], materials: [u32; 6]| {
        add([x, y, z], [0.0, 0.0, sz], [0.0, sy, 0.0], materials[0]);
        add([x + sx, y, z], [0.0, sy, 0.0], [0.0, 0.0, sz], materials[1]);
        add([x, y, z], [sx, 0.0, 0.0], [0.0, 0.0, sz], materials[2]);
        add([x, y + sy, z], [0.0, 0.0, sz], [sx, 0.0, 0.0], materials[3]);
        add([x, y, z], [0.0, sy, 0.0], [sx, 0.0, 0.0], materials[4]);
        add([x, y, z + sz], [sx, 0.0, 0.0], [0.0, sy, 0.0], materials[5]);
    };
    add_box([0.0; 3], [2.0; 3], [1, 2, 0, 0, 0, 0]);
    add_box([0.3, 0.0, 0.4], [0.6, 1.2, 0.6], [0; 6]);
    add_box([1.1, 0.0, 0.9], [0.6, 0.6, 0.6], [0; 6]);
    // Counter-clockwise from below: the square shines down.
    add([0.7, 1.95, 0.7], [0.6, 0.0, 0.0], [0.0, 0.0, 0.6], 3);
    let colour = |name: &str, albedo: [f32; 3]| Material {
        name: name.into(),
        albedo: albedo.into(),
        ..Material::default()
    };
    let light =
        Material { emission: Vec3::new(18.0, 14.0, 7.0), two_sided: false, ..colour("light", [0.0; 3]) };
    Scene {
        name: "lit box".into(),
        meshes: vec![mesh],
        nodes: vec![Node { name: "box".into(), mesh: 0, transform: glam::DAffine3::IDENTITY }],
        materials: vec![
            colour("white", [0.75; 3]),
            colour("red", [0.6, 0.05, 0.05]),
            colour("green", [0.1, 0.4, 0.1]),
            light,
        ],
        ..Scene::default()
    }
}

/// `N` numbers between separators.
pub(crate) fn numbers<T: std::str::FromStr, const N: usize>(
    text: &str,
    separator: char,
) -> Result<[T; N], AnyError>
where
    T::Err: std::error::Error + 'static,
{
    let numbers: Vec<T> = text.split(separator).map(str::parse).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| format!("{text}: {N} numbers separated by {separator} are needed").into())
}
