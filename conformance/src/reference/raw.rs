//! Packets of mode `raw`: `spec/pmesh.md`, sections 4 to 7.

use super::lattice::Lattice;
use super::{Fault, Tables};
use pmesh_format::{Header, PacketEntry, Positions};
use std::ops::Range;

/// Codes of `spec/tables/errors.toml`.
const POSITION: u16 = 501;
const ATTRIBUTE: u16 = 502;
const PARENT: u16 = 503;
const CORNER: u16 = 504;
const FACE_VERTICES: u16 = 505;
const FACE_ORDER: u16 = 506;
const FACE_LEVEL: u16 = 507;
const VARINT: u16 = 508;
const WEDGE_COUNT: u16 = 509;
const WEDGE_TARGET: u16 = 510;
const SWITCH: u16 = 511;
const SWITCH_LENGTH: u16 = 512;
const SWITCH_PADDING: u16 = 513;

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
    let mut end = 0;
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
    let parents = array(true, 4 * brought.splits.len());
    let materials = array(has.materials, 2 * f);
    let mut at = end;

    let v = brought.vertices.len();
    tables.positions.extend(match header.positions.bits() {
        None => (0..v).map(|k| floats(header, payload, positions + 12 * k)).collect::<Result<Vec<_>, _>>()?,
        Some(bits) => points(header, bits, payload, v)?,
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
    for (k, v) in brought.splits.clone().enumerate() {
        let parent = u32_at(payload, parents + 4 * k);
        if parent >= v {
            return Err(Fault { code: PARENT, at: parents + 4 * k });
        }
        tables.parents.insert(v, parent);
    }
    wedges(tables, has.seams, &brought, payload, &mut at)?;
    let faces = faces(tables, header, &brought, payload, corners)?;
    for k in 0..f {
        if has.materials {
            tables
                .materials
                .push(u16::from_le_bytes([payload[materials + 2 * k], payload[materials + 2 * k + 1]]));
        }
    }
    levels(tables, base, &brought, &faces, payload, at)
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
fn points(header: &Header, bits: u8, payload: &[u8], count: usize) -> Result<Vec<[f32; 3]>, Fault> {
    let lattice = Lattice::new(header.bounds, bits);
    let number = |at: usize| i64::from(u16::from_le_bytes([payload[at], payload[at + 1]]));
    for k in 0..count {
        let at = 8 * k;
        if (0..3).any(|axis| number(at + 2 * axis) > lattice.most[axis]) || number(at + 6) != 0 {
            return Err(Fault { code: POSITION, at });
        }
    }
    let positions = (0..count).map(|k| lattice.position([0, 2, 4].map(|c| number(8 * k + c))));
    let judged = positions.enumerate().map(|(k, position)| {
        let finite = position.iter().all(|x| x.is_finite());
        if finite { Ok(position) } else { Err(Fault { code: POSITION, at: 8 * k }) }
    });
    judged.collect()
}

fn finite(numbers: &[f32], at: usize) -> Result<(), Fault> {
    if numbers.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Fault { code: ATTRIBUTE, at }) }
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
        let (count, start) = number(payload, at)?;
        if count == 0 || tables.owners.len() + count > brought.wedges.end {
            return Err(Fault { code: WEDGE_COUNT, at: start });
        }
        tables.owners.extend(vec![v; count]);
    }
    if tables.owners.len() != brought.wedges.end {
        return Err(Fault { code: WEDGE_COUNT, at: *at });
    }
    for v in brought.splits.clone() {
        let of_parent = wedges_of(tables, tables.parents[&v]);
        for w in wedges_of(tables, v) {
            let (target, start) = number(payload, at)?;
            let Some(&target) = of_parent.get(target) else {
                return Err(Fault { code: WEDGE_TARGET, at: start });
            };
            tables.targets.insert(w, target);
        }
    }
    Ok(())
}

fn wedges_of(tables: &Tables, vertex: usize) -> Vec<usize> {
    (0..tables.owners.len()).filter(|&w| tables.owners[w] == vertex).collect()
}

/// PMESH-PKT-04: a number of variable length, and where it begins.
fn number(payload: &[u8], at: &mut usize) -> Result<(usize, usize), Fault> {
    let start = *at;
    let mut value = 0u64;
    for place in 0.. {
        let Some(&byte) = payload.get(*at) else { return Err(Fault { code: SWITCH_LENGTH, at: start }) };
        *at += 1;
        value |= u64::from(byte & 0x7F) << (7 * place);
        let more = byte & 0x80 != 0;
        let too_long = place > 0 && byte == 0;
        if too_long || value >= 1 << 32 || (place == 4 && more) {
            return Err(Fault { code: VARINT, at: start });
        }
        if !more {
            return Ok((value as usize, start));
        }
    }
    unreachable!("the fifth byte is the last")
}

