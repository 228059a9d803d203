use ivg_format::{EncodeOptions, Encoding, GridSource, Lattice, Order};
use ivg_grid::{FillOptions, IrradianceGrid, fill};
use pmesh_format::{IndexedMesh, Mode, ProgressiveMesh};
use quickcheck::quickcheck;

use super::*;
use crate::client::download::Arrived;

fn grid_file() -> Vec<u8> {
    let lattice = Lattice::new([3, 5, 4], [0.0; 3], [1.0, 2.0, 3.0]).unwrap();
    let vectors: Vec<_> = (0..60).map(|i| [[[i as f32, 0.5, 0.25]; 3]; 6]).collect();
    let validity: Vec<u8> = (0..60).map(|i| i * 4).collect();
    let mut source = GridSource::new(lattice, &vectors);
    source.validity = Some(&validity);
    let options = EncodeOptions { vertices_per_slice: 2, ..EncodeOptions::default() };
    ivg_format::encode(&source, &options).unwrap()
}

/// The same lattice with radiance harmonics.
fn radiance_file() -> Vec<u8> {
    let lattice = Lattice::new([3, 5, 4], [0.0; 3], [1.0, 2.0, 3.0]).unwrap();
    let radiance: Vec<_> =
        (0..60).map(|i| [[i as f32 + 1.0, 0.5, 0.25, 0.0, -0.5, 0.1, 0.2, 0.3, 0.4]; 3]).collect();
    let options =
        EncodeOptions { encoding: Encoding::Sh2, vertices_per_slice: 2, ..EncodeOptions::default() };
    ivg_format::encode(&GridSource::new(lattice, &radiance), &options).unwrap()
}

/// The same lattice in the order explicit: vertices inside geometry are in no bundle.
fn explicit_file() -> Vec<u8> {
    let lattice = Lattice::new([3, 5, 4], [0.0; 3], [1.0, 2.0, 3.0]).unwrap();
    let vectors: Vec<_> = (0..60).map(|i| [[[i as f32, 0.5, 0.25]; 3]; 6]).collect();
    let validity: Vec<u8> = (0..60).map(|i| if i % 7 == 3 { 0 } else { 255 }).collect();
    let corners: Vec<u64> = lattice.corners().collect();
    let bring = |vertex: &u64| validity[*vertex as usize] > 0 && !corners.contains(vertex);
    let vertices: Vec<u64> = (0..60).filter(bring).collect();
    let bundles: Vec<Vec<u64>> = vertices.chunks(8).rev().map(<[u64]>::to_vec).collect();
    let mut source = GridSource::new(lattice, &vectors);
    source.validity = Some(&validity);
    source.bundles = Some(&bundles);
    let options = EncodeOptions { order: Order::Explicit, vertices_per_slice: 2, ..EncodeOptions::default() };
    ivg_format::encode(&source, &options).unwrap()
}

/// A fan whose last vertex always collapses onto the one before it.
fn mesh_file() -> Vec<u8> {
    mesh_file_as(Mode::Raw)
}

/// The same, entropy coded.
fn coded_mesh_file() -> Vec<u8> {
    mesh_file_as(Mode::Coded)
}

fn mesh_file_as(mode: Mode) -> Vec<u8> {
    let count = 400;
    let positions = (0..count).map(|v| [v as f32, (v * v) as f32, 0.0]).collect();
    let full = IndexedMesh::from_positions(positions, (2..count).map(|v| [0, v - 1, v]).collect());
    let mesh = ProgressiveMesh {
        positions: full.positions,
        wedges: full.wedges,
        base_vertices: 3,
        collapse: (2..count - 1).collect(),
        wedge_collapse: (2..count - 1).collect(),
        errors: vec![0.0; count as usize - 3],
        faces: full.triangles,
        ..ProgressiveMesh::default()
    };
    let options = pmesh_format::EncodeOptions { mode, ..pmesh_format::EncodeOptions::fixed(70) };
    pmesh_format::encode(&mesh, &options).unwrap()
}

fn begin<C: Contents>(contents: C, file: &[u8]) -> Download<C> {
    Download::new(FileEntry::of("file".into(), file), contents)
}

/// Feeds a file cut at the given places; whether it arrived whole.
fn arrives<C: Contents>(download: &mut Download<C>, file: &[u8], cuts: &[usize]) -> bool {
    let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut % (file.len() + 1)).collect();
    cuts.extend([0, file.len()]);
    cuts.sort_unstable();
    let mut complete = false;
    for pair in cuts.windows(2) {
        let piece = &file[pair[0]..pair[1]];
        download
            .receive(piece, &mut |event| complete |= event == Arrived::Complete { matches: true })
            .unwrap();
    }
    complete
}

