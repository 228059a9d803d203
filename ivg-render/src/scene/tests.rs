use glam::Mat3;
use pmesh_format::Wedges;

use super::*;
use crate::Geometry;

fn triangle() -> RenderMesh {
    RenderMesh {
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
        triangles: vec![[0, 1, 2]],
        triangle_materials: vec![0],
        transform: Affine3A::IDENTITY,
        ..RenderMesh::default()
    }
}

fn scene_of(mesh: RenderMesh) -> RenderScene {
    RenderScene {
        origin: DVec3::ZERO,
        meshes: vec![mesh],
        materials: vec![Material::default()],
        textures: Vec::new(),
        lights: Vec::new(),
        sky: None,
        sky_image: None,
        camera: Camera { eye: DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 1.0 },
        grid: None,
    }
}

/// The error of a scene with one triangle after `change`.
fn error_after(change: impl FnOnce(&mut RenderScene)) -> RenderError {
    let mut scene = scene_of(triangle());
    assert_eq!(scene.check(), Ok(()));
    change(&mut scene);
    scene.check().unwrap_err()
}

#[test]
fn missing_normals_are_the_area_weighted_mean() {
    let mut mesh = triangle();
    // A second triangle around the first corner, facing +x with twice the area of the first.
    mesh.positions.extend([Vec3::new(0.0, 2.0, 0.0), Vec3::new(0.0, 0.0, 2.0)]);
    mesh.triangles = vec![[0, 1, 2], [0, 3, 4]];
    let normals = mesh.normals_or_computed();
    assert!((normals[0] - Vec3::new(4.0, 0.0, 1.0).normalize()).length() < 1e-6);
    assert_eq!((normals[1], normals[3]), (Vec3::Z, Vec3::X));
}

#[test]
fn normals_stay_perpendicular_and_outward_under_any_transform() {
    for transform in [
        Mat3::from_diagonal(Vec3::new(3.0, 0.2, 1.0)),
        Mat3::from_diagonal(Vec3::new(-1.0, 1.0, 1.0)),
        Mat3::from_cols(Vec3::new(1.0, 0.5, 0.0), Vec3::new(0.0, -2.0, 0.3), Vec3::new(0.1, 0.0, 1.0)),
    ] {
        let mut mesh = triangle();
        // Tilt the triangle out of the axes first.
        mesh.positions = [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.4), Vec3::new(0.0, 1.0, -0.7)].to_vec();
        mesh.transform = Affine3A::from_mat3(transform);
        let geometry = Geometry::new(&scene_of(mesh)).unwrap();
        let [a, b, c] = geometry.corners(0);
        let out = (b - a).cross(c - a).normalize();
        assert!((geometry.normals[0] - out).length() < 1e-5, "{transform}: {} {out}", geometry.normals[0]);
        // Outward is where the untransformed front faces.
        let front = transform * Vec3::new(-0.4, 0.7, 1.0);
        assert!(out.dot(front) > 0.0, "{transform}");
    }
}

#[test]
fn indices_out_of_range_name_mesh_and_triangle() {
    let vertex = error_after(|scene| scene.meshes[0].triangles[0][1] = 3);
    assert_eq!(vertex, RenderError::Index { mesh: 0, triangle: 0, what: "vertex", index: 3, count: 3 });
    let material = error_after(|scene| scene.meshes[0].triangle_materials[0] = 1);
    assert_eq!(material, RenderError::Index { mesh: 0, triangle: 0, what: "material", index: 1, count: 1 });
}

#[test]
fn attributes_must_be_one_each() {
    for change in [
        (|scene: &mut RenderScene| scene.meshes[0].normals = vec![Vec3::Z]) as fn(&mut RenderScene),
        |scene| scene.meshes[0].uvs = vec![Vec2::ZERO; 2],
        |scene| scene.meshes[0].triangle_materials.clear(),
    ] {
        assert!(matches!(error_after(change), RenderError::AttributeCount { mesh: 0, .. }));
    }
}

#[test]
fn values_that_are_not_finite_are_named() {
    for (change, name) in [
        ((|scene| scene.meshes[0].positions[1].y = f32::NAN) as fn(&mut RenderScene), "mesh 0"),
        (|scene| scene.meshes[0].transform.translation.x = f32::INFINITY, "mesh 0"),
        (|scene| scene.materials[0].emission.z = f32::NAN, "default"),
        (|scene| scene.sky = Some(Vec3::INFINITY), "sky"),
        (|scene| scene.sky_image = Some(sky([0.0, f32::NAN, 0.0])), "sky.hdr"),
        (
            |scene| {
                let kind = LightKind::Point { position: DVec3::NAN, intensity: Vec3::ONE };
                scene.lights.push(Light { name: "lamp".into(), kind });
            },
            "lamp",
        ),
    ] {
        let error = error_after(change).to_string();
        assert!(error.contains(name) && error.contains("not finite"), "{error}");
    }
}

#[test]
fn textures_must_exist_and_have_all_texels() {
    let missing = error_after(|scene| scene.materials[0].albedo_texture = Some(0));
    assert!(matches!(missing, RenderError::Texture { .. }));
    let short = error_after(|scene| {
        let format = ivg_scene::TextureFormat::Srgb8;
        scene.textures.push(Texture { name: "t".into(), width: 2, height: 2, format, texels: vec![0; 11] });
    });
    assert!(matches!(short, RenderError::Texture { .. }));
    let sky = error_after(|scene| scene.sky_image = Some(SkyImage { height: 2, ..sky([1.0; 3]) }));
    assert!(matches!(sky, RenderError::Texture { .. }));
}

/// A sky of one texel.
fn sky(texel: [f32; 3]) -> SkyImage {
    SkyImage { name: "sky.hdr".into(), width: 1, height: 1, rotation: 0.0, texels: vec![texel] }
}

#[test]
fn a_grid_with_missing_vertices_is_refused() {
    let error = error_after(|scene| {
        let lattice = ivg_format::Lattice::new([2; 3], [0.0; 3], [1.0; 3]).unwrap();
        scene.grid = Some(IrradianceGrid::new(lattice).unwrap());
    });
    assert_eq!(error, RenderError::GridNotFilled { missing: 8 });
}

#[test]
fn a_mesh_of_wedges_is_placed_in_f64_and_stays_smooth_across_seams() {
    // Two triangles that share an edge along a seam of texture coordinates, far from the origin.
    let mesh = IndexedMesh {
        origin: [1e7, 0.0, 0.0],
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        wedges: Wedges {
            vertices: vec![0, 1, 2, 0, 1, 3],
            uvs: vec![[0.0, 0.0], [0.5, 0.0], [0.0, 1.0], [1.0, 1.0], [0.25, 0.0], [0.0, 0.75]],
            ..Wedges::default()
        },
        triangles: vec![[0, 1, 2], [4, 3, 5]],
        materials: vec![1, 2],
        material_names: Vec::new(),
    };
    let transform = DAffine3::from_translation(DVec3::new(0.25, 0.0, 0.0));
    let render = RenderMesh::from_indexed(&mesh, &[7, 5], &transform, DVec3::new(1e7, -1.0, 0.0));
    assert_eq!(render.transform.transform_point3(render.positions[1]), Vec3::new(1.25, 1.0, 0.0));
    assert_eq!(render.uvs[3], Vec2::ONE);
    assert_eq!(render.triangle_materials, [5, u32::MAX]);
    // Both wedges of vertex 0 have the mean of +z and +y.
    let mean = Vec3::new(0.0, 1.0, 1.0).normalize();
    assert!((render.normals[0] - mean).length() < 1e-6 && render.normals[0] == render.normals[3]);
}