/// PMESH-FACE-01 to PMESH-FACE-04: the faces, each with the vertex that introduces it; B − 1 for the base.
fn faces(
    tables: &Tables,
    header: &Header,
    brought: &Brought,
    payload: &[u8],
    corners: usize,
) -> Result<Vec<(usize, [usize; 3])>, Fault> {
    let base = header.base_vertices as usize;
    let mut faces: Vec<(usize, [usize; 3])> = Vec::new();
    for k in 0..brought.faces.len() {
        let at = corners + 12 * k;
        let wedges = [0, 4, 8].map(|c| u32_at(payload, at + c));
        if wedges.iter().any(|&w| w >= brought.wedges.end) {
            return Err(Fault { code: CORNER, at });
        }
        let vertices = wedges.map(|w| tables.owners[w]);
        if vertices[0] == vertices[1] || vertices[1] == vertices[2] || vertices[2] == vertices[0] {
            return Err(Fault { code: FACE_VERTICES, at });
        }
        let latest = vertices[0].max(vertices[1]).max(vertices[2]);
        let introducer = if latest < base { base - 1 } else { latest };
        let in_this_packet = introducer >= brought.vertices.start;
        let sorted = faces.last().is_none_or(|&(before, _)| before <= introducer);
        if !in_this_packet || !sorted {
            return Err(Fault { code: FACE_ORDER, at });
        }
        if latest >= base && !vertices.contains(&tables.parents[&latest]) {
            return Err(Fault { code: FACE_LEVEL, at });
        }
        faces.push((introducer, wedges));
    }
    Ok(faces)
}

/// PMESH-SWI-01 to PMESH-SWI-03: goes up vertex by vertex and notes every level.
fn levels(
    tables: &mut Tables,
    base: usize,
    brought: &Brought,
    faces: &[(usize, [usize; 3])],
    payload: &[u8],
    codes: usize,
) -> Result<(), Fault> {
    let of = |v: usize| faces.iter().filter(move |&&(introducer, _)| introducer == v).map(|&(_, face)| face);
    if brought.vertices.start < base {
        tables.corners.extend(of(base - 1));
        tables.levels.insert(base, tables.corners.clone());
    }
    let mut bit = 0;
    let mut read = |count: usize| {
        let mut value = 0;
        for place in 0..count {
            let byte = payload.get(codes + bit / 8)?;
            value |= usize::from(byte >> (bit % 8) & 1) << place;
            bit += 1;
        }
        Some((value, codes + (bit - count) / 8))
    };
    for v in brought.splits.clone() {
        let own = wedges_of(tables, v);
        // ⌈log₂(m + 1)⌉ bits: the smallest number with which 2^bits is at least m + 1.
        let bits = (0..).find(|&bits| 1usize << bits > own.len()).unwrap_or(0);
        let parent = tables.parents[&v];
        for slot in (0..3 * tables.corners.len()).rev() {
            let present = tables.corners[slot / 3][slot % 3];
            // Slots that have switched to v lie on v by now, not on its parent.
            if tables.owners[present] != parent {
                continue;
            }
            let Some((code, at)) = read(bits) else {
                return Err(Fault { code: SWITCH_LENGTH, at: payload.len() });
            };
            if code == 0 {
                continue;
            }
            match own.get(code - 1) {
                Some(&wedge) if tables.targets[&wedge] == present => {
                    tables.corners[slot / 3][slot % 3] = wedge;
                }
                _ => return Err(Fault { code: SWITCH, at }),
            }
        }
        tables.corners.extend(of(v));
        tables.levels.insert(v + 1, tables.corners.clone());
    }
    let end = codes + bit.div_ceil(8);
    if end != payload.len() {
        return Err(Fault { code: SWITCH_LENGTH, at: end });
    }
    if bit % 8 != 0 && payload[end - 1] >> (bit % 8) != 0 {
        return Err(Fault { code: SWITCH_PADDING, at: end - 1 });
    }
    Ok(())
}

fn u32_at(payload: &[u8], at: usize) -> usize {
    u32::from_le_bytes(*payload[at..].first_chunk().expect("the directory was checked for that")) as usize
}

fn f32_at(payload: &[u8], at: usize) -> f32 {
    f32::from_bits(u32_at(payload, at) as u32)
}
