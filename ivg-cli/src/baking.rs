//! Scene in, baked grid and its file out: shared by every command that bakes.

use std::path::Path;
use std::time::{Duration, Instant};

use ivg_bake::{
    Accumulator, AccuracyReport, BakeError, BakeOptions, BakeResult, BakeStats, Estimator, PilotReport,
    ResolutionLimits, Shard,
};
use ivg_format::{EncodeOptions, Encoding, GridSource, Order, Quantity};
use ivg_grid::IrradianceGrid;
use ivg_scene::import::{self, ImportOptions};
use ivg_scene::plan::{self, PlanOptions};
use ivg_scene::{EffectPlan, FlatScene, Need, Scene};

use crate::args::{BakeSettings, EffectsArgument, SceneArguments};
use crate::failure::Failure;
use crate::files::shown;
use crate::scene_args::GridArgument;
use crate::watch::{StageTime, Watch};
use crate::writing::{self, Extras};

/// A scene with everything a bake or a picture needs to know about it.
#[derive(Debug)]
pub(crate) struct LoadedScene {
    pub(crate) scene: Scene,
    pub(crate) flat: FlatScene,
    /// When reading began.
    pub(crate) since: Instant,
}

impl LoadedScene {
    /// Reads a scene and what a lights file adds, and prints warnings to stderr.
    pub(crate) fn open(arguments: &SceneArguments) -> Result<Self, Failure> {
        Self::load(&arguments.scene, arguments.lights.as_deref())
    }

    pub(crate) fn load(path: &Path, lights: Option<&Path>) -> Result<Self, Failure> {
        let since = Instant::now();
        let options = ImportOptions { lights: lights.map(Into::into) };
        let scene = import::load(path, &options).map_err(|error| Failure::scene(path, &error))?;
        for warning in &scene.warnings {
            eprintln!("ivg: warning: {}", shown(warning));
        }
        Ok(Self { since, ..Self::from_scene(scene)? })
    }

    pub(crate) fn from_scene(scene: Scene) -> Result<Self, Failure> {
        scene.check().map_err(Failure::new)?;
        let since = Instant::now();
        let flat = scene.flatten();
        Ok(Self { scene, flat, since })
    }
}

/// A bake's result, as numbers and as a file.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) plan: EffectPlan,
    pub(crate) grid: IrradianceGrid,
    pub(crate) stats: BakeStats,
    pub(crate) accuracy: Option<AccuracyReport>,
    pub(crate) file: Vec<u8>,
    /// Wall time since reading the scene began.
    pub(crate) elapsed: Duration,
    /// Why the grid is as fine as it is, if the scene decided.
    pub(crate) grid_reason: Option<String>,
    /// Time of each part of the bake.
    pub(crate) stages: Vec<StageTime>,
}

/// Plans a scene and measures the plan by a pilot run of 1 % of the photons.
pub(crate) fn plan(
    loaded: &LoadedScene,
    planning: PlanOptions,
    options: &BakeOptions,
) -> Result<(EffectPlan, Option<PilotReport>), Failure> {
    let LoadedScene { scene, flat, .. } = loaded;
    let mut plan = analysed(loaded, planning);
    if scene.require_light().is_err() {
        return Ok((plan, None));
    }
    let report = ivg_bake::pilot(scene, flat, &mut plan, options).map_err(Failure::new)?;
    Ok((plan, Some(report)))
}

/// Prints to stderr what the scene asks for and this release does not simulate.
pub(crate) fn report_unsupported(scene: &Scene, plan: &EffectPlan) {
    for effect in plan.effects.iter().filter(|effect| effect.need == Need::Unsupported) {
        eprintln!("ivg: not simulated: {}: {}", effect.effect.name(), shown(&effect.reason));
    }
    for unsupported in &scene.unsupported {
        eprintln!("ivg: not supported: {}: {}", shown(&unsupported.object), shown(&unsupported.what));
    }
}

/// Plans, bakes and encodes; shows progress.
pub(crate) fn bake(loaded: &LoadedScene, settings: &BakeSettings) -> Result<Baked, Failure> {
    bake_with(loaded, settings, SumFiles::default())
}

