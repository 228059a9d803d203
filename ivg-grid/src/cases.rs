//! Hard cases of reconstruction, lookup and filling, each with what it measures and the most that is acceptable.
//!
//! Plain functions: this crate's tests run them, and so does whoever reports on numerical stability.

use glam::{DVec3, Vec3};
use ivg_format::Lattice;

use crate::integrate::fibonacci_sphere;
use crate::{
    FillOptions, FilledGrid, HemisphereVectors, IrradianceGrid, Reconstruction, SpatialFilter, fill,
    harmonics, reconstruct,
};

/// A hard case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// What is tried.
    pub name: &'static str,
    /// What [`measured`](Outcome::measured) is.
    pub figure: &'static str,
    /// Runs the case.
    pub run: fn() -> Outcome,
}

/// What a case measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The figure; smaller is better.
    pub measured: f64,
    /// The most that is acceptable.
    pub bound: f64,
}

impl Outcome {
    /// Whether the figure is acceptable; one that is not a number is not.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.measured <= self.bound
    }
}

/// Reconstruction, filling and lookups.
pub const CASES: &[Case] = &[
    Case {
        name: "white furnace, three vectors",
        figure: "largest relative error over 500 normals",
        run: || furnace(Reconstruction::ThreeVector, 2e-6),
    },
    Case {
        name: "white furnace, six vectors",
        figure: "largest relative error over 500 normals",
        run: || furnace(Reconstruction::SixVector, 2e-6),
    },
    Case {
        // 1 - 1/√3 on the diagonal: what the printed formula loses.
        name: "white furnace, squared normals as the papers print them",
        figure: "largest relative error over 500 normals",
        run: || furnace(Reconstruction::NSquared, 0.4227),
    },
    Case {
        name: "white furnace, radiance harmonics",
        figure: "largest relative error over 500 normals",
        run: harmonic_furnace,
    },
    Case {
        name: "hemispheres that cancel: equal lamps from +x and -x",
        figure: "largest error on the axes over the lamps' irradiance",
        run: || opposite_lamps(Vec3::ONE, Vec3::ONE),
    },
    Case {
        name: "cross-coloured hemispheres: red from +x, green from -x",
        figure: "largest error on the axes over the lamps' irradiance",
        run: || opposite_lamps(Vec3::X, Vec3::Y),
    },
    Case {
        name: "only the corners received",
        figure: "largest excess over the range of the received values",
        run: || excess(|lattice, index| lattice.is_corner(index)),
    },
    Case {
        name: "one vertex missing",
        figure: "largest excess over the range of the received values",
        run: || excess(|_, index| index != 200),
    },
    Case {
        name: "one vertex received",
        figure: "largest excess over the range of the received values",
        run: || excess(|_, index| index == 200),
    },
    Case { name: "nothing received", figure: "largest component", run: nothing_received },
    Case { name: "order of arrival", figure: "vertices whose bits differ", run: arrival_order },
    Case {
        name: "a grid that is looked at while it arrives",
        figure: "vertices whose bits differ from those of filling at the end",
        run: looks_on_the_way,
    },
    Case {
        name: "filling two rooms divided by a wall thinner than a cell",
        figure: "light in the dark room over light in the bright one",
        run: || leak(false),
    },
    Case {
        name: "lookups on both faces of a wall thinner than a cell",
        figure: "light in the dark room over light in the bright one",
        run: || leak(true),
    },
];

fn furnace(method: Reconstruction, bound: f64) -> Outcome {
    let mut vectors: HemisphereVectors = [[[0.0; 3]; 3]; 6];
    for (hemisphere, channels) in vectors.iter_mut().enumerate() {
        let sign = if hemisphere.is_multiple_of(2) { 1.0 } else { -1.0 };
        channels.iter_mut().for_each(|vector| vector[hemisphere / 2] = sign);
    }
    let measured = fibonacci_sphere(500)
        .iter()
        .map(|n| f64::from((reconstruct(method, &vectors, n.as_vec3()) - Vec3::ONE).abs().max_element()))
        .fold(0.0, f64::max);
    Outcome { measured, bound }
}

/// Radiance 1/π from everywhere: the first coefficient is 2√π times that, the irradiance 1.
fn harmonic_furnace() -> Outcome {
    let mut channel = [0.0; 9];
    channel[0] = std::f32::consts::FRAC_2_SQRT_PI;
    let measured = fibonacci_sphere(500)
        .iter()
        .map(|n| harmonics::irradiance(&[channel; 3], n.as_vec3()) - Vec3::ONE)
        .map(|off| f64::from(off.abs().max_element()))
        .fold(0.0, f64::max);
    Outcome { measured, bound: 2e-6 }
}

/// Lamps just above the plane y = 0 in the directions +x and -x: the hemispheres along x see one each, the others
/// both, whose vectors cancel but for what points up.
fn opposite_lamps(plus: Vec3, minus: Vec3) -> Outcome {
    let lamps =
        [(Vec3::new(1.0, 1e-3, 0.0).normalize(), plus), (Vec3::new(-1.0, 1e-3, 0.0).normalize(), minus)];
    let axis = |hemisphere: usize| {
        Vec3::AXES[hemisphere / 2] * if hemisphere.is_multiple_of(2) { 1.0 } else { -1.0 }
    };
    let vectors: HemisphereVectors = std::array::from_fn(|hemisphere| {
        std::array::from_fn(|channel| {
            let seen = lamps.iter().filter(|(w, _)| w.dot(axis(hemisphere)) > 0.0);
            seen.map(|&(w, light)| w * light[channel]).sum::<Vec3>().to_array()
        })
    });
    let mut measured = 0.0_f64;
    for n in (0..6).map(axis) {
        let exact: Vec3 = lamps.iter().map(|&(w, light)| light * w.dot(n).max(0.0)).sum();
        for method in Reconstruction::OF_VECTORS {
            measured =
                measured.max(f64::from((reconstruct(method, &vectors, n) - exact).abs().max_element()));
        }
    }
    // Sums of two numbers of at most 1 in f32.
    Outcome { measured, bound: 2.5e-7 }
}

