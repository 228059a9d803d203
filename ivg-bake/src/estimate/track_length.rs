//! The track-length estimators: what a photon adds to a vertex is in proportion to how far it flies through its dual cell.
//!
//! The radiance from direction w, averaged over a volume V, is the power times length of all flights along −w in it,
//! divided by V. So a flight of power φ and length l in the region of a vertex adds φ l w / V to the three irradiance vectors
//! whose hemispheres contain w ([`VectorTracks`]), and φ l Y(w) / V to the coefficient of the spherical harmonic Y of the
//! radiance ([`RadianceTracks`]). No cosine is divided by, so that grazing flights do no harm, and every flight counts in
//! every region that it passes.
//!
//! # What else was tried
//!
//! The Cornell box with the bunny, 16³ vertices, irradiance along the axes at the vertices half a cell or more from surfaces, against
//! 12288 paths a vertex (example `oracle_error`). As it is, the error is 2.41 % after a million photons and 1.26 % after 16 million.
//!
//! | instead | a million | 16 million | |
//! |---|---|---|---|
//! | a tent over two cells for the nearest cell (its second moment, by neighbours) | 2.52 % | 1.86 % | twice the width costs more bias than it saves noise |
//! | the mean less its neighbours' curvature / 24, exact for parabolas | 2.64 % | 1.01 % | noise grows by a tenth; pays from about three million photons on |
//! | emission and first reflection as scrambled Sobol points, blocks of 2048 or 16384 photons | - | - | noise² times 0.91 to 0.93 (125,000 and 500,000 photons, seven seeds), time times about 1.02: not enough to tie photons to blocks |
//!
//! A parabola fitted to the cells that a vertex sees of the 27 around it (least squares, weights exp(−n / w) at n squared steps), and its
//! value where the vertex looks from, in place of [what is done](crate::centring) next to surfaces. The same scene, a million photons
//! a bake, six of them at 16³ and four at 32³, two gathers of 2048 and 256 paths a vertex; measured once, with sums and gathers
//! written out and fitted elsewhere. Bias and noise: 16³ half a cell or more from surfaces, 32³ up to a cell from them.
//!
//! | | 16³, away | 32³, near |
//! |---|---|---|
//! | as it is | 1.01 %, 2.17 % | 2.69 %, 5.60 % |
//! | parabola, w = 0.4 | 0.73 %, 2.36 % | 2.73 %, 6.00 % |
//! | parabola, w = 0.6 | 1.01 %, 2.13 % | 2.79 %, 5.48 % |
//! | parabola, w = 1 | 1.57 %, 1.84 % | 3.02 %, 4.78 % |
//! | parabola, w = 3 | 2.40 %, 1.59 % | 3.56 %, 4.09 % |
//! | plane, w = 0.6 | 3.14 %, 1.25 % | 4.23 %, 3.99 % |
//!
//! Flights that pass a cell pass the next one too, so that what neighbours say in common is noise as well: what a wider fit saves
//! of it, bias takes. Half of the squared bias near surfaces is that of some sixty vertices in the plane of a ceiling with a black lamp
//! set into it, beside the lamp's edges, where light jumps; no fit follows that. Gathering all vertices there to the noise of a
//! million photons takes 256 paths each, two thirds as long as the photons.
//!
//! Flights wait until many of an [octant](super::queue) can be deposited, and parts of cells that are boxes are clipped, not walked through:
//! together 0.86 to 0.93 of the time of photons at 16³ (`oracle_error` with one seed and few paths, in turns with the program before;
//! ratio of medians of five sets of five to seven runs), and no less than before at 32³, where the sums of an octant exceed the
//! processor's second cache. Compiled for x86-64-v3 (AVX2) the same program takes 0.88 of that again: bought with a flag by who
//! compiles, not with a second copy of the code chosen as it runs.
//!
//! Two reflections for each first hit save half of the first flight, which is not deposited: a seventh of the time of a photon at
//! most, halved again for two, and what both share is as much noise as the points above take away. The example `deposits` prints
//! noise² times time of this estimator and of [crossings](super::face_crossing).

use ivg_format::{HemisphereVectors, Quantity, RadianceHarmonics};
use ivg_grid::harmonics::{COEFFICIENTS, basis};

use super::queue::{OCTANTS, octant};
use super::{Estimate, Flight, NUMBERS};
use crate::accumulate::{MAX_QUANTA, Sums, Total};
use crate::dual::{Boxes, Line};
use crate::region::{Region, Regions};

