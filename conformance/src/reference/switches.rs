//! Which corners of earlier faces a raw packet switches, and to what: `spec/pmesh.md`, section 7.

use super::numbers::{PACKET_LENGTH, Packed, bits};
use super::{Fault, Tables};
use pmesh_format::{Header, PacketEntry};
use std::collections::BTreeMap;

/// Codes of `spec/tables/errors.toml`.
const SWITCH: u16 = 511;
const SWITCH_SLOTS: u16 = 519;
const SWITCH_WORK: u16 = 520;

/// Takes the part of the payload that begins at `at`; all else that the packet brings is in the tables.
pub(super) fn take(
    tables: &mut Tables,
    header: &Header,
    entry: &PacketEntry,
    payload: &[u8],
    at: usize,
) -> Result<(), Fault> {
    let earlier = entry.faces.start as usize;
    let (slots, end) = slots(payload, at, 3 * earlier)?;
    // PMESH-SWI-06.
    let descendants = descendants(tables, header, entry);
    let mut packed = Packed::new(payload, end);
    let mut switched = Vec::new();
    for slot in slots {
        let present = tables.corners[slot / 3][slot % 3];
        let wedges = descendants.get(&present).map(Vec::as_slice).unwrap_or_default();
        if wedges.is_empty() {
            return Err(Fault { code: SWITCH, at: end });
        }
        let Some((number, _)) = packed.read(bits(wedges.len())) else {
            return Err(Fault { code: PACKET_LENGTH, at: end });
        };
        let Some(&wedge) = wedges.get(number) else { return Err(Fault { code: SWITCH, at: end }) };
        tables.corners[slot / 3][slot % 3] = wedge;
        switched.push(wedge);
    }
    packed.padding()?;
    if packed.end() < payload.len() {
        return Err(Fault { code: PACKET_LENGTH, at: packed.end() });
    }
    work(tables, header, entry, &switched)
}

/// PMESH-SWI-05: the slots that switch, of so many, and the byte behind the list.
fn slots(payload: &[u8], low_at: usize, of: usize) -> Result<(Vec<usize>, usize), Fault> {
    let count = u32::from_le_bytes([payload[0], payload[1], payload[2], payload[3]]) as usize;
    if count > of {
        return Err(Fault { code: SWITCH_SLOTS, at: 0 });
    }
    if count == 0 {
        return Ok((Vec::new(), low_at));
    }
    let high_bits = |l: usize| count + ((of - 1) >> l);
    // The first of equal ones.
    let l = (0..32).min_by_key(|&l| count * l + high_bits(l)).unwrap_or(0);
    let ends_before = Fault { code: PACKET_LENGTH, at: low_at };
    let wrong = Fault { code: SWITCH_SLOTS, at: low_at };

    let mut low = Packed::new(payload, low_at);
    let mut lowest = Vec::new();
    for _ in 0..count {
        lowest.push(low.read(l).ok_or(ends_before)?.0);
    }
    let mut high = Packed::new(payload, low.end());
    let mut ones = Vec::new();
    for bit in 0..high_bits(l) {
        if high.read(1).ok_or(ends_before)?.0 == 1 {
            ones.push(bit);
        }
    }
    if ones.len() != count {
        return Err(wrong);
    }
    let slots: Vec<usize> = (0..count).map(|i| ((ones[i] - i) << l) + lowest[i]).collect();
    if slots.windows(2).any(|pair| pair[0] >= pair[1]) || slots.iter().any(|&slot| slot >= of) {
        return Err(wrong);
    }
    low.padding()?;
    high.padding()?;
    Ok((slots, high.end()))
}

/// PMESH-SWI-04: for each wedge of an earlier packet the wedges of this one that descend from it, ascending.
fn descendants(tables: &Tables, header: &Header, entry: &PacketEntry) -> BTreeMap<usize, Vec<usize>> {
    let first = entry.wedges.start as usize;
    let mut descendants: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for wedge in first..entry.wedges.end as usize {
        if tables.owners[wedge] < header.base_vertices as usize {
            // Of the base: it becomes nothing.
            continue;
        }
        let mut ancestor = wedge;
        while ancestor >= first && tables.owners[ancestor] >= header.base_vertices as usize {
            ancestor = tables.targets[&ancestor];
        }
        descendants.entry(ancestor).or_default().push(wedge);
    }
    descendants
}

/// PMESH-SWI-07.
fn work(tables: &Tables, header: &Header, entry: &PacketEntry, switched: &[usize]) -> Result<(), Fault> {
    let depth = |wedge: usize| {
        let (mut depth, mut wedge) = (0u64, wedge);
        while tables.owners[wedge] >= (entry.vertices.start.max(header.base_vertices)) as usize {
            wedge = tables.targets[&wedge];
            depth += 1;
        }
        depth
    };
    let new = tables.corners[entry.faces.start as usize..].as_flattened();
    let sum: u64 = new.iter().chain(switched).map(|&wedge| depth(wedge)).sum();
    if sum > 8 * u64::from(entry.payload_bytes) {
        return Err(Fault { code: SWITCH_WORK, at: 0 });
    }
    Ok(())
}
