//! Raw `.pmesh` files made of choices, packet by packet: any parents, corners and switches that the rules allow, such as no writer
//! would make of a mesh. Bytes that a fuzzer changes rarely get as far.

use crate::choices::Choices;
use crate::vectors::parts::{Parts, bits_for, file_of, packed};
use std::collections::BTreeMap;

/// Vertices of a packet, at most, and packets.
const MOST_VERTICES: usize = 12;
const MOST_PACKETS: usize = 4;
/// Faces of a packet, at most.
const MOST_FACES: usize = 12;

/// Bits of `attributes`: colours, materials, seams.
const COLOURS: u8 = 4;
const MATERIALS: u8 = 8;
const SEAMS: u8 = 16;

/// What has been invented so far.
#[derive(Default)]
struct Invented {
    base: usize,
    owners: Vec<usize>,
    /// What each vertex and each wedge becomes; of the base, nothing that is used.
    parents: Vec<usize>,
    targets: Vec<usize>,
    /// Present corners.
    corners: Vec<[usize; 3]>,
}

/// A file whose packets break no rule but perhaps PMESH-SWI-07.
#[must_use]
pub fn invented(choices: &mut Choices<'_>) -> Vec<u8> {
    let flags = choices.byte();
    let seams = flags & SEAMS != 0;
    let attributes =
        if seams { flags & (MATERIALS | SEAMS) | COLOURS } else { flags & (COLOURS | MATERIALS) };
    let mut mesh = Invented { base: 1 + choices.below(6), ..Invented::default() };
    let mut packets: Vec<(Parts, [usize; 3])> = Vec::new();
    for k in 0..1 + choices.below(MOST_PACKETS) {
        let least = if k == 0 { mesh.base } else { 1 };
        let vertices = least + choices.below(MOST_VERTICES);
        let parts = packet(&mut mesh, vertices, attributes, choices);
        packets.push((parts, [mesh.parents.len(), mesh.owners.len(), mesh.corners.len()]));
    }
    file_of(mesh.base, attributes, &packets)
}

fn packet(mesh: &mut Invented, vertices: usize, attributes: u8, choices: &mut Choices<'_>) -> Parts {
    let (start, end) = (mesh.parents.len(), mesh.parents.len() + vertices);
    let (first_wedge, first_face) = (mesh.owners.len(), mesh.corners.len());
    let mut parts =
        Parts { parent_bits: bits_for(end as u32), of: 3 * first_face as u32, ..Parts::default() };
    for v in start..end {
        let count = if attributes & SEAMS == 0 { 1 } else { 1 + choices.below(3) };
        // Chains as often as not.
        let parent = match choices.byte() {
            _ if v < mesh.base => 0,
            choice if choice < 128 => v - 1,
            choice => usize::from(choice) % v,
        };
        let of_parent = mesh.wedges_of(parent);
        mesh.parents.push(parent);
        if v >= mesh.base {
            parts.parents.push(parent as u32);
        }
        if attributes & SEAMS != 0 {
            parts.wedge_counts.push(count as u32);
        }
        for _ in 0..count {
            let target = if v < mesh.base { 0 } else { choices.below(of_parent.len()) };
            if v >= mesh.base && attributes & SEAMS != 0 {
                parts.wedge_targets.push(target as u32);
            }
            mesh.owners.push(v);
            mesh.targets.push(of_parent.get(target).copied().unwrap_or(0));
        }
        parts.arrays.extend([0; 12]);
    }
    let wedges = mesh.owners.len() - first_wedge;
    parts.arrays.extend(vec![7; if attributes & COLOURS == 0 { 0 } else { 4 * wedges }]);
    mesh.switch(&mut parts, first_wedge, first_face, choices);
    for _ in 0..choices.below(MOST_FACES) {
        let corners = [0; 3].map(|_: usize| choices.below(mesh.owners.len()));
        let [a, b, c] = corners.map(|w| mesh.owners[w]);
        if a != b && b != c && c != a {
            mesh.corners.push(corners);
            parts.corners.push(corners.map(|w| w as u32));
            if attributes & MATERIALS != 0 {
                parts.materials.push(u16::from(choices.byte()));
            }
        }
    }
    parts
}

impl Invented {
    fn wedges_of(&self, vertex: usize) -> Vec<usize> {
        (0..self.owners.len()).filter(|&w| self.owners[w] == vertex).collect()
    }

    /// Some of the corners that can switch do.
    fn switch(&mut self, parts: &mut Parts, first_wedge: usize, faces: usize, choices: &mut Choices<'_>) {
        let mut descendants: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for wedge in first_wedge..self.owners.len() {
            let mut ancestor = wedge;
            while ancestor >= first_wedge && self.owners[ancestor] >= self.base {
                ancestor = self.targets[ancestor];
            }
            descendants.entry(ancestor).or_default().push(wedge);
        }
        let mut bits = Vec::new();
        for slot in 0..3 * faces {
            let corner = &mut self.corners[slot / 3][slot % 3];
            let Some(wedges) = descendants.get(corner) else { continue };
            if !choices.byte().is_multiple_of(4) {
                let number = choices.below(wedges.len());
                *corner = wedges[number];
                parts.slots.push(slot as u32);
                bits.extend((0..bits_for(wedges.len() as u32)).map(|bit| number as u32 >> bit & 1));
            }
        }
        parts.switch_count = parts.slots.len() as u32;
        parts.switch_to = packed(&bits, 1);
    }
}

#[cfg(test)]
mod tests;
