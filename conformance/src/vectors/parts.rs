//! The parts of a raw packet (`spec/pmesh.md`, section 4), to be changed one by one and put together again, right or wrong.

use super::edit::{CONTENT_ID_AT, DATA_OFFSET_AT, FILE_BYTES_AT, HEADER_BYTES_AT, reseal_header};
use ivg_wire::{ChunkKind, ContentId, write_chunk, write_end, write_record};
use pmesh_format::{Header, Positions};

/// Places in the header, and its length (`spec/common.md` and `spec/pmesh.md`).
const MINOR_AT: usize = 10;
const COUNTS_AT: usize = 56;
const MODE_AT: usize = 76;
const HEADER_BYTES: usize = 152;

/// What a raw packet holds. Nothing of it need be right.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Parts {
    /// How many slots switch, as the packet says.
    pub switch_count: u32,
    /// Positions, normals, texture coordinates, colours.
    pub arrays: Vec<u8>,
    /// The corners of the faces.
    pub corners: Vec<[u32; 3]>,
    /// The materials of the faces, if the file has any.
    pub materials: Vec<u16>,
    /// The parents of the vertices from the base on.
    pub parents: Vec<u32>,
    /// Bits of each of them.
    pub parent_bits: u32,
    /// The wedges of each vertex, with seams.
    pub wedge_counts: Vec<u32>,
    /// What each wedge becomes, with seams.
    pub wedge_targets: Vec<u32>,
    /// The slots that switch, and of how many.
    pub slots: Vec<u32>,
    /// Corners of earlier faces.
    pub of: u32,
    /// What they become, as it is stored, and whatever follows.
    pub switch_to: Vec<u8>,
}

impl Parts {
    /// Takes the payload of packet `k` apart, which must be right.
    ///
    /// # Panics
    ///
    /// If it is not.
    #[must_use]
    pub fn read(header: &Header, k: u32, payload: &[u8]) -> Self {
        let entry = &header.packets[k as usize];
        let (has, vertices, faces) = (header.attributes, entry.vertices.len(), entry.faces.len());
        let splits = entry.vertices.end - entry.vertices.start.max(header.base_vertices);
        let a_wedge = [(has.normals, 12), (has.uvs, 8), (has.colours, 4)];
        let a_wedge: usize = a_wedge.iter().filter(|(present, _)| *present).map(|(_, bytes)| bytes).sum();
        let position = if header.positions == Positions::F32 { 12 } else { 8 };
        let mut rest = payload;
        let mut take = |bytes: usize| rest.split_off(..bytes).expect("a whole packet");
        let word = |bytes: &[u8]| u32::from_le_bytes(*bytes.first_chunk().expect("four bytes"));
        let switch_count = word(take(4));
        let arrays = take(position * vertices + a_wedge * entry.wedges.len()).to_vec();
        let corners = take(12 * faces).chunks(12).map(|face| [0, 4, 8].map(|at| word(&face[at..]))).collect();
        let materials = take(if has.materials { 2 * faces } else { 0 });
        let materials = materials.chunks(2).map(|bytes| u16::from_le_bytes([bytes[0], bytes[1]])).collect();
        let parent_bits = bits_for(entry.vertices.end);
        let parents = unpacked(take((splits * parent_bits).div_ceil(8) as usize), splits, parent_bits);
        let (mut wedge_counts, mut wedge_targets) = (Vec::new(), Vec::new());
        if has.seams {
            wedge_counts = (0..vertices).map(|_| varint(&mut take)).collect();
            let own: u32 = wedge_counts[vertices - splits as usize..].iter().sum();
            wedge_targets = (0..own).map(|_| varint(&mut take)).collect();
        }
        let of = 3 * entry.faces.start;
        let mut slots = Vec::new();
        if switch_count > 0 {
            let (l, high) = shape(switch_count, of);
            let low = unpacked(take((switch_count * l).div_ceil(8) as usize), switch_count, l);
            let high = unpacked(take(high.div_ceil(8) as usize), high, 1);
            let ones = (0..).zip(high).filter(|&(_, bit)| bit == 1).map(|(at, _): (u32, u32)| at);
            slots = (0..).zip(ones).zip(low).map(|((i, one), low)| ((one - i) << l) + low).collect();
        }
        Self {
            switch_count,
            arrays,
            corners,
            materials,
            parents,
            parent_bits,
            wedge_counts,
            wedge_targets,
            slots,
            of,
            switch_to: rest.to_vec(),
        }
    }

    /// Everything up to the slots that switch.
    #[must_use]
    pub fn before_slots(&self) -> Vec<u8> {
        let mut payload = self.switch_count.to_le_bytes().to_vec();
        payload.extend(&self.arrays);
        payload.extend(self.corners.as_flattened().iter().flat_map(|corner| corner.to_le_bytes()));
        payload.extend(self.materials.iter().flat_map(|material| material.to_le_bytes()));
        payload.extend(packed(&self.parents, self.parent_bits));
        for &number in self.wedge_counts.iter().chain(&self.wedge_targets) {
            let mut number = number;
            while number > 127 {
                payload.push(number as u8 | 128);
                number >>= 7;
            }
            payload.push(number as u8);
        }
        payload
    }

