//! The order `explicit`: the directory and the lists of vertices, right and wrong.

use crate::files::{
    bundles, edited, full_explicit, header, lattice, one_shot, options, ordered, plain, vectors, with_chunk,
    with_chunk_at,
};
use ivg_format::{
    EncodeError, EncodeOptions, Encoding, Event, GridSource, Limits, Order, RecordId, Step, Verdict, codes,
    decode_all, encode,
};
use ivg_wire::{Code, codes as common};

#[track_caller]
fn refused(file: &[u8], code: Code, at: u64) {
    refused_within(file, &Limits::default(), code, at);
}

#[track_caller]
fn refused_within(file: &[u8], limits: &Limits, code: Code, at: u64) {
    match decode_all(file, limits, |_| {}) {
        Ok(()) => panic!("{code:?} was expected, and the file was accepted"),
        Err(error) => assert_eq!((error.code(), error.offset().0), (code.number(), at), "{error}"),
    }
}

/// Ten vertices in bundles of 1, 2, 3, 4: at most six are allowed. The directory's payload begins at byte 160.
fn small() -> Vec<u8> {
    ordered([2, 3, 3], Order::Explicit, 2)
}

/// The file `small` in which these u32 stand at byte `at`.
fn patched(at: usize, numbers: &[u32]) -> Vec<u8> {
    edited(&small(), |file| {
        for (place, number) in file[at..].chunks_exact_mut(4).zip(numbers) {
            place.copy_from_slice(&number.to_le_bytes());
        }
    })
}

#[test]
fn the_number_of_bundles_is_judged_for_every_order() {
    // Ten vertices that are not corners: two bundles of six, or up to ten that are listed.
    let count = |order, bundles: u32| {
        edited(&ordered([2, 3, 3], order, 2), |file| file[128..132].copy_from_slice(&bundles.to_le_bytes()))
    };
    assert_eq!(header(&ordered([2, 3, 3], Order::Octree, 2)).bundle_count, 2);
    for bundles in [0, 1, 3] {
        refused(&count(Order::Octree, bundles), codes::BUNDLE_COUNT, 128);
    }
    for bundles in [11, u32::MAX] {
        refused(&count(Order::Explicit, bundles), codes::BUNDLE_COUNT, 128);
    }
    for bundles in [0, 3, 5, 10] {
        refused(&count(Order::Explicit, bundles), codes::DIRECTORY_ENTRIES, 160);
    }
}

#[test]
fn the_directory_is_the_first_chunk_and_of_no_other_order() {
    let file = small();
    // Another chunk before it, none at all, the flag not set.
    refused(&with_chunk_at(&file, 144, *b"META", false, b""), codes::DIRECTORY_ABSENT, 144);
    let without = edited(&plain([2, 3, 2], Encoding::PackedOct24, 1), |file| {
        file[112] = 3;
        file[128..132].fill(0);
    });
    refused(&without, codes::DIRECTORY_ABSENT, 144);
    assert_eq!(one_shot(&edited(&file, |file| file[148] = 0)).1, None);
    // A second one, and one in a file of another order.
    let entries = &file[160..192];
    refused(&with_chunk(&file, *b"DIRE", true, entries), common::CHUNK_REPEATED, 200);
    for order in [Order::Slices, Order::Octree] {
        let with = with_chunk(&ordered([2, 3, 3], order, 2), *b"DIRE", true, entries);
        refused(&with, codes::DIRECTORY_FORBIDDEN, 144);
    }
    // What is wrong with the header is said before the directory is there, and nothing else of it.
    let bad = edited(&file, |file| file[137] = 1);
    assert_eq!(
        decode_all(&bad[..144], &Limits::default(), |_| {}).unwrap_err().code(),
        common::RESERVED.number()
    );
    for n in 144..200 {
        let mut events = 0;
        let error = decode_all(&file[..n], &Limits::default(), |_| events += 1).unwrap_err();
        assert_eq!((error.verdict(), error.offset().0, events), (Verdict::NeedMore, n as u64, 0));
    }
}

#[test]
fn a_writer_puts_the_directory_first() {
    let file = full_explicit();
    assert_eq!((&file[144..148], file[148]), (&b"DIRE"[..], 1), "critical");
    let header = header(&file);
    let entries = &file[160..160 + 8 * header.bundle_count as usize];
    for (k, entry) in (1..).zip(entries.chunks_exact(8)) {
        let number = |at: usize| u64::from(u32::from_le_bytes(entry[at..at + 4].try_into().unwrap()));
        assert_eq!(header.record_vertices(RecordId::Bundle(k)), number(0));
        assert_eq!(header.index_bytes(RecordId::Bundle(k)), number(4));
        assert_eq!(header.payload_len(RecordId::Bundle(k)), number(0) * 42 + number(4));
    }
}