/// Stretches of a flight that are collected before they are added. Waiting for memory is most of the cost of a bake; many
/// short additions in a row let the processor wait for several at once.
const STRETCHES: usize = 16;

/// Roundings in cutting a flight can make a stretch this much longer than the diagonal.
const DIAGONAL_MARGIN: f32 = 1.001;

/// The flights through the dual cells of a lattice.
#[derive(Debug)]
struct Tracks<'a> {
    cells: Boxes,
    regions: &'a Regions,
    /// Bake units a quantum: a power of two.
    quantum: f64,
}

impl<'a> Tracks<'a> {
    fn new(cells: Boxes, regions: &'a Regions) -> Self {
        Self { cells, regions, quantum: quantum(&cells) }
    }

    /// Calls `add` with the vertex and the length \[bake units\] of each stretch of a flight that counts.
    #[inline]
    fn for_each_stretch(&self, flight: &Flight, mut add: impl FnMut(usize, f32)) {
        let mut stretches = [(0u32, 0f32); STRETCHES];
        let mut waiting = 0;
        let line = Line::new(flight.origin, flight.direction);
        self.cells.walk(&line, 0.0, flight.length, |cell, from, to| {
            let index = self.cells.index(cell);
            let length = match self.regions.get(index) {
                Region::Whole => to - from,
                region => region.length(&self.cells, cell, &line, from, to),
            };
            if length > 0.0 {
                // A lattice has at most 2²⁴ vertices.
                stretches[waiting] = (index as u32, length);
                waiting += 1;
                if waiting == STRETCHES {
                    stretches.iter().for_each(|&(index, length)| add(index as usize, length));
                    waiting = 0;
                }
            }
        });
        stretches[..waiting].iter().for_each(|&(index, length)| add(index as usize, length));
    }

    /// What a sum of quanta is multiplied by; none where nothing counts.
    fn scale(&self, vertex: usize, power: f64) -> Option<f64> {
        let share = self.regions.get(vertex).share();
        (share > 0.0).then(|| power * self.quantum / (self.cells.volume() * share))
    }
}

/// Bake units a quantum: a power of two.
pub(crate) fn quantum(cells: &Boxes) -> f64 {
    let exponent = libm::ilogbf(cells.diagonal() * DIAGONAL_MARGIN) + 1;
    libm::scalbn(1.0, exponent) / f64::from(MAX_QUANTA)
}

/// Sums of a grid of `vertices` vertices.
pub(crate) fn sums_of(quantity: Quantity, vertices: usize) -> usize {
    match quantity {
        Quantity::Vectors => vertices * OCTANTS * NUMBERS,
        Quantity::Radiance => vertices * RADIANCE_NUMBERS,
    }
}

/// Track lengths to irradiance vectors.
///
/// Which three hemispheres contain w follows from the signs of its components alone, so deposits go to one of eight
/// octants a vertex, and each hemisphere is the sum of four octants at the end. The sums of an octant lie together: a flight
/// stays in one octant.
#[derive(Debug)]
pub(crate) struct VectorTracks<'a>(Tracks<'a>);

impl<'a> VectorTracks<'a> {
    pub(crate) fn new(cells: Boxes, regions: &'a Regions) -> Self {
        Self(Tracks::new(cells, regions))
    }
}

