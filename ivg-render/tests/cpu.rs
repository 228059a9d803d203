//! Pictures of the CPU renderer against closed forms, pixel by pixel.

use glam::{DVec3, Vec3};
use ivg_format::Lattice;
use ivg_grid::{GridValues, IrradianceGrid, Reconstruction, SpatialFilter, integrate};
use ivg_render::{Image, RenderOptions, RenderScene, compare, render_cpu};
use ivg_scene::{Light, LightKind, Material};

#[allow(dead_code, reason = "shared with the GPU tests and the example, which use other parts")]
mod scenes;

use scenes::{ROOM_MESHES, camera, cornell, diffuse, lamps, rectangle, scene};

const ALBEDO: Vec3 = Vec3::new(0.8, 0.5, 0.25);

/// One sample a pixel.
fn options(width: u32, height: u32) -> RenderOptions {
    let mut options = RenderOptions::new(width, height);
    options.supersampling = 1;
    options
}

/// A floor of 4 x 4 m in the plane y = 0, seen from above.
fn floor_scene() -> RenderScene {
    let floor = rectangle(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0, 7, 0);
    let mut camera = camera([0.0, 3.0, 0.0], [0.0, 0.0, 0.0]);
    camera.up = DVec3::NEG_Z;
    scene(vec![floor], vec![diffuse("floor", ALBEDO)], camera)
}

/// Asserts that each pixel of a picture of [`floor_scene`] shows `expected` of the floor point it looks at.
fn check_floor(image: &Image, relative: f32, expected: impl Fn(Vec3) -> Vec3) {
    // The floor is 3 m away under 40 degrees of view.
    let half = 3.0 * 20f32.to_radians().tan();
    for y in 0..image.height() {
        for x in 0..image.width() {
            let side = |pixel: u32, count: u32| (2.0 * pixel as f32 + 1.0) / count as f32 - 1.0;
            let aspect = image.width() as f32 / image.height() as f32;
            let point = half * Vec3::new(side(x, image.width()) * aspect, 0.0, side(y, image.height()));
            let (found, expected) = (image.pixel(x, y), expected(point));
            let error = (found - expected).abs().max_element() / expected.max_element().max(1e-6);
            assert!(error < relative, "pixel ({x}, {y}): {found} instead of {expected}");
        }
    }
}

fn light(kind: LightKind) -> Light {
    Light { name: "lamp".into(), kind }
}

#[test]
fn a_point_light_follows_the_inverse_square_law() {
    let mut scene = floor_scene();
    let (position, intensity) = (DVec3::new(0.3, 1.2, -0.2), Vec3::new(5.0, 3.0, 1.0));
    scene.lights.push(light(LightKind::Point { position, intensity }));
    let image = render_cpu(&scene, &options(48, 32)).unwrap();
    // f32 rounding of a position of 1 m seen from 3 m: 1e-6 relative; squared and divided a few times.
    check_floor(&image, 1e-5, |point| {
        let way = position.as_vec3() - point;
        ALBEDO / std::f32::consts::PI * intensity * way.normalize().y / way.length_squared()
    });
}

#[test]
fn sunlight_is_the_same_everywhere() {
    let mut scene = floor_scene();
    let direction = Vec3::new(0.5, -1.0, 0.3).normalize();
    scene.lights.push(light(LightKind::Directional { direction, irradiance: Vec3::splat(2.0) }));
    let image = render_cpu(&scene, &options(48, 32)).unwrap();
    check_floor(&image, 1e-5, |_| ALBEDO / std::f32::consts::PI * 2.0 * -direction.y);
}

#[test]
fn an_area_light_follows_the_closed_form_at_every_pixel() {
    let (half, height) = ([0.4, 0.3], 1.5);
    let mut scene = floor_scene();
    // Above the camera's near field of view nothing is seen of it: it is as high as half the camera, and faces down.
    let low = Vec3::new(-half[0], height, -half[1]);
    scene.meshes.push(rectangle(low, Vec3::X * 2.0 * half[0], Vec3::Z * 2.0 * half[1], 1, 1));
    scene.materials.push(Material { emission: Vec3::ONE, two_sided: false, ..diffuse("lamp", Vec3::ZERO) });
    // Seen from below the lamp, so that it hides nothing.
    scene.camera.eye.y = 1.0;
    let mut options = options(24, 16);
    options.area_samples = 64;
    let image = render_cpu(&scene, &options).unwrap();
    let view = 20f32.to_radians().tan();
    for y in 0..16 {
        for x in 0..24 {
            let point =
                view * Vec3::new((2 * x + 1) as f32 / 16.0 - 1.5, 0.0, (2 * y + 1) as f32 / 16.0 - 1.0);
            let exact = rectangle_irradiance(point, half, height);
            let found = image.pixel(x, y).x * std::f32::consts::PI / ALBEDO.x;
            // 64 evenly spread points are three times better than random ones at least (as the unit tests of the lights
            // check), which would be off by an eighth of the relative deviation over the lamp, 0.3 at most.
            assert!((found / exact - 1.0).abs() < 0.3 / 8.0 / 3.0, "({x}, {y}): {found} instead of {exact}");
        }
    }
}