#[test]
fn the_directory_has_one_entry_for_each_bundle() {
    // 31 bytes of payload: the length of the chunk stays, and its padding is one longer.
    refused(&edited(&small(), |file| file[152] = 31), codes::DIRECTORY_ENTRIES, 160);
    refused(&patched(128, &[3]), codes::DIRECTORY_ENTRIES, 160);
}

#[test]
fn each_entry_of_the_directory_is_judged_in_order() {
    let file = small();
    let entries: Vec<u32> =
        file[160..192].chunks_exact(4).map(|n| u32::from_le_bytes(n.try_into().unwrap())).collect();
    assert_eq!(entries, [1, 1, 2, 2, 3, 3, 4, 4]);
    // Of the first entry: no vertex and more than six; too few and too many index bytes, also where the vertices are wrong.
    for vertices in [0, 7, u32::MAX] {
        refused(&patched(160, &[vertices, 0]), codes::DIRECTORY_VERTICES, 160);
    }
    for index_bytes in [0, 8, u32::MAX] {
        refused(&patched(160, &[1, index_bytes, 0]), codes::DIRECTORY_INDEX, 164);
    }
    for index_bytes in [5, 43] {
        refused(&patched(160, &[6, index_bytes]), codes::DIRECTORY_INDEX, 164);
    }
    // 6 + 2 + 3 vertices are more than ten: said at the third entry, before what is wrong with the fourth.
    refused(&patched(160, &[6, 6, 2, 2, 3, 3, 0]), codes::DIRECTORY_VERTICES, 176);
    // The index bytes are within bounds and those of no file: the length of the file tells.
    refused(&patched(160, &[1, 3]), common::FILE_BYTES, 48);
    // A reader's own limit: one vertex and the envelope are 56 bytes, the corners 348; bundle 4 is 4 × 42 + 4 + 12.
    let within = |record_bytes| Limits {
        wire: ivg_wire::Limits { record_bytes, ..ivg_wire::Limits::new() },
        ..Limits::default()
    };
    let of = |vertices: [u32; 2]| {
        let lattice = lattice([1, 1, 64]);
        let mut bundles = bundles(&lattice, 64, |_| false);
        bundles.push((1..=u64::from(vertices[0])).collect());
        bundles.push((u64::from(vertices[0]) + 1..63).collect());
        let values = vectors(&lattice);
        let source = GridSource { bundles: Some(&bundles), ..GridSource::new(lattice, &values) };
        encode(&source, &EncodeOptions { order: Order::Explicit, ..EncodeOptions::new() }).unwrap()
    };
    // 50 vertices: 50 × 43 + 12 bytes, to a multiple of four; the second bundle has 12.
    refused_within(&of([50, 12]), &within(2163), common::LIMIT_RECORD_BYTES, 160);
    refused_within(&of([12, 50]), &within(2163), common::LIMIT_RECORD_BYTES, 168);
    assert_eq!(decode_all(&of([12, 50]), &within(2164), |_| {}), Ok(()));
}

#[test]
fn a_bundle_longer_than_a_record_may_be_is_named_in_the_directory() {
    // 300³ vertices in one bundle of 216 bytes each, as a header and a directory: no bundle is there.
    let mut file = ordered([1, 1, 3], Order::Explicit, 1);
    let limits = Limits {
        wire: ivg_wire::Limits { record_bytes: u32::MAX, ..ivg_wire::Limits::new() },
        ..Limits::default()
    };
    file = edited(&file, |file| {
        (0..3).for_each(|axis| file[56 + 2 * axis..][..2].copy_from_slice(&300u16.to_le_bytes()));
        file[62] = 6;
        (0..3).for_each(|axis| file[88 + 8 * axis..][..8].copy_from_slice(&1f64.to_le_bytes()));
        file[116..120].copy_from_slice(&90_000u32.to_le_bytes());
        file[160..164].copy_from_slice(&26_999_992u32.to_le_bytes());
        file[164..168].copy_from_slice(&27_000_000u32.to_le_bytes());
    });
    refused_within(&file[..176], &limits, codes::RECORD_TOO_LARGE, 160);
}

