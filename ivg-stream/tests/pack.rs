//! Packing a scene and reading the directory back.

mod support;

use std::path::Path;

use glam::DVec3;
use ivg_scene::{Scene, import};
use ivg_stream::{
    LoadError, LocalScene, PackError, PackInput, PackOptions, PackReport, SceneLimits, View, pack,
};
use support::scene::{files_of, grid_bytes, pmesh_bytes, scene, strip, write_files};

const VERTICES: u32 = 900;

fn pack_into(directory: &Path, coarse_vertices: u32) -> Result<PackReport, PackError> {
    let (scene, meshes) = scene(VERTICES);
    let grid = grid_bytes(1.0);
    let input = PackInput { scene: &scene, meshes: &meshes, grid: Some(&grid) };
    pack(&input, directory, &PackOptions { coarse_vertices })
}

fn open(directory: &Path) -> Result<LocalScene, LoadError> {
    LocalScene::open(directory, SceneLimits::default())
}

/// World positions of all corners of all triangles, sorted so that the order of triangles does not matter.
fn corners(scene: &Scene) -> Vec<([u64; 3], String)> {
    let mut corners: Vec<_> = scene
        .nodes
        .iter()
        .flat_map(|node| {
            let mesh = &scene.meshes[node.mesh as usize];
            mesh.triangles.iter().zip(&mesh.triangle_materials).flat_map(move |(triangle, &material)| {
                let material = scene.materials[material as usize].name.clone();
                triangle.map(|v| {
                    let local = mesh.origin + mesh.positions[v as usize].as_dvec3();
                    let world: DVec3 = node.transform.transform_point3(local);
                    (world.to_array().map(f64::to_bits), material.clone())
                })
            })
        })
        .collect();
    corners.sort_unstable();
    corners
}

#[test]
fn what_is_packed_is_read_back() {
    let home = tempfile::tempdir().unwrap();
    let report = pack_into(home.path(), 50).unwrap();
    let names: Vec<&str> = report.meshes.iter().map(|file| file.uri.as_str()).collect();
    assert_eq!(names, ["strip.pmesh", "strip-2.pmesh"]);
    for file in report.meshes.iter().chain(&report.grid) {
        assert_eq!(std::fs::metadata(home.path().join(&file.uri)).unwrap().len(), file.byte_length);
    }
    let mut local = open(home.path()).unwrap();
    // Positions in the world are the same to the last bit, although scene.glb has its own origins.
    let (source, _) = scene(VERTICES);
    assert!(corners(&local.scene_at(1.0)) == corners(&source));
    let lattice = local.grid_header().unwrap().lattice;
    let grid = local.grid().unwrap();
    assert_eq!((grid.received_count(), *grid.lattice()), (grid.vertex_count(), lattice));
    assert!(grid.is_filled());
    assert!(open(&home.path().join("scene.glb")).is_ok(), "scene.glb itself names the directory");
}

#[test]
fn scene_glb_stands_alone_with_coarse_meshes() {
    let home = tempfile::tempdir().unwrap();
    pack_into(home.path(), 50).unwrap();
    let glb = std::fs::read(home.path().join("scene.glb")).unwrap();
    let coarse = import::from_bytes("scene.glb", &glb).unwrap();
    let (source, _) = scene(VERTICES);
    let counts: Vec<usize> = coarse.meshes.iter().map(|mesh| mesh.positions.len()).collect();
    assert_eq!(counts, [50, 3, 50], "the lamp has no file of its own and is whole");
    let (low, high) = source.bounds();
    let (coarse_low, coarse_high) = coarse.bounds();
    // Coarse vertices are vertices of the full mesh; f64 in the nodes and f32 in the vertices hold them exactly.
    assert!(coarse_low.cmpge(low).all() && coarse_high.cmple(high).all());

    let text = glb[20..].iter().take_while(|b| **b != 0).copied().collect::<Vec<u8>>();
    let text = String::from_utf8_lossy(&text);
    assert!(text.contains("\"extensionsUsed\"") && text.contains("IVG_progressive_mesh"));
    assert!(!text.contains("extensionsRequired"));
}

