use std::collections::BTreeSet;

use ivg_format::{
    EncodeOptions, Encoding, Event, HemisphereVectors, Lattice, Limits, Order, decode_all, encode,
};
use ivg_format::{Header, Step};

use super::*;
use crate::fill;

fn lattice(dims: [u16; 3]) -> Lattice {
    Lattice::new(dims, [0.0; 3], [1.0; 3]).expect("a box")
}

/// Light that changes slowly, but for a bright spot in one corner region; a wall across the middle of x with vertices inside
/// geometry, and blocked edges along it.
fn grid(dims: [u16; 3]) -> IrradianceGrid {
    let lattice = lattice(dims);
    let count = lattice.vertex_count();
    let wall = dims[0] / 2;
    let vectors: Vec<HemisphereVectors> = (0..count)
        .map(|index| {
            let [x, y, z] = lattice.coords(index).map(f32::from);
            let spot = 8.0 / (1.0 + (x - 1.0).powi(2) + (y - 2.0).powi(2) + (z - 2.0).powi(2));
            let side = if x < f32::from(wall) { 1.0 } else { 3.0 };
            std::array::from_fn(|h| [[side + spot + 0.1 * (x + y) * (h as f32 + 1.0), 0.5 * z, spot]; 3])
        })
        .collect();
    let validity = (0..count).map(|v| if lattice.coords(v)[0] == wall { 0 } else { 255 }).collect();
    let blocked = (0..count).map(|v| u8::from(lattice.coords(v)[0] + 1 == wall)).collect();
    IrradianceGrid::from_parts(lattice, vectors, validity, blocked).expect("sound")
}

/// Relative error of what a client shows that has received the corners and these vertices.
fn error(grid: &IrradianceGrid, received: &[u64]) -> f64 {
    let mut client = IrradianceGrid::new(*grid.lattice()).expect("small");
    for vertex in 0..grid.vertex_count() {
        client.set_validity(vertex, grid.validity()[vertex]);
        client.set_blocked_edges(vertex, grid.blocked_edges()[vertex]);
    }
    for vertex in grid.lattice().corners().chain(received.iter().copied()) {
        client.set(vertex as usize, &grid.vectors()[vertex as usize]);
    }
    let filled = fill(&client, &FillOptions::default());
    let valid = |values: &IrradianceGrid| -> Vec<HemisphereVectors> {
        (0..grid.vertex_count()).filter(|&v| grid.is_valid(v)).map(|v| values.vectors()[v]).collect()
    };
    crate::relative_rmse(&valid(&filled), &valid(grid))
}

#[test]
fn every_valid_vertex_is_in_one_bundle_and_the_file_is_whole() {
    for dims in [[9, 6, 5], [2, 2, 2], [1, 1, 7], [3, 1, 4]] {
        let grid = grid(dims);
        let longest = usize::from(dims.into_iter().max().expect("three"));
        let options = ImportanceOptions { first_bundle: 3, ..ImportanceOptions::new(2 * longest) };
        let bundles = bundles(&grid, &options);
        let all: Vec<u64> = bundles.concat();
        let expected: BTreeSet<u64> = (0..grid.lattice().vertex_count())
            .filter(|&v| grid.is_valid(v as usize) && !grid.lattice().is_corner(v))
            .collect();
        assert_eq!(all.len(), expected.len(), "{dims:?}");
        assert_eq!(all.into_iter().collect::<BTreeSet<_>>(), expected, "{dims:?}");
        assert!(bundles.iter().all(|b| !b.is_empty() && b.len() <= 2 * longest && b.is_sorted()), "{dims:?}");

        let source = ivg_format::GridSource { bundles: Some(&bundles), ..grid.as_source() };
        let options = EncodeOptions {
            order: Order::Explicit,
            encoding: Encoding::VectorsF32,
            vertices_per_slice: 2,
            ..EncodeOptions::default()
        };
        let file = encode(&source, &options).expect("bundles as the format wants them");
        let (read, _) = IrradianceGrid::from_file(&file, &Limits::default()).expect("a whole file");
        for vertex in (0..grid.vertex_count()).filter(|&v| grid.is_valid(v)) {
            assert_eq!(read.get(vertex), grid.get(vertex), "{dims:?}, vertex {vertex}");
        }
        let mut found = vec![];
        decode_all(&file, &Limits::default(), |event| {
            if let Event::Bundle(bundle) = event {
                found.push(bundle.vertices().collect::<Vec<u64>>());
            }
        })
        .expect("a whole file");
        assert_eq!(found, bundles);
    }
}

#[test]
fn the_order_is_the_same_every_time() {
    let grid = grid([9, 6, 5]);
    let options = ImportanceOptions::new(64);
    assert_eq!(bundles(&grid, &options), bundles(&grid, &options));
}

