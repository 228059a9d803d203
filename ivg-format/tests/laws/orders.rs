//! What the header says of the layout against what lies in the file.

use crate::files::{describe, envelopes, header, lattice, options, ordered, plain, samples, vectors};
use ivg_format::{Encoding, Event, GridSource, Limits, Order, RecordId, decode_all, decode_record, encode};
use quickcheck::quickcheck;
use std::collections::BTreeSet;

/// Walks a file by the lengths of its records, which the closed form must name.
fn check_ranges(file: &[u8]) {
    let header = header(file);
    let mut next = header.data_offset;
    for id in header.records() {
        let range = header.record_range(id);
        assert_eq!(range.start, next, "{id:?}");
        let stored = u32::from_le_bytes(file[range.start as usize..][..4].try_into().unwrap());
        assert_eq!(stored, id.stored());
        next = range.end;
    }
    assert_eq!((next, header.file_bytes), (file.len() as u64, file.len() as u64));
    assert_eq!(header.records().count() as u64, header.record_count());
}

#[test]
fn the_closed_form_is_the_layout_of_the_file() {
    for file in samples() {
        check_ranges(&file);
    }
    for dims in [[5, 3, 3], [3, 3, 9], [2, 2, 9], [1, 5, 5], [4, 4, 4], [7, 1, 1], [3, 2, 2], [2, 3, 1]] {
        for per_slice in [1, 2, 3, 4, 5, 8, 64] {
            for &order in Order::ALL {
                check_ranges(&ordered(dims, order, per_slice));
            }
        }
    }
}

#[test]
fn every_vertex_arrives_exactly_once_and_corners_first() {
    for &order in Order::ALL {
        every_vertex_arrives_once(&ordered([5, 4, 3], order, 2));
    }
}

fn every_vertex_arrives_once(file: &[u8]) {
    let mut seen = BTreeSet::new();
    let mut corners = vec![];
    decode_all(file, &Limits::default(), |event| {
        if let Event::Corners(bundle) | Event::Bundle(bundle) = &event {
            assert_eq!(bundle.vertices().len(), bundle.len());
            for vertex in bundle.vertices() {
                assert!(seen.insert(vertex), "vertex {vertex} twice");
                if let Event::Corners(_) = event {
                    corners.push(vertex);
                }
            }
        }
    })
    .unwrap();
    assert!(seen.into_iter().eq(0..60));
    assert!(corners.into_iter().eq(lattice([5, 4, 3]).corners()));
}

#[test]
fn a_vertex_of_a_bundle_can_be_asked_for_alone() {
    for order in [Order::Slices, Order::Octree] {
        let header = header(&ordered([3, 4, 5], order, 3));
        for k in 0..=header.bundle_count + 1 {
            let all: Vec<u64> = header.bundle_vertices(k).into_iter().flatten().collect();
            assert_eq!(all.is_empty(), k == 0 || k > header.bundle_count);
            for n in 0..all.len() as u64 + 2 {
                assert_eq!(header.bundle_vertex(k, n), all.get(n as usize).copied());
            }
        }
    }
    // Where bundles list their vertices, the header does not pretend to know them.
    let header = header(&ordered([3, 4, 5], Order::Explicit, 3));
    assert!(header.bundle_vertices(1).is_none() && header.bundle_vertex(1, 0).is_none());
}

#[test]
fn validity_blocks_are_laid_out_as_the_header_says() {
    // 4097 and 8192 vertices: a last block of one vertex, and two full ones.
    for (dims, lengths) in [([17, 241, 1], vec![4096, 1]), ([2, 64, 64], vec![4096, 4096])] {
        let lattice = lattice(dims);
        let vectors = vectors(&lattice);
        let validity: Vec<u8> = (0..lattice.vertex_count()).map(|v| (v % 251) as u8).collect();
        let source = GridSource { validity: Some(&validity), ..GridSource::new(lattice, &vectors) };
        let file = encode(&source, &options(Encoding::PackedOct24, 1024)).unwrap();
        check_ranges(&file);
        let mut found = vec![];
        decode_all(&file, &Limits::default(), |event| {
            if let Event::Validity(block) = event {
                assert_eq!(block.first_vertex(), found.iter().sum::<usize>() as u64);
                assert_eq!(block.validity(), &validity[block.first_vertex() as usize..][..block.len()]);
                assert_eq!(block.id(), RecordId::Validity(found.len() as u32));
                found.push(block.len());
            }
        })
        .unwrap();
        assert_eq!(found, lengths);
    }
}

#[test]
fn a_huge_lattice_has_ranges_without_being_walked() {
    // 512³ vertices in a header made from a small file: only the arithmetic of the layout is asked.
    let mut bytes = plain([3, 3, 3], Encoding::PackedOct24, 64)[..144].to_vec();
    for axis in 0..3 {
        bytes[56 + 2 * axis..][..2].copy_from_slice(&512u16.to_le_bytes());
    }
    bytes[128..132].copy_from_slice(&4096u32.to_le_bytes());
    // 4095 full bundles of 512 × 64 vertices, one in which the outer slices have 60 left, corners and end.
    let full: u64 = 512 * 64 * 42 + 12;
    let length = 144 + 348 + 4095 * full + (full - 2 * 4 * 42) + 20;
    bytes[48..56].copy_from_slice(&length.to_le_bytes());
    ivg_wire::seal_header(&mut bytes);
    let header = header(&bytes);
    assert_eq!(header.record_range(RecordId::Bundle(4096)).start, 144 + 348 + 4095 * full);
    assert_eq!(header.record_range(RecordId::End).end, length);
    assert!(envelopes(&plain([3, 3, 3], Encoding::PackedOct24, 64)).len() == 3);
}

/// What each record of a file says, read alone in the order in which `next` draws them from those left.
fn alone(file: &[u8], mut next: impl FnMut(usize) -> usize) -> Vec<String> {
    let header = header(file);
    let mut left: Vec<RecordId> = header.records().collect();
    let mut found = vec![];
    while !left.is_empty() {
        let id = left.swap_remove(next(left.len()));
        let range = header.record_range(id);
        let bytes = &file[range.start as usize..range.end as usize];
        found.push(describe(&decode_record(&header, id, bytes).unwrap()));
    }
    found.sort();
    found
}

quickcheck! {
    fn records_in_any_order_are_those_of_the_file(which: u8, draws: Vec<u8>) -> bool {
        // As text with every value read: what a reader holds after all records is the same.
        let samples = samples();
        let file = &samples[usize::from(which) % samples.len()];
        let mut draws = draws.into_iter().cycle();
        alone(file, |_| 0) == alone(file, |left| usize::from(draws.next().unwrap_or(0)) % left)
    }

    fn any_lattice_has_the_layout_that_its_header_says(dims: (u8, u8, u8), per_slice: u8) -> bool {
        let dims = [dims.0, dims.1, dims.2].map(|n| u16::from(n % 7 + 1));
        for &order in Order::ALL {
            check_ranges(&ordered(dims, order, u32::from(per_slice % 20) + 1));
        }
        true
    }
}