/// The same, with sums read and written.
pub(crate) fn bake_with(
    loaded: &LoadedScene,
    settings: &BakeSettings,
    sums: SumFiles<'_>,
) -> Result<Baked, Failure> {
    loaded.scene.require_light().map_err(Failure::new)?;
    let mut options = bake_options(settings);
    if options.quantity == Quantity::Radiance && !options.estimator.gives_radiance() {
        return Err(Failure::usage(format_args!(
            "{} stores radiance, which the estimator {} does not give; use --estimator track-length or gather, or an encoding of irradiance vectors",
            settings.encoding.name(),
            options.estimator.name(),
        )));
    }
    let grid_reason = decide_grid(loaded, settings, &mut options)?;
    let mut plan = analysed(loaded, planning_for(settings.effects, settings.accuracy));
    report_unsupported(&loaded.scene, &plan);
    let watch = Watch::new(loaded.since, settings.time, &options);
    let result = simulate(loaded, &mut plan, &options, &watch, sums);
    let stages = watch.finish();
    let result = result?;
    let stored = Stored {
        encoding: settings.encoding,
        order: settings.order,
        per_slice: settings.per_slice,
        seed: settings.seed,
        bounces: plan.max_bounces,
        estimator: options.estimator,
    };
    let file = encode(&result.grid, &result.stats, &stored)?;
    if let Some(budget) = settings.budget.filter(|budget| file.len() as u64 > *budget) {
        return Err(Failure::usage(format_args!(
            "the file would have {} bytes, more than the {budget} of --budget; even the smallest grid takes so many",
            file.len()
        )));
    }
    let (grid, stats, accuracy) = (result.grid, result.stats, result.accuracy);
    let elapsed = loaded.since.elapsed();
    Ok(Baked { plan, grid, stats, accuracy, file, elapsed, stages, grid_reason })
}

/// Accumulator files to go on from and to write.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct SumFiles<'a> {
    pub(crate) resume: Option<&'a Path>,
    pub(crate) checkpoint: Option<&'a Path>,
}

/// How often sums are written.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(60);

fn simulate(
    loaded: &LoadedScene,
    plan: &mut EffectPlan,
    options: &BakeOptions,
    watch: &Watch,
    files: SumFiles<'_>,
) -> Result<BakeResult, Failure> {
    let LoadedScene { scene, flat, .. } = loaded;
    if files.resume.is_none() && files.checkpoint.is_none() {
        return ivg_bake::bake_measured(scene, flat, plan, options, watch).map_err(Failure::new);
    }
    let from = files.resume.map(read_sums).transpose()?;
    match &from {
        // How far light is worth following is measured with a part of the photons, and may be another number for more of them.
        Some(from) => plan.max_bounces = from.seed_and_bounces().1,
        None => ivg_bake::measure_reflections(scene, flat, plan, options).map_err(Failure::new)?,
    }
    let mut written = Instant::now();
    let mut failure = None;
    let mut save = |sums: &Accumulator| {
        if let (Some(path), None, true) =
            (files.checkpoint, &failure, written.elapsed() >= CHECKPOINT_INTERVAL)
        {
            failure = crate::files::write(path, &sums.to_bytes()).err();
            written = Instant::now();
        }
    };
    let sums = ivg_bake::accumulate(scene, flat, plan, options, (Shard::ALL, from), watch, &mut save);
    let mut sums = sums.map_err(|error| match (files.resume, error) {
        (Some(path), error @ BakeError::Accumulator(_)) => Failure::file(path, error),
        (_, error) => Failure::new(error),
    })?;
    if let Some(failure) = failure {
        return Err(failure);
    }
    if let Some(path) = files.checkpoint {
        crate::files::write(path, &sums.to_bytes())?;
    }
    sums.end_here();
    sums.finish().map_err(Failure::new)
}

/// Traces a shard of the photons: its sums as a file.
pub(crate) fn shard(loaded: &LoadedScene, settings: &BakeSettings, shard: Shard) -> Result<Vec<u8>, Failure> {
    loaded.scene.require_light().map_err(Failure::new)?;
    let mut options = bake_options(settings);
    decide_grid(loaded, settings, &mut options)?;
    let LoadedScene { scene, flat, .. } = loaded;
    let mut plan = analysed(loaded, planning(settings.effects));
    ivg_bake::measure_reflections(scene, flat, &mut plan, &options).map_err(Failure::new)?;
    report_unsupported(&loaded.scene, &plan);
    let watch = Watch::new(Instant::now(), None, &options);
    let sums = ivg_bake::accumulate(scene, flat, &plan, &options, (shard, None), &watch, &mut |_| {});
    watch.finish();
    Ok(sums.map_err(Failure::new)?.to_bytes())
}

