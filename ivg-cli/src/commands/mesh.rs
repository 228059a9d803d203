use std::cell::RefCell;
use std::process::ExitCode;
use std::time::Instant;

use ivg_scene::import::{self, ImportOptions};
use pmesh_build::{AttributeWeights, BuildOptions, BuildReport};
use pmesh_format::{EncodeOptions, Header, ProgressiveMesh};
use serde_json::{Value, json};

use crate::args::MeshArguments;
use crate::breakdown::Breakdown;
use crate::failure::Failure;
use crate::progress::FractionBar;
use crate::rounding::Rounding;
use crate::{breakdown, convert, files, reading, table};

pub(crate) fn run(arguments: &MeshArguments) -> Result<ExitCode, Failure> {
    files::require_extension(&arguments.out, &["pmesh"])?;
    let encode_options = arguments.options()?;
    let mut watch = Watch::start();
    let refused = |error| Failure::scene(&arguments.mesh, &error);
    let scene = import::load(&arguments.mesh, &ImportOptions::default()).map_err(refused)?;
    scene.check().map_err(refused)?;
    let (mesh, left_out) = convert::joined_mesh(&arguments.mesh, &scene)?;
    watch.lap("read");

    let attributes = AttributeWeights {
        normal: arguments.normal_weight,
        uv: arguments.uv_weight,
        ..AttributeWeights::default()
    };
    let options = BuildOptions { cost: arguments.cost, attributes, ..BuildOptions::default() };
    let watch = RefCell::new(watch);
    let bar = FractionBar::new("order");
    let mut calls = 0;
    let built = pmesh_build::build(&mesh, &options, &mut |done| {
        calls += 1;
        // Called with 0 at the beginning and when the mesh is clean.
        if calls == 2 {
            watch.borrow_mut().lap("clean");
        }
        bar.set(done);
    });
    bar.finish();
    let mut watch = watch.into_inner();
    let (progressive, report) = built.map_err(|error| Failure::file(&arguments.mesh, error))?;
    watch.lap("order");

    let file = pmesh_format::encode(&progressive, &encode_options)
        .map_err(|error| Failure::file(&arguments.mesh, error))?;
    watch.lap("encode");
    files::write(&arguments.out, &file)?;
    watch.lap("write");

    let written = Written {
        arguments,
        progressive: &progressive,
        report: &report,
        warnings: &scene.warnings,
        left_out: &left_out,
        options: &encode_options,
        header: reading::mesh_header(&arguments.out, &file)?,
        breakdown: breakdown::of(&file).map_err(|error| Failure::file(&arguments.out, error))?,
        bytes: file.len(),
        seconds: watch.laps,
    };
    if arguments.json {
        files::print(&format!("{}\n", written.json()))?;
    } else {
        files::print(&written.text())?;
    }
    for warning in scene.warnings.iter().chain(&left_out) {
        eprintln!("ivg: warning: {}", files::shown(warning));
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

/// Wall time by stage \[s\].
struct Watch {
    last: Instant,
    laps: Vec<(&'static str, f64)>,
}

impl Watch {
    fn start() -> Self {
        Self { last: Instant::now(), laps: Vec::new() }
    }

    /// Ends a stage; the next one begins.
    fn lap(&mut self, stage: &'static str) {
        self.laps.push((stage, self.last.elapsed().as_secs_f64()));
        self.last = Instant::now();
    }
}

/// What was written, and what there is to say of it.
struct Written<'a> {
    arguments: &'a MeshArguments,
    progressive: &'a ProgressiveMesh,
    report: &'a BuildReport,
    /// What was assumed or repaired while reading.
    warnings: &'a [String],
    /// What of the file has no place in the mesh.
    left_out: &'a [String],
    options: &'a EncodeOptions,
    header: Header,
    breakdown: Breakdown,
    bytes: usize,
    seconds: Vec<(&'static str, f64)>,
}

impl Written<'_> {
    fn vertices(&self) -> usize {
        self.progressive.positions.len()
    }

    fn levels(&self) -> usize {
        self.vertices() - self.progressive.base_vertices as usize + 1
    }

    fn bits_per_vertex(&self) -> f64 {
        8.0 * self.bytes as f64 / self.vertices().max(1) as f64
    }

    fn json(&self) -> Value {
        let Self { arguments, progressive, options, header, .. } = self;
        let rounding = Rounding::of(header);
        json!({
            "file": arguments.out,
            "bytes": self.bytes,
            "bits_per_vertex": self.bits_per_vertex(),
            "plain_bytes": convert::plain_bytes(&progressive.full()),
            "mode": options.mode.name(),
            "positions": options.positions.name(),
            "position_error_m": rounding.position,
            "normal_error_degrees": rounding.normal,
            "uv_error": rounding.uv,
            "cost": arguments.cost.name(),
            "attribute_weights_m": { "normal": arguments.normal_weight, "uv": arguments.uv_weight },
            "vertices": self.vertices(),
            "wedges": progressive.wedges.len(),
            "faces": progressive.faces.len(),
            "base_vertices": progressive.base_vertices,
            "levels": self.levels(),
            "packets": header.packet_count(),
            "parts": named(&self.breakdown),
            "findings": named(&findings(self.report).collect::<Vec<_>>()),
            "warnings": self.warnings,
            "left_out": self.left_out,
            "seconds": named(&self.seconds),
        })
    }

    fn text(&self) -> String {
        let Self { arguments, progressive, options, header, .. } = self;
        let plain = convert::plain_bytes(&progressive.full());
        let mut text = format!(
            "{}: {} vertices, {} wedges, {} faces, {} levels from {} vertices on\n{}, {:.1} bits a vertex ({:+.1} % against plain arrays); {} packets, {}, positions {}\n{}\n",
            files::shown(&arguments.out.display().to_string()),
            self.vertices(),
            progressive.wedges.len(),
            progressive.faces.len(),
            self.levels(),
            progressive.base_vertices,
            table::bytes(self.bytes as u64),
            self.bits_per_vertex(),
            100.0 * (self.bytes as f64 / plain.max(1) as f64 - 1.0),
            header.packet_count(),
            options.mode.name(),
            options.positions.name(),
            Rounding::of(header).text(),
        );
        for (part, bytes) in &self.breakdown {
            text.push_str(&format!("{bytes:>12} B  {part}\n"));
        }
        let stages: Vec<String> =
            self.seconds.iter().map(|(stage, seconds)| format!("{stage} {seconds:.2} s")).collect();
        let order =
            self.seconds.iter().find(|(stage, _)| *stage == "order").map_or(0.0, |(_, seconds)| *seconds);
        text.push_str(&format!(
            "{} ({:.1} us a vertex to order)\n",
            stages.join(", "),
            1e6 * order / self.vertices().max(1) as f64
        ));
        for (what, count) in findings(self.report) {
            text.push_str(&format!("{count:>12}    {what}\n"));
        }
        text
    }
}

/// Pairs as an object, in their order.
fn named<T: Copy + Into<Value>>(pairs: &[(&str, T)]) -> Value {
    pairs
        .iter()
        .map(|&(name, value)| (name.to_owned(), value.into()))
        .collect::<serde_json::Map<_, _>>()
        .into()
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
