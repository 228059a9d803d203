//! Every field of the header, every chunk and every payload with a value it must not have: which error, where.

use crate::files::{edited, envelopes, full, header, one_shot, plain, with_chunk};
use ivg_format::{Encoding, Event, Limits, RecordId, Verdict, codes, decode_all};
use ivg_wire::{Code, codes as common};

#[track_caller]
fn refused(file: &[u8], code: Code, at: u64) {
    match one_shot(file).1 {
        None => panic!("{code:?} was expected, and the file was accepted"),
        Some(error) => assert_eq!((error.code(), error.offset().0), (code.number(), at), "{error}"),
    }
}

/// A file of 2 × 4 × 3 vertices in which `bytes` stand at `at`.
fn patched(at: usize, bytes: &[u8]) -> Vec<u8> {
    edited(&full(), |file| file[at..at + bytes.len()].copy_from_slice(bytes))
}

#[test]
fn each_header_field_has_its_error() {
    let f64 = |x: f64| x.to_le_bytes();
    refused(&patched(56, &[0, 0]), codes::DIMENSIONS, 56);
    refused(&patched(60, &[0, 0]), codes::DIMENSIONS, 60);
    refused(&patched(62, &[0, 0]), codes::ENCODING_FORBIDDEN, 62);
    for encoding in [8u16, 9, 0x100, 0xFFFF] {
        refused(&patched(62, &encoding.to_le_bytes()), codes::ENCODING_UNKNOWN, 62);
    }
    refused(&patched(72, &f64(f64::NAN)), codes::ORIGIN, 72);
    refused(&patched(64, &f64(f64::INFINITY)), codes::ORIGIN, 64);
    refused(&patched(104, &f64(1e308)), codes::ORIGIN, 80);
    refused(&patched(96, &f64(0.0)), codes::STEP, 96);
    refused(&patched(96, &f64(-1.0)), codes::STEP, 96);
    refused(&patched(112, &[0, 0]), codes::ORDER_FORBIDDEN, 112);
    for order in [4u8, 5, 255] {
        refused(&patched(112, &[order, 0]), codes::ORDER_UNKNOWN, 112);
    }
    for scale in [-126i16, 113, i16::MIN, i16::MAX] {
        refused(&patched(114, &scale.to_le_bytes()), codes::SCALE_EXPONENT, 114);
    }
    refused(&patched(116, &[0; 4]), codes::SLICE_VERTICES, 116);
    refused(&patched(116, &[1, 0, 0, 0]), codes::BUNDLE_COUNT, 128);
    refused(&patched(128, &[9, 0, 0, 0]), codes::BUNDLE_COUNT, 128);
    refused(&patched(132, &[2, 0, 0, 0]), codes::VALIDITY_COUNT, 132);
    refused(&patched(136, &[2]), codes::UNITS_UNKNOWN, 136);
    refused(&patched(143, &[1]), common::RESERVED, 143 - 6);
    refused(&patched(48, &[1]), common::FILE_BYTES, 48);
    refused(&patched(40, &[145]), common::DATA_OFFSET, 40);
}

#[test]
fn ids_of_validity_records_stay_below_that_of_the_end_record() {
    let declared = |dims: [u16; 3], records: u32, bundles: u32| {
        edited(&full(), |file| {
            file[56..62].copy_from_slice(&dims.map(u16::to_le_bytes).concat());
            file[116..120].copy_from_slice(&1u32.to_le_bytes());
            file[128..132].copy_from_slice(&bundles.to_le_bytes());
            file[132..136].copy_from_slice(&records.to_le_bytes());
        })
    };
    // 4096 vertices a record: these lattices need 2³¹ − 1 and 2³¹ of them. The limit on vertices is judged later.
    let (most, beyond) = ([2235, 62_661, 62_808], [2441, 59_990, 60_068]);
    refused(&declared(most, 0x7FFF_FFFF, 2235 * 62_661), codes::LIMIT_VERTICES, 56);
    refused(&declared(beyond, 0x8000_0000, 2441 * 59_990), codes::VALIDITY_COUNT, 132);
    refused(&declared(beyond, 0, 2441 * 59_990), codes::LIMIT_VERTICES, 56);
}

#[test]
fn free_fields_are_free() {
    for file in
        [patched(120, &[0xAB; 4]), patched(136, &[1]), patched(16, &[0xFF; 4]), patched(114, &[112, 0])]
    {
        assert_eq!(one_shot(&file).1, None);
    }
}

