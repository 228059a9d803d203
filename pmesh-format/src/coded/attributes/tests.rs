use std::vec;
use std::vec::Vec;

use ivg_wire::splitmix64;

use super::Weights;
use crate::code::codes;
use crate::coded::tests::{damaged_record, options};
use crate::decode::decode_packet;
use crate::encode::{EncodeOptions, encode};
use crate::mesh::{IndexedMesh, Wedges};
use crate::progressive::ProgressiveMesh;
use crate::replay::Replay;
use crate::storage::{Mode, Positions};
use crate::tests::{Kind, expected, random_mesh, replay_all};

/// An indexed mesh with the obvious order: each vertex, the last first, onto the nearest earlier one that it shares a face with by
/// then, one without faces onto vertex 0; each wedge becomes the one that a face beside it has there.
fn ordered(mesh: IndexedMesh) -> ProgressiveMesh {
    let vertex_of = mesh.wedges.vertices.clone();
    let count = mesh.positions.len() as u32;
    let vertex = |w: u32| vertex_of[w as usize];
    let mut present = mesh.triangles.clone();
    let (mut collapse, mut wedge_collapse) = (Vec::new(), vec![0; vertex_of.len()]);
    let base = count.min(3);
    for v in (base..count).rev() {
        let with = |face: &&[u32; 3]| face.iter().any(|&w| vertex(w) == v);
        let others = present.iter().filter(with).flatten().map(|&w| vertex(w)).filter(|&w| w < v);
        let apart = |w: u32| {
            let [a, b] = [v, w].map(|v| mesh.positions[v as usize]);
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f32>()
        };
        let parent = others.min_by(|&a, &b| apart(a).total_cmp(&apart(b)).then(a.cmp(&b))).unwrap_or(0);
        collapse.push(parent);
        let first = vertex_of.iter().position(|&other| other == parent).unwrap() as u32;
        for wedge in (0..vertex_of.len() as u32).filter(|&w| vertex(w) == v) {
            let beside = present.iter().filter(|face| face.contains(&wedge)).flatten();
            let target = beside.copied().find(|&w| vertex(w) == parent).unwrap_or(first);
            wedge_collapse[wedge as usize] = target;
        }
        for face in &mut present {
            *face = face.map(|w| if vertex(w) == v { wedge_collapse[w as usize] } else { w });
        }
        present.retain(|face| {
            let [a, b, c] = face.map(vertex);
            a != b && b != c && c != a
        });
    }
    collapse.reverse();
    let base_wedges = vertex_of.iter().position(|&v| v == base).unwrap_or(vertex_of.len());
    ProgressiveMesh {
        origin: mesh.origin,
        positions: mesh.positions,
        wedges: mesh.wedges,
        base_vertices: base,
        errors: vec![0.5; collapse.len()],
        collapse,
        wedge_collapse: wedge_collapse.split_off(base_wedges),
        faces: mesh.triangles,
        materials: mesh.materials,
        material_names: mesh.material_names,
    }
}