impl Estimate for VectorTracks<'_> {
    type Value = HemisphereVectors;

    fn sums(&self) -> usize {
        self.0.cells.len() * OCTANTS * NUMBERS
    }

    #[inline]
    fn deposit(&self, flight: &Flight, sums: &mut impl Sums) {
        let per_length = flight.numbers((1.0 / self.0.quantum) as f32);
        let first = octant(flight) * self.0.cells.len();
        self.0.for_each_stretch(flight, |vertex, length| {
            sums.add((first + vertex) * NUMBERS, &per_length.map(|number| number * length));
        });
    }

    /// The vectors of a vertex take as much memory as its sums of three octants, and are put in their place: the vectors of a
    /// large grid beside all its sums would be more than either.
    fn values(&self, mut sums: Vec<i64>, vertices: usize, power: f64) -> Vec<HemisphereVectors> {
        const KEPT: usize = 3;
        for vertex in 0..vertices {
            let vectors = self.value(&Total::of(&sums), vertex, power);
            let mut numbers = vectors.as_flattened().as_flattened().chunks_exact(2);
            for octant in 0..KEPT {
                for sum in &mut sums[(octant * vertices + vertex) * NUMBERS..][..NUMBERS] {
                    if let Some([low, high]) = numbers.next() {
                        *sum = (u64::from(high.to_bits()) << 32 | u64::from(low.to_bits())) as i64;
                    }
                }
            }
        }
        sums.truncate(KEPT * vertices * NUMBERS);
        sums.shrink_to_fit();
        let vectors = |vertex: usize| -> HemisphereVectors {
            let halves: [f32; 2 * KEPT * NUMBERS] = core::array::from_fn(|n| {
                let (octant, at) = (n / 2 / NUMBERS, n / 2 % NUMBERS);
                let both = sums[(octant * vertices + vertex) * NUMBERS + at] as u64;
                f32::from_bits((both >> (32 * (n % 2)) & 0xffff_ffff) as u32)
            });
            core::array::from_fn(|h| {
                core::array::from_fn(|c| core::array::from_fn(|k| halves[9 * h + 3 * c + k]))
            })
        };
        (0..vertices).map(vectors).collect()
    }

    fn value(&self, sums: &Total<'_>, vertex: usize, power: f64) -> HemisphereVectors {
        let Some(scale) = self.0.scale(vertex, power) else { return HemisphereVectors::default() };
        vectors_of(sums, self.0.cells.len(), vertex, scale)
    }
}

/// The vectors of a vertex from all sums of `vertices` vertices.
pub(crate) fn vectors_of(sums: &Total<'_>, vertices: usize, vertex: usize, scale: f64) -> HemisphereVectors {
    let octants: [[i64; NUMBERS]; OCTANTS] =
        core::array::from_fn(|octant| sums.get((octant * vertices + vertex) * NUMBERS));
    core::array::from_fn(|hemisphere| {
        let (axis, negative) = (hemisphere / 2, hemisphere % 2);
        let mut numbers = [0i64; NUMBERS];
        for octant in (0..OCTANTS).filter(|octant| octant >> axis & 1 == negative) {
            numbers.iter_mut().zip(octants[octant]).for_each(|(sum, part)| *sum = sum.wrapping_add(part));
        }
        core::array::from_fn(|channel| {
            core::array::from_fn(|component| (numbers[3 * channel + component] as f64 * scale) as f32)
        })
    })
}

/// Numbers of a deposit of radiance: three channels times nine harmonics.
const RADIANCE_NUMBERS: usize = 3 * COEFFICIENTS;

/// Track lengths to spherical harmonics of the radiance.
#[derive(Debug)]
pub(crate) struct RadianceTracks<'a>(Tracks<'a>);

impl<'a> RadianceTracks<'a> {
    pub(crate) fn new(cells: Boxes, regions: &'a Regions) -> Self {
        Self(Tracks::new(cells, regions))
    }
}

impl Estimate for RadianceTracks<'_> {
    type Value = RadianceHarmonics;

    fn sums(&self) -> usize {
        self.0.cells.len() * RADIANCE_NUMBERS
    }

    #[inline]
    fn deposit(&self, flight: &Flight, sums: &mut impl Sums) {
        // |Y| <= √(5/4π) < 1, so that a number is at most the length times the power, as for the vectors.
        let basis = basis((-flight.direction).as_dvec3()).map(|y| (y / self.0.quantum) as f32);
        let mut per_length = [0.0; RADIANCE_NUMBERS];
        for (numbers, power) in per_length.chunks_exact_mut(COEFFICIENTS).zip(flight.power.to_array()) {
            numbers.iter_mut().zip(basis).for_each(|(number, y)| *number = y * power);
        }
        self.0.for_each_stretch(flight, |vertex, length| {
            sums.add(vertex * RADIANCE_NUMBERS, &per_length.map(|number| number * length));
        });
    }

    fn value(&self, sums: &Total<'_>, vertex: usize, power: f64) -> RadianceHarmonics {
        let Some(scale) = self.0.scale(vertex, power) else { return RadianceHarmonics::default() };
        radiance_of(sums, vertex, scale)
    }
}

/// The harmonics of a vertex from all sums.
pub(crate) fn radiance_of(sums: &Total<'_>, vertex: usize, scale: f64) -> RadianceHarmonics {
    let numbers: [i64; RADIANCE_NUMBERS] = sums.get(vertex * RADIANCE_NUMBERS);
    core::array::from_fn(|channel| {
        core::array::from_fn(|n| (numbers[channel * COEFFICIENTS + n] as f64 * scale) as f32)
    })
}

#[cfg(test)]
mod tests;