/// Reads an accumulator file.
pub(crate) fn read_sums(path: &Path) -> Result<Accumulator, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::file(path, error))?;
    Accumulator::from_bytes(&bytes).map_err(|error| Failure::file(path, error))
}

/// Share of the error asked for that light beyond the last reflection followed may be.
const CUTOFF_SHARE: f64 = 0.1;

/// Photons of a bake where nothing else ends it.
const PHOTONS: u64 = 1_000_000;

/// Photons where accuracy or time ends the bake: the sums hold so many with up to 127 reflections.
const MOST_PHOTONS: u64 = 1 << 33;

/// Most vertices of a grid that the scene decides.
const AUTO_VERTICES: u64 = 1 << 18;

/// Reflections of the photons that tell how far light flies and how it changes.
const AUTO_BOUNCES: u32 = 16;

/// Share of a time that photons are traced in: the rest is for what comes before and after.
const TRACING_SHARE: f64 = 0.5;

/// Share of a time that vertices may look around in before the first photon.
const PREPARATION_SHARE: f64 = 0.2;

/// Noise that a grid chosen for a time may have, where no accuracy is asked for.
const TIMED_NOISE: f64 = 0.02;

/// Decides the grid, if the scene is to, and says why.
fn decide_grid(
    loaded: &LoadedScene,
    settings: &BakeSettings,
    options: &mut BakeOptions,
) -> Result<Option<String>, Failure> {
    if settings.grid != GridArgument::Auto {
        if settings.budget.is_some() {
            return Err(Failure::usage("--budget chooses the grid; give --grid auto with it"));
        }
        return Ok(None);
    }
    let LoadedScene { scene, flat, .. } = loaded;
    let mut plan = analysed(loaded, planning_for(settings.effects, settings.accuracy));
    plan.max_bounces = plan.max_bounces.min(AUTO_BOUNCES);
    let (photons, prepared) = match settings.time {
        Some(seconds) => {
            let timed = BakeOptions { photons: PHOTONS, accuracy: None, ..options.clone() };
            let timed = BakeOptions { estimator: Estimator::TrackLength, ..timed };
            let report = ivg_bake::pilot(scene, flat, &mut plan.clone(), &timed).map_err(Failure::new)?;
            let each = (report.ray_seconds + report.deposit_seconds) / PHOTONS as f64;
            let left = (seconds - loaded.since.elapsed().as_secs_f64()).max(0.0);
            let threads = options.threads.unwrap_or_else(cores) as f64;
            let affordable =
                |share: f64, each: f64| (share * left * threads / each.max(f64::MIN_POSITIVE)) as u64;
            let photons = affordable(TRACING_SHARE, each);
            let vertices = timed.dims.iter().map(|&n| f64::from(n)).product::<f64>();
            let prepared = affordable(PREPARATION_SHARE, report.preparation_seconds / vertices);
            (Some((photons, settings.accuracy.unwrap_or(TIMED_NOISE))), Some(prepared))
        }
        None => (None, None),
    };
    let fits = |dims| settings.budget.is_none_or(|budget| file_bytes(dims, settings, scene) <= budget);
    let limits = ResolutionLimits { vertices: AUTO_VERTICES, prepared, photons, fits: &fits };
    let found = ivg_bake::resolution(scene, flat, &plan, options, &limits).map_err(Failure::new)?;
    options.dims = found.dims;
    Ok(Some(found.reason()))
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// The most bytes that the file of a grid takes, whatever it holds.
fn file_bytes(dims: [u16; 3], settings: &BakeSettings, scene: &Scene) -> u64 {
    // Header, directory, the metadata with numbers of any length, the corners and what frames them.
    const APART: u64 = 4096;
    // Each record's frame, and each light's entry besides its name.
    const FRAME: u64 = 64;
    // A list of vertices names each in so many bytes at most: seven bits in each.
    const NAMED: u64 = 3;
    let [vertices, longest] =
        [dims.iter().map(|&n| u64::from(n)).product::<u64>(), u64::from(dims.into_iter().max().unwrap_or(1))];
    let bundle = (u64::from(settings.per_slice) * longest).clamp(1, vertices);
    // Bundles of importance grow from 32 vertices by a quarter each: fewer than a hundred before they are as large as any.
    let (bundles, named) = match settings.order {
        Order::Explicit => (vertices.div_ceil(bundle) + 100, NAMED),
        _ => (vertices.div_ceil(bundle) + longest, 0),
    };
    let names =
        scene.lights.iter().map(|light| light.name.len()).chain(scene.materials.iter().map(|m| m.name.len()));
    let lights: u64 = names.map(|name| name as u64 + FRAME).sum();
    // Validity and blocked edges take two bytes at most.
    vertices * (settings.encoding.bytes_per_vertex() + 2 + named) + bundles * FRAME + lights + APART
}

fn analysed(loaded: &LoadedScene, planning: PlanOptions) -> EffectPlan {
    plan::analyse(&loaded.scene, &loaded.flat, &planning)
}

/// What a plan is made with, where no error is asked for.
pub(crate) fn planning(effects: EffectsArgument) -> PlanOptions {
    PlanOptions { all_effects: effects == EffectsArgument::All, ..PlanOptions::default() }
}

/// What a plan is made with. With an accuracy, light is followed until what is cut is far below it.
pub(crate) fn planning_for(effects: EffectsArgument, accuracy: Option<f64>) -> PlanOptions {
    let usual = planning(effects);
    PlanOptions { energy_cutoff: accuracy.map_or(usual.energy_cutoff, |asked| CUTOFF_SHARE * asked), ..usual }
}

/// The options of the baker that the arguments name.
pub(crate) fn bake_options(settings: &BakeSettings) -> BakeOptions {
    let until_good = settings.accuracy.is_some() || settings.time.is_some();
    let usual = BakeOptions::default();
    BakeOptions {
        dims: match settings.grid {
            GridArgument::Size(size) => size.0,
            GridArgument::Auto => usual.dims,
        },
        bounds: settings.bounds.map(|bounds| (bounds.0, bounds.1)),
        photons: settings.photons.unwrap_or(if until_good { MOST_PHOTONS } else { PHOTONS }),
        accuracy: settings.accuracy,
        paths: settings.paths.unwrap_or(if settings.accuracy.is_some() { u32::MAX } else { usual.paths }),
        estimator: settings.estimator.into(),
        seed: settings.seed,
        threads: settings.threads.map(usize::from),
        quantity: settings.encoding.quantity(),
    }
}

/// What a file says besides the grid, and how it stores that.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stored {
    pub(crate) encoding: Encoding,
    pub(crate) order: Order,
    pub(crate) per_slice: u32,
    pub(crate) seed: u64,
    pub(crate) bounces: u32,
    pub(crate) estimator: Estimator,
}

