//! What must hold of writer and reader of `.pmesh` together, for any progressive mesh.

use crate::choices::Choices;
use crate::surfaces::{Kind, surface};
use pmesh_format::{
    Decoder, EncodeOptions, Event, IndexedMesh, Limits, Mode, PacketSize, Positions, ProgressiveMesh, Replay,
    Step, Wedges, check, encode,
};

/// Vertices, at most: what a mesh can get wrong shows in small ones.
const MOST_VERTICES: usize = 40;
/// Wedges of a vertex, at most: so many that switch codes have one, two and three bits.
const MOST_WEDGES: usize = 5;

/// A progressive mesh made of the bytes has the same levels after encoding and decoding, at every vertex count, from whichever
/// packet on.
///
/// # Panics
///
/// When that does not hold.
pub fn pmesh_roundtrip(data: &[u8]) {
    let mut choices = Choices::new(data);
    let options = choose_options(&mut choices);
    let mesh = choose_mesh(&mut choices);
    let file = encode(&mesh, &options).unwrap_or_else(|error| panic!("a sound mesh is refused: {error}"));
    assert_eq!(encode(&mesh, &options).as_ref(), Ok(&file), "encoded twice, and the bytes differ");
    assert_eq!(check(&file, &Limits::default()), Ok(()), "what the encoder wrote is refused");

    let positions = options.positions.quantised(&mesh.positions);
    let mesh = ProgressiveMesh { positions, wedges: options.quantised_wedges(&mesh.wedges), ..mesh };
    // Doing it twice changes nothing more, but for the rounding of which side of the box is the longest: half a unit in the
    // last place of the greatest coordinate in the step, and half of one in the result.
    let again = options.positions.quantised(&mesh.positions);
    let all = mesh.positions.as_flattened();
    let most = all.iter().fold(0.0f32, |most, x| most.max(x.abs())) * f32::EPSILON;
    assert!(all.iter().zip(again.as_flattened()).all(|(x, again)| (x - again).abs() <= most));
    assert_eq!(options.quantised_wedges(&mesh.wedges).normals, mesh.wedges.normals);
    let arranged = options.arranged(&mesh);
    let levels = expected_levels(&arranged);
    let mut decoder = Decoder::new(Limits::default());
    let mut replay = Replay::default();
    let mut rest = &file[..];
    while let Step::Consumed(used, event) = decoder.push(rest).expect("accepted before") {
        rest = &rest[used..];
        let before = replay.max_level();
        replay.accept(&event).expect("accepted before");
        if matches!(event, Event::Packet(_)) {
            assert!(replay.max_level() > before, "a packet without a vertex");
            compare_levels(&levels, mesh.base_vertices, &mut replay);
            // Inside a packet the order may be another one, but what a packet completes is what was given.
            let complete = replay.max_level();
            let [given, found] = [&mesh, &arranged].map(|mesh| triangles(&mesh.level(complete)));
            assert_eq!(given, found, "level {complete} has other faces than were given");
        }
    }
    assert_eq!(replay.max_level() as usize, mesh.positions.len());
    assert_eq!(replay.material_names(), mesh.material_names);
}

fn choose_options(choices: &mut Choices<'_>) -> EncodeOptions {
    let packets = match choices.byte() % 3 {
        0 => PacketSize::Fixed(u32::from(choices.byte() % 8)),
        1 => PacketSize::Growing {
            first: u32::from(choices.byte() % 16),
            percent: u32::from(choices.byte()),
            most: 1 + u32::from(choices.byte() % 16),
        },
        _ => EncodeOptions::default().packets,
    };
    let positions = Positions::ALL[usize::from(choices.byte()) % Positions::ALL.len()];
    let mode = Mode::ALL[usize::from(choices.byte()) % Mode::ALL.len()];
    EncodeOptions { packets, positions, mode, ..EncodeOptions::new() }
}

