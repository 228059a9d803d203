use std::process::ExitCode;
use std::time::{Duration, Instant};

use ivg_bake::BakeOptions;
use ivg_grid::IrradianceGrid;
use ivg_scene::{EffectPlan, FlatScene};
use serde_json::{Value, json};

use self::comparison::{Comparison, compare, mark_near};
use crate::args::{EffectsArgument, RobustnessArguments};
use crate::baking::{self, LoadedScene};
use crate::decimation::Decimation;
use crate::failure::Failure;
use crate::progress::{FractionBar, say};
use crate::watch::Watch;
use crate::{files, table};

mod comparison;

/// Geometric robustness (RR-6983, section 5.1 and figure 2): the same grid baked with fewer faces, and how far its light is
/// from that of all faces.
pub(crate) fn run(arguments: &RobustnessArguments) -> Result<ExitCode, Failure> {
    let loaded = LoadedScene::open(&arguments.scene)?;
    loaded.scene.require_light().map_err(Failure::new)?;
    let usual = BakeOptions {
        dims: arguments.grid.0,
        bounds: arguments.bounds.map(|bounds| (bounds.0, bounds.1)),
        photons: arguments.photons,
        threads: arguments.threads.map(usize::from),
        ..BakeOptions::default()
    };
    // The same bounds whatever becomes of the geometry.
    let bounds = match usual.bounds {
        Some(bounds) => bounds,
        None => ivg_bake::automatic_bounds(&loaded.flat, usual.dims).map_err(Failure::new)?,
    };
    let options = BakeOptions { bounds: Some(bounds), ..usual };
    let (plan, _) = baking::plan(&loaded, baking::planning(EffectsArgument::Needed), &options)?;
    baking::report_unsupported(&loaded.scene, &plan);
    let bakes = Bakes { options, plan, count: arguments.bakes, seed: arguments.seed };
    say(&format!("all {} faces", loaded.flat.triangles.len()));
    let reference = bakes.of(&loaded)?;

    let start = Instant::now();
    let bar = FractionBar::new("order meshes");
    let decimation = Decimation::new(&loaded.scene, &mut |done| bar.set(done));
    bar.finish();
    let decimation = decimation?;
    let order = start.elapsed();

    let mut rows = vec![Row::reference(&loaded, &reference)];
    for share in &arguments.faces {
        let wanted = (share.0 * loaded.flat.triangles.len() as f64).round() as usize;
        let level = decimation.at_most(wanted);
        say(&format!("{} faces, at most {:.2e} m off", level.faces, level.error));
        let coarse = LoadedScene::from_scene(level.scene)?;
        let baked = bakes.of(&coarse)?;
        rows.push(Row::compared([&loaded, &coarse], [&reference, &baked], level.error));
    }
    let report = Report { name: &loaded.scene.name, arguments, order, rows };
    files::print(&if arguments.json { format!("{}\n", report.json()) } else { report.text() })?;
    Ok(ExitCode::SUCCESS)
}

/// How each geometry is baked.
struct Bakes {
    options: BakeOptions,
    plan: EffectPlan,
    count: u16,
    seed: u64,
}

/// Bakes of one geometry.
struct Baked {
    grids: Vec<IrradianceGrid>,
    /// Time of all bakes, wall and of the processors; the latter only where the system tells.
    wall: Duration,
    processors: Option<Duration>,
}

impl Bakes {
    fn of(&self, loaded: &LoadedScene) -> Result<Baked, Failure> {
        let mut baked = Baked { grids: Vec::new(), wall: Duration::ZERO, processors: Some(Duration::ZERO) };
        for number in 0..u64::from(self.count) {
            let options = BakeOptions { seed: self.seed.wrapping_add(number), ..self.options.clone() };
            let start = Instant::now();
            let watch = Watch::new(start, None, &options);
            let result = ivg_bake::bake(&loaded.scene, &loaded.flat, &self.plan, &options, &watch);
            let stages = watch.finish();
            baked.wall += start.elapsed();
            let processors: Option<Duration> = stages.iter().map(|stage| stage.cpu).sum();
            baked.processors = baked.processors.zip(processors).map(|(before, here)| before + here);
            baked.grids.push(result.map_err(Failure::new)?.grid);
        }
        Ok(baked)
    }
}

/// A geometry and what came of it.
struct Row {
    faces: usize,
    /// How far its surfaces are off \[m\].
    off: f64,
    /// Time of one bake \[s\], wall and of the processors.
    wall: f64,
    processors: Option<f64>,
    /// What the triangles take as the arrays that are baked \[bytes\].
    bytes: u64,
    /// Vertices that light reaches.
    valid: usize,
    /// At all vertices that are valid with all faces and with these; `None` for the reference.
    all: Option<Comparison>,
    /// At those of them that are half a step or more from the surfaces of both.
    interior: Option<Comparison>,
}

