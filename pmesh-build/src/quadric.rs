//! Quadrics of squared distances to planes.

use glam::DVec3;

/// A weighted sum of squared distances to planes, as the ten entries of a symmetric 4x4 matrix, and the surface area
/// that it stands for.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Quadric {
    xx: f64,
    xy: f64,
    xz: f64,
    yy: f64,
    yz: f64,
    zz: f64,
    x: f64,
    y: f64,
    z: f64,
    constant: f64,
    area: f64,
}

impl Quadric {
    /// Adds the plane through `point` with unit normal `n`, weighted; `area` is how much of the weight is surface
    /// (constraint planes stand for none).
    pub(crate) fn add_plane(&mut self, n: DVec3, point: DVec3, weight: f64, area: f64) {
        self.add_linear(n, -n.dot(point), weight, area);
    }

    /// Adds the weighted square of the linear function `n` · p + `d`.
    pub(crate) fn add_linear(&mut self, n: DVec3, d: f64, weight: f64, area: f64) {
        let m = n * weight;
        self.xx += m.x * n.x;
        self.xy += m.x * n.y;
        self.xz += m.x * n.z;
        self.yy += m.y * n.y;
        self.yz += m.y * n.z;
        self.zz += m.z * n.z;
        self.x += m.x * d;
        self.y += m.y * d;
        self.z += m.z * d;
        self.constant += weight * d * d;
        self.area += area;
    }

    /// Adds all planes of another quadric.
    pub(crate) fn add(&mut self, other: &Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yy += other.yy;
        self.yz += other.yz;
        self.zz += other.zz;
        self.x += other.x;
        self.y += other.y;
        self.z += other.z;
        self.constant += other.constant;
        self.area += other.area;
    }

    /// The weighted sum of squared distances of `p` to the planes; rounding never makes it negative.
    pub(crate) fn at(&self, p: DVec3) -> f64 {
        let row_x = self.xx * p.x + 2.0 * (self.xy * p.y + self.xz * p.z + self.x);
        let row_y = self.yy * p.y + 2.0 * (self.yz * p.z + self.y);
        let row_z = self.zz * p.z + 2.0 * self.z;
        (row_x * p.x + row_y * p.y + row_z * p.z + self.constant).max(0.0)
    }

    /// The surface area whose planes were added.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }
}