/// A grid on a surface, wedges numbered as `wedge` says: whatever differs there is a seam.
fn sheet(
    [width, height]: [u32; 2],
    round: bool,
    point: impl Fn(f32, f32) -> [f32; 3],
    attributes: impl Fn(f32, f32, u32) -> ([f32; 3], [f32; 2], [u8; 4], u32),
) -> ProgressiveMesh {
    let columns = if round { width } else { width + 1 };
    let count = columns * (height + 1);
    let mut order: Vec<u32> = (0..count).collect();
    order.sort_by_key(|&v| splitmix64(77, v.into()));
    let mut number = vec![0; count as usize];
    for (new, &old) in (0u32..).zip(&order) {
        number[old as usize] = new;
    }
    // A corner: its vertex and what it has there; equal ones are one wedge.
    let mut corners: Vec<(u32, [u32; 10])> = Vec::new();
    let mut materials = Vec::new();
    let mut positions = vec![[0.0; 3]; count as usize];
    for cell in 0..width * height {
        let (x, y) = (cell % width, cell / width);
        let at = [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]];
        for face in [[0, 1, 2], [0, 2, 3]] {
            for corner in face {
                let [column, row] = at[corner];
                let vertex = number[(row * columns + column % columns) as usize];
                let (s, t) = (column as f32 / width as f32, row as f32 / height as f32);
                positions[vertex as usize] = point(if round { s % 1.0 } else { s }, t);
                let (normal, uv, colour, _) = attributes(s, t, cell);
                let mut key = [0; 10];
                normal.iter().chain(&uv).map(|x| x.to_bits()).enumerate().for_each(|(k, x)| key[k] = x);
                colour.iter().enumerate().for_each(|(k, &x)| key[5 + k] = x.into());
                corners.push((vertex, key));
            }
            materials.push(attributes(x as f32, y as f32, cell).3 as u16);
        }
    }
    let mut wedges = corners.clone();
    wedges.sort_unstable();
    wedges.dedup();
    let place = |corner: &(u32, [u32; 10])| wedges.binary_search(corner).unwrap() as u32;
    let triangles =
        corners.chunks(3).map(|face| [place(&face[0]), place(&face[1]), place(&face[2])]).collect();
    let f = f32::from_bits;
    ordered(IndexedMesh {
        origin: [0.0; 3],
        positions,
        wedges: Wedges {
            vertices: wedges.iter().map(|w| w.0).collect(),
            normals: wedges.iter().map(|w| [f(w.1[0]), f(w.1[1]), f(w.1[2])]).collect(),
            uvs: wedges.iter().map(|w| [f(w.1[3]), f(w.1[4])]).collect(),
            colours: wedges.iter().map(|w| core::array::from_fn(|k| w.1[5 + k] as u8)).collect(),
        },
        triangles,
        materials,
        material_names: Vec::new(),
    })
}

/// A cylinder whose texture coordinates jump at one line, with two materials.
fn cylinder() -> ProgressiveMesh {
    let turn = |s: f32| (s * core::f32::consts::TAU).sin_cos();
    let point = |s: f32, t: f32| {
        let (y, x) = turn(s);
        [x, y, 3.0 * t]
    };
    sheet([16, 8], true, point, |s, t, cell| {
        let (y, x) = turn(s % 1.0);
        let shade = (t * 200.0) as u8;
        ([x, y, 0.0], [s, t], [shade, shade, shade, 255], u32::from(cell / 16 >= 4) * 300)
    })
}

/// Steps with hard edges, three charts that meet in points, a colour for each chart, and many materials.
fn steps() -> ProgressiveMesh {
    let height = |s: f32, t: f32| if s < 0.5 { 0.0 } else { 0.3 + (t - 0.4) * t * 0.3 };
    sheet(
        [12, 10],
        false,
        |s, t| [s, t, height(s, t)],
        |s, t, cell| {
            let (x, y) = (cell % 12, cell / 12);
            let chart = u32::from(x >= 6) + u32::from(x >= 6 && y >= 5);
            let normal = [[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, -0.6, -0.8]][chart as usize];
            let uv = [s * 0.3 + chart as f32 * 0.4, t * 0.7 - chart as f32];
            (
                normal,
                uv,
                [(chart * 90) as u8, (x * 9) as u8, (y * 20) as u8, 255 - chart as u8],
                (x / 3) * 7 + chart,
            )
        },
    )
}

/// A closed surface with its own normals and no seams: colours alone differ smoothly.
fn smooth() -> ProgressiveMesh {
    let point = |s: f32, t: f32| {
        let (b, a) = (s * core::f32::consts::TAU).sin_cos();
        let (d, c) = (t * 3.0 + 0.07).sin_cos();
        [a * d, b * d, c]
    };
    sheet([20, 14], true, point, |s, t, _| {
        let [x, y, z] = point(s % 1.0, t);
        ([x, y, z], [x * 0.5, z], [(x * 100.0 + 120.0) as u8, (y * 100.0 + 120.0) as u8, 7, 255], 0)
    })
}

