//! Coded files to refuse. What stands in a coded packet cannot be changed at will: one byte is, the first in the first file with
//! which a reader reports what is wanted.

use super::super::Refused;
use super::super::edit::in_envelope;
use super::dictated::{MOST, answered, cut_where_refused, ended, overlapping};
use super::refused::{in_directory, payload, with_payload};
use super::{CODED_ATTRIBUTES, RECORD_HEAD, entry, header, packet};
use crate::reference::LAST_STATES;
use ivg_wire::{Code, Part};
use pmesh_format::{Limits, check, codes as mesh};

const CLOSED: &str = "0033-coded-q12";
const EXACT: &str = "0030-coded-f32";
const IRREGULAR: &str = "0043-coded-irregular";
const TRIANGLE: &str = "0041-coded-triangle";
const HUB: &str = "0050-coded-hub";
const NORMALS: &str = "0054-coded-normals";
const WEDGES: &str = "0057-coded-wedges";
const NO_FACES: &str = "0058-coded-no-faces";
const GREATEST: &str = "0059-coded-greatest";
const POINTS: &str = "0072-coded-points";

pub(super) fn refused<'a>(twin: impl Fn(&str) -> &'a [u8]) -> Vec<Refused> {
    let mut list = bytes(&twin);
    list.extend(answers(&twin));
    list
}