/// The grid as a file. Its metadata hold what repeats the bake; nothing in it depends on time or threads.
pub(crate) fn encode(grid: &IrradianceGrid, stats: &BakeStats, stored: &Stored) -> Result<Vec<u8>, Failure> {
    let numbers = [stats.photons, stored.seed, u64::from(stored.bounces)].map(|n| n.to_string());
    let [photons, seed, bounces] = numbers;
    // Not for bakes by photons alone, so that they are told apart.
    let paths = (stats.paths > 0).then(|| ("paths", stats.paths.to_string()));
    let extras = Extras {
        lights: stats.lights.iter().map(|light| (light.name.clone(), light.direct)).collect(),
        metadata: [
            ("generator", concat!("ivg ", env!("CARGO_PKG_VERSION")).to_owned()),
            ("estimator", stored.estimator.name().to_owned()),
            ("photons", photons),
            ("seed", seed),
            ("bounces", bounces),
        ]
        .into_iter()
        .chain(paths)
        .map(|(key, value)| (key.to_owned(), value))
        .collect(),
    };
    let options = EncodeOptions {
        encoding: stored.encoding,
        order: stored.order,
        vertices_per_slice: stored.per_slice,
        ..EncodeOptions::default()
    };
    let bundles = writing::bundles(grid, &options);
    let source = GridSource { bundles: bundles.as_deref(), ..grid.as_source() };
    writing::encode(source, &extras, &options)
}
