//! Accepted files of every mode and every encoding of positions, of meshes that are surfaces and of some that are not.

use super::super::parts::{Parts, bits_for, file_of, packed};
use super::super::{Format, Vector};
use super::refused_packets::lie;
use crate::surfaces::{Kind, surface};
use ivg_wire::splitmix64;
use pmesh_format::{EncodeOptions, Mode, PacketSize, Positions, ProgressiveMesh, Wedges, encode};

/// Packets that grow as those of large meshes do, but begin small.
const GROWING: PacketSize = PacketSize::Growing { first: 6, percent: 30, most: 100 };

/// A packet for a base of three vertices and one for all others.
const BASE_AND_REST: PacketSize = PacketSize::Growing { first: 3, percent: 5000, most: 100 };

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

/// The mesh with these coordinates all the same.
fn flat(mut mesh: ProgressiveMesh, axes: &[usize]) -> ProgressiveMesh {
    mesh.positions.iter_mut().for_each(|p| axes.iter().for_each(|&axis| p[axis] = -3.25));
    mesh
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
    variants.extend([
        ("0027-raw-q12-plane", flat(closed(8), &[1]), raw(12), "a mesh without extent along one axis"),
        ("0028-raw-q12-point", flat(closed(5), &[0, 1, 2]), raw(12), "a mesh without extent: the step is 0"),
        (
            "0029-raw-q14-attributes",
            all_attributes(9),
            raw(14),
            "points of a lattice beside attributes, whose arrays keep their alignment",
        ),
        (
            "0073-raw-greatest",
            greatest(),
            raw(10),
            "positions up to the greatest number, as points: the last of an axis would lie beyond it",
        ),
    ]);
    variants
}

/// Three sheets on one edge, two components that touch in a vertex, and a vertex that no face has.
fn not_manifold() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: vec![
            [0.0; 3],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 0.5],
            [-0.5, 0.875, 0.5],
            [-0.5, -0.875, 0.5],
            [0.25, 0.25, 2.0],
            [-0.25, 0.25, 2.0],
            [3.0, 3.0, 3.0],
        ],
        wedges: Wedges { vertices: (0..8).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![2, 2, 2, 5, 6],
        wedge_collapse: vec![2, 2, 2, 5, 6],
        errors: vec![1.0, 0.75, 0.5, 0.25, 0.125],
        faces: vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [1, 5, 6]],
        ..ProgressiveMesh::default()
    }
}

