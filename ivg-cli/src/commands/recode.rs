use std::path::Path;
use std::process::ExitCode;

use ivg_format::{EncodeOptions, Event, Header, Limits, Order, Quantity, decode_all};
use ivg_grid::{FillOptions, IrradianceGrid, harmonics};
use serde_json::{Value, json};

use crate::args::RecodeArguments;
use crate::failure::Failure;
use crate::kind::FileKind;
use crate::loss::{Loss, Stored};
use crate::writing::{self, Extras};
use crate::{files, reading, table};

pub(crate) fn run(arguments: &RecodeArguments) -> Result<ExitCode, Failure> {
    files::require_extension(&arguments.out, &["ivg"])?;
    let path = &arguments.file;
    let bytes = files::read(path)?;
    if FileKind::of(path, &bytes) == FileKind::Mesh {
        return Err(Failure::usage(format_args!("{}: recode is for .ivg files", path.display())));
    }
    let (grid, header) = read(path, &bytes)?;
    let grid = without_gaps(path, grid);
    let options = EncodeOptions {
        encoding: arguments.encoding.unwrap_or(header.encoding),
        order: arguments.order.unwrap_or(header.order),
        vertices_per_slice: arguments.per_slice.unwrap_or(header.vertices_per_slice),
        seed: arguments.seed.unwrap_or(header.seed),
        units: header.units,
        ..EncodeOptions::default()
    };
    let converted = converted(path, &grid, &header, &options)?;
    let source_grid = converted.as_ref().unwrap_or(&grid);
    let mut source = source_grid.as_source();
    if header.validity_records > 0 {
        // The section stays, even if it says nothing.
        source.validity = Some(source_grid.validity());
        source.blocked_edges = Some(source_grid.blocked_edges());
    }
    let Rest { extras, bundles } = rest(path, &bytes)?;
    // An order that is not asked for and still fits stays as it is.
    let keeps_bundles = arguments.order.is_none() && arguments.per_slice.is_none();
    let bundles = match options.order {
        Order::Explicit if keeps_bundles => Some(bundles),
        _ => writing::bundles(source_grid, &options),
    };
    source.bundles = bundles.as_deref();
    let file = writing::encode(source, &extras, &options)?;

    let (after, written) = read(&arguments.out, &file)?;
    let before = Stored { grid: &grid, encoding: header.encoding };
    let after = Stored { grid: &after, encoding: written.encoding };
    let loss = Loss::measure(before, source_grid, after);
    files::write(&arguments.out, &file)?;
    report(arguments, (&header, bytes.len()), (&written, file.len()), &loss, converted.is_some())?;
    Ok(ExitCode::SUCCESS)
}

fn read(path: &Path, bytes: &[u8]) -> Result<(IrradianceGrid, Header), Failure> {
    IrradianceGrid::from_file(bytes, &Limits::default()).map_err(|error| Failure::file(path, error))
}

/// The grid with every vertex that light reaches: only a file that breaks a rule for writers (IVG-EXP-04) lacks some.
fn without_gaps(path: &Path, grid: IrradianceGrid) -> IrradianceGrid {
    let missing = reading::missing(&grid);
    if missing == 0 {
        return grid;
    }
    eprintln!(
        "ivg: warning: {}: {missing} of {} vertices are in no bundle and filled",
        path.display(),
        grid.vertex_count()
    );
    ivg_grid::fill(&grid, &FillOptions::default())
}

/// The grid in the quantity that the encoding stores, where that is another one than the file's.
fn converted(
    path: &Path,
    grid: &IrradianceGrid,
    header: &Header,
    options: &EncodeOptions,
) -> Result<Option<IrradianceGrid>, Failure> {
    match (grid.quantity(), options.encoding.quantity()) {
        (Quantity::Vectors, Quantity::Radiance) => {
            let (from, to) = (header.encoding.name(), options.encoding.name());
            Err(Failure::file(
                path,
                format_args!(
                    "{from} stores irradiance vectors, which do not hold the coefficients of {to}; bake the scene again with ivg bake --encoding {to}"
                ),
            ))
        }
        (Quantity::Radiance, Quantity::Vectors) => {
            let vectors: Vec<_> = grid.radiance().iter().map(harmonics::hemisphere_vectors).collect();
            let (validity, edges) = (grid.validity().to_vec(), grid.blocked_edges().to_vec());
            let converted = IrradianceGrid::from_parts(*grid.lattice(), vectors, validity, edges);
            converted.map(Some).map_err(|error| Failure::file(path, error))
        }
        _ => Ok(None),
    }
}