/// How far filled values leave the range of the received ones, for values of mixed sign and size.
fn excess(received: impl Fn(&Lattice, u64) -> bool) -> Outcome {
    let mut grid = cube([8, 7, 9]);
    let lattice = *grid.lattice();
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    for index in (0..lattice.vertex_count()).filter(|&index| received(&lattice, index)) {
        let value = (index as f32 * 1.7).sin() * 10.0_f32.powi((index % 7) as i32 - 3);
        (low, high) = (low.min(value), high.max(value));
        grid.set(index as usize, &[[[value; 3]; 3]; 6]);
    }
    let mut measured = 0.0_f32;
    for options in [FillOptions::BEST, FillOptions::PAPER] {
        for vectors in fill(&grid, &options).vectors() {
            let value = vectors[0][0][0];
            measured = measured.max(low - value).max(value - high);
        }
    }
    Outcome { measured: f64::from(measured), bound: 0.0 }
}

fn nothing_received() -> Outcome {
    let filled = fill(&cube([5, 6, 7]), &FillOptions::default());
    Outcome { measured: f64::from(filled.largest_component()), bound: 0.0 }
}

fn arrival_order() -> Outcome {
    let arrivals: Vec<usize> = (0..8 * 7 * 9).filter(|index| index % 5 < 2).collect();
    let value = |index: usize| [[[(index as f32 * 0.37).cos() + 1.0; 3]; 3]; 6];
    let (mut forwards, mut backwards) = (cube([8, 7, 9]), cube([8, 7, 9]));
    arrivals.iter().for_each(|&index| forwards.set(index, &value(index)));
    arrivals.iter().rev().for_each(|&index| backwards.set(index, &value(index)));
    let bits = |grid: &IrradianceGrid| {
        let filled = fill(grid, &FillOptions::default());
        filled.vectors().iter().map(|vectors| vectors[0][0][0].to_bits()).collect::<Vec<u32>>()
    };
    let differing = bits(&forwards).into_iter().zip(bits(&backwards)).filter(|(a, b)| a != b).count();
    Outcome { measured: differing as f64, bound: 0.0 }
}

/// Vertices, some of them twice, arrive beside a wall with a hole in it; after each the filled grid is looked at.
fn looks_on_the_way() -> Outcome {
    let mut received = cube([8, 7, 9]);
    for index in (3..received.vertex_count()).step_by(8).filter(|index| index % 56 != 3) {
        received.set_blocked_edges(index, 0b001);
    }
    received.set_validity(100, 0);
    let mut filled = FilledGrid::new(received.clone(), FillOptions::default());
    let mut differing = 0;
    for n in 0..150_usize {
        let index = n * 179 % 100 * 5;
        let vectors = [[[(n as f32 * 0.61).sin(); 3]; 3]; 6];
        received.set(index, &vectors);
        filled.set(index, &vectors);
        let expected = fill(&received, &FillOptions::default());
        let pairs = filled.grid().vectors().iter().zip(expected.vectors());
        differing += pairs.filter(|(a, b)| a[0][0][0].to_bits() != b[0][0][0].to_bits()).count();
    }
    Outcome { measured: differing as f64, bound: 0.0 }
}

/// A bright and a dark room; the edges between the fourth and fifth vertex along x are blocked.
fn leak(look_up: bool) -> Outcome {
    let mut grid = cube([8, 7, 9]);
    let lattice = *grid.lattice();
    for index in 0..grid.vertex_count() {
        let bright = lattice.coords(index as u64)[0] < 4;
        if lattice.coords(index as u64)[0] == 3 {
            grid.set_blocked_edges(index, 0b001);
        }
        if index % 6 == 1 {
            grid.set(index, &[[[f32::from(u8::from(bright)); 3]; 3]; 6]);
        }
    }
    let filled = fill(&grid, &FillOptions::default());
    let mut measured = 0.0_f64;
    if look_up {
        for share in [0.01, 0.25, 0.5, 0.75, 0.99] {
            let p = DVec3::new(3.0 + share, 2.2, 5.7);
            for filter in SpatialFilter::ALL {
                let light = |n| f64::from(filled.vectors_at(p, Some(n), filter)[0][0][0]);
                measured = measured.max(light(Vec3::X) / light(Vec3::NEG_X));
            }
        }
    } else {
        let room = |dark: bool| {
            let inside = move |&index: &usize| (lattice.coords(index as u64)[0] >= 4) == dark;
            (0..filled.vertex_count()).filter(inside).map(|index| f64::from(filled.vectors()[index][0][0][0]))
        };
        measured = room(true).fold(0.0, f64::max) / room(false).fold(f64::INFINITY, f64::min);
    }
    Outcome { measured, bound: 0.0 }
}

/// An empty grid with steps of one metre.
fn cube(dims: [u16; 3]) -> IrradianceGrid {
    let lattice = Lattice { dims, origin: [0.0; 3], step: [1.0; 3] };
    IrradianceGrid::new(lattice).expect("a small lattice with steps")
}

#[cfg(test)]
mod tests;