#[test]
fn the_level_of_scene_glb_is_a_choice() {
    for (asked, vertices) in [(0, 3), (4, 4), (200, 200), (u32::MAX, VERTICES as usize)] {
        let home = tempfile::tempdir().unwrap();
        pack_into(home.path(), asked).unwrap();
        let local = open(home.path()).unwrap();
        assert_eq!(local.manifest().scene.meshes[0].positions.len(), vertices, "asked for {asked}");
    }
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let (a, b) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    pack_into(a.path(), 50).unwrap();
    pack_into(b.path(), 50).unwrap();
    assert!(files_of(a.path()) == files_of(b.path()));
}

#[test]
fn a_scene_without_grid_and_without_meshes_is_a_scene() {
    let home = tempfile::tempdir().unwrap();
    let (scene, _) = scene(VERTICES);
    let input = PackInput { scene: &scene, meshes: &[None, None, None], grid: None };
    let report = pack(&input, home.path(), &PackOptions::default()).unwrap();
    assert!(report.meshes.is_empty() && report.grid.is_none());
    let mut local = open(home.path()).unwrap();
    assert!(local.grid().is_none());
    assert!(corners(&local.scene_at(0.0)) == corners(&scene));
}

#[test]
fn packing_again_replaces_and_failing_leaves_what_was_there() {
    let home = tempfile::tempdir().unwrap();
    let place = home.path().join("scene");
    pack_into(&place, 50).unwrap();
    let first = files_of(&place);
    let (source, meshes) = scene(VERTICES);
    let grid = grid_bytes(1.0);

    let mut bad_mesh = meshes.clone();
    bad_mesh[2].as_mut().unwrap()[700] ^= 1;
    let mut bad_grid = grid.clone();
    bad_grid.pop();
    let mut other_material = strip(30, 1.0);
    other_material.materials[0] = 3;
    let no_such_material = vec![Some(pmesh_bytes(&other_material)), None, None];
    let mut no_triangle = strip(30, 1.0);
    (no_triangle.faces, no_triangle.materials) = (Vec::new(), Vec::new());
    let no_triangle = vec![Some(pmesh_bytes(&no_triangle)), None, None];
    for (meshes, grid, reason) in [
        (&bad_mesh, &grid, "\"strip\""),
        (&meshes, &bad_grid, "irradiance grid"),
        (&meshes[..2].to_vec(), &grid, "2 progressive meshes for 3"),
        (&no_such_material, &grid, "material 3"),
        (&no_triangle, &grid, "no triangle"),
    ] {
        let input = PackInput { scene: &source, meshes, grid: Some(grid) };
        let error = pack(&input, &place, &PackOptions::default()).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
        assert!(files_of(&place) == first, "{reason}");
    }
    pack_into(&place, 70).unwrap();
    assert!(files_of(&place) != first);
    assert_eq!(std::fs::read_dir(home.path()).unwrap().count(), 1, "nothing is left beside");
}

#[test]
fn a_directory_that_is_not_whole_is_refused_by_name() {
    let home = tempfile::tempdir().unwrap();
    pack_into(home.path(), 50).unwrap();
    let whole = files_of(home.path());
    let check = |change: &dyn Fn(&mut Vec<u8>), name: &str, reason: &str| {
        let mut files = whole.clone();
        change(files.get_mut(name).unwrap());
        write_files(&files, home.path());
        let error = open(home.path()).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(reason), "{error}");
    };
    for name in ["light.ivg", "strip.pmesh"] {
        check(&|bytes| bytes[2000] ^= 1, name, "byte");
        check(&|bytes| bytes.truncate(2000), name, "ends too early");
        check(&|bytes| bytes.push(0), name, "longer");
    }
    check(&|bytes| bytes.truncate(30), "scene.glb", "scene.glb");
    write_files(&whole, home.path());
    std::fs::remove_file(home.path().join("light.ivg")).unwrap();
    assert!(matches!(open(home.path()), Err(LoadError::Read { path, .. }) if path.ends_with("light.ivg")));
    #[cfg(unix)]
    {
        let outside = tempfile::tempdir().unwrap();
        std::fs::write(outside.path().join("light.ivg"), &whole["light.ivg"]).unwrap();
        std::os::unix::fs::symlink(outside.path().join("light.ivg"), home.path().join("light.ivg")).unwrap();
        assert!(open(home.path()).unwrap_err().to_string().contains("link out"));
    }
}

