use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use glam::{DVec3, Vec3};
use ivg_bake::BakeError;
use ivg_bake::reference::{KnownLight, Oracle, Picture, Sampling, Shown};
use ivg_format::{Encoding, Quantity};
use ivg_grid::{FillOptions, IrradianceGrid, Reconstruction, SURFACE_BIAS, SpatialFilter};
use ivg_render::{Image, RenderOptions, RenderScene};
use ivg_scene::plan::{self, PlanOptions};
use ivg_scene::{Camera, EffectPlan, Scene};
use ivg_stream::blocking::Session;
use ivg_stream::{FetchOptions, Goal, LocalScene, SceneLimits, View};

use crate::args::{IndirectArgument, RenderArguments};
use crate::baking::{self, LoadedScene};
use crate::failure::Failure;
use crate::picture::{self, Renderer};
use crate::progress::BakeBar;
use crate::{files, reading};

/// Vertical field of view of a camera given on the command line \[rad\].
const COMMAND_LINE_FOV: f32 = 0.8;

/// A scene and its indirect light, wherever they came from.
struct Source {
    loaded: LoadedScene,
    plan: EffectPlan,
    grid: Option<(IrradianceGrid, Reconstruction)>,
}

pub(crate) fn run(arguments: &RenderArguments) -> Result<ExitCode, Failure> {
    files::require_extension(&arguments.out, &["png"])?;
    let source = open(arguments)?;
    let scene = &source.loaded.scene;
    let camera = camera(arguments, scene);
    let triangles = source.loaded.flat.triangles.len();
    let start = Instant::now();
    // A scene that was streamed has its grid filled already.
    let grid = source.grid.map(|(grid, reconstruction)| {
        let filled = grid.is_filled();
        (if filled { grid } else { ivg_grid::fill(&grid, &FillOptions::default()) }, reconstruction)
    });
    let (image, who) = match (arguments.indirect, grid) {
        (IndirectArgument::Path, _) => {
            let traced = traced(arguments, &source.loaded, |oracle, size, sampling, bar| {
                oracle.render(&camera, size, Shown::All, sampling, bar)
            })?;
            (traced, "path tracer".to_owned())
        }
        (IndirectArgument::Gather, Some((grid, reconstruction))) => {
            let light = KnownLight {
                irradiance: &|point, normal| {
                    let filter = SpatialFilter::default();
                    grid.surface_irradiance(point, normal, SURFACE_BIAS, reconstruction, filter)
                },
                shortest_flight: grid.lattice().step.into_iter().fold(0.0, f64::max),
            };
            let gathered = traced(arguments, &source.loaded, |oracle, size, sampling, bar| {
                oracle.render_gathering(&camera, size, &light, sampling, bar)
            })?;
            (gathered, "path tracer, gathering from the grid".to_owned())
        }
        (IndirectArgument::Gather, None) => {
            return Err(Failure::usage("--indirect gather needs a grid, and the packed scene has none"));
        }
        (IndirectArgument::Grid | IndirectArgument::None, grid) => {
            let renderer = Renderer::choose(arguments.renderer)?;
            let mut render_scene = RenderScene::from_scene(scene, &source.loaded.flat, camera);
            let mut options =
                RenderOptions::for_plan(&source.plan, arguments.size.width, arguments.size.height);
            match grid {
                Some((grid, reconstruction)) => {
                    options.reconstruction = reconstruction;
                    render_scene.grid = Some(grid);
                }
                None => options.indirect = false,
            }
            (renderer.render(&render_scene, &options)?, renderer.name())
        }
    };
    let exposure = arguments.exposure.unwrap_or_else(|| ivg_render::auto_exposure(&image));
    picture::write_png(&arguments.out, &image, exposure)?;
    files::print(&format!(
        "{}: {} x {}, {triangles} triangles, exposure {exposure:.4}, {:.2} s on {who}\n",
        arguments.out.display(),
        image.width(),
        image.height(),
        start.elapsed().as_secs_f64(),
    ))?;
    Ok(ExitCode::SUCCESS)
}

