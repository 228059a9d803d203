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
        let header = reader.headers().map_err(|error| refused(text, &error))?.clone();
        let places = places(&header).map_err(|what| format!("line {}: {what}", line(text, None)))?;
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|error| refused(text, &error))?;
            let point = point(&record, &places)
                .map_err(|what| format!("line {}, {what}", line(text, record.position())))?;
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

/// What the CSV reader refuses, by its line.
fn refused(text: &[u8], error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            format!("line {}: {len} columns, the header has {expected_len}", line(text, pos.as_ref()))
        }
        csv::ErrorKind::Utf8 { pos, .. } => {
            format!("line {}: this is not UTF-8 text", line(text, pos.as_ref()))
        }
        _ => error.to_string(),
    }
}

/// The line on which the record at this position begins, the first record without one. The reader's own count stops before
/// the line ends that it skips, so that it is short after empty lines and LF that follows CR.
fn line(text: &[u8], position: Option<&csv::Position>) -> usize {
    let reached = position.map_or(0, |position| position.byte() as usize).min(text.len());
    let skipped = text[reached..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
    let before = &text[..reached + skipped];
    // CR and LF are one end together.
    let ends = |&i: &usize| before[i] == b'\n' || (before[i] == b'\r' && before.get(i + 1) != Some(&b'\n'));
    1 + (0..before.len()).filter(ends).count()
}

/// Where the columns are.
fn places(header: &StringRecord) -> Result<[usize; 6], String> {
    let count = |name: &str| header.iter().filter(|&cell| cell == name).count();
    let missing: Vec<&str> = COLUMNS.into_iter().filter(|name| count(name) == 0).collect();
    if !missing.is_empty() {
        return Err(format!(
            "the header must name the columns x,y,z,nx,ny,nz; {} missing",
            match &missing[..] {
                [one] => format!("{one} is"),
                more => format!("{} are", more.join(",")),
            }
        ));
    }
    if let Some(twice) = COLUMNS.into_iter().find(|name| count(name) > 1) {
        return Err(format!("there are two columns {twice}; rename one"));
    }
    if let Some(taken) = RESULTS.into_iter().find(|name| count(name) > 0) {
        return Err(format!("the output gets a column {taken}, but the input has one; rename that"));
    }
    // Each is there exactly once.
    Ok(COLUMNS.map(|name| header.iter().position(|cell| cell == name).unwrap_or_default()))
}

fn point(record: &StringRecord, places: &[usize; 6]) -> Result<Point, String> {
    let mut values = [0.0; 6];
    for ((value, name), &place) in values.iter_mut().zip(COLUMNS).zip(places) {
        let cell = &record[place];
        *value = cell
            .parse()
            .ok()
            .filter(|value: &f64| value.is_finite())
            .ok_or_else(|| format!("column {name}: '{cell}' is not a finite number"))?;
    }
    let [position, normal] = [&values[..3], &values[3..]].map(DVec3::from_slice);
    // Scaled first, so that no square leaves the range of f64.
    let scaled = normal / normal.abs().max_element();
    if !scaled.is_finite() {
        return Err("columns nx,ny,nz: the normal is zero; a surface needs a direction".to_owned());
    }
    Ok(Point { position, normal: scaled.normalize().as_vec3() })
}

#[cfg(test)]
mod tests;