#[test]
fn a_mesh_is_shown_as_exactly_as_a_picture_needs() {
    let directory = tempfile::tempdir().unwrap();
    pack_into(directory.path(), 20).unwrap();
    let mut local = open(directory.path()).unwrap();
    let camera = local.manifest().scene.camera_or_framed();
    let mut vertices = |pixels: f32| {
        let scene = local.scene_for(&View { camera, height: 1000, pixels });
        scene.meshes.iter().map(|mesh| mesh.positions.len()).sum::<usize>()
    };
    let counts = [0.0, 0.5, 5.0, 50.0, f32::INFINITY].map(&mut vertices);
    assert!(counts.is_sorted_by(|finer, coarser| finer >= coarser), "{counts:?}");
    assert!(counts[0] > counts[1] && counts[1] > counts[4], "{counts:?}");
    let finest: usize = local.scene_at(1.0).meshes.iter().map(|mesh| mesh.positions.len()).sum();
    let coarsest: usize = local.scene_at(0.0).meshes.iter().map(|mesh| mesh.positions.len()).sum();
    assert_eq!((counts[0], counts[4]), (finest, coarsest));
}

#[test]
fn a_copy_of_a_mesh_follows_its_levels_by_what_changes() {
    let directory = tempfile::tempdir().unwrap();
    pack_into(directory.path(), 20).unwrap();
    let mut local = open(directory.path()).unwrap();
    let camera = local.manifest().scene.camera_or_framed();
    let (mut level, mut faces, mut rewritten) = (0, Vec::new(), Vec::new());
    for pixels in [1.0, 0.5, 0.55, 50.0, 0.4, 0.0] {
        let view = View { camera, height: 1000, pixels };
        let to = local.level_for(0, &view).unwrap();
        // What others look at in between makes no difference.
        let scene = local.scene_for(&view);
        let entry = local.manifest().meshes[0].clone();
        local.step(0, 5, 40).unwrap();
        let (replay, change) = local.step(0, level, to).unwrap();
        assert_eq!((change.from, change.to, replay.level()), (level, to, to));
        faces.resize(replay.face_count() as usize, [u32::MAX; 3]);
        for range in &change.changed {
            let range = range.start as usize..range.end as usize;
            faces[range.clone()].copy_from_slice(&replay.indices()[range]);
        }
        assert_eq!(faces, replay.indices(), "{pixels} pixels");
        rewritten.push(change.changed.iter().map(|range| range.end - range.start).sum::<u32>());
        level = to;
        // The scene shows the same level in the same place.
        let (mesh, node) = (&scene.meshes[entry.mesh], &scene.nodes[0]);
        assert_eq!(mesh.positions.len(), to as usize);
        let (own, header) = (replay.positions()[2], replay.header());
        let point = DVec3::from(header.origin) + glam::Vec3::from(own).as_dvec3();
        let shown = node.transform.transform_point3(mesh.origin + mesh.positions[2].as_dvec3());
        assert_eq!(entry.transform(&node.transform).transform_point3(point), shown);
    }
    assert!(rewritten[2] * 4 < rewritten[0], "a small step changes little: {rewritten:?}");
    // Beyond what there is the nearest; nothing without a mesh.
    assert_eq!(local.step(0, level, u32::MAX).unwrap().1.to, local.level_at(0, 1.0).unwrap());
    assert_eq!(local.step(0, level, 0).unwrap().1.to, local.level_at(0, 0.0).unwrap());
    assert!(local.step(9, 0, 5).is_none() && local.level_at(9, 1.0).is_none());
}
