use std::process::ExitCode;
use std::time::Instant;

use ivg_scene::import::{self, ImportOptions};
use pmesh_build::{BuildOptions, BuildReport, Cost};
use pmesh_format::EncodeOptions;
use serde_json::json;

use crate::args::{CostArgument, MeshArguments, ModeArgument, PositionsArgument};
use crate::convert;
use crate::failure::Failure;
use crate::progress::FractionBar;
use crate::{files, table};

pub(crate) fn run(arguments: &MeshArguments) -> Result<ExitCode, Failure> {
    // Each has one value in this release; the match keeps the names and the encoder's options together.
    let (PositionsArgument::F32, ModeArgument::Raw) = (arguments.positions, arguments.mode);
    files::require_extension(&arguments.out, &["pmesh"])?;
    let start = Instant::now();
    let scene = import::load(&arguments.mesh, &ImportOptions::default()).map_err(Failure::new)?;
    scene.check().map_err(Failure::new)?;
    let mesh = convert::joined_mesh(&scene)?;
    let read = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let bar = FractionBar::new("order");
    let options = BuildOptions {
        cost: match arguments.cost {
            CostArgument::Quadric => Cost::Quadric,
            CostArgument::Melax => Cost::Melax,
        },
        ..BuildOptions::default()
    };
    let built = pmesh_build::build(&mesh, &options, &mut |done| bar.set(done));
    bar.finish();
    let (progressive, report) = built.map_err(|error| Failure::file(&arguments.mesh, error))?;
    let order = start.elapsed().as_secs_f64();

    let start = Instant::now();
    let options = match arguments.packet {
        Some(vertices) => EncodeOptions::fixed(vertices),
        None => EncodeOptions::default(),
    };
    let file = pmesh_format::encode(&progressive, &options).map_err(Failure::new)?;
    let encode = start.elapsed().as_secs_f64();
    files::write(&arguments.out, &file)?;

    let vertices = progressive.positions.len();
    let base = progressive.base_vertices as usize;
    let plain = convert::plain_bytes(&progressive.full());
    if arguments.json {
        let figures = json!({
            "file": arguments.out,
            "bytes": file.len(),
            "plain_bytes": plain,
            "vertices": vertices,
            "wedges": progressive.wedges.len(),
            "faces": progressive.faces.len(),
            "base_vertices": base,
            "levels": vertices - base + 1,
            "findings": findings(&report).collect::<std::collections::BTreeMap<_, _>>(),
            "seconds": { "read": read, "order": order, "encode": encode },
        });
        files::print(&format!("{figures}\n"))?;
        return Ok(ExitCode::SUCCESS);
    }
    files::print(&format!(
        "{}: {vertices} vertices, {} faces, {} levels from {base} vertices on\n{} ({:+.1} % against plain arrays); read {read:.2} s, ordered {order:.2} s ({:.1} us a vertex), encoded {encode:.2} s\n",
        arguments.out.display(),
        progressive.faces.len(),
        vertices - base + 1,
        table::bytes(file.len() as u64),
        100.0 * (file.len() as f64 / plain as f64 - 1.0),
        1e6 * order / vertices.max(1) as f64,
    ))?;
    for (what, count) in findings(&report) {
        files::print(&format!("{count:>9}  {what}\n"))?;
    }
    if report.precision_lost() {
        eprintln!(
            "ivg: warning: {}: coordinates are {} m apart where the mesh is only {:.3} m across; store it nearer to its origin",
            arguments.mesh.display(),
            report.coordinate_spacing,
            report.diagonal,
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// What the build found and did, as (name, count), without what did not happen.
fn findings(report: &BuildReport) -> impl Iterator<Item = (&'static str, usize)> {
    [
        ("vertices welded (equal positions)", report.welded_vertices),
        ("wedges merged (equal attributes)", report.merged_wedges),
        ("degenerate faces dropped", report.dropped_degenerate),
        ("duplicate faces dropped", report.dropped_duplicate),
        ("unreferenced vertices dropped", report.dropped_unreferenced),
        ("faces of zero area", report.zero_area),
        ("boundary edges", report.boundary_edges),
        ("seam edges", report.seam_edges),
        ("non-manifold edges", report.nonmanifold_edges),
        ("collapses that change the topology", report.relaxed_collapses),
        ("collapses across components", report.forced_collapses),
    ]
    .into_iter()
    .filter(|&(_, count)| count > 0)
}
