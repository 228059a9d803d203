use std::vec;

use super::*;
use crate::mesh::Wedges;
use crate::tests::{Kind, header_of, random_mesh, replay_all, some_meshes};

#[test]
fn the_same_mesh_gives_the_same_bytes() {
    for mesh in some_meshes() {
        let options = EncodeOptions::default();
        assert_eq!(encode(&mesh, &options).unwrap(), encode(&mesh.clone(), &options).unwrap());
    }
}

/// Every array of the mesh counts for the content id, and so does the size of packets.
#[test]
fn the_content_id_differs_when_anything_differs() {
    let mesh = random_mesh(4, Kind { vertices: 12, seams: true, materials: true });
    let mut meshes = vec![mesh; 11];
    meshes[1].origin[2] = 1.0;
    meshes[2].positions[3][0] = 0.125;
    meshes[3].wedges.normals[0] = [1.0, 0.0, 0.0];
    meshes[4].wedges.uvs[2] = [0.0, 0.0];
    meshes[5].wedges.colours[1][3] = 7;
    meshes[6].faces.swap(0, 1);
    meshes[7].materials[0] ^= 1;
    meshes[8].material_names[0].push('!');
    meshes[9].errors[0] = 5.0;
    meshes[10].faces[0].rotate_left(1);
    let mut ids: Vec<_> = meshes
        .iter()
        .map(|mesh| header_of(&encode(mesh, &EncodeOptions::fixed(4)).unwrap()).content_id.0)
        .collect();
    ids.push(header_of(&encode(&meshes[0], &EncodeOptions::fixed(5)).unwrap()).content_id.0);
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
}

#[test]
fn packets_grow_as_asked() {
    let mesh = random_mesh(6, Kind { vertices: 100, seams: false, materials: false });
    let ends = |packets: PacketSize| -> Vec<u32> {
        let header = header_of(&encode(&mesh, &EncodeOptions { packets, ..EncodeOptions::new() }).unwrap());
        header.packets.iter().map(|packet| packet.vertices.end).collect()
    };
    assert_eq!(ends(PacketSize::Fixed(40)), [40, 80, 100]);
    assert_eq!(ends(PacketSize::Growing { first: 20, percent: 50, most: 1000 }), [20, 30, 45, 67, 100]);
    assert_eq!(ends(PacketSize::Growing { first: 20, percent: 50, most: 30 }), [20, 30, 45, 67, 97, 100]);
    // The first packet has the whole base, and every packet at least one vertex.
    assert_eq!(ends(PacketSize::Fixed(0)), (mesh.base_vertices..=100).collect::<Vec<_>>());
}

#[test]
fn a_packet_ends_with_the_first_hundredth() {
    let ends = |vertices: u32, packets: PacketSize| -> Vec<u32> {
        let mut ends = vec![packets.end(0, 3, vertices)];
        while ends[ends.len() - 1] < vertices {
            ends.push(packets.end(ends[ends.len() - 1], 3, vertices));
        }
        ends
    };
    let growing = |first, most| PacketSize::Growing { first, percent: 300, most };
    // Halves of 250, rounded up, that are no less than the first packet; from there on 300 % more each time.
    assert_eq!(ends(25_000, growing(32, 1 << 18)), [32, 63, 125, 250, 1000, 4000, 16_000, 25_000]);
    assert_eq!(ends(25_000, growing(33, 1 << 18)), [63, 125, 250, 1000, 4000, 16_000, 25_000]);
    assert_eq!(ends(25_000, growing(62, 1 << 18))[..3], [63, 125, 250]);
    assert_eq!(ends(25_000, growing(63, 1 << 18))[..2], [63, 252]);
    assert_eq!(ends(25_000, growing(32, 100))[..5], [32, 63, 125, 225, 250]);
    assert_eq!(ends(25_000, growing(0, 1 << 18))[..4], [3, 4, 8, 16]);
}

