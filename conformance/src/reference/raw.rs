//! Packets of mode `raw`: `spec/pmesh.md`, sections 4 to 7.

use super::lattice::Lattice;
use super::numbers::{Packed, bits, varint};
use super::{Fault, Tables, switches};
use pmesh_format::{Header, PacketEntry, Positions};
use std::ops::Range;

/// Codes of `spec/tables/errors.toml`.
const POSITION: u16 = 501;
const ATTRIBUTE: u16 = 502;
const PARENT: u16 = 503;
const CORNER: u16 = 504;
const FACE_VERTICES: u16 = 505;
const WEDGE_COUNT: u16 = 509;
const WEDGE_TARGET: u16 = 510;

/// Bytes of `switch_count`, with which the payload begins.
const SWITCH_COUNT: usize = 4;

/// The numbers of vertices, wedges and faces that a packet brings, as ranges, and its vertices from the base on.
struct Brought {
    vertices: Range<usize>,
    splits: Range<usize>,
    wedges: Range<usize>,
    faces: Range<usize>,
}

pub(super) fn take(
    tables: &mut Tables,
    header: &Header,
    entry: &PacketEntry,
    payload: &[u8],
) -> Result<(), Fault> {
    let whole = |range: &Range<u32>| range.start as usize..range.end as usize;
    let vertices = whole(&entry.vertices);
    let base = header.base_vertices as usize;
    let brought = Brought {
        splits: vertices.start.max(base)..vertices.end,
        vertices,
        wedges: whole(&entry.wedges),
        faces: whole(&entry.faces),
    };
    let has = header.attributes;
    let (w, f) = (brought.wedges.len(), brought.faces.len());
    // PMESH-PKT-02: the arrays one after the other.
    let position_bytes = if header.positions == Positions::F32 { 12 } else { 8 };
    let mut end = SWITCH_COUNT;
    let mut array = |present: bool, bytes: usize| {
        let start = end;
        end += if present { bytes } else { 0 };
        start
    };
    let positions = array(true, position_bytes * brought.vertices.len());
    let normals = array(has.normals, 12 * w);
    let uvs = array(has.uvs, 8 * w);
    let colours = array(has.colours, 4 * w);
    let corners = array(true, 12 * f);
    let materials = array(has.materials, 2 * f);
    let parents = end;

    let v = brought.vertices.len();
    tables.positions.extend(match header.positions.bits() {
        None => (0..v).map(|k| floats(header, payload, positions + 12 * k)).collect::<Result<Vec<_>, _>>()?,
        Some(bits) => points(header, bits, payload, positions, v)?,
    });
    for k in 0..w {
        if has.normals {
            let normal = [0, 4, 8].map(|c| f32_at(payload, normals + 12 * k + c));
            finite(&normal, normals + 12 * k)?;
            tables.normals.push(normal);
        }
    }
    for k in 0..w {
        if has.uvs {
            let uv = [0, 4].map(|c| f32_at(payload, uvs + 8 * k + c));
            finite(&uv, uvs + 8 * k)?;
            tables.uvs.push(uv);
        }
        if has.colours {
            tables.colours.push([0, 1, 2, 3].map(|c| payload[colours + 4 * k + c]));
        }
    }
    let mut at = collapses(tables, entry, &brought, payload, parents)?;
    wedges(tables, has.seams, &brought, payload, &mut at)?;
    faces(tables, &brought, payload, corners)?;
    for k in 0..f {
        if has.materials {
            tables
                .materials
                .push(u16::from_le_bytes([payload[materials + 2 * k], payload[materials + 2 * k + 1]]));
        }
    }
    switches::take(tables, header, entry, payload, at)
}

/// PMESH-POS-01 and PMESH-POS-02.
fn floats(header: &Header, payload: &[u8], at: usize) -> Result<[f32; 3], Fault> {
    let position = [0, 4, 8].map(|c| f32_at(payload, at + c));
    for (k, x) in position.iter().enumerate() {
        if !(x.is_finite() && header.bounds[0][k] <= *x && *x <= header.bounds[1][k]) {
            return Err(Fault { code: POSITION, at });
        }
    }
    Ok(position)
}

