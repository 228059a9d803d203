use std::process::ExitCode;

use glam::{DVec3, Vec3};
use ivg_format::{Encoding, Lattice, Limits};
use ivg_grid::{FillOptions, IrradianceGrid, Reconstruction, SpatialFilter};

use crate::args::{FilterArgument, ReconstructionArgument, SampleArguments};
use crate::failure::Failure;
use crate::points::Points;
use crate::{files, reading};

pub(crate) fn run(arguments: &SampleArguments) -> Result<ExitCode, Failure> {
    if let Some(out) = &arguments.out {
        files::require_extension(out, &["csv"])?;
    }
    let (grid, encoding) = grid(arguments)?;
    let reconstruction = reconstruction(arguments.reconstruction, encoding)?;
    let filter = filter(arguments.filter);
    let points = Points::read(&arguments.points)?;
    let outside = points.iter().filter(|point| is_outside(grid.lattice(), point.position)).count();
    if outside > 0 {
        eprintln!(
            "ivg: warning: {outside} of {} points lie outside the grid; the nearest point of its box answers for them",
            points.iter().count(),
        );
    }
    let results: Vec<Vec3> = points
        .iter()
        .map(|point| grid.irradiance(point.position, point.normal, reconstruction, filter))
        .collect();
    let unlit = points.iter().zip(&results);
    let unlit = unlit.filter(|(point, light)| **light == Vec3::ZERO && !touches_light(&grid, point.position));
    let unlit = unlit.count();
    if unlit > 0 && !arguments.fill {
        eprintln!(
            "ivg: warning: {unlit} of {} points touch only vertices without light; --fill gives those a value",
            results.len(),
        );
    }
    let table = points.with_results(&results).map_err(Failure::new)?;
    match &arguments.out {
        Some(out) => files::write(out, &table)?,
        None => files::print(&String::from_utf8_lossy(&table))?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The grid to look up in. Only a filled one may have missing vertices.
fn grid(arguments: &SampleArguments) -> Result<(IrradianceGrid, Encoding), Failure> {
    let path = &arguments.file;
    let bytes = files::read(path)?;
    if !arguments.fill {
        let whole = IrradianceGrid::from_file(&bytes, &Limits::default());
        let (grid, header) = whole.map_err(|error| match &error {
            ivg_grid::GridError::Format(found) if found.verdict() == ivg_wire::Verdict::NeedMore => {
                Failure::file(path, format_args!("{error}; --fill samples what there is"))
            }
            _ => Failure::file(path, error),
        })?;
        return Ok((grid, header.encoding));
    }
    let (header, grid, _) = reading::grid(path, &bytes)?;
    let missing = reading::missing(&grid);
    if grid.received_count() == 0 {
        eprintln!("ivg: warning: {}: nothing has arrived: all values are 0", path.display());
    } else if missing > 0 {
        eprintln!(
            "ivg: warning: {}: {missing} of {} vertices are missing and filled",
            path.display(),
            grid.vertex_count()
        );
    }
    Ok((ivg_grid::fill(&grid, &FillOptions::default()), header.encoding))
}

fn reconstruction(argument: ReconstructionArgument, encoding: Encoding) -> Result<Reconstruction, Failure> {
    let wanted = match argument {
        ReconstructionArgument::N2 => Reconstruction::NSquared,
        ReconstructionArgument::Three => Reconstruction::ThreeVector,
        ReconstructionArgument::Six => Reconstruction::SixVector,
        ReconstructionArgument::Sh2 => Reconstruction::Harmonics,
        ReconstructionArgument::Auto => Reconstruction::for_encoding(encoding),
    };
    let quantity = encoding.quantity();
    if wanted.fits(quantity) {
        return Ok(wanted);
    }
    let possible: Vec<&str> = Reconstruction::ALL
        .into_iter()
        .filter(|other| other.fits(quantity))
        .map(Reconstruction::name)
        .collect();
    Err(Failure::usage(format_args!(
        "--reconstruction {} does not go with {}, which stores {}; use {}",
        wanted.name(),
        encoding.name(),
        quantity.name(),
        possible.join(", "),
    )))
}

fn filter(argument: FilterArgument) -> SpatialFilter {
    match argument {
        FilterArgument::Trilinear => SpatialFilter::Trilinear,
        FilterArgument::Tricubic => SpatialFilter::Tricubic,
    }
}

/// Whether a lookup takes the nearest point of the grid's box instead. Along an axis of one vertex nothing is outside.
fn is_outside(lattice: &Lattice, p: DVec3) -> bool {
    let [i, j, k] = lattice.dims.map(|n| n.saturating_sub(1));
    let (first, last) = (lattice.position(0, 0, 0), lattice.position(i, j, k));
    (0..3).any(|axis| lattice.dims[axis] > 1 && !(first[axis]..=last[axis]).contains(&p[axis]))
}

/// Whether a vertex that light reaches, and whose value is known, lies around a point: a corner of its cell, or of the
/// face, edge or vertex that it lies on.
fn touches_light(grid: &IrradianceGrid, p: DVec3) -> bool {
    let lattice = grid.lattice();
    let around: [[u16; 2]; 3] = std::array::from_fn(|axis| {
        let last = lattice.dims[axis] - 1;
        if last == 0 {
            return [0; 2];
        }
        let at = ((p[axis] - lattice.origin[axis]) / lattice.step[axis]).clamp(0.0, f64::from(last));
        [at.floor() as u16, at.ceil() as u16]
    });
    (0..8).any(|corner: usize| {
        let [i, j, k] = std::array::from_fn(|axis| around[axis][corner >> axis & 1]);
        let vertex = lattice.index(i, j, k) as usize;
        grid.is_valid(vertex) && grid.has_value(vertex)
    })
}
