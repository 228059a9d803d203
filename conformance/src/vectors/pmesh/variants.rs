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

pub(super) fn accepted() -> Vec<Vector> {
    let variants = raw();
    variants
        .into_iter()
        .map(|(name, mesh, options, why)| {
            let file = encode(&mesh, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            Vector::accepted(Format::Pmesh, name, file, why)
        })
        .collect()
}
