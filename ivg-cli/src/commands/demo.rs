//! The paper's figure 1 in one command (Web3D 2008, figure 1): what a client shows of a scene while geometry and
//! indirect light arrive in different proportions.

mod report;
mod sheet;

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use ivg_format::{Encoding, Order};
use ivg_grid::Reconstruction;
use ivg_render::{Image, RenderOptions, RenderScene};
use ivg_scene::{Camera, EffectPlan};
use ivg_stream::blocking::{Server, Session};
use ivg_stream::{FetchOptions, Goal, Progress, ServerOptions};

use crate::args::{BakeSettings, DemoArguments, EffectsArgument, EstimatorArgument, StorageArguments};
use crate::baking::{self, LoadedScene};
use crate::failure::Failure;
#[cfg(feature = "gpu")]
use crate::live::Live;
use crate::packing::{self, Meshes};
use crate::picture::{self, Renderer};
use crate::scene_args::GridArgument;
use crate::{files, progress};

/// How much has arrived when each picture is drawn: share of the vertices of the meshes, share of the vertices of the
/// grid, and what stands below the picture (Web3D 2008, figure 1).
const STAGES: [Stage; 4] = [
    Stage { name: "a", geometry: 0.002, light: None, caption: "a: 0.2 % of the mesh, no grid" },
    Stage {
        name: "b",
        geometry: 0.002,
        light: Some(0.25),
        caption: "b: 0.2 % of the mesh, 25 % of the grid",
    },
    Stage { name: "c", geometry: 0.02, light: Some(0.25), caption: "c: 2 % of the mesh, 25 % of the grid" },
    Stage { name: "d", geometry: 1.0, light: Some(1.0), caption: "d: everything" },
];

/// Smaller meshes are not worth a stream and come whole with the scene; so is the room around the model.
const COARSE_VERTICES: u32 = 500;

/// Vertices of each slice that a bundle brings: small bundles, so that a quarter of the grid really is a quarter.
const PER_SLICE: u32 = 8;

#[derive(Debug)]
struct Stage {
    name: &'static str,
    geometry: f64,
    light: Option<f64>,
    caption: &'static str,
}

/// A picture of what had arrived.
#[derive(Debug)]
struct Shot {
    stage: &'static Stage,
    progress: Progress,
    /// Vertices drawn of the meshes that are streamed.
    vertices: u64,
    image: Image,
    render_time: Duration,
    /// Bytes of meshes that went to the GPU for this picture, if one draws.
    uploaded: Option<u64>,
}

pub(crate) fn run(arguments: &DemoArguments) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|error| Failure::file(out, error))?;
    let loaded = match &arguments.scene {
        Some(path) => LoadedScene::load(path, arguments.lights.as_deref())?,
        None => LoadedScene::from_scene(ivg_scene::demo::scene())?,
    };
    progress::say(&format!("{}: {} triangles", loaded.scene.name, loaded.flat.triangles.len()));
    let baked = baking::bake(&loaded, &settings(arguments))?;
    progress::say(&format!("baked {} photons in {:.1} s", baked.stats.photons, baked.elapsed.as_secs_f64()));
    let meshes = packing::order_meshes(&loaded.scene, COARSE_VERTICES, &StorageArguments::DEFAULT)?;
    progress::say(&format!(
        "ordered {} vertices in {:.1} s; {}",
        meshes.vertices,
        meshes.seconds,
        meshes.rounding.text()
    ));
    let directory = out.join("scene");
    let packed = packing::pack(&loaded.scene, &meshes, &baked.file, &directory, COARSE_VERTICES)?;

    let camera = loaded.scene.camera_or_framed();
    let renderer = Renderer::choose(arguments.renderer)?;
    let shots = stream(arguments, &directory, &baked.plan, camera, &renderer)?;

    let [.., last] = &shots[..] else { return Err(Failure::new("no picture was drawn")) };
    let exposure = ivg_render::auto_exposure(&last.image);
    for shot in &shots {
        let path = out.join(format!("fig1-{}.png", shot.stage.name));
        picture::write_png(&path, &shot.image, exposure)?;
    }
    sheet::write(&out.join("contact-sheet.png"), &shots, exposure)?;
    let report = report::Report::new(&report::Input {
        scene: &loaded.scene.name,
        triangles: loaded.flat.triangles.len(),
        renderer: &renderer.name(),
        shots: &shots,
        exposure,
        baked: &baked,
        meshes: &meshes,
        packed: &packed,
        elapsed: start.elapsed(),
    })?;
    files::write(&out.join("demo.json"), report.json().as_bytes())?;
    files::print(&report.text())?;
    files::print(&format!("\npictures and figures in {}\n", out.display()))?;
    Ok(ExitCode::SUCCESS)
}

