//! What newer writers of `.ivg` may write: to be skipped, or to be refused as unsupported.

use super::super::edit::{chunk, in_envelope, in_header, inserted, with_chunk};
use super::super::{Format, Refused, Vector};
use super::{at, file};
use ivg_format::{EncodeOptions, codes as ivg};
use ivg_wire::codes as wire;

/// The chunk `LITE` of the file with lights.
const LIGHTS_END: usize = at::END + 48;

pub(super) fn accepted(there: &[Vector]) -> Vec<Vector> {
    let named = |name: &str| &there.iter().find(|vector| vector.name == name).expect("a name").bytes[..];
    let (small, lights, meta) = (named("0008-small"), named("0006-lights"), named("0009-metadata"));
    let news = |at: usize| inserted(lights, at, &chunk(lights, b"NEWS", false, b"new"));
    let large: Vec<u8> = (0..3000u32).map(|n| (n % 251) as u8).collect();
    let list = [
        ("0025-chunk-first", news(at::END), "an unknown ancillary chunk before all others"),
        ("0026-chunk-middle", news(LIGHTS_END), "an unknown ancillary chunk between two known ones"),
        (
            "0027-chunk-last",
            with_chunk(lights, b"NEWS", false, b"new"),
            "an unknown ancillary chunk behind known ones",
        ),
        (
            "0028-chunk-empty",
            with_chunk(small, b"NEWS", false, b""),
            "an unknown ancillary chunk without a payload",
        ),
        (
            "0029-chunk-large",
            with_chunk(small, b"NEWS", false, &large),
            "an unknown ancillary chunk of 3000 bytes",
        ),
        ("0030-chunk-private", with_chunk(small, b"xyz ", false, b"mine"), "a chunk of a writer's own type"),
        (
            "0031-chunk-twice",
            with_chunk(&with_chunk(small, b"NEWS", false, b"1"), b"NEWS", false, b"2"),
            "an unknown ancillary chunk may repeat",
        ),
        (
            "0032-known-critical",
            in_envelope(meta, at::END..at::END + 48, at::END + 4, &[1]),
            "META with the critical flag, which is not looked at for known types",
        ),
        (
            "0033-optional-features",
            in_header(small, at::OPTIONAL_FEATURES, &[0xFF; 4]),
            "every optional feature bit",
        ),
        (
            "0034-minor",
            in_header(small, at::MINOR, &[0xFF, 0xFF]),
            "the greatest minor version, with the known header",
        ),
        (
            "0036-seed",
            file(
                [3, 4, 2],
                EncodeOptions { vertices_per_slice: 2, seed: u64::MAX, ..EncodeOptions::default() },
            ),
            "the greatest seed: sums and products in the order of vertices wrap around",
        ),
        ("0035-minor-0", in_header(small, at::MINOR, &[0, 0]), "minor version 0 is read as 1"),
    ];
    list.into_iter().map(|(name, bytes, why)| Vector::accepted(Format::Ivg, name, bytes, why)).collect()
}

pub(super) fn refused(small: &[u8]) -> Vec<Refused> {
    let s = "0008-small";
    let edited = |field: usize, bytes: &[u8]| in_header(small, field, bytes);
    vec![
        (s, "major-2", wire::MAJOR_VERSION, edited(at::MAJOR, &[2]), "major version 2"),
        (
            s,
            "major-high",
            wire::MAJOR_VERSION,
            edited(at::MAJOR, &[0, 1]),
            "major version 256: both bytes count",
        ),
        (
            s,
            "feature-high",
            wire::REQUIRED_FEATURE,
            edited(at::REQUIRED_FEATURES, &[0, 0, 0, 0x80]),
            "the highest required feature",
        ),
        (
            s,
            "encoding-private",
            ivg::ENCODING_UNKNOWN,
            edited(at::ENCODING, &[1, 0xC0]),
            "a private encoding",
        ),
        (
            s,
            "encoding-high",
            ivg::ENCODING_UNKNOWN,
            edited(at::ENCODING, &[1, 1]),
            "encoding 257: both bytes count",
        ),
        (s, "order-private", ivg::ORDER_UNKNOWN, edited(at::ORDER, &[1, 0xC0]), "a private order"),
        (s, "order-high", ivg::ORDER_UNKNOWN, edited(at::ORDER, &[1, 1]), "order 257: both bytes count"),
        (s, "units-private", ivg::UNITS_UNKNOWN, edited(at::UNITS, &[0xC0]), "private units"),
        (
            s,
            "reserved-last",
            wire::RESERVED,
            edited(at::RESERVED + 6, &[0x80]),
            "the last reserved byte of the header",
        ),
    ]
}
