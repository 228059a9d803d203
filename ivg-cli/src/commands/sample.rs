use std::io::Read;
use std::process::ExitCode;

use glam::{DVec3, Vec3};
use ivg_format::{Encoding, Limits};
use ivg_grid::{FillOptions, IrradianceGrid, Reconstruction, SpatialFilter};

use crate::args::{FilterArgument, ReconstructionArgument, SampleArguments};
use crate::failure::Failure;
use crate::files;

/// Columns of the input, in any order; further columns are an error, so that nothing is silently dropped.
const COLUMNS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// How far from 1 the length of a normal may be; f32 text with six digits stays well within it.
const UNIT_TOLERANCE: f64 = 1e-3;

pub(crate) fn run(arguments: &SampleArguments) -> Result<ExitCode, Failure> {
    let bytes = files::read(&arguments.file)?;
    let broken = |error: ivg_grid::GridError| Failure::file(&arguments.file, error);
    let (grid, header) = IrradianceGrid::from_file(&bytes, &Limits::default()).map_err(broken)?;
    let grid = ivg_grid::fill(&grid, &FillOptions::default());
    let reconstruction = reconstruction(arguments.reconstruction, header.encoding);
    let filter = filter(arguments.filter);
    let points = read_points(arguments)?;

    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS.into_iter().chain(["r", "g", "b"])).map_err(Failure::new)?;
    for (p, n) in points {
        let normal = n.normalize().as_vec3();
        let irradiance = grid.irradiance(p, normal, reconstruction, filter);
        let numbers = p.to_array().into_iter().chain(n.to_array()).map(|v| v.to_string());
        let record: Vec<String> = numbers.chain(Vec3::to_array(&irradiance).map(|v| v.to_string())).collect();
        writer.write_record(&record).map_err(Failure::new)?;
    }
    let text = writer.into_inner().map_err(Failure::new)?;
    files::print(&String::from_utf8_lossy(&text));
    Ok(ExitCode::SUCCESS)
}

fn reconstruction(argument: ReconstructionArgument, encoding: Encoding) -> Reconstruction {
    match argument {
        ReconstructionArgument::N2 => Reconstruction::NSquared,
        ReconstructionArgument::Three => Reconstruction::ThreeVector,
        ReconstructionArgument::Six => Reconstruction::SixVector,
        ReconstructionArgument::Auto => Reconstruction::for_encoding(encoding),
    }
}

fn filter(argument: FilterArgument) -> SpatialFilter {
    match argument {
        FilterArgument::Trilinear => SpatialFilter::Trilinear,
        FilterArgument::Tricubic => SpatialFilter::Tricubic,
    }
}

fn read_points(arguments: &SampleArguments) -> Result<Vec<(DVec3, DVec3)>, Failure> {
    let path = &arguments.at;
    let text = if path.as_os_str() == "-" {
        let mut text = Vec::new();
        std::io::stdin().read_to_end(&mut text).map_err(|error| Failure::file(path, error))?;
        text
    } else {
        files::read(path)?
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(&text[..]);
    let header = reader.headers().map_err(|error| Failure::file(path, error))?.clone();
    let column = |name: &str| header.iter().position(|cell| cell == name);
    let places: Vec<usize> = COLUMNS
        .iter()
        .map(|name| column(name))
        .collect::<Option<_>>()
        .filter(|_| header.len() == COLUMNS.len())
        .ok_or_else(|| Failure::file(path, "line 1: the header must be x,y,z,nx,ny,nz"))?;
    let mut points = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|error| Failure::file(path, error))?;
        let line = record.position().map_or(row as u64 + 2, csv::Position::line);
        let number = |place: usize| {
            record[place].parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| {
                let what =
                    format!("line {line}: {} is '{}', not a finite number", &header[place], &record[place]);
                Failure::file(path, what)
            })
        };
        let values: Vec<f64> = places.iter().map(|&place| number(place)).collect::<Result<_, _>>()?;
        let (p, n) = (DVec3::from_slice(&values[..3]), DVec3::from_slice(&values[3..]));
        if (n.length() - 1.0).abs() > UNIT_TOLERANCE {
            let what = format!("line {line}: the normal has length {:.4}, it must be 1", n.length());
            return Err(Failure::file(path, what));
        }
        points.push((p, n));
    }
    Ok(points)
}