/// All vertices but three collapse onto the first, round which the faces lie.
fn hub(vertices: u32) -> ProgressiveMesh {
    let splits = vertices as usize - 3;
    ProgressiveMesh {
        positions: (0..vertices).map(|v| if v == 1 { [1.0; 3] } else { [0.0; 3] }).collect(),
        wedges: Wedges { vertices: (0..vertices).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: vec![0; splits],
        wedge_collapse: vec![0; splits],
        errors: vec![0.5; splits],
        faces: (2..vertices).map(|v| [0, v - 1, v]).collect(),
        ..ProgressiveMesh::default()
    }
}

/// Names of coded files of each encoding of positions.
const CODED: [&str; 8] = [
    "0030-coded-f32",
    "0031-coded-q10",
    "0032-coded-q11",
    "0033-coded-q12",
    "0034-coded-q13",
    "0035-coded-q14",
    "0036-coded-q15",
    "0037-coded-q16",
];

fn coded() -> Vec<Variant> {
    let coded = |positions, packets| options(Mode::Coded, positions, packets);
    let mut variants: Vec<Variant> = CODED
        .into_iter()
        .zip(Positions::ALL)
        .map(|(name, &positions)| {
            (name, closed(40), coded(positions, GROWING), "a closed surface, entropy coded")
        })
        .collect();
    let q12 = Positions::Quantised(12);
    let triangle = || ProgressiveMesh { faces: vec![[0, 1, 2]], ..closed(3) };
    let zeros = || {
        let mut mesh = bordered(12);
        mesh.positions[4] = [0.0, -0.0, f32::from_bits(1)];
        mesh.positions[5] = [-f32::from_bits(1), 0.0, -0.0];
        mesh
    };
    variants.extend([
        ("0040-coded-empty", ProgressiveMesh::default(), coded(q12, GROWING), "no vertices: no packet"),
        ("0041-coded-triangle", triangle(), coded(q12, GROWING), "one triangle: a base and nothing else"),
        ("0042-coded-border", bordered(40), coded(q12, GROWING), "a surface with a border"),
        (
            "0043-coded-irregular",
            ProgressiveMesh {
                wedges: Wedges { normals: Vec::new(), ..irregular(40).wedges },
                ..irregular(40)
            },
            coded(q12, GROWING),
            "pinched vertices, faces across, vertices without a face",
        ),
        (
            "0044-coded-not-manifold",
            not_manifold(),
            coded(q12, PacketSize::Fixed(3)),
            "three sheets on one edge, two components in a vertex, a vertex alone",
        ),
        ("0045-coded-one-packet", closed(60), coded(q12, PacketSize::Fixed(60)), "one packet"),
        (
            "0046-coded-many-packets",
            closed(24),
            coded(q12, PacketSize::Fixed(1)),
            "a packet for each vertex: models carry over",
        ),
        (
            "0047-coded-f32-zeros",
            zeros(),
            coded(Positions::F32, GROWING),
            "zeros of both signs, subnormal numbers",
        ),
        (
            "0048-coded-point",
            flat(closed(8), &[0, 1, 2]),
            coded(q12, GROWING),
            "a mesh without extent: all points are one",
        ),
        (
            "0049-coded-f32-point",
            flat(closed(8), &[0, 1, 2]),
            coded(Positions::F32, GROWING),
            "a mesh without extent, nothing lost",
        ),
        (
            "0050-coded-hub",
            hub(400),
            coded(q12, PacketSize::Fixed(400)),
            "a vertex with very many faces: the packet is as long as the work that it makes",
        ),
    ]);
    variants.push((
        "0055-coded-deep",
        chain(100),
        coded(Positions::Quantised(10), PacketSize::Fixed(100)),
        "a chain of vertices, each onto the one before, in one packet; more than raw packets may have of it",
    ));
    variants.extend(coded_attributes());
    variants
}

fn coded_attributes() -> Vec<Variant> {
    let coded = |packets| options(Mode::Coded, Positions::Quantised(12), packets);
    let materials = grown(5, Kind { vertices: 30, seams: true, ..Kind::default() });
    vec![
        (
            "0051-coded-attributes",
            all_attributes(40),
            coded(GROWING),
            "normals, texture coordinates, colours, materials, and seams between these, entropy coded",
        ),
        (
            "0052-coded-f32-attributes",
            all_attributes(24),
            EncodeOptions {
                positions: Positions::F32,
                normal_bits: 16,
                uv_bits: 4,
                ..coded(PacketSize::Fixed(5))
            },
            "the most bits for normals and the fewest for texture coordinates, beside positions of which nothing is lost",
        ),
        (
            "0053-coded-materials",
            materials,
            coded(GROWING),
            "two materials, and nothing else beside positions",
        ),
        (
            "0054-coded-normals",
            irregular(40),
            EncodeOptions { normal_bits: 4, ..coded(PacketSize::Fixed(1)) },
            "normals without seams, of the fewest bits, where faces are pinched and vertices have none",
        ),
        (
            "0057-coded-wedges",
            colour_by_face(),
            coded(PacketSize::Fixed(10)),
            "a tetrahedron, each face of another colour: three wedges at every vertex",
        ),
        (
            "0058-coded-no-faces",
            no_faces(),
            coded(PacketSize::Fixed(2)),
            "vertices that collapse, but no face",
        ),
        (
            "0059-coded-greatest",
            greatest(),
            options(Mode::Coded, Positions::Quantised(10), PacketSize::Fixed(3)),
            "positions up to the greatest number: the last point of an axis would lie beyond it",
        ),
        (
            "0070-coded-colours",
            colourful(40),
            coded(GROWING),
            "colours of which each part goes its own way, alpha too",
        ),
        (
            "0071-coded-f32-lowest",
            lowest(),
            options(Mode::Coded, Positions::F32, PacketSize::Fixed(3)),
            "the lowest number there is: its cell begins below all numbers",
        ),
        (
            "0072-coded-points",
            split(&[], &[]),
            coded(PacketSize::Fixed(3)),
            "a base without faces: their number is the last that is read",
        ),
    ]
}

/// A surface of any colours.
fn colourful(vertices: usize) -> ProgressiveMesh {
    let mut mesh = grown(6, Kind { vertices, colours: true, ..Kind::default() });
    for (n, colour) in (0..).zip(&mut mesh.wedges.colours) {
        *colour = [0, 1, 2, 3].map(|part| (splitmix64(6, 4 * n + part) >> (56 + 2 * (part % 2))) as u8);
    }
    mesh
}

/// A tetrahedron with a colour for each face.
fn colour_by_face() -> ProgressiveMesh {
    let faces: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut corners: Vec<(u32, u8)> = (0..).zip(faces).flat_map(|(k, face)| face.map(|v| (v, k))).collect();
    corners.sort_unstable();
    let wedge =
        |vertex: u32, face: u8| corners.iter().position(|&c| c == (vertex, face)).expect("a corner") as u32;
    let mut mesh = split(&[0], &[]);
    mesh.faces = (0..).zip(faces).map(|(k, face)| face.map(|v| wedge(v, k))).collect();
    mesh.wedges = Wedges {
        vertices: corners.iter().map(|c| c.0).collect(),
        colours: corners.iter().map(|c| [80 * c.1, 200 - 40 * c.1, c.1, 255]).collect(),
        ..Wedges::default()
    };
    // Wedges of vertex 3, of faces 1 to 3: all become one, with which face 2 goes on where the others vanish.
    mesh.wedge_collapse = vec![wedge(0, 1); 3];
    mesh
}

fn no_faces() -> ProgressiveMesh {
    split(&[0, 0, 2], &[])
}

/// A triangle from the lowest number to near the greatest, in cells of 2¹⁰⁹ m.
fn lowest() -> ProgressiveMesh {
    let mut mesh = split(&[], &[[0, 1, 2]]);
    mesh.positions = vec![[f32::MIN, 0.0, 0.0], [3e38, 1e30, 0.0], [-3.4e38, 0.0, f32::MIN]];
    mesh
}

/// A triangle in a box that ends, along the second axis, 1.6 steps behind its begin and at the greatest number.
fn greatest() -> ProgressiveMesh {
    let mut mesh = split(&[], &[[0, 1, 2]]);
    let low = (f64::from(f32::MAX) - 1.6 * 3e38 / 1023.0) as f32;
    mesh.positions = vec![[0.0, low, 0.0], [3e38, low, 0.0], [0.0, f32::MAX, 0.0]];
    mesh
}

/// A vertex from which three descend in one packet: a corner becomes the second of them, another the only one of its own.
pub(super) const DESCENDANTS: &str = "0016-raw-descendants";
/// Corners that pass as many vertices inside one packet as its bytes allow.
pub(super) const DEEP: &str = "0018-raw-deep";

/// A triangle, and vertices that collapse onto these; all errors are alike.
fn split(collapse: &[u32], faces: &[[u32; 3]]) -> ProgressiveMesh {
    let vertices = 3 + collapse.len() as u32;
    ProgressiveMesh {
        positions: (0..vertices).map(|v| [v as f32, (v * v % 7) as f32, (v % 3) as f32]).collect(),
        wedges: Wedges { vertices: (0..vertices).collect(), ..Wedges::default() },
        base_vertices: 3,
        collapse: collapse.to_vec(),
        wedge_collapse: collapse.to_vec(),
        errors: vec![0.5; collapse.len()],
        faces: faces.to_vec(),
        ..ProgressiveMesh::default()
    }
}

/// A fan whose vertices each collapse onto the one before.
fn chain(vertices: u32) -> ProgressiveMesh {
    let collapse: Vec<u32> = (2..vertices - 1).collect();
    let faces: Vec<[u32; 3]> = (2..vertices).map(|v| [0, v - 1, v]).collect();
    split(&collapse, &faces)
}

fn one_vertex() -> ProgressiveMesh {
    ProgressiveMesh {
        positions: vec![[1.0, 2.0, 3.0]],
        wedges: Wedges { vertices: vec![0], ..Wedges::default() },
        base_vertices: 1,
        ..ProgressiveMesh::default()
    }
}

fn raw_packets() -> Vec<Variant> {
    let raw = |vertices| options(Mode::Raw, Positions::F32, PacketSize::Fixed(vertices));
    vec![
        ("0014-raw-one-vertex", one_vertex(), raw(1), "one vertex: no parent, and no bits for any"),
        (
            "0015-raw-all-switch",
            split(&[0, 1, 2], &[[3, 4, 5]]),
            raw(3),
            "every corner of an earlier face switches in one packet",
        ),
        (
            DESCENDANTS,
            split(&[0, 3, 0, 1], &[[4, 6, 2], [0, 3, 6]]),
            options(Mode::Raw, Positions::F32, BASE_AND_REST),
            "three vertices that descend from one, and one that descends from another",
        ),
        (
            "0019-raw-apart",
            split(&[0, 1, 1], &[[0, 1, 2], [1, 2, 5]]),
            raw(1),
            "packets of a vertex without a face, in which nothing switches",
        ),
    ]
}

/// More slots than a reader may look at together, which ascend by ones.
pub(super) const MANY: &str = "0056-raw-many-slots";
const MANY_SLOTS: u32 = 260;

/// Vertices of [`DEEP`] that each collapse onto the one before, and faces of these.
const CHAIN: (u32, usize) = (60, 76);

/// A chain of vertices, each onto the one before, with corners near its end; what it has too much is taken off the last face.
fn deep() -> Vec<u8> {
    let (chain, faces) = CHAIN;
    let collapse: Vec<u32> = (2..2 + chain).collect();
    let shallow = [&[[0, 1, 2 + chain]][..], &vec![[0, 3, 4]; faces]].concat();
    let options = options(Mode::Raw, Positions::F32, BASE_AND_REST);
    let file = encode(&split(&collapse, &shallow), &options).expect("shallow corners");
    let end = 2 + chain;
    lie(&file, 1, |parts| {
        parts.corners = vec![[end, end - 1, end - 2]; faces];
        // Vertex v has the depth v - 2. The corner of the base that switches has that of the last vertex.
        let depth = |corner: &u32| corner - 2;
        let sum: u32 = parts.corners.as_flattened().iter().map(depth).sum::<u32>() + chain;
        let allowed = 8 * parts.payload().len() as u32;
        parts.corners[faces - 1][2] -= sum - allowed;
    })
}

/// Many faces on one triangle, each vertex of which splits into three: corners of some switch to one or the other of two.
fn many_slots() -> Vec<u8> {
    let (faces, end) = (180, 9);
    let first = Parts { arrays: vec![0; 3 * 12], corners: vec![[0, 1, 2]; faces], ..Parts::default() };
    let to: Vec<u32> = (0..MANY_SLOTS).map(|slot| slot / 2 % 2).collect();
    let second = Parts {
        switch_count: MANY_SLOTS,
        arrays: vec![0; 6 * 12],
        parents: vec![0, 1, 2, 0, 1, 2],
        parent_bits: bits_for(end),
        slots: (1..=MANY_SLOTS).collect(),
        of: 3 * faces as u32,
        switch_to: packed(&to, 1),
        ..Parts::default()
    };
    file_of(3, 0, &[(first, [3, 3, faces]), (second, [end as usize, end as usize, faces])])
}

/// Faces in another order than that of the levels that introduce them: PMESH-FACE-05 says when they are there.
fn out_of_order() -> Vec<u8> {
    let options = options(Mode::Raw, Positions::F32, PacketSize::Fixed(10));
    let file = encode(&bordered(20), &options).expect("a sound mesh");
    lie(&file, 1, |parts| parts.corners.reverse())
}

fn by_hand() -> Vec<Vector> {
    let list = [
        ("0017-raw-out-of-order", out_of_order(), "faces that are not sorted by their level of introduction"),
        (MANY, many_slots(), "so many corners switch that a reader may take them in blocks"),
        (DEEP, deep(), "corners that pass as many vertices as the bytes of their packet allow"),
    ];
    list.into_iter().map(|(name, file, why)| Vector::accepted(Format::Pmesh, name, file, why)).collect()
}

pub(super) fn accepted() -> Vec<Vector> {
    let variants = raw().into_iter().chain(raw_packets()).chain(raw_quantised()).chain(coded());
    let mut vectors: Vec<Vector> = variants
        .map(|(name, mesh, options, why)| {
            let file = encode(&mesh, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
            Vector::accepted(Format::Pmesh, name, file, why)
        })
        .collect();
    vectors.extend(by_hand());
    vectors.sort_by(|a, b| a.name.cmp(&b.name));
    vectors
}
