//! The wgpu renderer against the CPU renderer. Without an adapter these tests fail and say what to install: they never
//! pass by being skipped.
//!
//! # The bound
//!
//! Both renderers do the same arithmetic in f32 on the same data, except:
//!
//! - Vectors of the grid are rounded to half precision: 2^-11 of each component, and reconstruction cancels no more
//!   than a factor of two between them: 2^-10 of the indirect part. Hardware may interpolate them with 8-bit weights:
//!   2^-9 of the difference of neighbouring vertices along each axis; together below 1 % of the indirect light in these
//!   scenes.
//! - Radiance harmonics are rounded to half precision too: 2^-11 of each of nine products. By the addition theorem and
//!   the inequality of Cauchy and Schwarz, the products of light from one direction add up in magnitude to no more than the
//!   irradiance of a surface that faces it; so the error is at most 2^-11 of what the brightest normal would get at that
//!   place, a quarter of the second part of the bound.
//! - Hardware converts sRGB texels within 0.5 / 255 of the display value, at most 0.9 % of a bright texel (IEC 61966-2-1
//!   has slope 2.3 at white).
//! - Which samples an edge covers may differ where an edge passes within 1/256 pixel of a sample, on the screen and in
//!   shadow maps. On the screen the sample then shows another surface: at most as many samples as edges are long
//!   \[samples\] times 2/256. In a shadow map one of the filter's 25 texels turns over for one light.
//!
//! So a pixel may differ by 2 % of its value plus 0.2 % of the brightest lit surface (a texel of the filter for one of
//! 16 points), and 0.5 % of the pixels may differ by more: edges in these scenes are below 80 samples long for each 100
//! samples of the picture's sides, and 0.8 * 2/256 of that is less.

#![cfg(feature = "gpu")]

use glam::{DAffine3, DQuat, DVec3};
use ivg_format::Quantity;
use ivg_grid::{Reconstruction, SpatialFilter};
use ivg_render::{
    GpuError, GpuMesh, GpuRenderer, Image, RenderError, RenderMesh, RenderOptions, RenderScene, compare,
    render_cpu,
};
use ivg_scene::SkyImage;
use pmesh_format::{LevelChange, Replay};
use scenes::progressive::{Sheet, sheet};

#[allow(dead_code, reason = "shared with the CPU tests and the example, which use other parts")]
mod scenes;

/// Share of the pixel's value by which the two pictures may differ.
const RELATIVE: f32 = 0.02;

/// Share of the brightest lit surface by which they may differ in addition.
const OF_BRIGHTEST: f32 = 0.002;

/// Share of the pixels that may differ by more.
const OUTLIERS: f64 = 0.005;

/// The renderer, or a failure that says what is missing.
fn renderer() -> GpuRenderer {
    GpuRenderer::new().unwrap_or_else(|error| panic!("the GPU tests need an adapter: {error}"))
}

/// Radiance of the brightest lit surface: light sources seen directly are far brighter.
fn brightest(image: &Image) -> f32 {
    image.pixels().iter().map(|pixel| pixel.max_element()).filter(|value| *value < 5.0).fold(0.0, f32::max)
}

/// Whether two pictures agree within the bound, and if not why.
fn agree(cpu: &Image, gpu: &Image) -> Result<(), String> {
    let absolute = OF_BRIGHTEST * brightest(cpu);
    let found = compare::difference(cpu, gpu, absolute, RELATIVE).map_err(|error| error.to_string())?;
    let share = found.beyond_tolerance as f64 / cpu.pixels().len() as f64;
    if share <= OUTLIERS {
        return Ok(());
    }
    let (x, y) = found.at;
    Err(format!(
        "{} pixels of the CPU and the GPU picture differ; the largest difference is {} at ({x}, {y}): CPU {}, GPU {}",
        found.beyond_tolerance,
        found.largest,
        cpu.pixel(x, y),
        gpu.pixel(x, y)
    ))
}

