//! Can anything cast a shadow? Two proofs that nothing can; without one, shadows are needed.

use glam::{DVec3, Vec3};

use crate::geometry::area_vector;
use crate::{FlatScene, LightKind, Scene};

/// Most products of planes and vertices that a proof may cost: about a second.
const MAX_TESTS: usize = 200_000_000;

/// How far a vertex may lie beyond a plane and still count as on it, as a share of the scene's size: some ten times the
/// rounding of f32 positions.
const FLATNESS: f64 = 1e-6;

/// Why nothing can cast a shadow, or `None` if that is not proved.
pub(super) fn proof_of_none(scene: &Scene, flat: &FlatScene) -> Option<&'static str> {
    let hull = Hull::of(flat)?;
    if hull.planes.len() <= 1 {
        return Some("all surfaces lie in one plane, which cannot shade itself");
    }
    // Light from outside may have to pass the surfaces; light from inside or on a convex shape passes none.
    let outside = scene.mean_sky().is_some_and(|s| s != Vec3::ZERO)
        || scene.lights.iter().any(|light| match light.kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => {
                !hull.contains(position - flat.origin)
            }
            LightKind::Directional { .. } => true,
        });
    (!outside).then_some(
        "all surfaces lie on one convex shape with the lights inside, so nothing stands between them",
    )
}

/// The planes of a scene all of whose surfaces lie on the border of a convex shape.
struct Hull {
    /// Unit normal, pointing away from the shape, and distance from the origin. Both sides of a single plane count.
    planes: Vec<(DVec3, f64)>,
    tolerance: f64,
}

impl Hull {
    fn of(flat: &FlatScene) -> Option<Self> {
        let used: Vec<DVec3> = {
            let mut seen = vec![false; flat.positions.len()];
            flat.triangles.iter().flatten().for_each(|i| seen[*i as usize] = true);
            flat.positions.iter().zip(seen).filter(|(_, seen)| *seen).map(|(p, _)| p.as_dvec3()).collect()
        };
        let (min, max) = (used.iter())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), p| (min.min(*p), max.max(*p)));
        let tolerance = FLATNESS * (max - min).max_element().max(min.abs().max(max.abs()).max_element());
        let mut hull = Self { planes: Vec::new(), tolerance };
        let mut tests = 0usize;
        for triangle in 0..flat.triangles.len() {
            let corners = flat.corners(triangle);
            let Some(normal) = area_vector(corners).try_normalize() else { continue };
            let distance = corners.iter().map(|c| normal.dot(c.as_dvec3())).sum::<f64>() / 3.0;
            tests += hull.planes.len();
            if hull.knows(normal, distance) {
                continue;
            }
            tests += used.len();
            if tests > MAX_TESTS {
                return None;
            }
            let (mut below, mut above) = (0.0f64, 0.0f64);
            for p in &used {
                let d = normal.dot(*p) - distance;
                (below, above) = (below.min(d), above.max(d));
                if below < -tolerance && above > tolerance {
                    return None;
                }
            }
            let sign = if above > tolerance { -1.0 } else { 1.0 };
            hull.planes.push((sign * normal, sign * distance));
        }
        Some(hull)
    }

    fn knows(&self, normal: DVec3, distance: f64) -> bool {
        self.planes.iter().any(|(n, d)| {
            let side = n.dot(normal).signum();
            (*n - side * normal).length_squared() < FLATNESS * FLATNESS
                && (d - side * distance).abs() <= self.tolerance
        })
    }

    fn contains(&self, p: DVec3) -> bool {
        self.planes.iter().all(|(n, d)| n.dot(p) - d <= self.tolerance)
    }
}