#[test]
fn materials_that_are_all_zero_are_not_stored() {
    let mut mesh = random_mesh(4, Kind { vertices: 12, seams: false, materials: true });
    mesh.materials.fill(0);
    let header = header_of(&encode(&mesh, &EncodeOptions::default()).unwrap());
    assert!(!header.attributes.materials);
    let replay = replay_all(&encode(&mesh, &EncodeOptions::default()).unwrap());
    assert!(replay.face_materials().is_empty());
    assert_eq!(replay.material_names(), mesh.material_names);
}

#[test]
fn what_cannot_be_written_is_named() {
    let good = random_mesh(4, Kind { vertices: 12, seams: true, materials: true });
    let base = good.base_vertices as usize;
    let check = |expected: EncodeError, spoil: fn(&mut ProgressiveMesh)| {
        let mut mesh = good.clone();
        spoil(&mut mesh);
        assert_eq!(encode(&mesh, &EncodeOptions::default()), Err(expected), "{expected}");
    };
    check(EncodeError::Base, |mesh| mesh.base_vertices = 0);
    check(EncodeError::Base, |mesh| mesh.base_vertices = 13);
    let splits = 12 - base;
    let length = |array, found, expected| EncodeError::Length { array, found, expected };
    check(length("collapse", splits - 1, splits), |mesh| {
        mesh.collapse.pop();
    });
    check(length("errors", 0, splits), |mesh| mesh.errors.clear());
    check(length("normals", 1, good.wedges.len()), |mesh| mesh.wedges.normals.truncate(1));
    check(length("uvs", 1, good.wedges.len()), |mesh| mesh.wedges.uvs.truncate(1));
    check(length("colours", 1, good.wedges.len()), |mesh| mesh.wedges.colours.truncate(1));
    check(length("materials", 1, good.faces.len()), |mesh| mesh.materials.truncate(1));
    let targets = good.wedge_collapse.len();
    check(length("wedge_collapse", targets - 1, targets), |mesh| {
        mesh.wedge_collapse.pop();
    });
    check(EncodeError::NotFinite { array: "origin", index: 0 }, |mesh| mesh.origin[1] = f64::NAN);
    check(EncodeError::NotFinite { array: "positions", index: 5 }, |mesh| mesh.positions[5][1] = f32::NAN);
    check(EncodeError::NotFinite { array: "normals", index: 2 }, |mesh| {
        mesh.wedges.normals[2][0] = f32::INFINITY;
    });
    check(EncodeError::NotFinite { array: "uvs", index: 3 }, |mesh| {
        mesh.wedges.uvs[3][1] = f32::NEG_INFINITY;
    });
    check(EncodeError::Wedge { wedge: good.wedges.len() - 1 }, |mesh| {
        *mesh.wedges.vertices.last_mut().unwrap() = 12;
    });
    check(EncodeError::Wedge { wedge: 0 }, |mesh| mesh.wedges.vertices.fill(1));
    check(EncodeError::Parent { vertex: 11 }, |mesh| *mesh.collapse.last_mut().unwrap() = 11);
    let last = good.wedges.len() - 1;
    check(EncodeError::WedgeTarget { wedge: last }, |mesh| {
        let last = mesh.wedges.len() as u32 - 1;
        *mesh.wedge_collapse.last_mut().unwrap() = last;
    });
    check(EncodeError::Face { face: 0 }, |mesh| mesh.faces[0][1] = mesh.faces[0][0]);
    check(EncodeError::Face { face: 1 }, |mesh| mesh.faces[1][2] = 10_000);
    check(EncodeError::ErrorEstimate { index: 0 }, |mesh| mesh.errors[0] = f32::NAN);
    check(EncodeError::ErrorEstimate { index: 1 }, |mesh| {
        mesh.errors.fill(0.5);
        mesh.errors[1] = 0.75;
    });
    check(EncodeError::MaterialName, |mesh| mesh.material_names[1] = "x".repeat(65_536));
    check(EncodeError::WedgesWithoutAttributes, |mesh| {
        mesh.wedges = Wedges { vertices: core::mem::take(&mut mesh.wedges.vertices), ..Wedges::default() };
    });
}