#[test]
fn the_step_of_a_single_vertex_is_zero_of_either_sign() {
    let flat = plain([1, 3, 2], Encoding::PackedOct24, 1);
    let step = |x: f64| edited(&flat, |file| file[88..96].copy_from_slice(&x.to_le_bytes()));
    assert_eq!(one_shot(&step(-0.0)).1, None);
    refused(&step(-1.0), codes::STEP, 88);
    refused(&step(1.0), codes::STEP, 88);
}

#[test]
fn reserved_is_unsupported_and_forbidden_is_invalid() {
    let verdict = |file: &[u8]| one_shot(file).1.unwrap().verdict();
    assert_eq!(verdict(&patched(62, &[8, 0])), Verdict::Unsupported);
    assert_eq!(verdict(&patched(62, &[0, 0])), Verdict::Invalid);
    assert_eq!(verdict(&patched(137, &[1])), Verdict::Unsupported);
    assert_eq!(verdict(&patched(8, &[1, 0])), Verdict::Unsupported);
    assert_eq!(verdict(&patched(12, &[1, 0])), Verdict::Unsupported);
    assert_eq!(verdict(&patched(24, &[1])), Verdict::Unsupported);
}

#[test]
fn another_major_version_is_unsupported_any_minor_is_read() {
    refused(&patched(8, &[1, 0]), common::MAJOR_VERSION, 8);
    assert_eq!(one_shot(&patched(10, &[0, 0])).1, None);
    assert_eq!(one_shot(&patched(10, &[2, 0])).1, None);
    assert_eq!(one_shot(&patched(10, &[0xFF, 0xFF])).1, None);
}

#[test]
fn unknown_chunks_are_skipped_or_refused() {
    let file = full();
    let skipped = with_chunk(&file, *b"ABCD", false, b"whatever");
    let (events, error) = one_shot(&skipped);
    assert_eq!((events.len(), error), (one_shot(&file).0.len() + 1, None));
    refused(&with_chunk(&file, *b"ABCD", true, b"whatever"), common::CHUNK_CRITICAL, 144);
    // For types that are known the flag is not looked at.
    let plain = plain([2, 2, 2], Encoding::PackedOct24, 1);
    assert_eq!(one_shot(&with_chunk(&plain, *b"META", true, b"key=value\n")).1, None);
}

#[test]
fn chunks_that_appear_once_are_refused_the_second_time() {
    // `full` has both already; the new one comes first and is good.
    let lights = with_chunk(&full(), *b"LITE", false, &[0; 4]);
    refused(&lights, common::CHUNK_REPEATED, envelopes(&lights)[1].start as u64);
    let metadata = with_chunk(&full(), *b"META", false, b"");
    refused(&metadata, common::CHUNK_REPEATED, envelopes(&metadata)[2].start as u64);
}

#[test]
fn lights_must_be_well_formed() {
    let plain = plain([2, 2, 2], Encoding::PackedOct24, 1);
    let lights = |payload: &[u8]| with_chunk(&plain, *b"LITE", false, payload);
    assert_eq!(one_shot(&lights(&[2, 0, 0, 0, 1, 0, 1, 0, b'a', 0, 0, 0, 0])).1, None);
    for (payload, at) in [
        (&[][..], 160),
        (&[1, 0, 0], 163),
        (&[1, 0, 0, 0], 164),
        (&[1, 0, 0, 0, 1, 0, 2, 0, b'a'], 169),
        (&[1, 0, 0, 0, 1, 0, 1, 0, 0xFF], 168),
        (&[0, 0, 0, 0, 1], 164),
        (&[0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0], 168),
    ] {
        refused(&lights(payload), codes::LIGHTS, at);
    }
    refused(&lights(&[1, 0, 0, 0, 2, 0, 0, 0]), common::RESERVED, 164);
    refused(&lights(&[1, 0, 0, 0, 0, 1, 0, 0]), common::RESERVED, 164);
}

#[test]
fn metadata_must_be_well_formed() {
    let plain = plain([2, 2, 2], Encoding::PackedOct24, 1);
    let metadata = |payload: &[u8]| with_chunk(&plain, *b"META", false, payload);
    for good in [&b""[..], b"a=\n", b"a-1_b=x=y\nb=\xC3\xA4\n"] {
        assert_eq!(one_shot(&metadata(good)).1, None, "{good:?}");
    }
    for bad in [&b"a=1"[..], b"a\n", b"=1\n", b"A=1\n", b"a b=1\n", b"\n", b"a=\xFF\n", b"a=1\n\n"] {
        refused(&metadata(bad), codes::METADATA, 160);
    }
}