#[test]
fn without_validity_no_vertex_may_be_left_out() {
    // Nine of ten vertices: the last bundle says one less.
    refused(&patched(184, &[3, 3]), codes::DIRECTORY_VERTICES, 192);
    let lattice = lattice([2, 3, 3]);
    let values = vectors(&lattice);
    let bundles = bundles(&lattice, 2, |_| false);
    let source = GridSource { bundles: Some(&bundles), ..GridSource::new(lattice, &values) };
    let options = EncodeOptions { order: Order::Explicit, ..options(Encoding::PackedOct24, 2) };
    assert_eq!(encode(&source, &options), Err(EncodeError::VertexMissing { vertex: [0, 1, 0] }));
    let inside = vec![0; 18];
    let without = encode(&GridSource { validity: Some(&inside), ..source }, &options).unwrap();
    assert_eq!((one_shot(&without).1, header(&without).bundle_count), (None, 0));
}

#[test]
fn a_vertex_inside_geometry_may_be_in_no_bundle() {
    let file = full_explicit();
    let mut received = [false; 18];
    decode_all(&file, &Limits::default(), |event| {
        if let Event::Corners(bundle) | Event::Bundle(bundle) = event {
            bundle.vertices().for_each(|vertex| received[vertex as usize] = true);
        }
    })
    .unwrap();
    let lattice = lattice([3, 3, 2]);
    for vertex in 0..18 {
        let expected = vertex % 5 != 4 || lattice.is_corner(vertex);
        assert_eq!(received[vertex as usize], expected, "vertex {vertex}");
    }
}

#[test]
fn every_vertex_of_a_bundle_comes_as_it_was_listed() {
    let lattice = lattice([4, 5, 6]);
    let (values, expected) = (vectors(&lattice), bundles(&lattice, 3, |_| true));
    let source = GridSource { bundles: Some(&expected), ..GridSource::new(lattice, &values) };
    let options = EncodeOptions { order: Order::Explicit, ..options(Encoding::VectorsF32, 3) };
    let mut found = vec![];
    decode_all(&encode(&source, &options).unwrap(), &Limits::default(), |event| {
        if let Event::Bundle(bundle) = event {
            let vertices: Vec<u64> = bundle.vertices().collect();
            assert!(vertices.is_sorted() && bundle.vertices().len() == bundle.len());
            for (n, &vertex) in vertices.iter().enumerate() {
                assert_eq!(bundle.vectors(n), values[vertex as usize]);
            }
            assert_eq!(bundle.payload().len(), 216 * bundle.len());
            found.push(vertices);
        }
    })
    .unwrap();
    let mut sorted = expected.clone();
    sorted.iter_mut().for_each(|bundle| bundle.sort_unstable());
    assert_eq!(found, sorted);
}

#[test]
fn the_list_of_vertices_is_judged_number_by_number() {
    // 300 vertices in a row and three bundles, whose lists take 2, 4 and the rest.
    let lattice = lattice([300, 1, 1]);
    let values = vectors(&lattice);
    let bundles =
        [vec![200], vec![130, 131, 132], (1..299).filter(|v| ![130, 131, 132, 200].contains(v)).collect()];
    let source = GridSource { bundles: Some(&bundles), ..GridSource::new(lattice, &values) };
    let options = EncodeOptions { order: Order::Explicit, ..options(Encoding::PackedOct24, 1) };
    let file = encode(&source, &options).unwrap();
    let header = header(&file);
    let at = |k| header.record_range(RecordId::Bundle(k)).start + 8;
    let with =
        |k, list: &[u8]| edited(&file, |file| file[at(k) as usize..][..list.len()].copy_from_slice(list));
    assert_eq!(file[at(1) as usize..][..2], [0xC8, 1]);
    assert_eq!(file[at(2) as usize..][..4], [0x82, 1, 0, 0]);
    // Not the shortest form; no end within the index bytes, though the values behind would give one.
    refused(&with(1, &[0x80, 0]), codes::INDEX_NUMBER, at(1));
    refused(&with(1, &[0x80, 0x80]), codes::INDEX_NUMBER, at(1));
    refused(&with(2, &[0x82, 1, 0x80, 0]), codes::INDEX_NUMBER, at(2) + 2);
    // Vertex 300, the last corner 299, and corner 0.
    refused(&with(1, &[0xAC, 2]), codes::INDEX_VERTEX, at(1));
    refused(&with(1, &[0xAB, 2]), codes::INDEX_VERTEX, at(1));
    refused(&with(2, &[0, 1, 0, 0]), codes::INDEX_VERTEX, at(2));
    refused(&with(2, &[0xA8, 2, 1, 0]), codes::INDEX_VERTEX, at(2) + 3);
    // A byte is left over; and what is wrong with the values comes last.
    let wrong_value = at(2) as usize + 4 + 3 * 24;
    let both = edited(&with(2, &[1, 0, 0, 0]), |file| file[wrong_value..wrong_value + 3].fill(0xFF));
    refused(&both, codes::INDEX_LENGTH, at(2) + 3);
    let value = edited(&file, |file| file[wrong_value..wrong_value + 3].fill(0xFF));
    refused(&value, codes::DIRECTION_CODE, wrong_value as u64);
    // The same vertex in two bundles is not a reader's matter.
    assert_eq!(one_shot(&with(1, &[0x82, 1])).1, None);
}