fn check(scene: &RenderScene, options: &RenderOptions) {
    let cpu = render_cpu(scene, options).unwrap();
    let gpu = renderer().render(scene, options).unwrap();
    if let Err(reason) = agree(&cpu, &gpu) {
        panic!("{reason}");
    }
    // The same comparison must tell this picture from one that is slightly wrong: five per cent too bright, and
    // shifted by a pixel.
    let brighter = Image::new(gpu.width(), gpu.height(), gpu.pixels().iter().map(|p| *p * 1.05).collect());
    assert!(agree(&cpu, &brighter).is_err(), "a picture five per cent too bright passes the comparison");
    let mut shifted = gpu.pixels().to_vec();
    shifted.rotate_right(1);
    let shifted = Image::new(gpu.width(), gpu.height(), shifted);
    assert!(agree(&cpu, &shifted).is_err(), "a picture shifted by a pixel passes the comparison");
}

fn options() -> RenderOptions {
    let mut options = RenderOptions::new(160, 120);
    options.supersampling = 1;
    options.shadow_size = 256;
    options
}

#[test]
fn a_box_with_area_light_and_shadows() {
    check(&scenes::cornell(false), &options());
}

#[test]
fn textures_point_spot_and_sun_light() {
    check(&scenes::lamps(), &options());
}

/// The image is put in where the device says that there is no surface.
#[test]
fn the_image_of_a_sky_is_behind_everything() {
    let mut scene = scenes::lamps();
    let texels = (0..32).map(|n| [n as f32 / 16.0, 0.5, (n % 8) as f32 / 8.0]).collect();
    scene.sky_image = Some(SkyImage { name: "sky".into(), width: 8, height: 4, rotation: 1.0, texels });
    check(&scene, &options());
    let [cpu, gpu] =
        [render_cpu(&scene, &options()).unwrap(), renderer().render(&scene, &options()).unwrap()];
    let upper = 0..2 * 160;
    assert_eq!(cpu.pixels()[upper.clone()], gpu.pixels()[upper]);
    assert_ne!(cpu.pixel(0, 0), cpu.pixel(159, 0));
}

#[test]
fn indirect_light_alone_with_every_reconstruction_and_filter() {
    let scene = scenes::cornell(true);
    for reconstruction in Reconstruction::OF_VECTORS {
        for filter in SpatialFilter::ALL {
            let mut options = options();
            options.direct = false;
            (options.reconstruction, options.filter) = (reconstruction, filter);
            check(&scene, &options);
        }
    }
}

#[test]
fn indirect_light_of_a_grid_without_obstacles() {
    let mut scene = scenes::cornell(true);
    let grid = scene.grid.as_mut().unwrap();
    for vertex in 0..grid.vertex_count() {
        grid.set_validity(vertex, 255);
        grid.set_blocked_edges(vertex, 0);
    }
    for filter in SpatialFilter::ALL {
        let mut options = options();
        options.direct = false;
        options.filter = filter;
        check(&scene, &options);
    }
}

#[test]
fn indirect_light_of_radiance_harmonics_with_and_without_obstacles() {
    let mut scene = scenes::cornell(false);
    scene.grid = Some(scenes::cornell_grid(Quantity::Radiance));
    let mut free = scene.clone();
    let grid = free.grid.as_mut().unwrap();
    for vertex in 0..grid.vertex_count() {
        grid.set_validity(vertex, 255);
        grid.set_blocked_edges(vertex, 0);
    }
    for filter in SpatialFilter::ALL {
        let mut options = options();
        options.direct = false;
        (options.reconstruction, options.filter) = (Reconstruction::Harmonics, filter);
        check(&scene, &options);
        check(&free, &options);
    }
}

#[test]
fn a_reconstruction_that_does_not_fit_the_grid_is_an_error() {
    let mut scene = scenes::cornell(true);
    let mut options = options();
    options.reconstruction = Reconstruction::Harmonics;
    let refused = |scene: &RenderScene, options: &RenderOptions| {
        let error = renderer().render(scene, options).unwrap_err();
        assert!(matches!(error, GpuError::Render(RenderError::Reconstruction { .. })), "{error}");
    };
    refused(&scene, &options);
    scene.grid = Some(scenes::cornell_grid(Quantity::Radiance));
    options.reconstruction = Reconstruction::ThreeVector;
    refused(&scene, &options);
    // Without indirect light nothing is reconstructed.
    options.indirect = false;
    assert!(renderer().render(&scene, &options).is_ok());
}

