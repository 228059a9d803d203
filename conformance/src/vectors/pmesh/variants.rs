//! Accepted files of every mode and every encoding of positions, of meshes that are surfaces and of some that are not.

use super::super::{Format, Vector};
use crate::surfaces::{Kind, surface};
use ivg_wire::splitmix64;
use pmesh_format::{EncodeOptions, Mode, PacketSize, Positions, ProgressiveMesh, encode};

/// Packets that grow as those of large meshes do, but begin small.
const GROWING: PacketSize = PacketSize::Growing { first: 6, percent: 30, most: 100 };

/// A name, a mesh, how it is stored, what it shows.
type Variant = (&'static str, ProgressiveMesh, EncodeOptions, &'static str);

/// A surface that is the same on every machine.
fn grown(seed: u64, kind: Kind) -> ProgressiveMesh {
    let mut n = 0;
    surface(kind, |bound| {
        n += 1;
        (splitmix64(seed, n) % bound as u64) as usize
    })
}

fn options(mode: Mode, positions: Positions, packets: PacketSize) -> EncodeOptions {
    EncodeOptions { mode, positions, packets, ..EncodeOptions::new() }
}

/// A closed surface without attributes.
pub(super) fn closed(vertices: usize) -> ProgressiveMesh {
    grown(1, Kind { vertices, ..Kind::default() })
}

/// A surface with all attributes, and seams along the border of two materials.
pub(super) fn all_attributes(vertices: usize) -> ProgressiveMesh {
    grown(2, Kind { vertices, normals: true, uvs: true, colours: true, seams: true, ..Kind::default() })
}

fn bordered(vertices: usize) -> ProgressiveMesh {
    grown(3, Kind { vertices, bordered: true, ..Kind::default() })
}

fn irregular(vertices: usize) -> ProgressiveMesh {
    grown(4, Kind { vertices, irregular: true, bordered: true, normals: true, ..Kind::default() })
}

fn raw() -> Vec<Variant> {
    let raw = |packets| options(Mode::Raw, Positions::F32, packets);
    vec![
        ("0010-raw-closed", closed(24), raw(GROWING), "a closed surface; packets that grow"),
        (
            "0011-raw-attributes",
            all_attributes(16),
            raw(GROWING),
            "normals, texture coordinates, colours, materials, and seams between these",
        ),
        (
            "0012-raw-border",
            bordered(20),
            raw(PacketSize::Fixed(1)),
            "a surface with a border; a packet for each vertex",
        ),
        (
            "0013-raw-irregular",
            irregular(24),
            raw(PacketSize::Fixed(24)),
            "pinched vertices, faces across, vertices without a face; one packet",
        ),
    ]
}

/// Names of the raw files of each number of bits, from the least on.
const QUANTISED: [&str; 7] = [
    "0020-raw-q10",
    "0021-raw-q11",
    "0022-raw-q12",
    "0023-raw-q13",
    "0024-raw-q14",
    "0025-raw-q15",
    "0026-raw-q16",
];

fn raw_quantised() -> Vec<Variant> {
    let raw = |bits| options(Mode::Raw, Positions::Quantised(bits), PacketSize::Fixed(8));
    let mut variants: Vec<Variant> = (10..)
        .zip(QUANTISED)
        .map(|(bits, name)| (name, bordered(9), raw(bits), "positions on a lattice along the longest side"))
        .collect();
    let flat = |mut mesh: ProgressiveMesh, axes: &[usize]| {
        mesh.positions.iter_mut().for_each(|p| axes.iter().for_each(|&axis| p[axis] = -3.25));
        mesh
    };
    variants.extend([
        ("0027-raw-q12-plane", flat(closed(8), &[1]), raw(12), "a mesh without extent along one axis"),
        ("0028-raw-q12-point", flat(closed(5), &[0, 1, 2]), raw(12), "a mesh without extent: the step is 0"),
        (
            "0029-raw-q14-attributes",
            all_attributes(9),
            raw(14),
            "points of a lattice beside attributes, whose arrays keep their alignment",
        ),
    ]);
    variants
}

pub(super) fn accepted() -> Vec<Vector> {
    let variants = raw().into_iter().chain(raw_quantised());
    variants
        .map(|(name, mesh, options, why)| {
            let file = encode(&mesh, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            Vector::accepted(Format::Pmesh, name, file, why)
        })
        .collect()
}
