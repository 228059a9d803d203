//! What a vertex holds, seen as the numbers that errors are measured in.

use glam::Vec3;
use ivg_format::{HemisphereVectors, RadianceHarmonics};
use ivg_grid::harmonics::{COEFFICIENTS, irradiance_signed};

use super::vertex_gather::{NUMBERS, VECTOR_NUMBERS};

/// Numbers that errors are measured in: three channels times six axes.
pub(crate) const AXES: usize = 18;

/// The irradiance of surfaces that face along the axes, `[rgb][+x −x +y −y +z −z]` flattened.
pub(crate) type Axes = [f32; AXES];

/// Light that can be added up, channel by channel.
pub(crate) trait Linear: Copy + Default + Send + Sync {
    /// The irradiance of surfaces that face along the axes: I_d·d of the vectors, or what the harmonics make of it.
    fn axes(&self) -> Axes;

    /// Adds `other`, of each channel a multiple.
    fn add(&mut self, other: &Self, factors: [f32; 3]);
}

/// What a vertex holds.
pub(crate) trait Held: Linear {
    /// From what was gathered.
    fn gathered(numbers: &[f64; NUMBERS]) -> Self;
}

impl Linear for HemisphereVectors {
    fn axes(&self) -> Axes {
        core::array::from_fn(|n| {
            let (channel, hemisphere) = (n / 6, n % 6);
            let along = self[hemisphere][channel][hemisphere / 2];
            if hemisphere % 2 == 0 { along } else { -along }
        })
    }

    fn add(&mut self, other: &Self, factors: [f32; 3]) {
        for (own, other) in self.iter_mut().zip(other) {
            for c in 0..3 {
                own[c].iter_mut().zip(other[c]).for_each(|(x, y)| *x += factors[c] * y);
            }
        }
    }
}

impl Held for HemisphereVectors {
    fn gathered(numbers: &[f64; NUMBERS]) -> Self {
        core::array::from_fn(|h| {
            core::array::from_fn(|c| core::array::from_fn(|k| numbers[9 * h + 3 * c + k] as f32))
        })
    }
}

impl Linear for RadianceHarmonics {
    fn axes(&self) -> Axes {
        let towards: [Vec3; 6] = core::array::from_fn(|hemisphere| {
            let axis = Vec3::AXES[hemisphere / 2];
            irradiance_signed(self, if hemisphere % 2 == 0 { axis } else { -axis })
        });
        core::array::from_fn(|n| towards[n % 6][n / 6])
    }

    fn add(&mut self, other: &Self, factors: [f32; 3]) {
        for c in 0..3 {
            self[c].iter_mut().zip(other[c]).for_each(|(x, y)| *x += factors[c] * y);
        }
    }
}

impl Held for RadianceHarmonics {
    fn gathered(numbers: &[f64; NUMBERS]) -> Self {
        core::array::from_fn(|c| {
            core::array::from_fn(|n| numbers[VECTOR_NUMBERS + COEFFICIENTS * c + n] as f32)
        })
    }
}

impl Linear for Axes {
    fn axes(&self) -> Axes {
        *self
    }

    fn add(&mut self, other: &Self, factors: [f32; 3]) {
        for (n, (x, y)) in self.iter_mut().zip(other).enumerate() {
            *x += factors[n / (AXES / 3)] * y;
        }
    }
}

/// The sum of squares of some numbers.
pub(crate) fn energy(axes: &Axes) -> f64 {
    axes.iter().map(|&x| f64::from(x) * f64::from(x)).sum()
}