#[test]
fn everything_together_with_supersampling() {
    let mut options = options();
    (options.width, options.height, options.supersampling) = (80, 60, 2);
    check(&scenes::cornell(true), &options);
}

/// Where the sheet stands in the box; with a mirror image among its transforms.
fn stand(mirrored: bool) -> DAffine3 {
    let scale = DVec3::new(if mirrored { -0.6 } else { 0.6 }, 0.6, 0.6);
    let corner = DVec3::new(if mirrored { 0.8 } else { 0.2 }, 0.2, 0.45);
    DAffine3::from_scale_rotation_translation(scale, DQuat::from_rotation_x(-0.3), corner)
}

/// The room of [`scenes::cornell`] without what stands in it, and a texture for the sheet.
fn room() -> RenderScene {
    let mut scene = scenes::cornell(true);
    scene.meshes.truncate(scenes::ROOM_MESHES);
    scene.textures = scenes::lamps().textures;
    scene.materials[4].albedo_texture = Some(0);
    scene
}

/// The scene's materials for those of the sheet: textured, then green.
const SHEET_MATERIALS: [u32; 2] = [4, 2];

/// A mesh on the device at the level of `replay`, uploaded at once.
fn fresh(renderer: &GpuRenderer, replay: &Replay, transform: &DAffine3) -> GpuMesh {
    let mut mesh = GpuMesh::new(renderer, replay.header(), &SHEET_MATERIALS, transform, DVec3::ZERO).unwrap();
    mesh.upload(renderer, replay, &LevelChange::default()).unwrap();
    mesh
}

#[test]
fn a_progressive_mesh_that_was_stepped_looks_as_one_uploaded_at_once_and_as_on_the_cpu() {
    let (renderer, room, options) = (renderer(), room(), options());
    for (kind, mirrored) in [(Sheet::Plain, false), (Sheet::Full, true)] {
        let (mut replay, transform) = (sheet(kind), stand(mirrored));
        replay.set_level(4).unwrap();
        let mut kept = fresh(&renderer, &replay, &transform);
        let mut pictures: Vec<Image> = Vec::new();
        for level in [60, 700, 1089, 60] {
            let change = replay.set_level(level).unwrap();
            kept.upload(&renderer, &replay, &change).unwrap();
            let picture = renderer.render_with(&room, &options, &[&kept]).unwrap();
            let at_once = fresh(&renderer, &replay, &transform);
            assert_eq!(
                picture,
                renderer.render_with(&room, &options, &[&at_once]).unwrap(),
                "{kind:?} {level}"
            );
            pictures.push(picture);
            let mut on_cpu = room.clone();
            on_cpu.meshes.push(RenderMesh::from_indexed(
                &replay.mesh(),
                &SHEET_MATERIALS,
                &transform,
                DVec3::ZERO,
            ));
            let cpu = render_cpu(&on_cpu, &options).unwrap();
            if let Err(reason) = agree(&cpu, pictures.last().unwrap()) {
                panic!("{kind:?}, level {level}: {reason}");
            }
        }
        assert_eq!(pictures[0], pictures[3], "the same level after others");
        // The comparison tells levels apart, and a room without the sheet from one with it.
        assert!(agree(&pictures[0], &pictures[2]).is_err(), "{kind:?}: 60 vertices look like 1,089");
        assert!(agree(&pictures[2], &renderer.render(&room, &options).unwrap()).is_err());
    }
}

