//! What a grid loses when it is written in another encoding.

use ivg_format::{Encoding, VertexValues};
use ivg_grid::{IrradianceError, IrradianceGrid, Reconstruction, harmonics, integrate, reconstruct_signed};

/// Normals for which irradiance is compared at each vertex, spread evenly.
const NORMALS: usize = 50;

/// Vertices at which irradiance is compared; of a larger grid every second, third and so on.
const MOST_VERTICES: usize = 1 << 16;

/// How far what is read from a file is from what was to be written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Loss {
    /// Relative RMSE of the numbers that the file stores, over valid vertices.
    pub(crate) values: f64,
    /// Relative RMSE of irradiance at valid vertices, as the reconstruction for each encoding gives it.
    pub(crate) irradiance: f64,
}

/// A grid and how it is or was stored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stored<'a> {
    pub(crate) grid: &'a IrradianceGrid,
    pub(crate) encoding: Encoding,
}

impl Loss {
    /// Compares the grid that was read with the one that is written; `source` is the former in the quantity of the latter.
    pub(crate) fn measure(before: Stored<'_>, source: &IrradianceGrid, after: Stored<'_>) -> Self {
        let valid: Vec<usize> =
            (0..before.grid.vertex_count()).filter(|&vertex| before.grid.is_valid(vertex)).collect();
        let (mut squares, mut norm) = (0.0, 0.0);
        for &vertex in &valid {
            if let (Some(exact), Some(found)) = (source.get(vertex), after.grid.get(vertex)) {
                for (&e, &f) in numbers(&exact).iter().zip(numbers(&found)) {
                    squares += (f64::from(f) - f64::from(e)).powi(2);
                    norm += f64::from(e).powi(2);
                }
            }
        }
        let values = if squares == 0.0 { 0.0 } else { (squares / norm).sqrt() };

        let normals = integrate::fibonacci_sphere(NORMALS).into_iter().map(|n| n.as_vec3());
        let normals: Vec<glam::Vec3> = normals.collect();
        let mut error = IrradianceError::default();
        for &vertex in valid.iter().step_by(valid.len().div_ceil(MOST_VERTICES).max(1)) {
            for &n in &normals {
                error.add(
                    before.irradiance(vertex, n),
                    after.irradiance(vertex, n).max(glam::Vec3::ZERO).as_dvec3(),
                );
            }
        }
        Self { values, irradiance: Some(error.relative_rmse()).filter(|e| !e.is_nan()).unwrap_or(0.0) }
    }

    /// Whether every number came through as it was.
    pub(crate) fn is_none(&self) -> bool {
        self.values == 0.0
    }
}

impl Stored<'_> {
    /// Irradiance at a vertex, before the cut at zero \[W/m²\].
    fn irradiance(&self, vertex: usize, n: glam::Vec3) -> glam::Vec3 {
        match self.grid.get(vertex) {
            Some(VertexValues::Vectors(vectors)) => {
                reconstruct_signed(Reconstruction::for_encoding(self.encoding), &vectors, n)
            }
            Some(VertexValues::Radiance(radiance)) => harmonics::irradiance_signed(&radiance, n),
            None => glam::Vec3::ZERO,
        }
    }
}

fn numbers(values: &VertexValues) -> &[f32] {
    match values {
        VertexValues::Vectors(vectors) => vectors.as_flattened().as_flattened(),
        VertexValues::Radiance(radiance) => radiance.as_flattened(),
    }
}