fn settings(arguments: &DemoArguments) -> BakeSettings {
    BakeSettings {
        grid: GridArgument::Size(arguments.grid),
        budget: None,
        bounds: None,
        photons: Some(arguments.photons),
        accuracy: None,
        time: None,
        paths: None,
        estimator: EstimatorArgument::TrackLength,
        encoding: Encoding::PackedOct24,
        order: Order::Slices,
        effects: EffectsArgument::Needed,
        seed: 1,
        threads: None,
        per_slice: PER_SLICE,
    }
}

/// Serves the scene on loopback, streams it, and draws a picture at each stage.
fn stream(
    arguments: &DemoArguments,
    directory: &Path,
    plan: &EffectPlan,
    camera: Camera,
    renderer: &Renderer,
) -> Result<Vec<Shot>, Failure> {
    let server = Server::start(directory, ServerOptions::default()).map_err(Failure::new)?;
    let mut clock = Instant::now();
    let mut session =
        Session::open(&server.url(), FetchOptions::default(), &mut |_| {}).map_err(Failure::new)?;
    let mut streaming = Duration::ZERO;
    let mut shots = Vec::new();
    let mut drawn = Drawn {
        arguments,
        plan,
        camera,
        renderer,
        #[cfg(feature = "gpu")]
        live: None,
    };
    for stage in &STAGES {
        let goal = Goal { geometry: stage.geometry, light: stage.light.unwrap_or(0.0) };
        // The session's own clock runs on while a picture is drawn; only the streaming counts here.
        let progress = session.fetch_until(goal, &mut |_| {}).map_err(Failure::new)?;
        streaming += clock.elapsed();
        let progress = Progress { elapsed: streaming, ..progress };
        let shot = drawn.draw(stage, &mut session, progress)?;
        progress::say(&format!(
            "{} after {:.3} s of streaming, drawn in {:.1} s on {}",
            stage.caption,
            progress.elapsed.as_secs_f64(),
            shot.render_time.as_secs_f64(),
            renderer.name(),
        ));
        shots.push(shot);
        clock = Instant::now();
    }
    server.stop();
    Ok(shots)
}

/// How pictures are drawn, one after the other.
struct Drawn<'a> {
    arguments: &'a DemoArguments,
    plan: &'a EffectPlan,
    camera: Camera,
    renderer: &'a Renderer,
    /// What stays on the GPU; nothing before the first picture.
    #[cfg(feature = "gpu")]
    live: Option<Live<'a>>,
}

impl Drawn<'_> {
    fn draw(
        &mut self,
        stage: &'static Stage,
        session: &mut Session,
        progress: Progress,
    ) -> Result<Shot, Failure> {
        let levels = (0..session.manifest().meshes.len()).filter_map(|k| session.level_at(k, stage.geometry));
        let vertices = levels.map(u64::from).sum();
        let mut options =
            RenderOptions::for_plan(self.plan, self.arguments.size.width, self.arguments.size.height);
        let encoding = session.grid_header().map(|header| header.encoding);
        let mut grid = None;
        match (session.grid(), encoding) {
            (Some(filled), Some(encoding)) if stage.light.is_some() => {
                options.reconstruction = Reconstruction::for_encoding(encoding);
                grid = Some(filled.clone());
            }
            _ => options.indirect = false,
        }
        #[cfg(feature = "gpu")]
        if let Renderer::Gpu(gpu) = self.renderer {
            let live = match &mut self.live {
                Some(live) => live,
                none => none.insert(Live::new(gpu, session, self.camera)?),
            };
            let start = Instant::now();
            let uploaded = Some(live.go_to(session, stage.geometry)?);
            live.scene_mut().grid = grid;
            let image = live.render(&options)?;
            return Ok(Shot { stage, progress, vertices, image, render_time: start.elapsed(), uploaded });
        }
        let loaded = LoadedScene::from_scene(session.scene_at(stage.geometry))?;
        let mut scene = RenderScene::from_scene(&loaded.scene, &loaded.flat, self.camera);
        scene.grid = grid;
        let start = Instant::now();
        let image = self.renderer.render(&scene, &options)?;
        Ok(Shot { stage, progress, vertices, image, render_time: start.elapsed(), uploaded: None })
    }
}