quickcheck! {
    fn a_grid_cut_anywhere_is_the_grid_of_the_file(cuts: Vec<usize>) -> bool {
        let file = grid_file();
        let (whole, _) = IrradianceGrid::from_file(&file, &ivg_format::Limits::default()).unwrap();
        let expected = fill(&whole, &FillOptions::default());
        let mut download = begin(GridContents::new(1000), &file);
        arrives(&mut download, &file, &cuts) && download.contents.grid() == Some(&expected)
    }

    fn a_grid_of_radiance_cut_anywhere_is_the_grid_of_the_file(cuts: Vec<usize>) -> bool {
        let file = radiance_file();
        let (whole, _) = IrradianceGrid::from_file(&file, &ivg_format::Limits::default()).unwrap();
        let expected = fill(&whole, &FillOptions::default());
        let mut download = begin(GridContents::new(1000), &file);
        arrives(&mut download, &file, &cuts) && download.contents.grid() == Some(&expected)
    }

    fn an_explicit_grid_cut_anywhere_is_the_grid_of_the_file(cuts: Vec<usize>) -> bool {
        let file = explicit_file();
        let (whole, _) = IrradianceGrid::from_file(&file, &ivg_format::Limits::default()).unwrap();
        let expected = fill(&whole, &FillOptions::default());
        let mut download = begin(GridContents::new(1000), &file);
        arrives(&mut download, &file, &cuts)
            && download.contents.grid() == Some(&expected)
            && download.vertices() < expected.vertex_count() as u64
            && download.share() == 1.0
    }

    fn a_mesh_cut_anywhere_is_the_mesh_of_the_file(cuts: Vec<usize>, coded: bool) -> bool {
        let file = if coded { coded_mesh_file() } else { mesh_file() };
        let expected = read_mesh(&file, &SceneLimits::default()).unwrap().mesh();
        let mut download = begin(MeshContents::new(1000), &file);
        arrives(&mut download, &file, &cuts)
            && download.contents.replay().map(Replay::mesh) == Some(expected)
    }
}

/// After each prefix of a file: nothing before header and chunks are in, then whole parts only, and the next
/// request begins where the bytes end.
fn states_after_each_length<C: Contents>(fresh: impl Fn() -> C, file: &[u8]) {
    let whole = begin(fresh(), file);
    let mut download = begin(fresh(), file);
    let (mut ends, mut vertices) = (Vec::new(), 0);
    for (length, byte) in (1..).zip(file) {
        download
            .receive(&[*byte], &mut |event| {
                if let Arrived::Part { vertices, .. } = event {
                    ends.push((length, vertices));
                }
            })
            .unwrap();
        if !download.is_complete() {
            assert_eq!(download.next_range(1.0, 100, 100).start, length);
        }
        vertices = vertices.max(download.vertices());
        assert_eq!(download.vertices(), vertices);
        assert_eq!(download.is_complete(), length == file.len() as u64);
    }
    assert_eq!(whole.vertices(), 0);
    // Every part was reported with its last byte.
    for (index, &(end, _)) in (0..).zip(&ends) {
        assert_eq!(download.contents.part(index).unwrap().end, end);
    }
    assert_eq!(download.contents.part(ends.len() as u32), None);
    assert_eq!(Some(vertices), download.contents.vertices());
}

#[test]
fn parts_count_once_they_are_whole() {
    states_after_each_length(|| GridContents::new(1000), &grid_file());
    states_after_each_length(|| GridContents::new(1000), &explicit_file());
    states_after_each_length(|| MeshContents::new(1000), &mesh_file());
    states_after_each_length(|| MeshContents::new(1000), &coded_mesh_file());
}

/// Every flipped byte is noticed by the end of its part, and right bytes then go on from there.
fn flips_are_noticed<C: Contents>(fresh: impl Fn() -> C, file: &[u8]) {
    for at in 0..file.len() {
        let mut bad = file.to_vec();
        bad[at] ^= 0x20;
        let mut download = begin(fresh(), file);
        let refused = download.receive(&bad, &mut |_| ());
        match refused {
            Ok(()) => panic!("byte {at}: not noticed"),
            Err(Refusal::Final(_)) => {}
            Err(Refusal::Damaged(_)) => {
                let from = download.position();
                assert!(from <= at as u64, "byte {at}: taken although damaged");
                download.receive(&file[from as usize..], &mut |_| ()).unwrap();
                assert!(download.is_complete());
            }
        }
    }
}

#[test]
fn no_flipped_byte_gets_through() {
    flips_are_noticed(|| GridContents::new(1000), &grid_file());
    flips_are_noticed(|| GridContents::new(1000), &explicit_file());
    flips_are_noticed(|| MeshContents::new(1000), &mesh_file());
    flips_are_noticed(|| MeshContents::new(1000), &coded_mesh_file());
}

#[test]
fn files_beyond_the_limits_are_refused_for_good() {
    let (grid, mesh) = (grid_file(), mesh_file());
    let refused = begin(GridContents::new(59), &grid).receive(&grid, &mut |_| ());
    assert!(matches!(refused, Err(Refusal::Final(_))), "{refused:?}");
    let refused = begin(MeshContents::new(399), &mesh).receive(&mesh, &mut |_| ());
    assert!(matches!(refused, Err(Refusal::Final(_))), "{refused:?}");
    assert!(begin(GridContents::new(60), &grid).receive(&grid, &mut |_| ()).is_ok());
    assert!(begin(MeshContents::new(400), &mesh).receive(&mesh, &mut |_| ()).is_ok());
}

#[test]
fn another_format_is_no_mesh_and_no_grid() {
    assert!(read_mesh(&grid_file(), &SceneLimits::default()).is_err());
    assert!(check_grid(&mesh_file(), &SceneLimits::default()).is_err());
    let grid = grid_file();
    assert!(check_grid(&grid[..grid.len() - 1], &SceneLimits::default()).is_err());
    assert!(check_grid(&grid, &SceneLimits::default()).is_ok());
}