/// Meshes with all attributes, seams of every kind, and random tables.
fn meshes() -> Vec<ProgressiveMesh> {
    let mut meshes = vec![cylinder(), steps(), smooth()];
    for seed in 0..30 {
        let kind = Kind { vertices: 1 + seed as usize * 2, seams: seed % 3 != 0, materials: seed % 2 == 0 };
        let mut mesh = random_mesh(seed, kind);
        let wedges = mesh.wedges.len() as u64;
        let part = |w: u64, k: u64| (splitmix64(seed + k, w) % 2001) as f32 / 1000.0 - 1.0;
        mesh.wedges.normals = (0..wedges).map(|w| [part(w, 1), part(w, 2), part(w, 3)]).collect();
        mesh.wedges.uvs = (0..wedges).map(|w| [part(w, 4) * 9.0, part(w, 5) * 1e-3]).collect();
        mesh.wedges.colours = (0..wedges).map(|w| (splitmix64(seed, w) as u32).to_le_bytes()).collect();
        meshes.push(mesh);
    }
    meshes
}

/// The mesh with some of its attributes: bit 0 normals, 1 texture coordinates, 2 colours, 3 materials.
fn with(mesh: &ProgressiveMesh, which: u32) -> ProgressiveMesh {
    let mut mesh = mesh.clone();
    let has = |bit: u32| which >> bit & 1 == 1;
    if !has(0) {
        mesh.wedges.normals.clear();
    }
    if !has(1) {
        mesh.wedges.uvs.clear();
    }
    if !has(2) {
        mesh.wedges.colours.clear();
    }
    if !has(3) {
        mesh.materials.clear();
    }
    if which & 7 == 0 && mesh.wedges.len() > mesh.positions.len() {
        // Without attributes of wedges there is one a vertex.
        let vertex =
            |wedges: &[u32]| wedges.iter().map(|&w| mesh.wedges.vertices[w as usize]).collect::<Vec<_>>();
        let faces: Vec<u32> = vertex(mesh.faces.as_flattened());
        mesh.faces = faces.as_chunks().0.to_vec();
        mesh.wedge_collapse = mesh.collapse.clone();
        mesh.wedges.vertices = (0..mesh.positions.len() as u32).collect();
    }
    mesh
}

fn bits<const N: usize>(all: &[[f32; N]]) -> Vec<[u32; N]> {
    all.iter().map(|x| x.map(f32::to_bits)).collect()
}

fn compare(mesh: &ProgressiveMesh, options: &EncodeOptions, file: &[u8]) {
    let mut arranged = options.arranged(mesh);
    arranged.positions = options.positions.quantised(&arranged.positions);
    arranged.wedges = options.quantised_wedges(&arranged.wedges);
    let mut replay = replay_all(file);
    for level in (mesh.base_vertices..=mesh.positions.len() as u32).rev() {
        replay.set_level(level).unwrap();
        let (found, expected) = (replay.mesh(), expected(&arranged, level));
        assert_eq!(found.triangles, expected.triangles, "level {level}");
        assert_eq!(found.materials, expected.materials, "level {level}");
        assert_eq!(found.wedges.vertices, expected.wedges.vertices, "level {level}");
        assert_eq!(bits(&found.wedges.normals), bits(&expected.wedges.normals), "level {level}");
        assert_eq!(bits(&found.wedges.uvs), bits(&expected.wedges.uvs), "level {level}");
        assert_eq!(found.wedges.colours, expected.wedges.colours, "level {level}");
        assert_eq!(bits(&found.positions), bits(&expected.positions), "level {level}");
    }
}

