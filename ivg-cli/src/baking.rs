//! Scene in, baked grid and its file out: shared by every command that bakes.

use std::time::{Duration, Instant};

use ivg_bake::{BakeOptions, BakeStats, Estimator, PilotReport};
use ivg_format::{EncodeOptions, GridSource, Quantity};
use ivg_grid::IrradianceGrid;
use ivg_scene::import::{self, ImportOptions};
use ivg_scene::plan::{self, PlanOptions};
use ivg_scene::{EffectPlan, FlatScene, Need, Scene};

use crate::args::{BakeSettings, EffectsArgument, EstimatorArgument, SceneArguments};
use crate::failure::Failure;
use crate::files::shown;
use crate::progress::BakeBar;
use crate::writing::{self, Extras};

/// A scene with everything a bake or a picture needs to know about it.
#[derive(Debug)]
pub(crate) struct LoadedScene {
    pub(crate) scene: Scene,
    pub(crate) flat: FlatScene,
}

impl LoadedScene {
    /// Reads a scene and what a lights file adds, and prints warnings to stderr.
    pub(crate) fn open(arguments: &SceneArguments) -> Result<Self, Failure> {
        Self::load(&arguments.scene, arguments.lights.as_deref())
    }

    pub(crate) fn load(path: &std::path::Path, lights: Option<&std::path::Path>) -> Result<Self, Failure> {
        let options = ImportOptions { lights: lights.map(Into::into) };
        let scene = import::load(path, &options).map_err(Failure::new)?;
        for warning in &scene.warnings {
            eprintln!("ivg: warning: {}", shown(warning));
        }
        Self::from_scene(scene)
    }

    pub(crate) fn from_scene(scene: Scene) -> Result<Self, Failure> {
        scene.check().map_err(Failure::new)?;
        let flat = scene.flatten();
        Ok(Self { scene, flat })
    }
}

/// A bake's result, as numbers and as a file.
#[derive(Debug)]
pub(crate) struct Baked {
    pub(crate) plan: EffectPlan,
    pub(crate) grid: IrradianceGrid,
    pub(crate) stats: BakeStats,
    pub(crate) file: Vec<u8>,
    /// Wall time of pilot and bake.
    pub(crate) elapsed: Duration,
}

/// Plans a scene and measures the plan by a pilot run of 1 % of the photons.
pub(crate) fn plan(
    loaded: &LoadedScene,
    planning: PlanOptions,
    options: &BakeOptions,
) -> Result<(EffectPlan, Option<PilotReport>), Failure> {
    let LoadedScene { scene, flat } = loaded;
    let mut plan = plan::analyse(scene, flat, &planning);
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
    loaded.scene.require_light().map_err(Failure::new)?;
    let options = bake_options(settings);
    if options.quantity == Quantity::Radiance && options.estimator != Estimator::TrackLength {
        return Err(Failure::usage(format_args!(
            "{} stores radiance, which the estimator {} does not give; use --estimator track-length, or an encoding of irradiance vectors",
            settings.encoding.name(),
            options.estimator.name(),
        )));
    }
    let start = Instant::now();
    let (plan, _) = plan(loaded, planning(settings.effects), &options)?;
    report_unsupported(&loaded.scene, &plan);
    let bar = BakeBar::new("bake", settings.photons, "photons");
    let result = ivg_bake::bake(&loaded.scene, &loaded.flat, &plan, &options, &bar);
    bar.finish();
    let result = result.map_err(Failure::new)?;
    let elapsed = start.elapsed();
    let file = encode(&result.grid, &result.stats, settings, &plan)?;
    Ok(Baked { plan, grid: result.grid, stats: result.stats, file, elapsed })
}

/// What a plan is made with, where no error is asked for.
pub(crate) fn planning(effects: EffectsArgument) -> PlanOptions {
    PlanOptions { all_effects: effects == EffectsArgument::All, ..PlanOptions::default() }
}

/// The options of the baker that the arguments name.
pub(crate) fn bake_options(settings: &BakeSettings) -> BakeOptions {
    BakeOptions {
        dims: settings.grid.0,
        bounds: settings.bounds.map(|bounds| (bounds.0, bounds.1)),
        photons: settings.photons,
        estimator: match settings.estimator {
            EstimatorArgument::TrackLength => Estimator::TrackLength,
            EstimatorArgument::FaceCrossing => Estimator::FaceCrossing,
            EstimatorArgument::FaceCrossingRr6983 => Estimator::FaceCrossingRr6983,
        },
        seed: settings.seed,
        threads: settings.threads.map(usize::from),
        quantity: settings.encoding.quantity(),
        ..BakeOptions::default()
    }
}

/// The grid as a file. Its metadata hold what repeats the bake; nothing in it depends on time or threads.
fn encode(
    grid: &IrradianceGrid,
    stats: &BakeStats,
    settings: &BakeSettings,
    plan: &EffectPlan,
) -> Result<Vec<u8>, Failure> {
    let estimator = bake_options(settings).estimator.name();
    let numbers = [settings.photons, settings.seed, u64::from(plan.max_bounces)].map(|n| n.to_string());
    let [photons, seed, bounces] = numbers;
    let extras = Extras {
        lights: stats.lights.iter().map(|light| (light.name.clone(), light.direct)).collect(),
        metadata: [
            ("generator", concat!("ivg ", env!("CARGO_PKG_VERSION")).to_owned()),
            ("estimator", estimator.to_owned()),
            ("photons", photons),
            ("seed", seed),
            ("bounces", bounces),
        ]
        .map(|(key, value)| (key.to_owned(), value))
        .into(),
    };
    let options = EncodeOptions {
        encoding: settings.encoding,
        order: settings.order,
        vertices_per_slice: settings.per_slice,
        ..EncodeOptions::default()
    };
    let bundles = writing::bundles(grid, &options);
    let source = GridSource { bundles: bundles.as_deref(), ..grid.as_source() };
    writing::encode(source, &extras, &options)
}