/// The faces of a level by the positions of their corners, in an order that depends on nothing else.
fn triangles(mesh: &IndexedMesh) -> Vec<[[u32; 3]; 3]> {
    let corner = |wedge: u32| mesh.positions[mesh.wedges.vertices[wedge as usize] as usize].map(f32::to_bits);
    let turned = |face: &[u32; 3]| {
        let [a, b, c] = face.map(corner);
        [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().expect("three ways")
    };
    let mut triangles: Vec<_> = mesh.triangles.iter().map(turned).collect();
    triangles.sort_unstable();
    triangles
}

/// A surface, or any mesh whose tables are valid.
fn choose_mesh(choices: &mut Choices<'_>) -> ProgressiveMesh {
    let flags = choices.byte();
    if flags & 1 == 0 {
        return choose_tables(choices);
    }
    let kind = Kind {
        vertices: 3 + choices.below(MOST_VERTICES - 2),
        bordered: flags & 2 != 0,
        normals: flags & 4 != 0,
        uvs: flags & 8 != 0,
        colours: flags & 16 != 0,
        seams: flags & 32 != 0,
        irregular: flags & 64 != 0,
    };
    surface(kind, |bound| choices.below(bound))
}

/// Any mesh whose tables are valid; most are no surface.
fn choose_tables(choices: &mut Choices<'_>) -> ProgressiveMesh {
    let vertices = choices.below(MOST_VERTICES + 1);
    let base = if vertices == 0 { 0 } else { 1 + choices.below(vertices) };
    let flags = choices.byte();
    let collapse: Vec<u32> = (base..vertices).map(|vertex| choices.below(vertex) as u32).collect();

    // Several wedges only where something can differ.
    let most_wedges = if flags & 0b111 == 0 { 1 } else { 1 + choices.below(MOST_WEDGES) };
    let counts: Vec<usize> = (0..vertices).map(|_| 1 + choices.below(most_wedges)).collect();
    let starts: Vec<usize> =
        counts.iter().scan(0, |end, count| Some(std::mem::replace(end, *end + count))).collect();
    let wedge_vertices: Vec<u32> =
        (0..).zip(&counts).flat_map(|(vertex, &count)| std::iter::repeat_n(vertex, count)).collect();
    let wedge_collapse = (base..vertices)
        .flat_map(|vertex| std::iter::repeat_n(collapse[vertex - base] as usize, counts[vertex]))
        .map(|parent| (starts[parent] + choices.below(counts[parent])) as u32)
        .collect();
    let wedges = wedge_vertices.len();

    let mut errors: Vec<f32> = (base..vertices).map(|_| choices.finite().abs()).collect();
    errors.sort_by(|a, b| b.total_cmp(a));
    let positions = (0..vertices).map(|_| [0; 3].map(|_| choices.finite())).collect();
    let normals = optional(flags & 1 != 0, wedges, || [0; 3].map(|_| choices.finite()));
    let uvs = optional(flags & 2 != 0, wedges, || [0; 2].map(|_| choices.finite()));
    let colours = optional(flags & 4 != 0, wedges, || choices.word().to_le_bytes());

    let faces: Vec<[u32; 3]> = if vertices < 3 {
        Vec::new()
    } else {
        let count = choices.below(3 * vertices);
        let corners = (0..count).map(|_| [0; 3].map(|_| choices.below(wedges) as u32));
        corners.filter(|face| are_distinct(face.map(|wedge| wedge_vertices[wedge as usize]))).collect()
    };
    let materials = optional(flags & 8 != 0, faces.len(), || u16::from(choices.byte() % 3));
    let names = ["", "stone", "glæs"];
    let material_names = names[..usize::from(flags >> 4) % 4].iter().map(|&name| name.to_owned()).collect();
    ProgressiveMesh {
        origin: [0; 3].map(|_| f64::from(choices.finite())),
        positions,
        wedges: Wedges { vertices: wedge_vertices, normals, uvs, colours },
        base_vertices: base as u32,
        collapse,
        wedge_collapse,
        errors,
        faces,
        materials,
        material_names,
    }
}

fn optional<T>(present: bool, count: usize, mut choose: impl FnMut() -> T) -> Vec<T> {
    if present { (0..count).map(|_| choose()).collect() } else { Vec::new() }
}

fn are_distinct([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Every level from the coarsest on, by mapping each face of the source through the tables.
fn expected_levels(source: &ProgressiveMesh) -> Vec<IndexedMesh> {
    (source.base_vertices..=source.positions.len() as u32)
        .map(|level| {
            let mut expected = source.level(level);
            // A file does not say that every face has material 0.
            if source.materials.iter().all(|&material| material == 0) {
                expected.materials.clear();
            }
            expected
        })
        .collect()
}

/// Every level that is there is as expected.
fn compare_levels(expected: &[IndexedMesh], coarsest: u32, replay: &mut Replay) {
    let levels = replay.levels().expect("a packet is in");
    assert_eq!(*levels.start(), coarsest);
    for level in levels.rev() {
        replay.set_level(level).expect("a level that is there");
        assert_eq!(replay.mesh(), expected[(level - coarsest) as usize], "level {level}");
    }
}
