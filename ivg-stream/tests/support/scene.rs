//! A small scene with two progressive meshes and a grid, made from nothing but arithmetic.

use glam::{DAffine3, DVec3, Vec3};
use ivg_format::{EncodeOptions, GridSource, Lattice};
use ivg_scene::{Material, Mesh, Node, Scene};
use ivg_stream::{PackInput, PackOptions, pack};
use pmesh_format::{IndexedMesh, ProgressiveMesh};

use super::faulty::Files;

/// A strip of triangles winding upwards, whose last vertex always collapses onto the one before it.
pub(crate) fn strip(vertices: u32, radius: f32) -> ProgressiveMesh {
    let position = |v: u32| {
        let angle = v as f32 * 0.3;
        [radius * angle.cos(), v as f32 * 0.01, radius * angle.sin()]
    };
    let faces: Vec<[u32; 3]> =
        (2..vertices).map(|v| if v % 2 == 0 { [v - 2, v - 1, v] } else { [v - 1, v - 2, v] }).collect();
    let full = IndexedMesh::from_positions((0..vertices).map(position).collect(), faces.clone());
    ProgressiveMesh {
        origin: [10.0, 0.0, -3.0],
        positions: full.positions,
        wedges: full.wedges,
        base_vertices: 3,
        collapse: (3..vertices).map(|v| v - 1).collect(),
        wedge_collapse: (3..vertices).map(|v| v - 1).collect(),
        errors: (3..vertices).map(|v| 1.0 / v as f32).collect(),
        materials: faces.iter().map(|face| (face[2] % 2) as u16).collect(),
        faces,
        material_names: vec!["red".into(), "grey".into()],
    }
}

pub(crate) fn pmesh_bytes(mesh: &ProgressiveMesh) -> Vec<u8> {
    pmesh_format::encode(mesh, &pmesh_format::EncodeOptions::default()).expect("a valid mesh")
}

/// A grid whose values depend on `brightness` and differ everywhere.
pub(crate) fn grid_bytes(brightness: f32) -> Vec<u8> {
    let lattice = Lattice::new([6, 9, 7], [9.0, -0.5, -4.0], [11.0, 25.0, -2.0]).expect("a lattice");
    let vertex = |i: u64| {
        let value = brightness * (1.0 + (i as f32 * 0.37).sin());
        let mut vectors = [[[0.0; 3]; 3]; 6];
        for (hemisphere, channels) in vectors.iter_mut().enumerate() {
            let sign = if hemisphere % 2 == 0 { 1.0 } else { -1.0 };
            for channel in channels.iter_mut() {
                channel[hemisphere / 2] = sign * value;
            }
        }
        vectors
    };
    let vectors: Vec<_> = (0..lattice.vertex_count()).map(vertex).collect();
    let validity: Vec<u8> = (0..vectors.len()).map(|i| if i % 17 == 0 { 0 } else { 255 }).collect();
    let mut source = GridSource::new(lattice, &vectors);
    source.validity = Some(&validity);
    let options = EncodeOptions { vertices_per_slice: 3, ..EncodeOptions::default() };
    ivg_format::encode(&source, &options).expect("a valid grid")
}

fn material(name: &str, albedo: Vec3, emission: Vec3) -> Material {
    Material { name: name.into(), albedo, emission, ..Material::default() }
}

/// A scene of two strips and a plain lamp, and the bytes of its progressive meshes.
pub(crate) fn scene(vertices: u32) -> (Scene, Vec<Option<Vec<u8>>>) {
    let strips = [strip(vertices, 1.0), strip(vertices / 3, 0.5)];
    let mesh_of = |strip: &ProgressiveMesh, name: &str| {
        let full = strip.full();
        Mesh {
            name: name.into(),
            origin: DVec3::from_array(full.origin),
            positions: full.positions.iter().map(|&p| Vec3::from_array(p)).collect(),
            triangles: full.triangles.clone(),
            triangle_materials: full.materials.iter().map(|&m| u32::from(m)).collect(),
            ..Mesh::default()
        }
    };
    let lamp = Mesh {
        name: "lamp".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Z],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![2],
        ..Mesh::default()
    };
    let place = |mesh: u32, at: DVec3| Node {
        name: format!("node {mesh}"),
        mesh,
        transform: DAffine3::from_translation(at),
    };
    let scene = Scene {
        name: "strips".into(),
        meshes: vec![mesh_of(&strips[0], "strip"), lamp, mesh_of(&strips[1], "strip")],
        nodes: vec![place(0, DVec3::ZERO), place(1, DVec3::new(10.0, 30.0, -3.0)), place(2, DVec3::X)],
        materials: vec![
            material("red", Vec3::new(0.5, 0.25, 0.125), Vec3::ZERO),
            material("grey", Vec3::splat(0.5), Vec3::ZERO),
            material("lamp", Vec3::ZERO, Vec3::splat(8.0)),
        ],
        ..Scene::default()
    };
    let [first, second] = strips.map(|strip| Some(pmesh_bytes(&strip)));
    (scene, vec![first, None, second])
}

/// The files of a packed scene of `vertices` and `vertices / 3` vertices.
pub(crate) fn packed(vertices: u32, brightness: f32) -> Files {
    let (scene, meshes) = scene(vertices);
    let grid = grid_bytes(brightness);
    let home = tempfile::tempdir().expect("a temporary directory");
    let place = home.path().join("scene");
    let input = PackInput { scene: &scene, meshes: &meshes, grid: Some(&grid) };
    pack(&input, &place, &PackOptions::default()).expect("packing");
    files_of(&place)
}

pub(crate) fn files_of(directory: &std::path::Path) -> Files {
    let entries = std::fs::read_dir(directory).expect("a directory").map(|entry| entry.expect("an entry"));
    entries
        .map(|entry| {
            let name = entry.file_name().into_string().expect("an ASCII name");
            (name, std::fs::read(entry.path()).expect("a file"))
        })
        .collect()
}

pub(crate) fn write_files(files: &Files, directory: &std::path::Path) {
    for (name, bytes) in files {
        std::fs::write(directory.join(name), bytes).expect("writing a file");
    }
}
