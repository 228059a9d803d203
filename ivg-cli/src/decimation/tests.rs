use glam::{DAffine3, DVec3, Vec3};
use ivg_scene::{Material, Mesh, Node, Scene};

use super::Decimation;

/// A height field of `n` × `n` squares over 2 m, one of which shines; bent if `height` is not 0.
fn field(n: u32, height: f32) -> Mesh {
    let mut mesh = Mesh { name: "field".into(), ..Mesh::default() };
    for j in 0..=n {
        for i in 0..=n {
            let [x, z] = [i, j].map(|k| 2.0 * k as f32 / n as f32 - 1.0);
            mesh.positions.push(Vec3::new(x, height * (1.0 - x * x) * (1.0 - z * z), z));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [0, 1, n + 2, n + 1].map(|k| j * (n + 1) + i + k);
            mesh.triangles.extend([[a, c, b], [a, d, c]]);
            mesh.triangle_materials.extend([u32::from((i, j) == (n / 2, n / 2)); 2]);
        }
    }
    mesh
}

/// A bent field of 800 faces twice, the second time ten times as large, and a flat square of two.
fn scene() -> Scene {
    let plain = Material { name: "plain".into(), ..Material::default() };
    let shining = Material { name: "shining".into(), emission: Vec3::ONE, ..Material::default() };
    let square = Mesh { triangle_materials: vec![0; 2], ..field(1, 0.0) };
    let place = |mesh, scale, x| Node {
        name: format!("node at {x}"),
        mesh,
        transform: DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            glam::DQuat::IDENTITY,
            DVec3::X * x,
        ),
    };
    Scene {
        meshes: vec![field(20, 0.5), square],
        nodes: vec![place(0, 1.0, 0.0), place(0, 10.0, 30.0), place(1, 1.0, -5.0)],
        materials: vec![plain, shining],
        ..Scene::default()
    }
}

fn emissive_area(scene: &Scene) -> f64 {
    let flat = scene.flatten();
    let emits = |t: &usize| flat.material(scene, *t).emission != Vec3::ZERO;
    (0..flat.triangles.len()).filter(emits).map(|t| flat.area(t)).sum()
}

#[test]
fn levels_have_the_faces_asked_for_and_all_of_the_light() {
    let scene = scene();
    let decimation = Decimation::new(&scene, &mut |_| {}).unwrap();
    let mut error = 0.0;
    for faces in [1602, 800, 160, 40] {
        let level = decimation.at_most(faces);
        level.scene.check().unwrap();
        assert_eq!(level.scene.triangle_count() as usize, level.faces);
        // A collapse takes away two faces of the mesh, of which there are two nodes; a few more at its border.
        assert!(level.faces <= faces && level.faces + 12 > faces, "{} of {faces} faces", level.faces);
        assert_eq!(emissive_area(&level.scene), emissive_area(&scene));
        assert!(level.error >= error && (level.error == 0.0) == (faces == 1602), "{}", level.error);
        error = level.error;
        // The bounds of the flat square, which the others do not reach: it has lost nothing, being off by more than they.
        assert_eq!(level.scene.bounds().0.x, -6.0);
    }
}

/// Collapses of flat parts cost nothing, all of them the same: still no more are made than asked for.
#[test]
fn flat_parts_lose_no_more_faces_than_asked_for() {
    let mut scene = scene();
    scene.meshes[0] = field(20, 0.0);
    let decimation = Decimation::new(&scene, &mut |_| {}).unwrap();
    let level = decimation.at_most(801);
    assert!(level.faces <= 801 && level.faces > 770, "{}", level.faces);
    assert!(level.error < 1e-6, "{}", level.error);
}

#[test]
fn fewer_faces_than_there_are_at_least_give_the_coarsest_levels() {
    let scene = scene();
    let level = Decimation::new(&scene, &mut |_| {}).unwrap().at_most(1);
    // Two faces that shine, and one or two of each mesh, in three nodes.
    assert!((7..=14).contains(&level.faces), "{}", level.faces);
    level.scene.check().unwrap();
}