    /// The bytes of `switch_low` and those of `switch_high`.
    #[must_use]
    pub fn slot_lists(&self) -> [Vec<u8>; 2] {
        if self.slots.is_empty() {
            return [Vec::new(), Vec::new()];
        }
        let (l, high_bits) = shape(self.slots.len() as u32, self.of);
        let lowest: Vec<u32> = self.slots.iter().map(|slot| slot & ((1 << l) - 1)).collect();
        let mut high = vec![0; high_bits as usize];
        (0..).zip(&self.slots).for_each(|(i, slot): (u32, &u32)| high[((slot >> l) + i) as usize] = 1);
        [packed(&lowest, l), packed(&high, 1)]
    }

    /// The payload.
    #[must_use]
    pub fn payload(&self) -> Vec<u8> {
        let [low, high] = self.slot_lists();
        [self.before_slots(), low, high, self.switch_to.clone()].concat()
    }
}

/// The file of these packets, each with what there is at its end: vertices, wedges, faces. Positions are binary32, all in a box
/// without extent at the origin; `attributes` are the bits of the header.
#[must_use]
pub fn file_of(base: usize, attributes: u8, packets: &[(Parts, [usize; 3])]) -> Vec<u8> {
    let content = ContentId(0x1234_5678_9ABC_DEF0);
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut file = [&b"\x89PMS\r\n\x1A\n"[..], &[0; HEADER_BYTES - 8]].concat();
    file[MINOR_AT] = 2;
    file[HEADER_BYTES_AT..HEADER_BYTES_AT + 4].copy_from_slice(&word(HEADER_BYTES));
    file[CONTENT_ID_AT..CONTENT_ID_AT + 8].copy_from_slice(&content.0.to_le_bytes());
    let [vertices, wedges, faces] = packets.last().map_or([0; 3], |&(_, ends)| ends);
    let counts = [vertices, wedges, faces, base, packets.len()];
    file[COUNTS_AT..MODE_AT].copy_from_slice(counts.map(word).as_flattened());
    file[MODE_AT..MODE_AT + 3].copy_from_slice(&[1, 1, attributes]);

    let payloads: Vec<Vec<u8>> = packets.iter().map(|(parts, _)| parts.payload()).collect();
    let mut directory = Vec::new();
    for ((_, ends), payload) in packets.iter().zip(&payloads) {
        directory.extend_from_slice(ends.map(word).as_flattened());
        directory.extend(word(payload.len()));
        directory.extend(word(0));
    }
    write_chunk(&mut file, ChunkKind(*b"PDIR"), true, &directory, content);
    let data = (file.len() as u64).to_le_bytes();
    file[DATA_OFFSET_AT..DATA_OFFSET_AT + 8].copy_from_slice(&data);
    for (k, payload) in (0..).zip(&payloads) {
        write_record(&mut file, k, 0, payload, content);
    }
    let length = file.len() as u64 + 20;
    write_end(&mut file, length, content);
    file[FILE_BYTES_AT..FILE_BYTES_AT + 8].copy_from_slice(&length.to_le_bytes());
    reseal_header(&mut file);
    file
}

/// ⌈log₂ x⌉.
#[must_use]
pub fn bits_for(x: u32) -> u32 {
    x.next_power_of_two().ilog2()
}

/// The low bits of each of so many numbers below `of`, and the bits of the high part (PMESH-SWI-05).
#[must_use]
pub fn shape(count: u32, of: u32) -> (u32, u32) {
    let high = |l: u32| count + ((of - 1) >> l);
    let l = (0..31).min_by_key(|&l| count * l + high(l)).expect("there are some");
    (l, high(l))
}

/// Numbers of so many bits, one after the other.
#[must_use]
pub fn packed(numbers: &[u32], width: u32) -> Vec<u8> {
    let bits: Vec<bool> = numbers.iter().flat_map(|n| (0..width).map(move |bit| n >> bit & 1 == 1)).collect();
    bits.chunks(8).map(|eight| eight.iter().rev().fold(0, |byte, &bit| 2 * byte + u8::from(bit))).collect()
}

fn unpacked(bytes: &[u8], count: u32, width: u32) -> Vec<u32> {
    let bit = |at: u32| u32::from(bytes[(at / 8) as usize] >> (at % 8) & 1);
    (0..count).map(|k| (0..width).map(|place| bit(k * width + place) << place).sum()).collect()
}

fn varint<'a>(take: &mut impl FnMut(usize) -> &'a [u8]) -> u32 {
    let mut number = 0;
    for place in 0.. {
        let byte = take(1)[0];
        number |= u32::from(byte & 127) << (7 * place);
        if byte < 128 {
            break;
        }
    }
    number
}
