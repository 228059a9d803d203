//! Where the numbers of an OUT lie (PROTOCOL.md, "What OUT holds"), so that a difference can be named.

use crate::manifest::{Op, Test};

/// How numbers of a field are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Whole numbers, little-endian.
    Whole,
    /// binary32: their bits.
    F32,
    /// binary64: their bits.
    F64,
}

/// Numbers of one kind, one after the other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// What PROTOCOL.md calls it.
    pub name: String,
    /// Where it begins \[bytes\].
    pub at: usize,
    /// Length of each number \[bytes\].
    pub size: usize,
    /// How many there are.
    pub count: usize,
    /// What they are.
    pub kind: Kind,
}

/// Goes through an OUT and notes fields.
struct Walk<'a> {
    out: &'a [u8],
    at: usize,
    fields: Vec<Field>,
}

impl Walk<'_> {
    fn put(&mut self, name: impl Into<String>, size: usize, count: usize, kind: Kind) {
        if count > 0 {
            self.fields.push(Field { name: name.into(), at: self.at, size, count, kind });
        }
        self.at = self.at.saturating_add(size.saturating_mul(count));
    }

    fn words(&mut self, name: impl Into<String>, count: usize) {
        self.put(name, 4, count, Kind::Whole);
    }

    /// The word at a place, 0 behind the end.
    fn word(&self, at: usize) -> usize {
        let bytes = self.out.get(at..).and_then(|rest| rest.first_chunk());
        bytes.map_or(0, |bytes| u32::from_le_bytes(*bytes) as usize)
    }

    /// Reads a word and notes it.
    fn next(&mut self, name: impl Into<String>) -> usize {
        let word = self.word(self.at);
        self.words(name, 1);
        word
    }

    fn bytes(&mut self, name: impl Into<String>, count: usize) {
        self.put(name, 1, count, Kind::Whole);
    }

    /// Words that count to this are nothing.
    fn text(&mut self, name: &str, length: usize) {
        if length != NOTHING {
            self.bytes(name, length);
        }
    }
}

/// The u32 that says that there is nothing.
const NOTHING: usize = 0xFFFF_FFFF;

/// The fields of an OUT, as far as it says itself what it holds.
#[must_use]
pub fn fields(test: &Test, out: &[u8]) -> Vec<Field> {
    let mut walk = Walk { out, at: 0, fields: Vec::new() };
    match (test.op, test.format.as_deref()) {
        _ if out.is_empty() => {}
        (Op::Numeric, _) => walk.put("components", 4, out.len() / 4, Kind::F32),
        (Op::Prefixes, _) => walk.words("statuses and records", out.len() / 4),
        (_, Some("ivg")) => grid(&mut walk),
        _ => mesh(&mut walk),
    }
    walk.fields
}

fn grid(walk: &mut Walk<'_>) {
    let vertices = (0..3).map(|axis| walk.word(4 * axis)).fold(1usize, usize::saturating_mul);
    walk.words("dims", 3);
    walk.put("origin", 8, 3, Kind::F64);
    walk.put("step", 8, 3, Kind::F64);
    walk.words("units", 1);
    walk.words(QUANTITY, 1);
    let lights = walk.next("lights");
    for light in 0..if lights == NOTHING { 0 } else { lights } {
        if walk.at >= walk.out.len() {
            return;
        }
        walk.words(format!("light {light}, direct"), 1);
        let length = walk.next(format!("light {light}, bytes of the name"));
        walk.text(&format!("light {light}, name"), length);
    }
    let length = walk.next("bytes of the metadata");
    walk.text("metadata", length);
    for name in [RECEIVED, "validity", "blocked"] {
        walk.bytes(name, vertices);
    }
    let left = walk.out.len().saturating_sub(walk.at);
    walk.put(VALUES, 4, left / 4, Kind::F32);
}

fn mesh(walk: &mut Walk<'_>) {
    walk.put("origin", 8, 3, Kind::F64);
    let attributes = walk.next("attributes");
    walk.words("counts", 4);
    for packet in 0..walk.next("packets") {
        if walk.at >= walk.out.len() {
            return;
        }
        walk.words(format!("packet {packet}"), 4);
        walk.put(format!("packet {packet}, error"), 4, 1, Kind::F32);
    }
    let names = walk.next("materials' names");
    for name in 0..if names == NOTHING { 0 } else { names } {
        if walk.at >= walk.out.len() {
            return;
        }
        let length = walk.next(format!("bytes of name {name}"));
        walk.text(&format!("name {name}"), length);
    }
    if walk.next("level") == NOTHING {
        return;
    }
    let [vertices, wedges, faces] = [0, 4, 8].map(|at| walk.word(walk.at + at));
    walk.words("level's counts", 3);
    let has = |bit: usize, count: usize| if attributes >> bit & 1 == 1 { count } else { 0 };
    walk.put("positions", 4, 3 * vertices, Kind::F32);
    walk.words("wedges", wedges);
    walk.put("normals", 4, has(0, 3 * wedges), Kind::F32);
    walk.put("texture coordinates", 4, has(1, 2 * wedges), Kind::F32);
    walk.bytes("colours", has(2, 4 * wedges));
    walk.words("corners", 3 * faces);
    walk.put("materials", 2, has(3, faces), Kind::Whole);
}