impl Row {
    fn reference(loaded: &LoadedScene, baked: &Baked) -> Self {
        let count = baked.grids.len() as f64;
        Self {
            faces: loaded.flat.triangles.len(),
            off: 0.0,
            wall: baked.wall.as_secs_f64() / count,
            processors: baked.processors.map(|time| time.as_secs_f64() / count),
            bytes: scene_bytes(&loaded.flat),
            valid: baked.grids[0].valid_count(),
            all: None,
            interior: None,
        }
    }

    fn compared(loaded: [&LoadedScene; 2], baked: [&Baked; 2], off: f64) -> Self {
        let [reference, here] = baked.map(|baked| &baked.grids[..]);
        let count = reference[0].vertex_count();
        let mut near = vec![false; count];
        loaded.iter().for_each(|loaded| mark_near(&loaded.flat, reference[0].lattice(), &mut near));
        let valid: Vec<usize> =
            (0..count).filter(|&vertex| reference[0].is_valid(vertex) && here[0].is_valid(vertex)).collect();
        let interior: Vec<usize> = valid.iter().copied().filter(|&vertex| !near[vertex]).collect();
        Self {
            off,
            all: Some(compare(here, reference, &valid)),
            interior: Some(compare(here, reference, &interior)),
            ..Self::reference(loaded[1], baked[1])
        }
    }
}

/// Bytes of the arrays of a scene.
fn scene_bytes(flat: &FlatScene) -> u64 {
    let FlatScene { positions, normals, uvs, colours, triangles, triangle_materials, .. } = flat;
    (size_of_val(&positions[..])
        + size_of_val(&normals[..])
        + size_of_val(&uvs[..])
        + size_of_val(&colours[..])
        + size_of_val(&triangles[..])
        + size_of_val(&triangle_materials[..])) as u64
}

/// What is printed.
struct Report<'a> {
    name: &'a str,
    arguments: &'a RobustnessArguments,
    /// Time that ordering the meshes took.
    order: Duration,
    /// The first one is of all faces.
    rows: Vec<Row>,
}

impl Report<'_> {
    fn json(&self) -> Value {
        let compared = |found: &Option<Comparison>| {
            found.map(|found| {
                json!({
                    "vertices": found.vertices,
                    "rmse": found.error,
                    "noise": found.noise,
                    "mean_ratio": found.mean,
                    "largest_difference": found.largest,
                })
            })
        };
        let rows = self.rows.iter().map(|row| {
            json!({
                "faces": row.faces,
                "face_share": row.faces as f64 / self.rows[0].faces.max(1) as f64,
                "surface_error_m": row.off,
                "seconds": row.wall,
                "cpu_seconds": row.processors,
                "geometry_bytes": row.bytes,
                "valid_vertices": row.valid,
                "all": compared(&row.all),
                "interior": compared(&row.interior),
            })
        });
        json!({
            "scene": self.name,
            "dims": self.arguments.grid.0,
            "photons": self.arguments.photons,
            "bakes": self.arguments.bakes,
            "order_seconds": self.order.as_secs_f64(),
            "geometries": rows.collect::<Vec<_>>(),
        })
    }

    fn text(&self) -> String {
        let heading = [
            "faces",
            "share",
            "surface off m",
            "interior",
            "all",
            "noise",
            "largest",
            "mean",
            "wall s",
            "CPU s",
            "geometry",
        ];
        let mut rows = vec![heading.map(str::to_owned).to_vec()];
        rows.extend(self.rows.iter().map(|row| self.cells(row)));
        let [nx, ny, nz] = self.arguments.grid.0;
        format!(
            "{}: {} bakes of each geometry, {} photons each, {nx} x {ny} x {nz} vertices; meshes ordered in {:.1} s\n\n{}\n\
             interior, all: error of I_d.d against all faces, root mean square, relative, without noise; at the {} of {} valid\n\
             vertices that are half a step from every surface (last row), and at all. noise: what was taken off (all); largest:\n\
             greatest difference at interior vertices over the greatest value, with noise; mean: over that of all faces.\n\
             wall, CPU: of one bake; geometry: its positions, attributes, corners and materials in memory.\n",
            self.name,
            self.arguments.bakes,
            self.arguments.photons,
            self.order.as_secs_f64(),
            table::layout(&rows, &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]),
            self.rows.last().and_then(|row| row.interior).map_or(0, |found| found.vertices),
            self.rows.last().and_then(|row| row.all).map_or(0, |found| found.vertices),
        )
    }

    fn cells(&self, row: &Row) -> Vec<String> {
        let percent =
            |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |s| format!("{:.2} %", 100.0 * s));
        vec![
            row.faces.to_string(),
            percent(Some(row.faces as f64 / self.rows[0].faces.max(1) as f64)),
            format!("{:.2e}", row.off),
            percent(row.interior.map(|found| found.error)),
            percent(row.all.map(|found| found.error)),
            percent(row.all.map(|found| found.noise)),
            percent(row.interior.map(|found| found.largest)),
            row.all.map_or_else(|| "-".to_owned(), |found| format!("{:.4}", found.mean)),
            format!("{:.2}", row.wall),
            row.processors.map_or_else(|| "-".to_owned(), |seconds| format!("{seconds:.2}")),
            table::bytes(row.bytes),
        ]
    }
}
