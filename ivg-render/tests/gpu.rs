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

use ivg_format::Quantity;
use ivg_grid::{Reconstruction, SpatialFilter};
use ivg_render::{
    GpuError, GpuRenderer, Image, RenderError, RenderOptions, RenderScene, compare, render_cpu,
};

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
