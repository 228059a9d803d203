//! Points with normals from a CSV file, and the same rows with what was found there.

use std::io::Read;
use std::path::Path;

use csv::StringRecord;
use glam::{DVec3, Vec3};

use crate::failure::Failure;
use crate::files;

/// Columns that the input must have, in any order.
const COLUMNS: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];

/// Columns that the output has in addition: irradiance \[W/m²\].
const RESULTS: [&str; 3] = ["r", "g", "b"];

/// What begins a text file from some spreadsheets: U+FEFF in UTF-8.
const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// A table of points on surfaces.
#[derive(Debug)]
pub(crate) struct Points {
    header: StringRecord,
    rows: Vec<(StringRecord, Point)>,
}

/// A point on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    /// Where it is \[m\].
    pub(crate) position: DVec3,
    /// The surface's normal, unit length.
    pub(crate) normal: Vec3,
}

impl Points {
    /// Reads a CSV file, `-` for stdin. All of it is checked before anything is computed.
    ///
    /// # Errors
    ///
    /// Names line and column of what is missing, no number, or no direction.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        if path.as_os_str() == "-" {
            let mut text = Vec::new();
            std::io::stdin()
                .read_to_end(&mut text)
                .map_err(|error| Failure::new(format_args!("stdin: {error}")))?;
            return Self::parse(&text).map_err(|what| Failure::new(format_args!("stdin: {what}")));
        }
        Self::parse(&files::read(path)?).map_err(|what| Failure::file(path, what))
    }

    fn parse(text: &[u8]) -> Result<Self, String> {
        let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text);
        let header = reader.headers().map_err(|error| error.to_string())?.clone();
        let places = places(&header)?;
        let mut rows = Vec::new();
        for (row, record) in (2..).zip(reader.records()) {
            let record = record.map_err(|error| error.to_string())?;
            let line = record.position().map_or(row, csv::Position::line);
            let point = point(&record, &places, line)?;
            rows.push((record, point));
        }
        Ok(Self { header, rows })
    }

    /// The points, in order of the rows.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Point> + '_ {
        self.rows.iter().map(|&(_, point)| point)
    }

    /// The rows as they came, each with the irradiance \[W/m²\] of its point.
    pub(crate) fn with_results(&self, results: &[Vec3]) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.header.iter().chain(RESULTS))?;
        for ((record, _), irradiance) in self.rows.iter().zip(results) {
            let numbers = irradiance.to_array().map(|value| value.to_string());
            writer.write_record(record.iter().chain(numbers.iter().map(String::as_str)))?;
        }
        // Nothing is buffered that could fail: the writer writes to memory.
        writer.into_inner().map_err(|error| error.into_error().into())
    }
}

/// Where the columns are.
fn places(header: &StringRecord) -> Result<[usize; 6], String> {
    let count = |name: &str| header.iter().filter(|&cell| cell == name).count();
    let missing: Vec<&str> = COLUMNS.into_iter().filter(|name| count(name) == 0).collect();
    if !missing.is_empty() {
        return Err(format!(
            "line 1: the header must name the columns x,y,z,nx,ny,nz; {} missing",
            match &missing[..] {
                [one] => format!("{one} is"),
                more => format!("{} are", more.join(",")),
            }
        ));
    }
    if let Some(twice) = COLUMNS.into_iter().find(|name| count(name) > 1) {
        return Err(format!("line 1: there are two columns {twice}; rename one"));
    }
    if let Some(taken) = RESULTS.into_iter().find(|name| count(name) > 0) {
        return Err(format!("line 1: the output gets a column {taken}, but the input has one; rename that"));
    }
    // Each is there exactly once.
    Ok(COLUMNS.map(|name| header.iter().position(|cell| cell == name).unwrap_or_default()))
}

fn point(record: &StringRecord, places: &[usize; 6], line: u64) -> Result<Point, String> {
    let mut values = [0.0; 6];
    for ((value, name), &place) in values.iter_mut().zip(COLUMNS).zip(places) {
        let cell = &record[place];
        *value = cell
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
            .ok_or_else(|| format!("line {line}, column {name}: '{cell}' is not a finite number"))?;
    }
    let [position, normal] = [&values[..3], &values[3..]].map(DVec3::from_slice);
    // Scaled first, so that no square leaves the range of f64.
    let scaled = normal / normal.abs().max_element();
    if !scaled.is_finite() {
        return Err(format!(
            "line {line}, columns nx,ny,nz: the normal is zero; a surface needs a direction"
        ));
    }
    Ok(Point { position, normal: scaled.normalize().as_vec3() })
}

#[cfg(test)]
mod tests;
