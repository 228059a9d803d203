//! How far what a .pmesh file stores can be from the mesh that was to be written.

use pmesh_format::Header;
use serde_json::{Value, json};

/// Bounds of what rounding does; 0 for what is exact or not there. Colours, materials and faces are always exact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Rounding {
    /// Of each coordinate of a position \[m\].
    pub(crate) position: f64,
    /// Angle between a normal and what is stored \[degrees\].
    pub(crate) normal: f64,
    /// Of each texture coordinate, whose unit is the width of the image.
    pub(crate) uv: f64,
}

impl Rounding {
    /// Half a step of each lattice (PMESH-POS-03, PMESH-COD-16 and -17).
    pub(crate) fn of(header: &Header) -> Self {
        let position = header.positions.bits().map_or(0.0, |bits| half_step(header.bounds, bits));
        let uv = if header.uv_bits > 0 { half_step(header.uv_bounds, header.uv_bits) } else { 0.0 };
        let normal = if header.normal_bits > 0 { octahedral_angle(header.normal_bits) } else { 0.0 };
        Self { position, normal, uv }
    }

    /// The greater of each.
    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            position: self.position.max(other.position),
            normal: self.normal.max(other.normal),
            uv: self.uv.max(other.uv),
        }
    }

    pub(crate) fn json(&self) -> Value {
        json!({ "position_m": self.position, "normal_degrees": self.normal, "uv": self.uv })
    }

    /// One line for people.
    pub(crate) fn text(&self) -> String {
        let parts: Vec<String> = [
            (self.position, " m in a coordinate"),
            (self.normal, " degrees in a normal"),
            (self.uv, " in a texture coordinate"),
        ]
        .into_iter()
        .filter(|&(bound, _)| bound > 0.0)
        .map(|(bound, what)| format!("{bound:.1e}{what}"))
        .collect();
        if parts.is_empty() {
            return "nothing is rounded".to_owned();
        }
        format!("rounded, at most by {}; --mode raw --positions f32 rounds nothing", parts.join(", "))
    }
}

/// Half a step of the lattice of so many bits along the longest side of a box.
fn half_step<const N: usize>([low, high]: [[f32; N]; 2], bits: u8) -> f64 {
    let sides = low.iter().zip(&high).map(|(&low, &high)| f64::from(high) - f64::from(low));
    sides.fold(0.0, f64::max) / f64::from((1u32 << bits) - 1) / 2.0
}

/// The greatest angle between a normal and the nearest code of so many bits \[degrees\].
///
/// On each face of the octahedron |x| + |y| + |z| = 1 the points of the codes are the corners of equilateral triangles of
/// side √2 / M, so none is farther from the nearest than their circumradius, √(2/3) / M. The octahedron is nowhere nearer
/// to its middle than 1/√3, where that is seen at an angle of √2 / M.
fn octahedral_angle(bits: u8) -> f64 {
    let greatest = f64::from((1u32 << (bits - 1)) - 1);
    (std::f64::consts::SQRT_2 / greatest).to_degrees()
}

#[cfg(test)]
mod tests;
