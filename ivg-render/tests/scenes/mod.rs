//! Small scenes made by code, for the tests and the example.

pub(crate) mod progressive;

use glam::{Affine3A, DVec3, Vec2, Vec3};
use ivg_format::{Lattice, Quantity};
use ivg_grid::{FillOptions, IrradianceGrid, fill, integrate};
use ivg_render::{RenderMesh, RenderScene};
use ivg_scene::{Camera, Light, LightKind, Material, Texture, TextureFormat};

/// Half sides of the ceiling light's rectangle along x and z \[m\], in a box of one metre.
pub(crate) const LIGHT_HALF_SIDES: [f32; 2] = [0.12, 0.10];

/// Radiance of the ceiling light \[W/(m² sr)\].
pub(crate) const LIGHT_RADIANCE: Vec3 = Vec3::new(18.4, 14.0, 6.8);

/// Number of meshes of [`cornell`] that make the room and its light; those after them stand in it.
pub(crate) const ROOM_MESHES: usize = 9;

const WHITE: Vec3 = Vec3::new(0.76, 0.75, 0.72);
const RED: Vec3 = Vec3::new(0.57, 0.05, 0.04);
const GREEN: Vec3 = Vec3::new(0.11, 0.38, 0.08);

/// A diffuse material that emits nothing.
pub(crate) fn diffuse(name: &str, albedo: Vec3) -> Material {
    Material { name: name.into(), albedo, ..Material::default() }
}

