//! The tables of all values of a code (`PROTOCOL.md`, "Tables"), twice: as the decoders of `ivg-format` say, and as the specification
//! says, in binary64. The hashes in the suite are of the latter.

use ivg_format::quant::{direction, rgb9e5, xyz};
use sha2::{Digest, Sha256};
use std::io::{self, Write};

/// A table.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    /// Its name on the command line.
    pub name: &'static str,
    /// The number of its rows.
    pub rows: u32,
    /// What it shows.
    pub why: &'static str,
    /// The clauses that it is about.
    pub clauses: &'static [&'static str],
    /// A row as the decoder gives it, and as the specification says.
    decoded: fn(u32) -> Vec<f32>,
    specified: fn(u32) -> Vec<f32>,
}

/// All tables.
pub const TABLES: [Table; 4] = [
    Table {
        name: "rgb9e5",
        rows: 32,
        why: "every exponent and mantissa of a colour: a row for each exponent",
        clauses: &["IVG-RGB-01"],
        decoded: |e| (0..512).map(|m| rgb9e5::decode(e << 27 | m)[0]).collect(),
        specified: |e| (0..512).map(|m| (f64::from(m) * f64::from(e as i32 - 24).exp2()) as f32).collect(),
    },
    Table {
        name: "f16",
        rows: 64,
        why: "every number of binary16: a row for each sign and exponent",
        clauses: &["IVG-PAIR-05"],
        decoded: |row| (0..1024).map(|m| marked(half(row << 10 | m))).collect(),
        specified: |row| (0..1024).map(|m| marked(binary16(row, m))).collect(),
    },
    Table {
        name: "oct24",
        rows: 4095,
        why: "every direction code of packed-oct24: a row for each v, from -2047",
        clauses: &["IVG-DIR-01", "IVG-DIR-03"],
        decoded: |row| directions(4095, |u| direction::decode_octahedral24(u + 4096 * row)),
        specified: |row| directions(4095, |u| Some(unit(octahedral(u as i32 - 2047, row as i32 - 2047)))),
    },
    Table {
        name: "xyz24",
        rows: 255,
        why: "every direction code of packed-xyz24: a row for each z, from -127",
        clauses: &["IVG-XYZ-01", "IVG-XYZ-03"],
        decoded: |z| {
            let byte = |n: u32| u32::from((n as i32 - 127) as i8 as u8);
            directions(255 * 255, |n| xyz::decode_xyz24(byte(n % 255) | byte(n / 255) << 8 | byte(z) << 16))
        },
        specified: |z| {
            let point = |n: u32| [n % 255, n / 255, z].map(|c| c as i32 - 127);
            directions(255 * 255, |n| (point(n) != [0; 3]).then(|| unit(point(n))))
        },
    },
];

/// What stands for something that is no number.
const NONE: f32 = f32::from_bits(0xFFFF_FFFF);

fn marked(number: f32) -> f32 {
    if number.is_finite() { number } else { NONE }
}

fn half(code: u32) -> f32 {
    ::half::f16::from_bits(code as u16).to_f32()
}

/// IEEE 754: sign and exponent in the row, then the mantissa.
fn binary16(row: u32, mantissa: u32) -> f32 {
    let sign = if row >= 32 { -1.0 } else { 1.0 };
    let size = match row % 32 {
        0 => f64::from(mantissa) * (-24f64).exp2(),
        31 => f64::INFINITY,
        e => f64::from(1024 + mantissa) * (f64::from(e) - 25.0).exp2(),
    };
    (sign * size) as f32
}

fn directions(count: u32, of: impl Fn(u32) -> Option<[f32; 3]>) -> Vec<f32> {
    (0..count).flat_map(|n| of(n).unwrap_or([NONE; 3])).collect()
}

/// IVG-DIR-03.
fn octahedral(u: i32, v: i32) -> [i32; 3] {
    let z = 2047 - u.abs() - v.abs();
    if z >= 0 { [u, v, z] } else { [(2047 - v.abs()) * u.signum(), (2047 - u.abs()) * v.signum(), z] }
}

/// IVG-DIR-03: root and quotients in binary64, each rounded to binary32.
fn unit(point: [i32; 3]) -> [f32; 3] {
    let length = f64::from(point.iter().map(|c| c * c).sum::<i32>()).sqrt();
    point.map(|c| (f64::from(c) / length) as f32)
}

fn bytes(row: &[f32]) -> Vec<u8> {
    row.iter().flat_map(|number| number.to_bits().to_le_bytes()).collect()
}

impl Table {
    /// Writes the table as the decoder gives it.
    ///
    /// # Errors
    ///
    /// Those of writing.
    pub fn write(&self, mut out: impl Write) -> io::Result<()> {
        (0..self.rows).try_for_each(|row| out.write_all(&bytes(&(self.decoded)(row))))?;
        out.flush()
    }

    /// As the specification says: the first eight bytes of the hash of each row, the hash of all, the number of bytes.
    #[must_use]
    pub fn hashes(&self) -> (Vec<u8>, String, u64) {
        let (mut rows, mut whole, mut length) = (Vec::new(), Sha256::new(), 0);
        for row in 0..self.rows {
            let row = bytes(&(self.specified)(row));
            rows.extend(&Sha256::digest(&row)[..8]);
            whole.update(&row);
            length += row.len() as u64;
        }
        (rows, conformance_runner::hex(&whole.finalize()), length)
    }
}

/// The table of this name.
#[must_use]
pub fn table(name: &str) -> Option<&'static Table> {
    TABLES.iter().find(|table| table.name == name)
}
