//! Files of `.pmesh` to refuse for the corners that a raw packet switches.

use super::super::Refused;
use super::super::parts::{Parts, packed, shape};
use super::refused::{payload, with_payload};
use super::refused_packets::lie;
use super::variants::{DEEP, DESCENDANTS, MANY};
use super::{OCTAHEDRON, SEAM, header};
use pmesh_format::codes as mesh;

const BORDER: &str = "0012-raw-border";
/// The last packet of the folded strip switches slots 1 and 3 of 6: a low bit of each, then four bits.
const STRIP: u32 = 2;

/// The file with other bytes from the slots that switch on: `edit` gets the low bits, the high bits, what they become.
fn with_bytes(file: &[u8], k: u32, edit: impl FnOnce(&mut [Vec<u8>; 3])) -> Vec<u8> {
    let parts = Parts::read(&header(file), k, &payload(file, k));
    let [low, high] = parts.slot_lists();
    let mut bytes = [low, high, parts.switch_to.clone()];
    edit(&mut bytes);
    with_payload(file, k, &[parts.before_slots(), bytes.concat()].concat())
}

pub(super) fn refused<'a>(twin: &impl Fn(&str) -> &'a [u8]) -> Vec<Refused> {
    let mut list = counts(twin(OCTAHEDRON), twin(SEAM));
    list.extend(slots(twin(SEAM), twin(BORDER)));
    list.extend(becomes(twin(SEAM), twin(DESCENDANTS)));
    list.extend(work(twin(DEEP)));
    list.extend(blocks(twin(MANY)));
    list
}

fn counts(file: &[u8], seam: &[u8]) -> Vec<Refused> {
    let count = |k: u32, count: u32| lie(file, k, |parts| parts.switch_count = count);
    let slots = 3 * header(file).packets[1].faces.start;
    let last = header(file).packet_count() - 1;
    let cut = |part: usize| with_bytes(seam, STRIP, |bytes| bytes[part..].iter_mut().for_each(Vec::clear));
    vec![
        (
            OCTAHEDRON,
            "slots-first",
            mesh::SWITCH_SLOTS,
            count(0, 1),
            "a slot that switches in the first packet",
        ),
        (OCTAHEDRON, "slots-many", mesh::SWITCH_SLOTS, count(1, slots + 1), "more slots than there are"),
        (
            OCTAHEDRON,
            "slots-all",
            mesh::PACKET_LENGTH,
            count(last, 18),
            "all slots switch, in bytes for fewer",
        ),
        (SEAM, "slots-low-cut", mesh::PACKET_LENGTH, cut(0), "a payload that ends before the slots"),
        (
            SEAM,
            "slots-high-cut",
            mesh::PACKET_LENGTH,
            cut(1),
            "a payload that ends between the bits of slots",
        ),
        (
            OCTAHEDRON,
            "slots-none",
            mesh::PACKET_LENGTH,
            with_bytes(file, 0, |bytes| bytes[2].push(0)),
            "a byte behind a packet in which nothing switches",
        ),
        (
            SEAM,
            "slots-long",
            mesh::PACKET_LENGTH,
            with_bytes(seam, STRIP, |bytes| bytes[2].push(0)),
            "a byte behind the slots, which need no more",
        ),
    ]
}

fn slots(seam: &[u8], border: &[u8]) -> Vec<Refused> {
    let list = |slots: [u32; 2]| lie(seam, STRIP, |parts| parts.slots.copy_from_slice(&slots));
    let high = |bits: u8| with_bytes(seam, STRIP, |bytes| bytes[1] = vec![bits]);
    let low = |bits: u8| with_bytes(seam, STRIP, |bytes| bytes[0] = vec![bits]);
    vec![
        (SEAM, "slots-equal", mesh::SWITCH_SLOTS, list([3, 3]), "a slot that switches twice"),
        (SEAM, "slots-descend", mesh::SWITCH_SLOTS, list([3, 2]), "slots that do not ascend"),
        (SEAM, "slots-fewer", mesh::SWITCH_SLOTS, high(0b0001), "fewer slots than are counted"),
        (SEAM, "slots-more", mesh::SWITCH_SLOTS, high(0b1101), "more slots than are counted"),
        (BORDER, "slots-beyond", mesh::SWITCH_SLOTS, beyond(border), "the slot behind the last one"),
        (SEAM, "slots-low-padding", mesh::PACKET_PADDING, low(0b111), "a bit behind the low bits of slots"),
        (
            SEAM,
            "slots-high-padding",
            mesh::PACKET_PADDING,
            high(0b1_0101),
            "a bit behind the high bits of slots",
        ),
    ]
}