/// Packets with other answers to what a reader asks: each breaks one rule, and ends there.
fn answers<'a>(twin: impl Fn(&str) -> &'a [u8]) -> Vec<Refused> {
    let other = |name: &'static str, what: &str, answers: &[i64], mistake, code, why| {
        (name, mistake, code, answered(twin(name), what, answers, false, code), why)
    };
    // Not as expected; a residual of the greatest octave that an answer of 20 names.
    let far = [0, 15, 20, MOST, MOST];
    let (closed, attributes) = (twin(CLOSED), twin(CODED_ATTRIBUTES));
    let faces = header(closed).packets[1].faces.end;
    // PMESH-COD-12: of a packet with nothing before it.
    let first = &header(closed).packets[0];
    let least = 8 + (first.wedges.end + first.faces.end) / 4;
    // A packet behind which there is one with a wedge to spare.
    let spare =
        header(attributes).packets.windows(2).position(|two| two[1].wedges.len() > two[1].vertices.len());
    let few = spare.expect("a packet with seams") as u32;
    let wedges = header(attributes).packets[few as usize].wedges.end;
    vec![
        other(
            CLOSED,
            "cell of the base",
            &[MOST],
            "coded-base-cell",
            mesh::POSITION,
            "a vertex of the base outside the lattice",
        ),
        (
            GREATEST,
            "coded-base-infinite",
            mesh::POSITION,
            answered(twin(GREATEST), "cell of the base", &[2], true, mesh::POSITION),
            "a point of the lattice whose coordinate is too great for binary32",
        ),
        other(
            CLOSED,
            "faces of the base",
            &[MOST],
            "coded-base-faces",
            mesh::CODED_FACES,
            "more faces of the base than the directory says",
        ),
        other(
            TRIANGLE,
            "faces of the base",
            &[1, 0, 1, 1],
            "coded-face-twice-last",
            mesh::FACE_VERTICES,
            "a face of the base whose last two corners are one vertex",
        ),
        other(
            TRIANGLE,
            "faces of the base",
            &[1, 0, 1, 0],
            "coded-face-twice-ends",
            mesh::FACE_VERTICES,
            "a face of the base whose first and last corners are one vertex",
        ),
        other(
            CLOSED,
            "length of a run",
            &[14],
            "coded-run-length",
            mesh::CORNER,
            "as many faces switch as there are, or more",
        ),
        other(
            CLOSED,
            "rank of a run",
            &[14],
            "coded-run-rank",
            mesh::CORNER,
            "a rank beyond those of the runs there are",
        ),
        other(
            IRREGULAR,
            "more faces",
            &[1, 0, 0, MOST],
            "coded-third-later",
            mesh::CORNER,
            "a new face whose third vertex is not there",
        ),
        other(
            IRREGULAR,
            "more faces",
            &[1, 0, 1, MOST],
            "coded-third-place",
            mesh::CORNER,
            "a third vertex in a place that the order of faces does not have",
        ),
        other(
            NO_FACES,
            "more faces",
            &[1, 0, 0, 0],
            "coded-third-parent",
            mesh::FACE_VERTICES,
            "a new face whose third vertex is its first",
        ),
        other(
            NO_FACES,
            "more faces",
            &[1, 1],
            "coded-guess-parent",
            mesh::FACE_VERTICES,
            "a new face whose third vertex, as guessed, is its first",
        ),
        (
            CLOSED,
            "coded-faces-early",
            mesh::CODED_FACES,
            cut_where_refused(
                closed,
                &in_directory(closed, 1, entry::END_FACE, faces - 1),
                1,
                mesh::CODED_FACES,
            ),
            "a packet that ends with the face that the directory does not give it",
        ),
        (
            CODED_ATTRIBUTES,
            "coded-wedges-few",
            mesh::WEDGE_COUNT,
            in_directory(attributes, few, entry::END_WEDGE, wedges + 1),
            "the directory gives a packet a wedge more than it brings",
        ),
        other(
            WEDGES,
            "place of a wedge of the base",
            &[MOST],
            "coded-base-wedge",
            mesh::CORNER,
            "a corner of the base has a fourth wedge of three",
        ),
        other(
            WEDGES,
            "target",
            &[0, MOST],
            "coded-target",
            mesh::WEDGE_TARGET,
            "a wedge becomes a fourth wedge of three",
        ),
        other(
            WEDGES,
            "corner",
            &[0, MOST],
            "coded-wedge",
            mesh::CORNER,
            "a corner of a new face has a fourth wedge of three",
        ),
        other(NORMALS, "normal", &far, "coded-normal", mesh::ATTRIBUTE, "a normal outside its square"),
        other(
            CODED_ATTRIBUTES,
            "texture coordinates",
            &far,
            "coded-uv",
            mesh::ATTRIBUTE,
            "texture coordinates outside their lattice",
        ),
        other(CODED_ATTRIBUTES, "colour", &far, "coded-colour", mesh::ATTRIBUTE, "a colour outside 0 to 255"),
        other(
            NORMALS,
            "normal of the base",
            &[MOST],
            "coded-base-normal",
            mesh::ATTRIBUTE,
            "a normal of the base outside its square",
        ),
        other(
            WEDGES,
            "wedge of a slot",
            &[0, MOST],
            "coded-switch-place",
            mesh::SWITCH,
            "a corner switches to a fourth wedge of three",
        ),
        (
            CLOSED,
            "coded-state-first",
            mesh::CODED_LENGTH,
            ended(closed, 0, [LAST_STATES[0] + 1, LAST_STATES[1]], &[], 0, mesh::CODED_LENGTH),
            "the first state is not what it is behind the last symbol",
        ),
        (
            CLOSED,
            "coded-state-second",
            mesh::CODED_LENGTH,
            ended(closed, 0, [LAST_STATES[0], LAST_STATES[1] + 1], &[], 0, mesh::CODED_LENGTH),
            "the second state is not what it is behind the last symbol",
        ),
        (
            CLOSED,
            "coded-between",
            mesh::CODED_LENGTH,
            ended(closed, 0, LAST_STATES, &[0], 0, mesh::CODED_LENGTH),
            "a byte between words and raw bits of a packet that is long enough",
        ),
        (
            CLOSED,
            "coded-raw-unused",
            mesh::CODED_PADDING,
            ended(closed, 0, LAST_STATES, &[], 0x80, mesh::CODED_PADDING),
            "an unused bit of the raw bits is set",
        ),
        other(
            EXACT,
            "place in a cell",
            &[MOST],
            "coded-base-place",
            mesh::POSITION,
            "a number that a cell of the base does not have",
        ),
        (
            CLOSED,
            "coded-bytes-least",
            mesh::DIRECTORY_BYTES,
            in_directory(closed, 0, entry::PAYLOAD_BYTES, least - 1),
            "a packet a byte shorter than its vertices and faces demand",
        ),
        (
            EXACT,
            "coded-overlap",
            mesh::CODED_LENGTH,
            overlapping(twin(EXACT), mesh::CODED_LENGTH),
            "the last word of a packet and its raw bits have a byte in common",
        ),
        (
            POINTS,
            "coded-overlap-base",
            mesh::CODED_LENGTH,
            overlapping(twin(POINTS), mesh::CODED_LENGTH),
            "the second state and the number of faces of the base, the last that is read, have a byte in common",
        ),
    ]
}

/// Packets of which bytes are changed.
fn bytes<'a>(twin: impl Fn(&str) -> &'a [u8]) -> Vec<Refused> {
    let closed = twin(CLOSED);
    let last = header(closed).packet_count() - 1;
    let whole = payload(closed, last);
    let faces = header(closed).packets[1].faces.end;
    let wedges = header(twin(CODED_ATTRIBUTES)).packets[0].wedges.end;
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
            CODED_ATTRIBUTES,
            "coded-wedges-many",
            mesh::WEDGE_COUNT,
            in_directory(twin(CODED_ATTRIBUTES), 0, entry::END_WEDGE, wedges - 1),
            "the directory gives a packet a wedge less than it brings",
        ),
        search(
            CODED_ATTRIBUTES,
            "coded-switch",
            mesh::SWITCH,
            "a corner switches, but no wedge becomes the one that it has",
        ),
        search(
            CODED_ATTRIBUTES,
            "coded-attribute",
            mesh::ATTRIBUTE,
            "a value outside what it is quantised to",
        ),
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