#[test]
fn every_level_has_the_wedges_of_the_arranged_mesh() {
    for (k, mesh) in meshes().iter().enumerate() {
        for (positions, size) in
            [(Positions::F32, 7), (Positions::Quantised(11), 1), (Positions::Quantised(14), 60)]
        {
            let bits = 4 + (k as u8 * 5 + size as u8) % 13;
            let options = EncodeOptions { normal_bits: bits, uv_bits: 20 - bits, ..options(positions, size) };
            compare(mesh, &options, &encode(mesh, &options).unwrap());
        }
    }
}

#[test]
fn every_choice_of_attributes_comes_back() {
    for mesh in [cylinder(), steps(), smooth()] {
        for which in 0..16 {
            let mesh = with(&mesh, which);
            let options = options(Positions::Quantised(12), 40);
            let file = encode(&mesh, &options).unwrap();
            let attributes = replay_all(&file).header().attributes;
            assert_eq!(attributes.normals, which & 1 != 0);
            assert_eq!(attributes.materials, which & 8 != 0 && mesh.materials.iter().any(|&m| m != 0));
            compare(&mesh, &options, &file);
        }
    }
}

/// Meshes above have what they are there for.
#[test]
fn the_meshes_have_seams_of_every_kind() {
    let most = |mesh: &ProgressiveMesh| {
        let mut counts = vec![0; mesh.positions.len()];
        mesh.wedges.vertices.iter().for_each(|&v| counts[v as usize] += 1);
        counts.into_iter().max().unwrap()
    };
    assert_eq!((most(&cylinder()), most(&steps()), most(&smooth())), (2, 4, 1));
    assert!(cylinder().materials.contains(&300));
    assert!(cylinder().collapse.len() > 100 && steps().collapse.len() > 100 && smooth().collapse.len() > 200);
}

/// Quantised texture coordinates are at most half a step off along each axis, and what was quantised stays (PMESH-COD-17); the
/// rounding to binary32 adds half a unit in the last place. Normals: see the tests of the octahedron.
#[test]
fn values_are_quantised_once_and_by_no_more_than_half_a_step() {
    let mesh = steps();
    let options = EncodeOptions { uv_bits: 9, ..options(Positions::F32, 50) };
    let once = options.quantised_wedges(&mesh.wedges);
    let all = |k: usize| mesh.wedges.uvs.iter().map(move |uv| uv[k]);
    let extent = |k: usize| all(k).fold(f32::MIN, f32::max) - all(k).fold(f32::MAX, f32::min);
    let step = f64::from(extent(0).max(extent(1))) / 511.0;
    let mut worst = 0.0f64;
    for (a, b) in mesh.wedges.uvs.as_flattened().iter().zip(once.uvs.as_flattened()) {
        worst = worst.max(f64::from(a - b).abs());
    }
    assert!(worst <= 0.5 * step + 1e-6 && worst > 0.4 * step, "{worst} of {step}");
    assert_eq!(once.colours, mesh.wedges.colours);
    // Texture coordinates that a lattice cannot reach with finite numbers are brought to the last that is.
    let far = Wedges { uvs: vec![[-f32::MAX, f32::MAX], [f32::MAX, -f32::MAX * 0.93]], ..Wedges::default() };
    for uv_bits in 4..=16 {
        let found = EncodeOptions { uv_bits, ..options }.quantised_wedges(&far).uvs;
        assert!(found.as_flattened().iter().all(|x| x.is_finite()), "{uv_bits} bits: {found:?}");
    }
    let twice = options.quantised_wedges(&once);
    assert_eq!(bits(&once.normals), bits(&twice.normals));
    let raw = EncodeOptions { mode: Mode::Raw, ..options };
    assert_eq!(raw.quantised_wedges(&mesh.wedges), mesh.wedges);
}

