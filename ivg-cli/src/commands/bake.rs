mod report;

use std::process::ExitCode;

use serde_json::json;

use crate::args::BakeArguments;
use crate::baking::{self, LoadedScene, SumFiles};
use crate::failure::Failure;
use crate::scene_args::ShardArgument;
use crate::{files, table};

pub(crate) fn run(arguments: &BakeArguments) -> Result<ExitCode, Failure> {
    if let Some(ShardArgument(shard)) = arguments.shard {
        files::require_extension(&arguments.out, &["acc"])?;
        let loaded = LoadedScene::open(&arguments.scene)?;
        let bytes = baking::shard(&loaded, &arguments.bake, shard)?;
        files::write(&arguments.out, &bytes)?;
        let out = &arguments.out;
        if arguments.json {
            let report =
                json!({ "file": out, "bytes": bytes.len(), "shard": shard.index, "shards": shard.count });
            files::print(&format!("{report}\n"))?;
        } else {
            let [index, count] = [shard.index, shard.count];
            let size = table::bytes(bytes.len() as u64);
            files::print(&format!("{}: shard {index} of {count}, {size}\n", out.display()))?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    let sums = SumFiles { resume: arguments.resume.as_deref(), checkpoint: arguments.checkpoint.as_deref() };
    if arguments.bake.accuracy.is_some() && (sums.resume.is_some() || sums.checkpoint.is_some()) {
        return Err(Failure::usage(
            "a bake to an accuracy cannot be stopped and gone on with: sums do not hold the batches that tell its noise, nor the \
             gathered light; give --accuracy in one run, with --time as a cap, or go on with --resume and a greater --photons",
        ));
    }
    files::require_extension(&arguments.out, &["ivg"])?;
    if let Some(path) = sums.checkpoint {
        files::require_extension(path, &["acc"])?;
    }
    let loaded = LoadedScene::open(&arguments.scene)?;
    let baked = baking::bake_with(&loaded, &arguments.bake, sums)?;
    files::write(&arguments.out, &baked.file)?;
    let lattice = baked.grid.lattice();
    let seconds = baked.elapsed.as_secs_f64();
    let stats = &baked.stats;
    if arguments.json {
        let report = json!({
            "file": arguments.out,
            "bytes": baked.file.len(),
            "dims": lattice.dims,
            "grid_reason": baked.grid_reason,
            "origin": lattice.origin,
            "step": lattice.step,
            "vertices": lattice.vertex_count(),
            "valid_vertices": stats.valid_vertices,
            "blocked_edges": stats.blocked_edges,
            "photons": stats.photons,
            "paths": stats.paths,
            "rough_vertices": stats.rough_vertices,
            "flights": stats.flights,
            "bounces": baked.plan.max_bounces,
            "emitted_watts": stats.emitted.to_array(),
            "absorbed_watts": stats.absorbed.to_array(),
            "escaped_watts": stats.escaped.to_array(),
            "cut_watts": stats.cut.to_array(),
            "lights": stats.lights.iter().map(|light| &light.name).collect::<Vec<_>>(),
            "seconds": seconds,
            "stages": baked.stages.iter().map(report::stage_json).collect::<Vec<_>>(),
            "accuracy": baked.accuracy.as_ref().map(report::accuracy_json),
        });
        files::print(&format!("{report}\n"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let [nx, ny, nz] = lattice.dims;
    files::print(&format!(
        "{}: {nx} x {ny} x {nz} vertices ({} valid), {} in {seconds:.2} s\n",
        arguments.out.display(),
        stats.valid_vertices,
        table::bytes(baked.file.len() as u64),
    ))?;
    if let Some(reason) = &baked.grid_reason {
        files::print(&format!("grid {reason}\n"))?;
    }
    if stats.photons > 0 {
        files::print(&format!(
            "{} photons, {} flights, up to {} bounces\n",
            stats.photons, stats.flights, baked.plan.max_bounces,
        ))?;
    }
    if stats.paths > 0 {
        files::print(&format!("{} paths traced to gather light\n", stats.paths))?;
    }
    if stats.rough_vertices > 0 {
        files::print(&format!(
            "{} of {} vertices have fewer paths than asked for: the time was up\n",
            stats.rough_vertices, stats.valid_vertices
        ))?;
    }
    files::print(&report::stages_text(&baked.stages, baked.elapsed))?;
    if let Some(report) = &baked.accuracy {
        files::print(&report::accuracy_text(report))?;
        if !report.holds() {
            eprintln!("ivg: warning: {}", report::advice(report));
        }
    }
    let sum = |watts: glam::DVec3| watts.element_sum();
    let emitted = sum(stats.emitted);
    if emitted > 0.0 {
        files::print(&format!(
            "{emitted:.4} W emitted: {:.1} % absorbed, {:.1} % left the scene, {:.2} % lost: cut after {} bounces{}; nothing is clamped\n",
            100.0 * sum(stats.absorbed) / emitted,
            100.0 * sum(stats.escaped) / emitted,
            100.0 * sum(stats.cut) / emitted,
            baked.plan.max_bounces,
            if baked.accuracy.is_some() { " (the bias counts it)" } else { "" },
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}