/// Fields of a grid that tell which number of which vertex a value is.
const QUANTITY: &str = "quantity";
const RECEIVED: &str = "received";
const VALUES: &str = "values";
/// The hemispheres in their order (IVG-DEF-03).
const HEMISPHERES: [&str; 6] = ["+x", "-x", "+y", "-y", "+z", "-z"];
const CHANNELS: [&str; 3] = ["R", "G", "B"];
const COORDINATES: [&str; 3] = ["x", "y", "z"];
/// Coefficients of harmonics of a channel.
const COEFFICIENTS: usize = 9;

/// Which number of which vertex a value of a grid is.
fn value_name(fields: &[Field], out: &[u8], index: usize) -> String {
    let bytes = |name: &str| {
        let field = fields.iter().find(|field| field.name == name);
        field.and_then(|field| out.get(field.at..field.at + field.size * field.count)).unwrap_or_default()
    };
    let harmonics = bytes(QUANTITY) == [1, 0, 0, 0];
    let of_hemisphere = CHANNELS.len() * COORDINATES.len();
    let of_vertex = if harmonics { CHANNELS.len() * COEFFICIENTS } else { HEMISPHERES.len() * of_hemisphere };
    let mut arrived = bytes(RECEIVED).iter().enumerate().filter(|(_, received)| **received == 1);
    let vertex = match arrived.nth(index / of_vertex) {
        Some((vertex, _)) => format!("vertex {vertex}"),
        None => "no vertex".to_owned(),
    };
    let number = index % of_vertex;
    if harmonics {
        return format!(
            "{vertex}, {}, coefficient {}",
            CHANNELS[number / COEFFICIENTS],
            number % COEFFICIENTS
        );
    }
    let (hemisphere, number) = (HEMISPHERES[number / of_hemisphere], number % of_hemisphere);
    let (channel, coordinate) =
        (CHANNELS[number / COORDINATES.len()], COORDINATES[number % COORDINATES.len()]);
    format!("{vertex}, hemisphere {hemisphere}, {channel}, {coordinate}")
}

/// The first number in which two OUTs differ, in a line; `None` if they are the same.
#[must_use]
pub fn difference(test: &Test, expected: &[u8], found: &[u8]) -> Option<String> {
    let first = expected.iter().zip(found).position(|(a, b)| a != b);
    let lengths = || format!("OUT has {} bytes, expected {}", found.len(), expected.len());
    let Some(at) = first else {
        return (expected.len() != found.len()).then(|| format!("{}; the same up to there", lengths()));
    };
    let fields = fields(test, expected);
    let Some(field) = fields.iter().rev().find(|field| field.at <= at) else {
        return Some(format!("byte {at} differs; {}", lengths()));
    };
    let index = (at - field.at) / field.size;
    let place = field.at + index * field.size;
    let show = |out: &[u8]| match out.get(place..place + field.size) {
        None => "nothing".to_owned(),
        Some(bytes) => {
            let mut whole = [0; 8];
            whole[..bytes.len()].copy_from_slice(bytes);
            let whole = u64::from_le_bytes(whole);
            match field.kind {
                Kind::Whole => whole.to_string(),
                Kind::F32 => format!("{:.6e} (0x{whole:08X})", f32::from_bits(whole as u32)),
                Kind::F64 => format!("{:.6e} (0x{whole:016X})", f64::from_bits(whole)),
            }
        }
    };
    let name = match test.op {
        Op::Prefixes => format!("after {} bytes: {}", index / 2, ["exit status", "records"][index % 2]),
        _ if field.name == VALUES => format!("{VALUES}[{index}], {}", value_name(&fields, expected, index)),
        _ if field.count == 1 => field.name.clone(),
        _ => format!("{}[{index}]", field.name),
    };
    let also = if expected.len() == found.len() { String::new() } else { format!("; {}", lengths()) };
    Some(format!("{name} (byte {place}): expected {}, found {}{also}", show(expected), show(found)))
}

#[cfg(test)]
mod tests;