#[test]
fn a_prefix_is_worth_more_than_that_of_an_even_spread() {
    let grid = grid([16, 16, 16]);
    let encoded =
        encode(&grid.as_source(), &EncodeOptions { order: Order::Octree, ..EncodeOptions::default() });
    let Ok(Step::Consumed(_, header)) = Header::read(&encoded.expect("sound"), &Limits::default()) else {
        panic!("a header")
    };
    let spread: Vec<u64> =
        (1..=header.bundle_count).filter_map(|k| header.bundle_vertices(k)).flatten().collect();
    let mut options = ImportanceOptions { first_bundle: 8, free_weight: 1.0, ..ImportanceOptions::new(256) };
    let ranked = bundles(&grid, &options).concat();
    options.look_ahead = false;
    let residual = bundles(&grid, &options).concat();
    // An order that ignored the errors would do as well as the spread, within a few percent of it; this one does
    // twice as well from the first percents on.
    for count in [40, 200, 800] {
        let [ranked, spread] = [&ranked, &spread].map(|order| error(&grid, &order[..count]));
        assert!(ranked < 0.7 * spread, "{count}: {ranked} and {spread}");
    }
    // And the first vertices stand for their blocks: the largest errors alone are a bad beginning.
    let [ahead, blind] = [&ranked, &residual].map(|order| error(&grid, &order[..40]));
    assert!(ahead < blind, "{ahead} and {blind}");
}

#[test]
fn a_vertex_unlike_its_surroundings_does_not_stand_for_them() {
    // Even light, but for one vertex in the middle. Nothing else is wrong, so by errors alone it comes first; but then all of
    // its empty block would be filled with it, and its neighbours are worth more.
    let lattice = lattice([16, 16, 16]);
    let odd = lattice.index(7, 7, 7);
    let mut vectors: Vec<HemisphereVectors> = vec![[[[1.0; 3]; 3]; 6]; 4096];
    vectors[odd as usize] = [[[50.0; 3]; 3]; 6];
    let grid = IrradianceGrid::from_parts(lattice, vectors, vec![255; 4096], vec![0; 4096]).expect("sound");
    let first = |look_ahead| {
        let options = ImportanceOptions { look_ahead, first_bundle: 1, ..ImportanceOptions::new(256) };
        bundles(&grid, &options)[0].clone()
    };
    assert_eq!(first(false), [odd]);
    assert_ne!(first(true), [odd]);
}

#[test]
fn surfaces_come_first_where_they_weigh_more() {
    let grid = grid([16, 16, 16]);
    let near = near_surfaces(&grid);
    let share = |free_weight| {
        let options = ImportanceOptions { free_weight, ..ImportanceOptions::new(256) };
        let first = &bundles(&grid, &options).concat()[..400];
        first.iter().filter(|&&vertex| near[vertex as usize]).count()
    };
    let (even, weighted) = (share(1.0), share(0.05));
    assert!(weighted > even + 40, "{weighted} and {even} of 400 near a surface");
}

#[test]
fn near_a_surface_is_where_geometry_is_in_reach() {
    let lattice = lattice([7, 3, 3]);
    let mut grid = IrradianceGrid::new(lattice).expect("small");
    assert!(near_surfaces(&grid).iter().all(|near| !near));
    // A cut edge is near both its ends, and a vertex inside geometry near all around it.
    grid.set_blocked_edges(lattice.index(0, 1, 1) as usize, 1);
    grid.set_validity(lattice.index(4, 0, 0) as usize, 0);
    grid.set_validity(lattice.index(6, 2, 2) as usize, 254);
    let near: BTreeSet<[u16; 3]> = near_surfaces(&grid)
        .into_iter()
        .enumerate()
        .filter(|(_, near)| *near)
        .map(|(index, _)| lattice.coords(index as u64))
        .collect();
    let mut expected = BTreeSet::from([[0, 1, 1], [1, 1, 1], [6, 2, 2]]);
    for (i, j, k) in (3..=5).flat_map(|i| (0..=1).flat_map(move |j| (0..=1).map(move |k| (i, j, k)))) {
        expected.insert([i, j, k]);
    }
    assert_eq!(near, expected);
}

#[test]
fn radiance_harmonics_are_ranked_too() {
    let lattice = lattice([6, 5, 4]);
    let values: Vec<ivg_format::RadianceHarmonics> = (0..120)
        .map(|v| std::array::from_fn(|c| std::array::from_fn(|k| ((v * 7 + c * 3 + k) % 11) as f32 / 11.0)))
        .collect();
    let grid = IrradianceGrid::from_parts(lattice, values, vec![255; 120], vec![0; 120]).expect("sound");
    let all: BTreeSet<u64> = bundles(&grid, &ImportanceOptions::new(50)).concat().into_iter().collect();
    assert_eq!(all.len(), 112);
    assert_eq!(scales(Quantity::Radiance).len(), 27);
    assert_eq!(
        scales(Quantity::Radiance).take(10).collect::<Vec<_>>()[4..],
        [0.25, 0.25, 0.25, 0.25, 0.25, 1.0]
    );
}