/// Irradiance under a rectangle of radiance 1 that is parallel to the floor, by the closed form for a corner.
fn rectangle_irradiance(point: Vec3, half: [f32; 2], height: f32) -> f32 {
    let corner = |a: f32, b: f32| {
        let (x, y) = (a / height, b / height);
        let (sx, sy) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        0.5 * (x / sx * (y / sx).atan() + y / sy * (x / sy).atan())
    };
    let [right, left] = [half[0] - point.x, -half[0] - point.x];
    let [front, back] = [half[1] - point.z, -half[1] - point.z];
    corner(right, front) - corner(left, front) - corner(right, back) + corner(left, back)
}

#[test]
fn a_light_shows_its_radiance_on_the_side_that_emits() {
    let lamp =
        |two_sided| Material { emission: Vec3::new(7.0, 5.0, 3.0), two_sided, ..diffuse("lamp", Vec3::ZERO) };
    let up = rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 1, 0);
    let down = rectangle(Vec3::new(-1.0, 0.0, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 1, 0);
    let camera = floor_scene().camera;
    for (mesh, two_sided, expected) in [
        (up.clone(), false, Vec3::new(7.0, 5.0, 3.0)),
        (up, true, Vec3::new(7.0, 5.0, 3.0)),
        (down.clone(), true, Vec3::new(7.0, 5.0, 3.0)),
        (down, false, Vec3::ZERO),
    ] {
        let image = render_cpu(&scene(vec![mesh], vec![lamp(two_sided)], camera), &options(5, 5)).unwrap();
        assert_eq!(image.pixel(2, 2), expected, "two-sided: {two_sided}");
    }
}

#[test]
fn uniform_indirect_light_shows_albedo_times_radiance() {
    // White furnace: radiance L from everywhere gives E = pi L and a reflected radiance of albedo L, whatever the
    // normal; all reconstructions but the papers' are exact there.
    let lattice = Lattice::new([3, 4, 5], [-3.0, -1.0, -3.0], [3.0, 4.0, 3.0]).unwrap();
    let radiance = DVec3::new(0.9, 0.6, 0.3);
    let directions = integrate::fibonacci_sphere(100_000);
    let vectors = integrate::hemisphere_vectors(&directions, |_| radiance);
    let harmonics = integrate::radiance_harmonics(&directions, |_| radiance);
    let count = lattice.vertex_count() as usize;
    let grid = |values: GridValues| {
        IrradianceGrid::from_parts(lattice, values, vec![255; count], vec![0; count]).unwrap()
    };
    let mut scene = floor_scene();
    scene.meshes.push(scenes::sphere(Vec3::new(0.2, 0.3, 0.1), 0.4, 16, 0));
    for (reconstruction, values) in [
        (Reconstruction::ThreeVector, GridValues::from(vec![vectors; count])),
        (Reconstruction::SixVector, vec![vectors; count].into()),
        (Reconstruction::Harmonics, vec![harmonics; count].into()),
    ] {
        scene.grid = Some(grid(values));
        for filter in SpatialFilter::ALL {
            let mut options = options(30, 20);
            (options.reconstruction, options.filter) = (reconstruction, filter);
            let image = render_cpu(&scene, &options).unwrap();
            // The sum over 100,000 directions is off by up to 1e-4 of the integral (hemisphere borders).
            check_floor(&image, 3e-4, |_| ALBEDO * radiance.as_vec3());
        }
    }
}

#[test]
fn what_is_not_hit_shows_the_sky() {
    let mut scene = lamps();
    scene.lights.clear();
    let image = render_cpu(&scene, &options(32, 24)).unwrap();
    assert_eq!(image.pixel(0, 0), scene.sky.unwrap());
    let mut without = options(32, 24);
    without.sky = false;
    assert_eq!(render_cpu(&scene, &without).unwrap().pixel(0, 0), Vec3::ZERO);
}

