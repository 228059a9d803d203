//! Coded packets that say what no writer says: the second reader tells what a packet asks, and other answers make another packet,
//! which ends where the reader would refuse it.

use super::header;
use super::refused::{payload, with_payload};
use crate::reference::{Asked, LAST_STATES, Reference, payload_of};
use ivg_wire::{Code, Part};
use pmesh_format::{Header, Limits, check};

/// The greatest answer that there is.
pub(super) const MOST: i64 = i64::MAX;

/// The file in which, from the first question about `what` on for which a reader then reports `code` in the packet, the answers are
/// these; further ones are what they were if `goes_on`, else 0.
pub(super) fn answered(file: &[u8], what: &str, answers: &[i64], goes_on: bool, code: Code) -> Vec<u8> {
    let header = header(file);
    for k in 0..header.packet_count() {
        let known = asked(file, &header, k);
        for at in (0..known.len()).filter(|&at| known[at].what == what) {
            let rest = known.get(at + answers.len()..).filter(|_| goes_on).unwrap_or_default();
            let all: Vec<i64> = (known[..at].iter().map(|asked| asked.answer))
                .chain(answers.iter().copied())
                .chain(rest.iter().map(|asked| asked.answer))
                .collect();
            let changed = dictated(file, &header, k, all);
            if is_refused(&changed, code) {
                return changed;
            }
        }
    }
    panic!("no answers {answers:?} about {what:?} make a reader report {}", code.number())
}

/// The file, another number in its directory, in which packet `k` ends where a reader refuses it.
pub(super) fn cut_where_refused(file: &[u8], changed: &[u8], k: u32, code: Code) -> Vec<u8> {
    let answers = asked(file, &header(file), k).iter().map(|asked| asked.answer).collect();
    let header = header(changed);
    let (asked, _) = before(changed, &header, k).asked(&payload(changed, k), Some(answers));
    let [front, raw] = payload_of(&asked, LAST_STATES);
    // As long as PMESH-COD-12 demands, and no longer, so that nothing more can be read.
    let entry = &header.packets[k as usize];
    let least = 8 + (entry.wedges.len() + entry.faces.len()) / 4 + entry.vertices.start as usize / 64;
    let padding = vec![0; least.saturating_sub(front.len() + raw.len())];
    let cut = with_payload(changed, k, &[front, padding, raw].concat());
    assert!(is_refused(&cut, code), "{}", code.number());
    cut
}

/// The file in which the last word and the raw bits of a packet have a byte in common: some raw number is another, so that they can.
pub(super) fn overlapping(file: &[u8], code: Code) -> Vec<u8> {
    let header = header(file);
    for k in 0..header.packet_count() {
        let known = asked(file, &header, k);
        for at in (0..known.len()).rev().filter(|&at| known[at].is_raw()) {
            for answer in 0..1 << known[at].bits.min(10) {
                let mut asked = known.clone();
                asked[at].answer = answer;
                let [front, raw] = payload_of(&asked, LAST_STATES);
                if front.last() != raw.first() {
                    continue;
                }
                let apart = with_payload(file, k, &[&front[..], &raw].concat());
                let changed = with_payload(file, k, &[&front[..], &raw[1..]].concat());
                if check(&apart, &Limits::default()).is_ok() && is_refused(&changed, code) {
                    return changed;
                }
            }
        }
    }
    panic!("no packet whose words and raw bits could overlap")
}

/// What packet `k` asks, and the answers.
fn asked(file: &[u8], header: &Header, k: u32) -> Vec<Asked> {
    before(file, header, k).asked(&payload(file, k), None).0
}

/// The packets before `k`.
fn before<'a>(file: &[u8], header: &'a Header, k: u32) -> Reference<'a> {
    let mut reference = Reference::new(header);
    (0..k).for_each(|k| reference.take(&payload(file, k)).expect("a sound packet"));
    reference
}

/// The file whose packet `k` has these states behind the last symbol, or these bytes between words and raw bits, or these unused bits
/// of raw bits.
pub(super) fn ended(
    file: &[u8],
    k: u32,
    states: [u64; 2],
    between: &[u8],
    unused: u8,
    code: Code,
) -> Vec<u8> {
    let [front, mut raw] = payload_of(&asked(file, &header(file), k), states);
    raw[0] |= unused;
    let changed = with_payload(file, k, &[&front[..], between, &raw].concat());
    assert!(is_refused(&changed, code), "{}", code.number());
    changed
}

/// The file with the packet that gives these answers, no shorter than it was.
fn dictated(file: &[u8], header: &Header, k: u32, answers: Vec<i64>) -> Vec<u8> {
    let old = payload(file, k);
    let (asked, _) = before(file, header, k).asked(&old, Some(answers));
    let [front, raw] = payload_of(&asked, LAST_STATES);
    let padding = vec![0; old.len().saturating_sub(front.len() + raw.len())];
    with_payload(file, k, &[front, padding, raw].concat())
}

/// Whether a reader reports this code in a packet.
fn is_refused(file: &[u8], code: Code) -> bool {
    let error = check(file, &Limits::default()).err();
    error.is_some_and(|e| e.code() == code.number() && matches!(e.part(), Part::Record(_)))
}
