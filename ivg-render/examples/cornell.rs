//! Renders a small box with a block, a ball and a light in its ceiling on the CPU and, if there is an adapter, on a
//! GPU; writes both pictures and prints how long each took and how far they are apart.
//!
//! ```text
//! cargo run --release -p ivg-render --example cornell -- [FOLDER]
//! ```

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use ivg_render::{Image, RenderOptions, auto_exposure, png, render_cpu, tonemap};

#[path = "../tests/scenes/mod.rs"]
#[allow(dead_code, reason = "shared with the tests, which use all scenes")]
mod scenes;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("."), PathBuf::from);
    for (name, scene) in [("cornell", scenes::cornell(true)), ("lamps", scenes::lamps())] {
        let options = RenderOptions::new(640, 480);
        let start = Instant::now();
        let cpu = render_cpu(&scene, &options)?;
        println!("{name}: CPU {:.2} s", start.elapsed().as_secs_f64());
        save(&folder, &format!("{name}-cpu.png"), &cpu, auto_exposure(&cpu))?;
        on_gpu(name, &scene, &options, &folder, &cpu)?;
    }
    Ok(())
}

#[cfg(feature = "gpu")]
fn on_gpu(
    name: &str,
    scene: &ivg_render::RenderScene,
    options: &RenderOptions,
    folder: &Path,
    cpu: &Image,
) -> Result<(), Box<dyn Error>> {
    use ivg_render::{GpuError, GpuRenderer, compare};

    let renderer = match GpuRenderer::new() {
        Err(GpuError::NoAdapter(reason)) => {
            println!("{name}: no GPU: {reason}");
            return Ok(());
        }
        renderer => renderer?,
    };
    let start = Instant::now();
    let gpu = renderer.render(scene, options)?;
    println!("{name}: {} {:.2} s", renderer.adapter_name(), start.elapsed().as_secs_f64());
    let exposure = auto_exposure(cpu);
    save(folder, &format!("{name}-gpu.png"), &gpu, exposure)?;
    println!(
        "{name}: difference {:.2e} W/(m² sr) RMS, {:.2e} CIE76 / 100",
        compare::rmse(cpu, &gpu)?,
        compare::cie76_exposed(cpu, &gpu, exposure)?
    );
    Ok(())
}

#[cfg(not(feature = "gpu"))]
fn on_gpu(
    name: &str,
    _: &ivg_render::RenderScene,
    _: &RenderOptions,
    _: &Path,
    _: &Image,
) -> Result<(), Box<dyn Error>> {
    println!("{name}: built without the wgpu renderer");
    Ok(())
}

fn save(folder: &Path, name: &str, image: &Image, exposure: f32) -> Result<(), png::PngError> {
    png::write(&folder.join(name), &tonemap(image, exposure))
}