/// Where the slot behind the last one has the same high bits as the last one, it takes the place of the last that switches.
fn beyond(file: &[u8]) -> Vec<u8> {
    for k in 1..header(file).packet_count() {
        let parts = Parts::read(&header(file), k, &payload(file, k));
        if parts.slots.is_empty() {
            continue;
        }
        let (l, _) = shape(parts.switch_count, parts.of);
        if parts.of >> l == (parts.of - 1) >> l {
            return lie(file, k, |parts| *parts.slots.last_mut().expect("a slot") = parts.of);
        }
    }
    panic!("there is no such packet")
}

fn becomes(seam: &[u8], file: &[u8]) -> Vec<Refused> {
    let to = |numbers: &[u32]| lie(file, 1, |parts| parts.switch_to = packed(numbers, 2));
    let parts = Parts::read(&header(file), 1, &payload(file, 1));
    let padded = parts.switch_to[0] | 0x80;
    vec![
        (
            SEAM,
            "switch-none",
            mesh::SWITCH,
            // Vertex 0 is nobody's parent.
            lie(seam, STRIP, |parts| parts.slots[0] = 0),
            "a corner switches from which no wedge of the packet descends",
        ),
        (DESCENDANTS, "switch-high", mesh::SWITCH, to(&[3]), "the fourth of three descendants"),
        (
            DESCENDANTS,
            "switch-cut",
            mesh::PACKET_LENGTH,
            with_bytes(file, 1, |bytes| bytes[2].clear()),
            "a payload that ends before what a corner becomes",
        ),
        (
            DESCENDANTS,
            "switch-long",
            mesh::PACKET_LENGTH,
            with_bytes(file, 1, |bytes| bytes[2].push(0)),
            "a byte behind what corners become",
        ),
        (
            DESCENDANTS,
            "switch-padding",
            mesh::PACKET_PADDING,
            with_bytes(file, 1, |bytes| bytes[2] = vec![padded]),
            "a bit behind what corners become",
        ),
    ]
}

fn work(file: &[u8]) -> Vec<Refused> {
    let deeper = lie(file, 1, |parts| parts.corners.last_mut().expect("a face")[2] += 1);
    vec![(DEEP, "deep", mesh::SWITCH_WORK, deeper, "corners that pass one vertex more than the bytes allow")]
}

/// Lists of more than a byte. Slots 256 and 257, which have the same high bits, are the last of 256 and the first of the next.
fn blocks(file: &[u8]) -> Vec<Refused> {
    let swapped = lie(file, 1, |parts| parts.slots.swap(255, 256));
    let padded = |part: usize| with_bytes(file, 1, |bytes| *bytes[part].last_mut().expect("a byte") |= 0x80);
    vec![
        (MANY, "slots-descend-far", mesh::SWITCH_SLOTS, swapped, "slots that do not ascend after the 256th"),
        (
            MANY,
            "slots-low-padding-far",
            mesh::PACKET_PADDING,
            padded(0),
            "a bit behind many bytes of low bits",
        ),
        (
            MANY,
            "slots-high-padding-far",
            mesh::PACKET_PADDING,
            padded(1),
            "a bit behind many bytes of high bits",
        ),
        (
            MANY,
            "switch-padding-far",
            mesh::PACKET_PADDING,
            padded(2),
            "a bit behind many bytes of what corners become",
        ),
    ]
}