#[test]
fn forbidden_direction_codes_are_refused_where_they_stand() {
    let file = plain([1, 3, 2], Encoding::PackedOct24, 1);
    let record = header(&file).record_range(RecordId::Bundle(1)).start as usize;
    // One vertex: 8 bytes of envelope, 24 of colours, then six codes of 3 bytes.
    for n in 0..6 {
        let at = record + 32 + 3 * n;
        for code in [0xFFF, 0xFFF << 12, 0xFF_FFFFu32] {
            let bad = edited(&file, |b| b[at..at + 3].copy_from_slice(&code.to_le_bytes()[..3]));
            refused(&bad, codes::DIRECTION_CODE, at as u64);
        }
        let good = edited(&file, |b| b[at..at + 3].copy_from_slice(&0xFFE_FFEu32.to_le_bytes()[..3]));
        assert_eq!(one_shot(&good).1, None);
    }
}

#[test]
fn a_direction_outside_its_hemisphere_is_reported_by_validators_only() {
    let file = plain([1, 3, 2], Encoding::PackedOct24, 1);
    let header = header(&file);
    let record = header.record_range(RecordId::Bundle(1)).start as usize;
    let vertex = header.bundle_vertex(1, 0);
    let outside = |file: &[u8]| {
        let mut found = vec![];
        decode_all(file, &Limits::default(), |event| {
            if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
                found.extend(bundle.outside_hemisphere());
            }
        })
        .unwrap();
        found
    };
    assert_eq!(outside(&file), []);
    // The third code, of hemisphere +y, becomes the axis +x: on the tangent plane.
    let code = 4094u32 | 2047 << 12;
    let at = record + 32 + 3 * 2;
    let bad = edited(&file, |b| b[at..at + 3].copy_from_slice(&code.to_le_bytes()[..3]));
    assert_eq!(outside(&bad), [(vertex.unwrap(), 2)]);
    assert_eq!(outside(&plain([1, 3, 2], Encoding::VectorsF32, 1)), []);
}

#[test]
fn numbers_that_are_not_finite_are_refused_where_they_stand() {
    let file = plain([1, 1, 3], Encoding::VectorsF32, 1);
    let at = header(&file).record_range(RecordId::Bundle(1)).start as usize + 8 + 53 * 4;
    let with = |number: f32| edited(&file, |b| b[at..at + 4].copy_from_slice(&number.to_le_bytes()));
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        refused(&with(bad), codes::NOT_FINITE, at as u64);
    }
    assert_eq!(one_shot(&with(f32::MAX)).1, None);
    // Finite as stored, infinite when scaled.
    let scaled = edited(&with(f32::MAX), |b| b[114] = 1);
    refused(&scaled, codes::NOT_FINITE, at as u64);
}

#[test]
fn blocked_edges_must_stay_inside_and_unused_bits_be_zero() {
    let file = full();
    let payload = header(&file).record_range(RecordId::Validity(0)).start as usize + 8;
    // 24 vertices: 24 bytes of validity, then 72 bits without a rest. The last vertex has no neighbour.
    let last = payload + 24 + 23 * 3 / 8;
    refused(&edited(&file, |b| b[last] |= 0x80), codes::EDGE_OUTSIDE, last as u64);
    // Vertex 1 lies at the end of x: bit 3.
    refused(&edited(&file, |b| b[payload + 24] |= 8), codes::EDGE_OUTSIDE, payload as u64 + 24);
    let small = crate::roundtrip::with_validity([1, 3, 1], &[9, 8, 7], &[2, 2, 0]);
    let payload = header(&small).record_range(RecordId::Validity(0)).start as usize + 8;
    assert_eq!(one_shot(&small).1, None);
    refused(&edited(&small, |b| b[payload + 4] |= 2), codes::UNUSED_BITS, payload as u64 + 4);
}

#[test]
fn limits_are_judged_from_the_header_alone() {
    let file = full();
    let judged = |limits: Limits| decode_all(&file[..144], &limits, |_| {}).unwrap_err();
    assert_eq!(judged(Limits::default()).verdict(), Verdict::NeedMore);
    let error = judged(Limits { vertices: 23, ..Limits::default() });
    assert_eq!((error.code(), error.offset().0), (codes::LIMIT_VERTICES.number(), 56));
    assert_eq!(judged(Limits { vertices: 24, ..Limits::default() }).verdict(), Verdict::NeedMore);
    // The longest record is that of the eight corners: 8 × 42 bytes and the envelope.
    let with_record = |record_bytes| {
        judged(Limits {
            wire: ivg_wire::Limits { record_bytes, ..ivg_wire::Limits::new() },
            ..Limits::default()
        })
    };
    assert_eq!(with_record(347).code(), common::LIMIT_RECORD_BYTES.number());
    assert_eq!(with_record(348).verdict(), Verdict::NeedMore);
}