#[test]
fn attributes_take_less_than_a_third_of_their_raw_bytes() {
    let mesh = smooth();
    let coded = options(Positions::Quantised(12), 100);
    let bytes = |mesh: &ProgressiveMesh, options: &EncodeOptions| encode(mesh, options).unwrap().len();
    let raw = EncodeOptions { mode: Mode::Raw, ..coded };
    let attributes = |options| bytes(&mesh, options) - bytes(&with(&mesh, 0), options);
    let (coded, raw) = (attributes(&coded), attributes(&raw));
    assert!(coded * 3 < raw, "{coded} of {raw}");
}

/// Connectivity of wedges and materials, without values: colours that are all the same cost next to nothing.
#[test]
fn seams_and_materials_cost_little_where_they_go_on() {
    let mesh = cylinder();
    let coded = options(Positions::Quantised(12), 1000);
    let bytes = |mesh: &ProgressiveMesh| encode(mesh, &coded).unwrap().len();
    let mut flat = with(&mesh, 4);
    flat.wedges.colours = vec![[9; 4]; mesh.wedges.len()];
    let (none, seams) = (bytes(&with(&mesh, 0)), bytes(&flat));
    // The base, 4 bytes a wedge; of 144 vertices nine are on the seam, and wedges of the others have to be told from them.
    let base = 4 * mesh.base_wedges();
    assert!(seams <= none + base + 40, "{seams} of {none} and {base}");
    // 256 faces of two materials, whose border has 16 edges.
    let materials = bytes(&with(&mesh, 8));
    assert!(materials <= none + 2 * mesh.faces.len() / 8, "{materials} of {none}");
}

/// Neighbours in a plane and values that are linear there give the value of the place, up to what whole numbers round off. Values
/// differ by less than 4,000 and weights are too small by less than 1 / 2¹⁰ each; coordinates of up to eleven bits are cut by less
/// than 8, which is 16 for the steepest value, once for the place and, with the sum of weights, twice for the neighbours; then 1.
#[test]
fn what_is_linear_in_positions_is_expected() {
    for seed in 0..200u64 {
        let part = |k: u64| (splitmix64(seed, k) % 2001) as i32 - 1000;
        let count = 6 + seed % 5;
        let cells: Vec<[i32; 3]> = (0..count).map(|k| [part(2 * k), part(2 * k + 1), 70]).collect();
        let mean = |axis: usize| cells.iter().map(|c| c[axis]).sum::<i32>() / cells.len() as i32;
        let here = [mean(0) + part(91) / 3, mean(1) + part(92) / 3, 90];
        let value = |[x, y, _]: [i32; 3]| [3000 + x / 2 + y / 4, 9, x - y];
        let weights = Weights::new(&cells, here, [0, -1, 5]);
        let expected = weights.expected(|k| value(cells[k]));
        for (found, right) in expected.into_iter().zip(value(here)) {
            let most = 4000 * count as i64 / 1024 + 3 * 16 + 1;
            assert!((found - i64::from(right)).abs() <= most, "seed {seed}: {found} for {right}");
        }
        assert_eq!(expected[1], 9);
    }
    // In a line nothing is fitted, and far outside neither: the mean.
    let line = [[0, 0, 0], [10, 10, 0], [20, 20, 0], [30, 30, 0]];
    let values = |k: usize| [[0], [1], [1], [4]][k];
    assert_eq!(Weights::new(&line, [30, 30, 0], [0, 0, 1]).expected(values), [2]);
    let small = [[0, 0, 0], [30, 0, 0], [0, 30, 0]];
    assert_eq!(Weights::new(&small, [90, 90, 0], [0, 0, 1]).expected(values), [1]);
    let [found] = Weights::new(&small, [0, 30, 0], [0, 0, 1]).expected(|k| [[5], [7], [93]][k]);
    assert!((92..=94).contains(&found), "{found}");
}