#[test]
fn bundles_that_cannot_be_written_are_named() {
    let lattice = lattice([3, 3, 3]);
    let values = vectors(&lattice);
    let explicit = EncodeOptions { order: Order::Explicit, ..options(Encoding::PackedOct24, 1) };
    let good = bundles(&lattice, 1, |_| true);
    let written = |bundles: Option<&[Vec<u64>]>, options: &EncodeOptions| {
        encode(&GridSource { bundles, ..GridSource::new(lattice, &values) }, options).err()
    };
    let with = |edit: fn(&mut Vec<Vec<u64>>)| {
        let mut bundles = good.clone();
        edit(&mut bundles);
        written(Some(&bundles), &explicit)
    };
    assert_eq!(with(|_| ()), None);
    assert_eq!(written(None, &explicit), Some(EncodeError::BundlesMissing));
    for order in [Order::Slices, Order::Octree] {
        let unwanted = written(Some(&good), &EncodeOptions { order, ..explicit });
        assert_eq!(unwanted, Some(EncodeError::BundlesUnwanted { order }));
    }
    assert_eq!(with(|b| b.insert(1, vec![])), Some(EncodeError::BundleEmpty { bundle: 1 }));
    let merged = with(|b| {
        let moved = b.remove(0);
        b[2].extend(moved);
    });
    assert_eq!(merged, Some(EncodeError::BundleTooLarge { bundle: 2, found: 4, most: 3 }));
    assert_eq!(with(|b| b[1][0] = 27), Some(EncodeError::VertexOutside { bundle: 1, vertex: 27 }));
    assert_eq!(with(|b| b[1][0] = 26), Some(EncodeError::VertexIsCorner { bundle: 1, vertex: [2, 2, 2] }));
    let missing = lattice.coords(good[0][0]);
    assert_eq!(with(|b| b.truncate(0)), Some(EncodeError::VertexMissing { vertex: [1, 0, 0] }));
    assert_eq!(with(|b| drop(b.remove(0))), Some(EncodeError::VertexMissing { vertex: missing }));
    // With a validity section as well, unless it says that the vertex lies inside geometry.
    let mut validity = [255; 27];
    let short = &good[1..];
    let with_validity = |validity: &[u8]| {
        let source = GridSource { validity: Some(validity), ..GridSource::new(lattice, &values) };
        encode(&GridSource { bundles: Some(short), ..source }, &explicit).err()
    };
    assert_eq!(with_validity(&validity), Some(EncodeError::VertexMissing { vertex: missing }));
    validity[good[0][0] as usize] = 0;
    assert_eq!(with_validity(&validity), None);
    let twice = with(|b| b[3][1] = b[0][0]);
    assert_eq!(twice, Some(EncodeError::VertexTwice { bundle: 3, vertex: missing }));
    for error in [twice, merged, with(|b| b[1][0] = 26)] {
        assert!(error.unwrap().to_string().starts_with("bundle "), "{error:?}");
    }
}

#[test]
fn every_reader_takes_a_directory_of_8189_bundles() {
    // The chunk limit that every reader keeps, 65,536 bytes: one bundle more is beyond it.
    let wire = ivg_wire::Limits { chunk_bytes: 65_536, ..ivg_wire::Limits::new() };
    let limits = Limits { wire, ..Limits::default() };
    for (bundles, expected) in [(8189u16, true), (8190, false)] {
        let lattice = lattice([bundles + 2, 1, 1]);
        let each: Vec<Vec<u64>> = (1..=u64::from(bundles)).map(|vertex| vec![vertex]).collect();
        let values = vectors(&lattice);
        let source = GridSource { bundles: Some(&each), ..GridSource::new(lattice, &values) };
        let options = EncodeOptions { order: Order::Explicit, ..EncodeOptions::new() };
        let file = encode(&source, &options).unwrap();
        match ivg_format::Header::read(&file, &limits) {
            Ok(Step::Consumed(used, header)) => {
                assert!(expected && used as u64 == header.data_offset);
                let end = header.record_range(RecordId::Bundle(u32::from(bundles))).end;
                assert_eq!(end, header.record_range(RecordId::End).start);
            }
            Ok(Step::NeedMore(more)) => panic!("{more} bytes"),
            Err(error) => {
                assert!(!expected);
                assert_eq!(error.code(), common::LIMIT_CHUNK_BYTES.number());
            }
        }
    }
}
