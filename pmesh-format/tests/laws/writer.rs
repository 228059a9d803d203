//! What the encoder writes, against the rules for writers, read here from the bytes.

use crate::files::{ENTRY, Parts, file, random, samples, seam, u32_at, u64_at};
use pmesh_format::{EncodeError, EncodeOptions, Limits, PacketSize, ProgressiveMesh, check, encode};

fn f32_at(bytes: &[u8], at: usize) -> f32 {
    f32::from_bits(u32_at(bytes, at))
}

#[test]
fn the_bounding_box_is_the_tightest() {
    let mesh = random(8, 20, false);
    let file = file(&mesh, 6);
    for axis in 0..3 {
        let coordinates = || mesh.positions.iter().map(|p| p[axis]);
        let least = coordinates().fold(f32::INFINITY, f32::min);
        let greatest = coordinates().fold(f32::NEG_INFINITY, f32::max);
        assert_eq!(f32_at(&file, 104 + 4 * axis), least);
        assert_eq!(f32_at(&file, 116 + 4 * axis), greatest);
    }
    let empty = encode(&ProgressiveMesh::default(), &EncodeOptions::default()).unwrap();
    assert!(empty[104..128].iter().all(|&byte| byte == 0), "zeros without vertices");
}

/// A wider box than the tightest breaks a rule for writers only.
#[test]
fn a_wider_box_changes_no_verdict() {
    let mut parts = Parts::of(&file(&random(8, 20, false), 6));
    parts.header[104..108].copy_from_slice(&(-100.0f32).to_le_bytes());
    parts.header[120..124].copy_from_slice(&100.0f32.to_le_bytes());
    assert_eq!(check(&parts.build(), &Limits::default()), Ok(()));
}

#[test]
fn the_directory_counts_up_to_the_header() {
    for packet in [1, 4, 7, 100] {
        let mesh = random(3, 14, true);
        let mut parts = Parts::of(&file(&mesh, packet));
        let directory = parts.directory().clone();
        let mut before = [0; 3];
        let mut error = f32::INFINITY;
        for (k, entry) in directory.chunks_exact(ENTRY).enumerate() {
            let ends = [0, 4, 8].map(|at| u32_at(entry, at));
            assert!(ends[0] > before[0] && ends[0] >= 3);
            assert_eq!(ends[1], mesh.wedges.vertices.partition_point(|&v| v < ends[0]) as u32);
            assert!(ends[2] >= before[2]);
            assert_eq!(u32_at(entry, 12) as usize, parts.packets[k].1.len());
            assert!(f32_at(entry, 16) <= error && f32_at(entry, 16) >= 0.0);
            (before, error) = (ends, f32_at(entry, 16));
        }
        let faces = mesh.faces.len() as u32;
        assert_eq!(before, [14, 21, faces]);
        assert_eq!([56, 60, 64].map(|at| u32_at(&parts.header, at)), [14, 21, faces]);
        assert_eq!(u32_at(&parts.header, 72) as usize, parts.packets.len());
    }
}

/// The error of a packet is that of its coarsest level, which is the greatest (PMESH-DIR-05).
#[test]
fn the_error_of_a_packet_is_that_of_its_coarsest_level() {
    let mesh = random(3, 14, false);
    let mut parts = Parts::of(&file(&mesh, 4));
    // Packets end at 4, 8, 12, 14; their coarsest levels are 3 (the base), 5, 9, 13, which lack vertices from there on.
    let errors: Vec<f32> = parts.directory().chunks_exact(ENTRY).map(|entry| f32_at(entry, 16)).collect();
    assert_eq!(errors, [3, 5, 9, 13].map(|level: usize| mesh.errors[level - 3]));
}

#[test]
fn records_are_the_packets_in_order_and_the_end() {
    for file in samples() {
        let parts = Parts::of(&file);
        let mut at = parts.data_offset() as usize;
        for (k, (id, payload)) in (0u32..).zip(&parts.packets) {
            assert_eq!((*id, u32_at(&file, at + 4)), (k, 0), "id and generation");
            at += (12 + payload.len()).next_multiple_of(4);
        }
        assert_eq!((u32_at(&file, at), u32_at(&file, at + 4)), (u32::MAX, 0));
        assert_eq!(u64_at(&file, at + 8), file.len() as u64);
    }
}

/// Up to `materials` every array begins at a multiple of 4 bytes of the file (PMESH-PKT-02).
#[test]
fn arrays_lie_at_multiples_of_four_bytes() {
    let parts = Parts::of(&file(&seam(), 3));
    for k in 0..2 {
        for start in &parts.arrays(k)[..6] {
            assert_eq!((parts.payload_offset(k) + *start as u64) % 4, 0);
        }
    }
}

#[test]
fn every_packet_brings_a_vertex_and_the_first_the_base() {
    let mesh = random(7, 30, false);
    for packets in [
        PacketSize::Fixed(0),
        PacketSize::Fixed(2),
        PacketSize::Growing { first: 0, percent: 0, most: 0 },
        PacketSize::Growing { first: 5, percent: 1000, most: u32::MAX },
    ] {
        let options = EncodeOptions { packets, ..EncodeOptions::default() };
        let file = encode(&mesh, &options).unwrap();
        assert_eq!(check(&file, &Limits::default()), Ok(()), "{packets:?}");
        let mut parts = Parts::of(&file);
        assert!(u32_at(parts.directory(), 0) >= 3);
    }
}

#[test]
fn a_face_with_a_vertex_twice_is_refused_whichever_corners_they_are() {
    for corners in [[1, 1, 2], [2, 1, 1], [1, 2, 1]] {
        let mut mesh = random(7, 10, false);
        mesh.faces[4] = corners;
        assert_eq!(encode(&mesh, &EncodeOptions::default()), Err(EncodeError::Face { face: 4 }));
    }
    // Two wedges of one vertex.
    let mut mesh = seam();
    mesh.faces[1] = [2, 0, 3];
    assert_eq!(encode(&mesh, &EncodeOptions::default()), Err(EncodeError::Face { face: 1 }));
}

#[test]
fn the_last_vertices_must_have_wedges_too() {
    let mut mesh = seam();
    mesh.wedges.vertices.truncate(4);
    mesh.wedges.normals.truncate(4);
    mesh.wedges.uvs.truncate(4);
    mesh.wedges.colours.truncate(4);
    mesh.wedge_collapse.clear();
    mesh.faces.clear();
    mesh.materials.clear();
    assert_eq!(encode(&mesh, &EncodeOptions::default()), Err(EncodeError::Wedge { wedge: 4 }));
}