/// What is in a file besides header and values.
struct Rest {
    extras: Extras,
    /// The vertices of each bundle.
    bundles: Vec<Vec<u64>>,
}

/// Lights, metadata and bundles of the file. Chunks that this release does not know may refer to what changes; they are
/// left out.
fn rest(path: &Path, bytes: &[u8]) -> Result<Rest, Failure> {
    let mut extras = Extras::default();
    let mut bundles = Vec::new();
    let mut take = |chunk: &ivg_format::Chunk<'_>| -> Result<(), ivg_format::Error> {
        if chunk.kind == ivg_format::LIGHTS {
            let lights = ivg_format::lights(chunk)?;
            extras.lights.extend(lights.map(|light| (light.name.to_owned(), light.direct_included)));
        } else if chunk.kind == ivg_format::METADATA {
            let pairs = ivg_format::metadata(chunk)?;
            extras.metadata.extend(pairs.map(|(key, value)| (key.to_owned(), value.to_owned())));
        } else {
            eprintln!("ivg: warning: {}: chunk {} is not known and left out", path.display(), chunk.kind);
        }
        Ok(())
    };
    decode_all(bytes, &Limits::default(), |event| {
        match event {
            Event::Chunk(chunk) => take(&chunk)?,
            Event::Bundle(bundle) => bundles.push(bundle.vertices().collect()),
            _ => {}
        }
        Ok::<(), ivg_format::Error>(())
    })
    .map_err(|error| Failure::file(path, error))?;
    Ok(Rest { extras, bundles })
}

fn report(
    arguments: &RecodeArguments,
    from: (&Header, usize),
    to: (&Header, usize),
    loss: &Loss,
    converted: bool,
) -> Result<(), Failure> {
    let lossy = converted || !loss.is_none();
    if arguments.json {
        let mut report = described(to);
        report["file"] = json!(arguments.out);
        report["vertices"] = to.0.lattice.vertex_count().into();
        report["from"] = described(from);
        report["lossy"] = lossy.into();
        report["quantity_changed"] = converted.into();
        // Numbers of different quantities cannot be compared.
        report["values_relative_rmse"] = (!converted).then_some(loss.values).into();
        report["irradiance_relative_rmse"] = loss.irradiance.into();
        files::print(&format!("{report}\n"))?;
    } else {
        files::print(&format!(
            "{}: {} vertices, {} (from {})\n",
            arguments.out.display(),
            to.0.lattice.vertex_count(),
            phrase(to),
            phrase(from)
        ))?;
    }
    let irradiance = percent(loss.irradiance);
    if converted {
        let [lost, kept] = [from, to].map(|(header, _)| header.encoding.quantity().name());
        eprintln!(
            "ivg: lossy: {lost} cannot be had back from {kept}; irradiance differs by {irradiance} (relative RMSE over all vertices)"
        );
    } else if lossy {
        eprintln!(
            "ivg: lossy: irradiance differs by {irradiance}, stored numbers by {} (relative RMSE over all vertices; surfaces see the first)",
            percent(loss.values),
        );
    }
    Ok(())
}

fn percent(share: f64) -> String {
    if share > 0.0 && share < 5e-5 {
        "less than 0.01 %".to_owned()
    } else {
        format!("{:.2} %", 100.0 * share)
    }
}

fn described((header, bytes): (&Header, usize)) -> Value {
    json!({
        "bytes": bytes,
        "encoding": header.encoding.name(),
        "order": header.order.name(),
        "vertices_per_slice": header.vertices_per_slice,
        "seed": header.seed,
    })
}

fn phrase((header, bytes): (&Header, usize)) -> String {
    format!(
        "{} in the order {}, {} a slice, {}",
        header.encoding.name(),
        header.order.name(),
        header.vertices_per_slice,
        table::bytes(bytes as u64)
    )
}