fn open(arguments: &RenderArguments) -> Result<Source, Failure> {
    let path = Path::new(&arguments.source);
    if arguments.source.starts_with("http://") {
        let mut session =
            Session::open(&arguments.source, FetchOptions::default(), &mut |_| {}).map_err(Failure::new)?;
        session.fetch_until(Goal::ALL, &mut |_| {}).map_err(Failure::new)?;
        let scene = match view(arguments, &session.manifest().scene) {
            Some(view) => session.scene_for(&view),
            None => session.scene_at(1.0),
        };
        let encoding = session.grid_header().map(|header| header.encoding);
        return packed(arguments, scene, session.grid().zip(encoding));
    }
    if path.is_dir() || path.join("scene.glb").is_file() {
        let mut local = LocalScene::open(path, SceneLimits::default()).map_err(Failure::new)?;
        let scene = match view(arguments, &local.manifest().scene) {
            Some(view) => local.scene_for(&view),
            None => local.scene_at(1.0),
        };
        let encoding = local.grid_header().map(|header| header.encoding);
        return packed(arguments, scene, local.grid().zip(encoding));
    }
    if arguments.pixel_error.is_some() {
        return Err(Failure::usage(
            "--pixel-error is for packed scenes; a scene file has one level of each mesh",
        ));
    }
    let loaded = LoadedScene::load(path, arguments.lights.as_deref())?;
    if !arguments.indirect.needs_grid() {
        let plan = planned(&loaded);
        return Ok(Source { loaded, plan, grid: None });
    }
    if let Some(file) = &arguments.ivg {
        let (header, grid, _) = reading::grid(file, &files::read(file)?)?;
        let plan = planned(&loaded);
        return Ok(Source {
            loaded,
            plan,
            grid: Some((grid, Reconstruction::for_encoding(header.encoding))),
        });
    }
    let baked = baking::bake(&loaded, &arguments.bake)?;
    // Straight from the baker, nothing is packed: irradiance vectors are as they were, all six of them.
    let reconstruction = match baked.grid.quantity() {
        Quantity::Vectors => Reconstruction::SixVector,
        Quantity::Radiance => Reconstruction::Harmonics,
    };
    Ok(Source { loaded, plan: baked.plan, grid: Some((baked.grid, reconstruction)) })
}

/// What a picture needs, without a pilot run: nothing is baked. Reports what is not simulated.
fn planned(loaded: &LoadedScene) -> EffectPlan {
    let plan = plan::analyse(&loaded.scene, &loaded.flat, &PlanOptions::default());
    baking::report_unsupported(&loaded.scene, &plan);
    plan
}

/// A packed scene: complete, with the grid that was packed with it.
fn packed(
    arguments: &RenderArguments,
    scene: Scene,
    grid: Option<(&IrradianceGrid, Encoding)>,
) -> Result<Source, Failure> {
    if arguments.lights.is_some() || arguments.ivg.is_some() {
        return Err(Failure::usage("--lights and --ivg are for scene files; a packed scene has its own"));
    }
    let loaded = LoadedScene::from_scene(scene)?;
    let plan = planned(&loaded);
    let grid = grid.filter(|_| arguments.indirect.needs_grid());
    let grid = grid.map(|(grid, encoding)| (grid.clone(), Reconstruction::for_encoding(encoding)));
    Ok(Source { loaded, plan, grid })
}

/// What the picture asks of the meshes, if it may take coarser levels.
fn view(arguments: &RenderArguments, scene: &Scene) -> Option<View> {
    let pixels = arguments.pixel_error?;
    Some(View { camera: camera(arguments, scene), height: arguments.size.height, pixels })
}

fn camera(arguments: &RenderArguments, scene: &Scene) -> Camera {
    match arguments.camera {
        Some(eye_and_target) => Camera {
            eye: eye_and_target.0,
            target: eye_and_target.1,
            up: DVec3::Y,
            vertical_fov: COMMAND_LINE_FOV,
        },
        None => scene.camera_or_framed(),
    }
}

/// A picture by following paths from the eye.
fn traced(
    arguments: &RenderArguments,
    loaded: &LoadedScene,
    trace: impl FnOnce(&Oracle<'_>, (u32, u32), Sampling, &BakeBar) -> Result<Picture, BakeError>,
) -> Result<Image, Failure> {
    let oracle = Oracle::new(&loaded.scene, &loaded.flat).map_err(Failure::new)?;
    let sampling = Sampling {
        paths: arguments.samples,
        seed: arguments.bake.seed,
        threads: arguments.bake.threads.map(usize::from),
    };
    let size = (arguments.size.width, arguments.size.height);
    let bar = BakeBar::new("trace paths", u64::from(size.0) * u64::from(size.1), "pixels");
    let picture = trace(&oracle, size, sampling, &bar);
    bar.finish();
    let picture = picture.map_err(Failure::new)?;
    let pixels = picture.pixels.into_iter().map(Vec3::from_array).collect();
    Ok(Image::new(size.0, size.1, pixels))
}