#[test]
fn a_step_uploads_what_it_changes() {
    let renderer = renderer();
    for kind in [Sheet::Plain, Sheet::Full] {
        let mut replay = sheet(kind);
        let mut mesh = fresh(&renderer, &replay, &stand(false));
        let whole = mesh.uploaded_bytes();
        // A wedge has a position and perhaps a normal and texture coordinates, a face three corners and perhaps a material.
        let (a_wedge, a_face) = if kind == Sheet::Full { (32, 16) } else { (24, 12) };
        assert_eq!(whole, u64::from(a_wedge * replay.wedge_count() + a_face * replay.face_count()));
        for level in [1085, 1089, 1080, 1081] {
            let change = replay.set_level(level).unwrap();
            let bytes = mesh.upload(&renderer, &replay, &change).unwrap();
            // All vertices are there. Corners: the ranges, and the gaps between them that are no longer than 16 faces. Normals
            // of the sheet that has none: those of corners of changed faces, which have 3 each before and after.
            let faces: u32 = change.changed.iter().map(|range| range.end - range.start).sum();
            let gone = if change.to < change.from { 2 * (change.from - change.to) } else { 0 };
            let gaps = 16 * change.changed.len() as u32;
            let normals = if kind == Sheet::Plain { 12 * (6 * (faces + gone) * 17) } else { 0 };
            assert!(
                bytes <= u64::from(12 * (faces + gaps) + normals),
                "{kind:?}, level {level}: {bytes} bytes"
            );
            assert!(bytes > 0 && 8 * bytes < whole, "{kind:?}, level {level}: {bytes} of {whole} bytes");
        }
        let before = mesh.uploaded_bytes();
        let change = replay.set_level(1081).unwrap();
        assert_eq!(mesh.upload(&renderer, &replay, &change).unwrap(), 0, "the same level");
        assert_eq!(mesh.uploaded_bytes(), before);
    }
}

#[test]
fn progressive_meshes_that_do_not_fit_the_scene_are_errors() {
    let (renderer, room, options) = (renderer(), room(), options());
    let replay = sheet(Sheet::Full);
    let problem = |scene: &RenderScene, mesh: &GpuMesh| {
        let error = renderer.render_with(scene, &options, &[mesh]).unwrap_err();
        assert!(matches!(error, GpuError::Render(RenderError::Progressive { .. })), "{error}");
        error.to_string()
    };
    let place = |materials: &[u32]| {
        let mut mesh =
            GpuMesh::new(&renderer, replay.header(), materials, &DAffine3::IDENTITY, DVec3::ZERO).unwrap();
        mesh.upload(&renderer, &replay, &LevelChange::default()).unwrap();
        mesh
    };
    assert!(problem(&room, &place(&[0, 5])).contains("a material that the scene does not have"));
    assert!(problem(&room, &place(&[0, 3])).contains("emits light"));
    let mut moved = room.clone();
    moved.origin = DVec3::X;
    assert!(problem(&moved, &place(&[0, 1])).contains("another origin"));
    // One that nothing was uploaded of is not there.
    let empty = GpuMesh::new(&renderer, replay.header(), &[9, 9], &DAffine3::IDENTITY, DVec3::X).unwrap();
    let without = renderer.render(&room, &options).unwrap();
    assert_eq!(renderer.render_with(&room, &options, &[&empty]).unwrap(), without);
}

#[test]
fn an_empty_scene_is_the_sky() {
    let mut scene = scenes::lamps();
    scene.meshes.clear();
    let gpu = renderer().render(&scene, &options()).unwrap();
    assert!(gpu.pixels().iter().all(|pixel| *pixel == scene.sky.unwrap()));
}

#[test]
fn what_does_not_fit_is_an_error_before_anything_is_allocated() {
    let mut options = options();
    options.area_samples = 100;
    let error = renderer().render(&scenes::cornell(false), &options).unwrap_err();
    assert_eq!(error, GpuError::Limit { what: "layers of shadow maps", needed: 500, limit: 256 });
    let mut broken = scenes::cornell(false);
    broken.meshes[0].triangles[0][0] = 1_000_000;
    assert!(matches!(renderer().render(&broken, &options), Err(GpuError::Render(_))));
}
