//! How far a grid or a reconstruction is off.

use glam::{DVec3, Vec3};

use crate::{HemisphereVectors, Reconstruction, reconstruct_signed};

/// Errors of irradiance values against exact ones, summed over points, normals and the three channels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IrradianceError {
    count: u64,
    exact: f64,
    exact_squares: f64,
    difference: f64,
    squares: f64,
    negative: u64,
    largest: f64,
}

impl IrradianceError {
    /// Counts one value, as reconstructed *before* the cut at zero, against the exact one \[W/m²\].
    ///
    /// The error is that of the value after the cut.
    pub fn add(&mut self, signed: Vec3, exact: DVec3) {
        for channel in 0..3 {
            let value = f64::from(signed[channel]);
            let difference = value.max(0.0) - exact[channel];
            self.count += 1;
            self.exact += exact[channel];
            self.exact_squares += exact[channel] * exact[channel];
            self.difference += difference;
            self.squares += difference * difference;
            self.negative += u64::from(value < 0.0);
            self.largest = self.largest.max(difference.abs());
        }
    }

    /// Counts a reconstruction over many normals; `exact` gives the irradiance for a normal \[W/m²\].
    pub fn add_normals(
        &mut self,
        method: Reconstruction,
        vectors: &HemisphereVectors,
        normals: &[Vec3],
        exact: impl Fn(Vec3) -> DVec3,
    ) {
        for &n in normals {
            self.add(reconstruct_signed(method, vectors, n), exact(n));
        }
    }

    /// Values counted: three a call of [`add`](Self::add).
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Root mean square error divided by the root mean square of the exact irradiance; 0.05 is 5 %. Not a number before
    /// anything bright was counted.
    #[must_use]
    pub fn relative_rmse(&self) -> f64 {
        (self.squares / self.exact_squares).sqrt()
    }

    /// Like [`relative_rmse`](Self::relative_rmse), less what the exact values themselves are off: `noise` is the mean of their
    /// squared standard errors \[(W/m²)²\], independent of the values counted. 0 where nothing is left.
    #[must_use]
    pub fn relative_rmse_less(&self, noise: f64) -> f64 {
        ((self.squares / self.count as f64 - noise).max(0.0) * self.count as f64 / self.exact_squares).sqrt()
    }

    /// Mean error divided by the mean exact irradiance: negative where light is lost.
    #[must_use]
    pub fn relative_bias(&self) -> f64 {
        self.difference / self.exact
    }

    /// The largest error divided by the mean exact irradiance.
    #[must_use]
    pub fn relative_maximum(&self) -> f64 {
        self.largest / (self.exact / self.count as f64)
    }

    /// The share of the values that were negative before the cut at zero, 0 to 1.
    #[must_use]
    pub fn negative_share(&self) -> f64 {
        self.negative as f64 / self.count as f64
    }
}

/// Relative root mean square difference of vectors: `sqrt(Σ |a − e|² / Σ |e|²)` over all vertices, hemispheres and
/// channels; 0.05 is 5 %. 0 for two dark grids, infinite where only the exact one is dark.
///
/// # Panics
///
/// If the two have different lengths.
#[must_use]
pub fn relative_rmse(approximate: &[HemisphereVectors], exact: &[HemisphereVectors]) -> f64 {
    assert_eq!(approximate.len(), exact.len(), "one approximate vertex for each exact one");
    let flat = |vectors| <[[[[f32; 3]; 3]; 6]]>::as_flattened(vectors).as_flattened().as_flattened();
    let (mut squares, mut norm) = (0.0, 0.0);
    for (&a, &e) in flat(approximate).iter().zip(flat(exact)) {
        let (a, e) = (f64::from(a), f64::from(e));
        squares += (a - e) * (a - e);
        norm += e * e;
    }
    if squares == 0.0 { 0.0 } else { (squares / norm).sqrt() }
}

#[cfg(test)]
mod tests;
