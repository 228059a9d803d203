use std::process::ExitCode;

use serde_json::json;

use crate::args::BakeArguments;
use crate::baking::{self, LoadedScene};
use crate::failure::Failure;
use crate::{files, table};

pub(crate) fn run(arguments: &BakeArguments) -> Result<ExitCode, Failure> {
    files::require_extension(&arguments.out, &["ivg"])?;
    let loaded = LoadedScene::open(&arguments.scene)?;
    let baked = baking::bake(&loaded, &arguments.bake)?;
    files::write(&arguments.out, &baked.file)?;
    let lattice = baked.grid.lattice();
    let seconds = baked.elapsed.as_secs_f64();
    let stats = &baked.stats;
    if arguments.json {
        let report = json!({
            "file": arguments.out,
            "bytes": baked.file.len(),
            "dims": lattice.dims,
            "origin": lattice.origin,
            "step": lattice.step,
            "vertices": lattice.vertex_count(),
            "valid_vertices": stats.valid_vertices,
            "blocked_edges": stats.blocked_edges,
            "photons": stats.photons,
            "flights": stats.flights,
            "bounces": baked.plan.max_bounces,
            "emitted_watts": stats.emitted.to_array(),
            "absorbed_watts": stats.absorbed.to_array(),
            "escaped_watts": stats.escaped.to_array(),
            "cut_watts": stats.cut.to_array(),
            "lights": stats.lights.iter().map(|light| &light.name).collect::<Vec<_>>(),
            "seconds": seconds,
        });
        files::print(&format!("{report}\n"))?;
        return Ok(ExitCode::SUCCESS);
    }
    let [nx, ny, nz] = lattice.dims;
    files::print(&format!(
        "{}: {nx} x {ny} x {nz} vertices ({} valid), {} in {seconds:.2} s\n{} photons, {} flights ({:.2} million a second), up to {} bounces\n",
        arguments.out.display(),
        stats.valid_vertices,
        table::bytes(baked.file.len() as u64),
        stats.photons,
        stats.flights,
        stats.flights as f64 / seconds / 1e6,
        baked.plan.max_bounces,
    ))?;
    let sum = |watts: glam::DVec3| watts.element_sum();
    let emitted = sum(stats.emitted);
    if emitted > 0.0 {
        files::print(&format!(
            "{emitted:.4} W emitted: {:.1} % absorbed, {:.1} % left the scene, {:.2} % cut after the last bounce\n",
            100.0 * sum(stats.absorbed) / emitted,
            100.0 * sum(stats.escaped) / emitted,
            100.0 * sum(stats.cut) / emitted,
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}