#[test]
fn a_texture_is_seen_where_its_coordinates_say() {
    let mut scene = lamps();
    // The floor alone, from straight above, under a sun that shines straight down.
    scene.meshes.truncate(1);
    scene.lights =
        vec![light(LightKind::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::splat(1.0) })];
    scene.camera = floor_scene().camera;
    let image = render_cpu(&scene, &options(48, 32)).unwrap();
    check_floor(&image, 1e-3, |point| {
        // u runs along z, v along x, from the corner at -2, -2; three repeats shifted by 0.7.
        let uv = glam::Vec2::new(point.z + 2.0, point.x + 2.0) / 4.0 * 3.0 - 0.7;
        scene.textures[0].sample(uv) / std::f32::consts::PI
    });
    let mut plain = options(48, 32);
    plain.textures = false;
    check_floor(&render_cpu(&scene, &plain).unwrap(), 1e-5, |_| Vec3::splat(1.0 / std::f32::consts::PI));
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads() {
    let scene = cornell(true);
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render_cpu(&scene, &RenderOptions::new(60, 45))).unwrap()
    };
    let one = with_threads(1);
    assert_eq!(one, with_threads(2));
    assert_eq!(one, with_threads(5));
}

#[test]
fn a_scene_far_from_the_origin_gives_the_same_picture() {
    let near = cornell(false);
    let mut far = near.clone();
    // Powers of two, so that world positions in f64 stay exact.
    far.origin = DVec3::new(1_048_576.0, -524_288.0, 2_097_152.0);
    far.camera.eye += far.origin;
    far.camera.target += far.origin;
    let options = options(60, 45);
    assert_eq!(render_cpu(&near, &options).unwrap(), render_cpu(&far, &options).unwrap());
}

#[test]
fn supersampling_is_the_mean_of_a_larger_picture() {
    let scene = cornell(false);
    let mut fine = options(24, 18);
    fine.supersampling = 3;
    let large = render_cpu(&scene, &options(72, 54)).unwrap();
    let small = render_cpu(&scene, &fine).unwrap();
    let mut mean = Vec3::ZERO;
    for y in 27..30 {
        for x in 30..33 {
            mean += large.pixel(x, y) / 9.0;
        }
    }
    assert!((small.pixel(10, 9) - mean).abs().max_element() < 1e-6);
}

#[test]
fn effects_that_are_switched_off_are_missing_from_the_picture() {
    let scene = cornell(true);
    let all = render_cpu(&scene, &options(40, 30)).unwrap();
    for switch in [
        (|o: &mut RenderOptions| o.direct = false) as fn(&mut RenderOptions),
        |o| o.shadows = false,
        |o| o.indirect = false,
    ] {
        let mut less = options(40, 30);
        switch(&mut less);
        let picture = render_cpu(&scene, &less).unwrap();
        assert!(compare::rmse(&all, &picture).unwrap() > 1e-3);
    }
    // Direct and indirect light add up; each is rounded once more.
    let (mut direct, mut indirect) = (options(40, 30), options(40, 30));
    (direct.indirect, indirect.direct) = (false, false);
    let parts = [direct, indirect].map(|options| render_cpu(&scene, &options).unwrap());
    let emission = |x, y| if all.pixel(x, y).x > 10.0 { scenes::LIGHT_RADIANCE } else { Vec3::ZERO };
    for y in 0..30 {
        for x in 0..40 {
            let sum = parts[0].pixel(x, y) + parts[1].pixel(x, y) - emission(x, y);
            assert!((sum - all.pixel(x, y)).abs().max_element() < 1e-5, "({x}, {y})");
        }
    }
}

#[test]
fn the_box_is_lit_without_seams_or_leaks() {
    let scene = cornell(true);
    let mut options = options(320, 240);
    options.indirect = false;
    let image = render_cpu(&scene, &options).unwrap();
    // The core of the shadow under the ball gets no direct light at all.
    assert_eq!(image.pixel(207, 213), Vec3::ZERO);
    // The empty box is convex: every point sees the whole light, up to the corners.
    let mut empty = scene.clone();
    empty.meshes.truncate(ROOM_MESHES);
    let with = render_cpu(&empty, &options).unwrap();
    options.shadows = false;
    let without = render_cpu(&empty, &options).unwrap();
    for y in 0..240 {
        for x in 0..320 {
            let (with, without) = (with.pixel(x, y), without.pixel(x, y));
            // The filter's weights add up to 1 but for rounding.
            let error = (with - without).abs().max_element();
            assert!(error <= 1e-6 * without.max_element(), "({x}, {y}): {with} instead of {without}");
        }
    }
}
