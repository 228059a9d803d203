use super::{Centring, Place};
use crate::Silent;
use crate::estimate::held::{AXES, Axes, Linear};
use crate::region::SUB_CELLS;
use crate::workers::Workers;

const WORKERS: Workers<'_> = Workers { threads: 2, monitor: &Silent, total_photons: 0 };

/// Vertices of a room whose floor is in the lowest layer: half of the cells there count, 4 of 8 layers of sub-cells along z,
/// and their vertices look from a 32nd of a step above.
fn floor(count: [usize; 3]) -> Centring {
    let vertices: usize = count.iter().product();
    let place = |vertex: usize| {
        if vertex >= count[0] * count[1] {
            return Place { cells: SUB_CELLS as u16, ..Place::default() };
        }
        // Sub-cells 4 to 7 of 8: twice their distances are 1, 3, 5, 7, in the mean 4.
        let cells = SUB_CELLS as u16 / 2;
        Place { cells, moments: [0, 0, 4 * cells as i16], aside: [0, 0, 1], open: (1 << 26) - 1 }
    };
    Centring { places: (0..vertices).map(place).collect(), count }
}

fn place_of(centring: &Centring, vertex: usize) -> [f64; 3] {
    let [nx, ny, _] = centring.count;
    [vertex % nx, vertex / nx % ny, vertex / nx / ny].map(|n| n as f64)
}

/// Light that changes evenly: what the mean over each part is, and what the light is where the vertex looks from.
#[test]
fn light_that_changes_evenly_is_carried_to_the_vertex_exactly_but_for_the_ridge() {
    let centring = floor([5, 4, 3]);
    let light = |p: [f64; 3]| 10.0 + 0.5 * p[0] - 0.3 * p[1] + 2.0 * p[2];
    let means = |vertex: usize| {
        let [x, y, z] = place_of(&centring, vertex);
        let centre = if z == 0.0 { 0.25 } else { z };
        light([x, y, centre])
    };
    let mut values: Vec<Axes> = (0..60).map(|vertex| [means(vertex) as f32; AXES]).collect();
    centring.apply(&mut values, &WORKERS).unwrap();
    for (vertex, value) in values.iter().enumerate() {
        let [x, y, z] = place_of(&centring, vertex);
        let exact = light([x, y, if z == 0.0 { 1.0 / 32.0 } else { z }]);
        // The variance along z is that of places 0.25 and 1 in shares of about 2 to 1, 0.13 squared steps: the ridge of 0.01
        // takes at most a tenth of the change, which is 2 · 0.22.
        let off = (f64::from(value[0]) - exact).abs();
        assert!(off < if z == 0.0 { 0.044 } else { 1e-6 }, "vertex {vertex}: {} for {exact}", value[0]);
        assert!((means(vertex) - exact).abs() > if z == 0.0 { 0.4 } else { -1.0 });
    }
}

#[test]
fn even_light_stays_as_it_is_and_nothing_falls_below_half() {
    let centring = floor([4, 4, 3]);
    let mut even = vec![[3.0; AXES]; 48];
    centring.apply(&mut even, &WORKERS).unwrap();
    assert!(even.as_flattened().iter().all(|x| (x - 3.0).abs() < 1e-5), "{even:?}");
    // So steep that a plane goes below zero; only the first channel, and only from above.
    let mut steep: Vec<Axes> = (0..48)
        .map(|vertex| {
            let height = place_of(&centring, vertex)[2] as f32;
            core::array::from_fn(|n| if n < 6 { 1.0 + 100.0 * height } else { 1.0 })
        })
        .collect();
    centring.apply(&mut steep, &WORKERS).unwrap();
    for value in &steep[..16] {
        assert!((value[0] - 0.5).abs() < 1e-5 && (value[6] - 1.0).abs() < 1e-5, "{value:?}");
    }
}

/// What is not seen is not looked at, and what lies beyond the lattice, as a file can say, is not either.
#[test]
fn neighbours_out_of_sight_do_not_count() {
    let mut centring = floor([3, 3, 2]);
    for place in &mut centring.places[..9] {
        // Only those of the same layer: nothing is known about the change upwards.
        place.open = neighbours_where(|[_, _, z]| z == 0);
    }
    let mut values: Vec<Axes> = (0..18).map(|v| [if v < 9 { 1.0 } else { 1e9 }; AXES]).collect();
    centring.apply(&mut values, &WORKERS).unwrap();
    assert!(values[..9].iter().all(|value| value[0] == 1.0), "{values:?}");
    for place in &mut centring.places {
        place.open = u32::MAX;
    }
    centring.apply(&mut values, &WORKERS).unwrap();
}

fn neighbours_where(keep: impl Fn([i8; 3]) -> bool) -> u32 {
    super::neighbours().enumerate().filter(|(_, o)| keep(*o)).fold(0, |bits, (n, _)| bits | 1 << n)
}

/// The three kinds of values agree about what their axes are.
#[test]
fn vectors_and_their_axes_are_carried_alike() {
    let centring = floor([3, 3, 3]);
    let mut vectors: Vec<ivg_format::HemisphereVectors> = (0..27u32)
        .map(|v| {
            core::array::from_fn(|h| {
                let sign = if h % 2 == 0 { 1.0 } else { -1.0 };
                core::array::from_fn(|c| {
                    core::array::from_fn(|k| {
                        let number = (v * 7 + h as u32 * 5 + c as u32 * 3 + k as u32) % 11;
                        if k == h / 2 { sign * number as f32 } else { number as f32 - 5.0 }
                    })
                })
            })
        })
        .collect();
    let mut axes: Vec<Axes> = vectors.iter().map(Linear::axes).collect();
    centring.apply(&mut vectors, &WORKERS).unwrap();
    centring.apply(&mut axes, &WORKERS).unwrap();
    for (vectors, axes) in vectors.iter().zip(&axes) {
        let own = Linear::axes(vectors);
        assert!(own.iter().zip(axes).all(|(a, b)| (a - b).abs() < 1e-4), "{own:?} {axes:?}");
    }
}
