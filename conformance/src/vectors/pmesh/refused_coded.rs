//! Coded files to refuse. What stands in a coded packet cannot be changed at will: one byte is, the first in the first file with
//! which a reader reports what is wanted.

use super::super::Refused;
use super::super::edit::in_envelope;
use super::refused::{in_directory, payload, with_payload};
use super::{RECORD_HEAD, entry, header, packet};
use ivg_wire::{Code, Part};
use pmesh_format::{Limits, check, codes as mesh};

const CLOSED: &str = "0033-coded-q12";
const EXACT: &str = "0030-coded-f32";
const IRREGULAR: &str = "0043-coded-irregular";
const TRIANGLE: &str = "0041-coded-triangle";
const ATTRIBUTES: &str = "0051-coded-attributes";
const HUB: &str = "0050-coded-hub";

pub(super) fn refused<'a>(twin: impl Fn(&str) -> &'a [u8]) -> Vec<Refused> {
    let closed = twin(CLOSED);
    let last = header(closed).packet_count() - 1;
    let whole = payload(closed, last);
    let faces = header(closed).packets[1].faces.end;
    let wedges = header(twin(ATTRIBUTES)).packets[0].wedges.end;
    let hub = payload(twin(HUB), 0);
    let search = |name: &'static str, mistake: &'static str, code: Code, why: &'static str| {
        (name, mistake, code, one_byte(twin(name), code), why)
    };
    vec![
        (
            CLOSED,
            "coded-short",
            mesh::CODED_LENGTH,
            one_edit(closed, last, mesh::CODED_LENGTH, |at| [&whole[..at], &whole[at + 2..]].concat()),
            "a word of a packet is missing",
        ),
        (
            CLOSED,
            "coded-long",
            mesh::CODED_LENGTH,
            one_edit(closed, last, mesh::CODED_LENGTH, |at| [&whole[..at], &[0; 2], &whole[at..]].concat()),
            "a word behind the last symbol of a packet that is long enough",
        ),
        (
            ATTRIBUTES,
            "coded-wedges-many",
            mesh::WEDGE_COUNT,
            in_directory(twin(ATTRIBUTES), 0, entry::END_WEDGE, wedges - 1),
            "the directory gives a packet a wedge less than it brings",
        ),
        search(
            ATTRIBUTES,
            "coded-switch",
            mesh::SWITCH,
            "a corner switches, but no wedge becomes the one that it has",
        ),
        search(ATTRIBUTES, "coded-attribute", mesh::ATTRIBUTE, "a value outside what it is quantised to"),
        (
            CLOSED,
            "coded-bytes",
            mesh::DIRECTORY_BYTES,
            in_directory(closed, 0, entry::PAYLOAD_BYTES, 4),
            "a packet shorter than its vertices and faces demand",
        ),
        (
            HUB,
            "coded-padding",
            mesh::CODED_PADDING,
            one_edit(twin(HUB), 0, mesh::CODED_PADDING, |at| {
                [&hub[..at], &[hub[at] ^ 1], &hub[at + 1..]].concat()
            }),
            "a byte of padding that is not 0",
        ),
        (
            CLOSED,
            "coded-faces-few",
            mesh::CODED_FACES,
            in_directory(closed, 1, entry::END_FACE, faces + 1),
            "the directory gives a packet a face more than it brings",
        ),
        (
            CLOSED,
            "coded-faces-many",
            mesh::CODED_FACES,
            in_directory(closed, 1, entry::END_FACE, faces - 1),
            "the directory gives a packet a face less than it brings",
        ),
        (
            HUB,
            "coded-work",
            mesh::CODED_WORK,
            one_edit(twin(HUB), 0, mesh::CODED_WORK, |at| {
                [&hub[..at], &hub[(at + hub.len() / 4).min(hub.len())..]].concat()
            }),
            "a packet too short for the faces that it makes a reader look at",
        ),
        search(CLOSED, "coded-position", mesh::POSITION, "a point outside the lattice"),
        search(EXACT, "coded-position-exact", mesh::POSITION, "a number outside the bounding box"),
        search(CLOSED, "coded-parent", mesh::PARENT, "no vertex is split that is there"),
        search(TRIANGLE, "coded-corner", mesh::CORNER, "a face of the base names a vertex that is not in it"),
        search(TRIANGLE, "coded-face-twice", mesh::FACE_VERTICES, "a face of the base names a vertex twice"),
        search(IRREGULAR, "coded-third", mesh::CORNER, "a new face names a vertex that has not arrived"),
    ]
}

/// The file with the first edit of a packet's payload, at whichever byte, for which a reader reports this code there.
fn one_edit(file: &[u8], k: u32, code: Code, edit: impl Fn(usize) -> Vec<u8>) -> Vec<u8> {
    let edits = (0..payload(file, k).len() - 1).map(|at| with_payload(file, k, &edit(at)));
    let reported = |changed: &Vec<u8>| {
        let error = check(changed, &Limits::default()).err();
        error.is_some_and(|e| e.code() == code.number() && matches!(e.part(), Part::Record(_)))
    };
    edits
        .into_iter()
        .find(reported)
        .unwrap_or_else(|| panic!("no edit makes a reader report {}", code.number()))
}

/// The file with the first changed byte for which a reader reports this code in a packet.
fn one_byte(file: &[u8], code: Code) -> Vec<u8> {
    for k in 0..header(file).packet_count() {
        let record = packet(file, k);
        for at in 0..payload(file, k).len() {
            let at = record.start + RECORD_HEAD + at;
            for change in 1..=255u8 {
                let changed = in_envelope(file, record.clone(), at, &[file[at] ^ change]);
                let error = check(&changed, &Limits::default()).err();
                if error.is_some_and(|e| e.code() == code.number() && matches!(e.part(), Part::Record(_))) {
                    return changed;
                }
            }
        }
    }
    panic!("no change of one byte makes a reader report {}", code.number())
}