/// A rectangle `corner + s u + t v` with front normal `u x v`, cut into `cuts * cuts` pairs of triangles.
pub(crate) fn rectangle(corner: Vec3, u: Vec3, v: Vec3, cuts: u32, material: u32) -> RenderMesh {
    let mut mesh = RenderMesh { transform: Affine3A::IDENTITY, ..RenderMesh::default() };
    for row in 0..=cuts {
        for column in 0..=cuts {
            let uv = Vec2::new(column as f32, row as f32) / cuts as f32;
            mesh.positions.push(corner + u * uv.x + v * uv.y);
            mesh.uvs.push(uv);
        }
    }
    for row in 0..cuts {
        for column in 0..cuts {
            let a = row * (cuts + 1) + column;
            let (b, c, d) = (a + 1, a + cuts + 2, a + cuts + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
            mesh.triangle_materials.extend([material; 2]);
        }
    }
    mesh
}

/// The five outward faces of a block that stands on a floor, turned by `angle` \[rad\] about its upright axis.
pub(crate) fn block(centre: Vec3, half: Vec3, angle: f32, material: u32) -> Vec<RenderMesh> {
    let turn = glam::Quat::from_rotation_y(angle);
    let [x, y, z] = [Vec3::X * half.x, Vec3::Y * half.y, Vec3::Z * half.z].map(|axis| turn * axis);
    [(y, z, x), (z, y, -x), (z, x, y), (x, y, z), (y, x, -z)]
        .map(|(u, v, out)| rectangle(centre + out - u - v, 2.0 * u, 2.0 * v, 4, material))
        .to_vec()
}

/// A sphere of `2 * rows * rows` quadrilaterals with smooth normals.
pub(crate) fn sphere(centre: Vec3, radius: f32, rows: u32, material: u32) -> RenderMesh {
    let mut mesh = RenderMesh { transform: Affine3A::IDENTITY, ..RenderMesh::default() };
    let columns = 2 * rows;
    for row in 0..=rows {
        let (sin, cos) = (std::f32::consts::PI * row as f32 / rows as f32).sin_cos();
        for column in 0..=columns {
            let angle = std::f32::consts::TAU * column as f32 / columns as f32;
            let out = Vec3::new(sin * angle.cos(), cos, -sin * angle.sin());
            mesh.positions.push(centre + radius * out);
            mesh.normals.push(out);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = row * (columns + 1) + column;
            let (b, c, d) = (a + columns + 1, a + columns + 2, a + 1);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
            mesh.triangle_materials.extend([material; 2]);
        }
    }
    mesh
}

/// A camera in world space with 40 degrees of view.
pub(crate) fn camera(eye: [f64; 3], target: [f64; 3]) -> Camera {
    Camera { eye: eye.into(), target: target.into(), up: DVec3::Y, vertical_fov: 40f32.to_radians() }
}

/// A scene of meshes and materials, without lights of their own and without a grid.
pub(crate) fn scene(meshes: Vec<RenderMesh>, materials: Vec<Material>, camera: Camera) -> RenderScene {
    RenderScene {
        origin: DVec3::ZERO,
        meshes,
        materials,
        textures: Vec::new(),
        lights: Vec::new(),
        sky: None,
        sky_image: None,
        camera,
        grid: None,
    }
}

/// A Cornell box of one metre, open towards +z: red wall at the left, green at the right, a block and a finely cut
/// sphere, a rectangle of light in a hole of the ceiling. With `with_grid` also a grid of indirect light.
pub(crate) fn cornell(with_grid: bool) -> RenderScene {
    let [half_x, half_z] = LIGHT_HALF_SIDES;
    let materials = vec![
        diffuse("white", WHITE),
        diffuse("red", RED),
        diffuse("green", GREEN),
        Material { emission: LIGHT_RADIANCE, ..diffuse("light", Vec3::ZERO) },
        diffuse("ball", Vec3::new(0.8, 0.7, 0.5)),
    ];
    let mut meshes = vec![
        rectangle(Vec3::ZERO, Vec3::Z, Vec3::X, 8, 0),
        rectangle(Vec3::ZERO, Vec3::X, Vec3::Y, 8, 0),
        rectangle(Vec3::ZERO, Vec3::Y, Vec3::Z, 8, 1),
        rectangle(Vec3::X, Vec3::Z, Vec3::Y, 8, 2),
    ];
    // The ceiling around the hole, and the light that fills it.
    let (low, high) = ([0.5 - half_x, 0.5 - half_z], [0.5 + half_x, 0.5 + half_z]);
    for (x, z, wide, deep) in [
        (0.0, 0.0, low[0], 1.0),
        (high[0], 0.0, 1.0 - high[0], 1.0),
        (low[0], 0.0, 2.0 * half_x, low[1]),
        (low[0], high[1], 2.0 * half_x, 1.0 - high[1]),
    ] {
        meshes.push(rectangle(Vec3::new(x, 1.0, z), Vec3::X * wide, Vec3::Z * deep, 4, 0));
    }
    meshes.push(rectangle(
        Vec3::new(low[0], 1.0, low[1]),
        Vec3::X * 2.0 * half_x,
        Vec3::Z * 2.0 * half_z,
        1,
        3,
    ));
    meshes.extend(block(BLOCK_CENTRE, BLOCK_HALF, BLOCK_ANGLE, 0));
    meshes.push(sphere(BALL_CENTRE, BALL_RADIUS, 48, 4));
    let mut scene = scene(meshes, materials, camera([0.5, 0.5, 2.45], [0.5, 0.5, 0.0]));
    scene.grid = with_grid.then(|| cornell_grid(Quantity::Vectors));
    scene
}

const BLOCK_CENTRE: Vec3 = Vec3::new(0.33, 0.3, 0.32);
const BLOCK_HALF: Vec3 = Vec3::new(0.14, 0.3, 0.14);
const BLOCK_ANGLE: f32 = 0.3;
const BALL_CENTRE: Vec3 = Vec3::new(0.68, 0.2, 0.62);
const BALL_RADIUS: f32 = 0.2;

/// One bounce of light in the empty box, seen from 9 x 9 x 9 vertices; vertices inside block and ball are invalid and
/// the edges into them blocked.
pub(crate) fn cornell_grid(quantity: Quantity) -> IrradianceGrid {
    let dims = [9u16; 3];
    let lattice = Lattice::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let directions = integrate::fibonacci_sphere(2000);
    let inside = |p: Vec3| {
        let local = glam::Quat::from_rotation_y(-BLOCK_ANGLE) * (p - BLOCK_CENTRE);
        local.abs().cmplt(BLOCK_HALF).all() || p.distance(BALL_CENTRE) < BALL_RADIUS
    };
    let mut grid = IrradianceGrid::of(lattice, quantity).unwrap();
    for k in 0..dims[2] {
        for j in 0..dims[1] {
            for i in 0..dims[0] {
                let at = |i: u16, j: u16, k: u16| DVec3::from(lattice.position(i, j, k));
                // Vertices on the walls look from just inside.
                let p = at(i, j, k).clamp(DVec3::splat(1e-3), DVec3::splat(1.0 - 1e-3));
                let index = lattice.index(i, j, k) as usize;
                let radiance = |w| wall_radiance(p, w);
                match quantity {
                    Quantity::Vectors => {
                        grid.set(index, &integrate::hemisphere_vectors(&directions, radiance));
                    }
                    Quantity::Radiance => {
                        grid.set(index, &integrate::radiance_harmonics(&directions, radiance));
                    }
                }
                let here = inside(p.as_vec3());
                grid.set_validity(index, if here { 0 } else { 255 });
                let neighbours = [(i + 1, j, k), (i, j + 1, k), (i, j, k + 1)];
                let cut = |(i, j, k): (u16, u16, u16)| inside(at(i, j, k).as_vec3()) != here;
                let bits =
                    (0..3).filter(|axis| cut(neighbours[*axis])).fold(0, |bits, axis| bits | 1 << axis);
                grid.set_blocked_edges(index, bits);
            }
        }
    }
    fill(&grid, &FillOptions::default())
}

/// Radiance that arrives at `p` from direction `w` after one reflection at the walls of the empty box.
fn wall_radiance(p: DVec3, w: DVec3) -> DVec3 {
    let mut nearest = (f64::INFINITY, Vec3::ZERO, DVec3::ZERO);
    for (normal, offset, albedo) in [
        (DVec3::Y, 0.0, WHITE),
        (DVec3::NEG_Y, -1.0, WHITE),
        (DVec3::Z, 0.0, WHITE),
        (DVec3::X, 0.0, RED),
        (DVec3::NEG_X, -1.0, GREEN),
        // The open front is a black wall.
        (DVec3::NEG_Z, -1.0, Vec3::ZERO),
    ] {
        let distance = (offset - p.dot(normal)) / w.dot(normal);
        if w.dot(normal) < 0.0 && distance < nearest.0 {
            nearest = (distance, albedo, normal);
        }
    }
    let (distance, albedo, normal) = nearest;
    let to_light = DVec3::new(0.5, 1.0, 0.5) - (p + w * distance);
    let squared = to_light.length_squared();
    let cosines = to_light.dot(normal).max(0.0) * to_light.y.max(0.0) / squared;
    let area = f64::from(4.0 * LIGHT_HALF_SIDES[0] * LIGHT_HALF_SIDES[1]);
    let irradiance = LIGHT_RADIANCE.as_dvec3() * (area * cosines / squared);
    albedo.as_dvec3() * irradiance / std::f64::consts::PI
}

/// A textured floor and a coloured ball under a point light, a spot light and the sun, before a sky.
pub(crate) fn lamps() -> RenderScene {
    let mut texels = Vec::new();
    for y in 0..8u8 {
        for x in 0..8u8 {
            texels.extend(if (x + y) % 2 == 0 { [230, 200, 40] } else { [20 * x, 60, 30 * y] });
        }
    }
    let textured = Material { albedo_texture: Some(0), ..diffuse("floor", Vec3::ONE) };
    let mut floor = rectangle(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0, 1, 0);
    floor.uvs.iter_mut().for_each(|uv| *uv = *uv * 3.0 - 0.7);
    let ball = sphere(Vec3::new(0.1, 0.6, 0.0), 0.5, 24, 1);
    let mut scene = scene(
        vec![floor, ball],
        vec![textured, diffuse("ball", Vec3::new(0.2, 0.5, 0.7))],
        camera([1.5, 2.0, 4.0], [0.0, 0.3, 0.0]),
    );
    scene.textures =
        vec![Texture { name: "checks".into(), width: 8, height: 8, format: TextureFormat::Srgb8, texels }];
    let light = |name: &str, kind| Light { name: name.into(), kind };
    scene.lights = vec![
        light(
            "lamp",
            LightKind::Point { position: DVec3::new(-1.2, 1.5, 0.8), intensity: Vec3::new(3.0, 2.0, 1.0) },
        ),
        light(
            "spot",
            LightKind::Spot {
                position: DVec3::new(1.5, 2.0, 1.0),
                direction: Vec3::new(-1.0, -1.4, -0.8).normalize(),
                intensity: Vec3::new(2.0, 4.0, 8.0),
                inner_angle: 0.2,
                outer_angle: 0.5,
            },
        ),
        light(
            "sun",
            LightKind::Directional {
                direction: Vec3::new(0.4, -1.0, -0.3).normalize(),
                irradiance: Vec3::splat(1.5),
            },
        ),
    ];
    scene.sky = Some(Vec3::new(0.3, 0.4, 0.6));
    scene
}