/// Whatever changes the symbols changes these: lengths and sums of files with everything, whose meshes are made of sums and
/// products alone.
#[test]
fn the_bytes_of_attributes_are_pinned() {
    let sums = [steps(), meshes().pop().unwrap()].map(|mesh| {
        let file = encode(&mesh, &options(Positions::Quantised(12), 50)).unwrap();
        let sum = file.iter().fold(0u64, |sum, &byte| splitmix64(sum, byte.into()));
        (file.len(), sum)
    });
    assert_eq!(sums, PINNED);
}

/// Lengths of the files, and what `splitmix64` makes of their bytes in turn.
const PINNED: [(usize, u64); 2] = [(3592, 10528927190577734719), (2196, 3099553181196321315)];

#[test]
fn a_packet_that_fails_in_its_attributes_changes_nothing() {
    let mut refused = Vec::new();
    let last = || meshes().pop().unwrap();
    for (mesh, size, seeds) in [(steps(), 30, 120), (cylinder(), 30, 120), (last(), 30, 120), (last(), 1, 20)]
    {
        let file = encode(&mesh, &options(Positions::Quantised(12), size)).unwrap();
        let whole = replay_all(&file);
        let header = whole.header().clone();
        for index in 0..header.packet_count() {
            let entry = &header.packets[index as usize];
            let record = &file[entry.bytes.start as usize..entry.bytes.end as usize];
            let mut replay = Replay::new(&header);
            for k in 0..index {
                let range = header.packets[k as usize].bytes.clone();
                let bytes = &file[range.start as usize..range.end as usize];
                replay.apply(&decode_packet(&header, k, bytes).unwrap()).unwrap();
            }
            let before = replay.mesh();
            for seed in 0..seeds {
                let bytes =
                    damaged_record(&header, index, &record[8..8 + entry.payload_bytes as usize], seed);
                let mut damaged = replay.clone();
                if let Err(error) = damaged.apply(&decode_packet(&header, index, &bytes).unwrap()) {
                    refused.push(error.code());
                    assert!(damaged.mesh() == before, "packet {index} seed {seed}");
                    // Models too: the right packet, and all that follow, say what they said.
                    for k in index..header.packet_count() {
                        let range = header.packets[k as usize].bytes.clone();
                        let bytes = &file[range.start as usize..range.end as usize];
                        damaged.apply(&decode_packet(&header, k, bytes).unwrap()).unwrap();
                    }
                    assert!(damaged.mesh() == whole.mesh(), "packet {index} seed {seed}");
                }
            }
        }
    }
    refused.sort_unstable();
    refused.dedup();
    let all = [
        codes::ATTRIBUTE,
        codes::CORNER,
        codes::SWITCH,
        codes::WEDGE_COUNT,
        codes::WEDGE_TARGET,
        codes::CODED_LENGTH,
    ];
    for code in all {
        assert!(refused.contains(&code.number()), "{code:?} of {refused:?}");
    }
}

/// Every kind of value is judged, whatever else there is.
#[test]
fn values_out_of_range_are_refused_of_every_kind() {
    for which in [1, 2, 4] {
        let file = encode(&with(&smooth(), which), &options(Positions::Quantised(12), 300)).unwrap();
        let header = replay_all(&file).header().clone();
        let entry = &header.packets[0];
        let record = &file[entry.bytes.start as usize..entry.bytes.end as usize];
        let refused = (0..400u64).any(|seed| {
            let mut payload = record[8..8 + entry.payload_bytes as usize].to_vec();
            let at = payload.len() / 2 + splitmix64(seed, 1) as usize % (payload.len() / 2);
            payload[at] ^= 1 << (seed % 8);
            let mut bytes = Vec::new();
            ivg_wire::write_record(&mut bytes, 0, 0, &payload, header.content_id);
            let result = Replay::new(&header).apply(&decode_packet(&header, 0, &bytes).unwrap()).map(drop);
            result.is_err_and(|error| error.code() == codes::ATTRIBUTE.number())
        });
        assert!(refused, "attributes {which}");
    }
}