/// PMESH-POS-03 and PMESH-POS-04: first all positions by their numbers, then by their coordinates.
fn points(
    header: &Header,
    bits: u8,
    payload: &[u8],
    start: usize,
    count: usize,
) -> Result<Vec<[f32; 3]>, Fault> {
    let lattice = Lattice::new(header.bounds, bits);
    let number = |at: usize| i64::from(u16::from_le_bytes([payload[at], payload[at + 1]]));
    for k in 0..count {
        let at = start + 8 * k;
        if (0..3).any(|axis| number(at + 2 * axis) > lattice.most[axis]) || number(at + 6) != 0 {
            return Err(Fault { code: POSITION, at });
        }
    }
    let positions = (0..count).map(|k| lattice.position([0, 2, 4].map(|c| number(start + 8 * k + c))));
    let judged = positions.enumerate().map(|(k, position)| {
        let finite = position.iter().all(|x| x.is_finite());
        if finite { Ok(position) } else { Err(Fault { code: POSITION, at: start + 8 * k }) }
    });
    judged.collect()
}

fn finite(numbers: &[f32], at: usize) -> Result<(), Fault> {
    if numbers.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Fault { code: ATTRIBUTE, at }) }
}

/// PMESH-COL-01: onto what vertices collapse; the byte behind.
fn collapses(
    tables: &mut Tables,
    entry: &PacketEntry,
    brought: &Brought,
    payload: &[u8],
    start: usize,
) -> Result<usize, Fault> {
    let mut packed = Packed::new(payload, start);
    for v in brought.splits.clone() {
        let read = packed.read(bits(entry.vertices.end as usize));
        let (parent, at) = read.expect("the directory was checked for that");
        if parent >= v {
            return Err(Fault { code: PARENT, at });
        }
        tables.parents.insert(v, parent);
    }
    packed.padding()?;
    Ok(packed.end())
}

/// PMESH-WDG-01 and PMESH-COL-02: whose the wedges are and what they become.
fn wedges(
    tables: &mut Tables,
    seams: bool,
    brought: &Brought,
    payload: &[u8],
    at: &mut usize,
) -> Result<(), Fault> {
    if !seams {
        tables.owners.extend(brought.vertices.clone());
        for v in brought.splits.clone() {
            tables.targets.insert(v, tables.parents[&v]);
        }
        return Ok(());
    }
    for v in brought.vertices.clone() {
        let (count, start) = varint(payload, at)?;
        if count == 0 || tables.owners.len() + count > brought.wedges.end {
            return Err(Fault { code: WEDGE_COUNT, at: start });
        }
        tables.owners.extend(vec![v; count]);
    }
    if tables.owners.len() != brought.wedges.end {
        return Err(Fault { code: WEDGE_COUNT, at: *at });
    }
    for v in brought.splits.clone() {
        let of_parent = tables.wedges_of(tables.parents[&v]);
        for w in tables.wedges_of(v) {
            let (target, start) = varint(payload, at)?;
            let Some(&target) = of_parent.get(target) else {
                return Err(Fault { code: WEDGE_TARGET, at: start });
            };
            tables.targets.insert(w, target);
        }
    }
    Ok(())
}

/// PMESH-FACE-01.
fn faces(tables: &mut Tables, brought: &Brought, payload: &[u8], corners: usize) -> Result<(), Fault> {
    for k in 0..brought.faces.len() {
        let at = corners + 12 * k;
        let face = [0, 4, 8].map(|c| u32_at(payload, at + c));
        if face.iter().any(|&w| w >= brought.wedges.end) {
            return Err(Fault { code: CORNER, at });
        }
        let [a, b, c] = face.map(|w| tables.owners[w]);
        if a == b || b == c || c == a {
            return Err(Fault { code: FACE_VERTICES, at });
        }
        tables.corners.push(face);
    }
    Ok(())
}

fn u32_at(payload: &[u8], at: usize) -> usize {
    u32::from_le_bytes(*payload[at..].first_chunk().expect("the directory was checked for that")) as usize
}

fn f32_at(payload: &[u8], at: usize) -> f32 {
    f32::from_bits(u32_at(payload, at) as u32)
}
