//! Watertight intersection of a ray with a triangle.
//!
//! S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013: the triangle is sheared so
//! that the ray becomes the z axis; the three edge functions of neighbours sharing an edge are then the same numbers
//! with opposite sign, and zero counts as inside, so that a ray through an edge or a vertex cannot pass between them. (The
//! paper computes an edge function that is zero again in f64, to know on which side of the edge the ray really is; hit is
//! enough for us.) Both sides of a triangle are hit.

use glam::Vec3;

/// Error of the distance of a crossing that a triangle may well make, which has a greatest depth, a range of depths and a width aside of
/// the ray: times their product over the determinant. An edge function is off by a few roundings of depth times width, and distance
/// is a mean of depths with three such weights. For a long thin triangle, or one seen nearly from its edge, that can be more than the
/// distance of what is near. The worst case, 48 roundings, would hold for the triangle that most rays start on.
const DISTANCE_ERROR: f32 = 4.0 * (f32::EPSILON / 2.0);

/// The corners of a triangle, each padded to four numbers so that an axis can be picked without a bounds check.
pub(crate) type Corners = [[f32; 4]; 3];

/// The corners as [`intersect`] takes them.
pub(crate) fn corners(points: [Vec3; 3]) -> Corners {
    points.map(|p| [p.x, p.y, p.z, 0.0])
}

/// A ray prepared for many triangles (Woop et al., section 3.2).
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShearedRay {
    origin: [f32; 4],
    direction: [f32; 3],
    axes: [usize; 3],
    shear: [f32; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Distance in lengths of the ray's direction, above 0.
    pub(crate) distance: f32,
    /// Barycentric weights of the three corners; they sum to 1.
    pub(crate) weights: [f32; 3],
}

impl ShearedRay {
    /// Prepares a ray. The direction must not be zero.
    #[inline]
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Self {
        let d = direction.to_array();
        let size = direction.abs();
        let z = if size.x > size.y {
            if size.x > size.z { 0 } else { 2 }
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            core::mem::swap(&mut x, &mut y);
        }
        Self {
            origin: [origin.x, origin.y, origin.z, 0.0],
            direction: d,
            axes: [x, y, z],
            shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]],
        }
    }

    /// Where the ray meets the triangle at a distance above 0 and up to `limit`, if it does.
    #[inline]
    pub(crate) fn intersect(&self, triangle: &Corners, limit: f32) -> Option<Crossing> {
        let [kx, ky, kz] = self.axes.map(|axis| axis & 3);
        let [sx, sy, sz] = self.shear;
        let relative = |corner: &[f32; 4]| {
            let z = corner[kz] - self.origin[kz];
            let x = (corner[kx] - self.origin[kx]) - sx * z;
            let y = (corner[ky] - self.origin[ky]) - sy * z;
            [x, y, z]
        };
        let [a, b, c] = [relative(&triangle[0]), relative(&triangle[1]), relative(&triangle[2])];
        let u = c[0] * b[1] - c[1] * b[0];
        let v = a[0] * c[1] - a[1] * c[0];
        let w = b[0] * a[1] - b[1] * a[0];
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let reciprocal = 1.0 / determinant;
        let mut distance = (u * a[2] + v * b[2] + w * c[2]) * sz * reciprocal;
        let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        // A triangle that lies before or behind the origin with all its corners is so with every point.
        if low <= 0.0 && high >= 0.0 {
            let aside = |corner: [f32; 3]| corner[0].abs().max(corner[1].abs());
            let width = aside(a).max(aside(b)).max(aside(c));
            let error = DISTANCE_ERROR * high.max(-low) * (high - low) * width;
            if distance.abs() <= error * (sz * reciprocal).abs() {
                distance = exact_distance(self.origin, self.direction, triangle).unwrap_or(distance);
            }
        }
        let hit = distance > 0.0 && distance <= limit;
        hit.then_some(Crossing { distance, weights: [u * reciprocal, v * reciprocal, w * reciprocal] })
    }
}

/// Distance of a triangle's plane along a ray, in f64, where differences of coordinates have hardly any error; `None` for a plane that
/// the ray lies in.
#[cold]
#[inline(never)]
fn exact_distance(origin: [f32; 4], direction: [f32; 3], triangle: &Corners) -> Option<f32> {
    let point = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z).as_dvec3();
    let [a, b, c] = triangle.map(point);
    let normal = (b - a).cross(c - a);
    let distance = normal.dot(a - point(origin)) / normal.dot(Vec3::from(direction).as_dvec3());
    distance.is_finite().then_some(distance as f32)
}
