//! The distance from a point to a triangle.

use glam::DVec3;

/// Squared distance from `p` to the triangle `a`, `b`, `c`, which may have no area \[m²\].
pub(crate) fn squared_distance(p: DVec3, triangle @ [a, b, c]: [DVec3; 3]) -> f64 {
    let squared = squared_distance_by_region(p, triangle);
    if squared.is_nan() {
        // No area, so no plane: what there is are its edges.
        return to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a));
    }
    squared
}

fn to_segment(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let along = b - a;
    let squared = along.length_squared();
    let share = if squared > 0.0 { (along.dot(p - a) / squared).clamp(0.0, 1.0) } else { 0.0 };
    p.distance_squared(a + along * share)
}

/// By the region of the triangle's plane in which the nearest point lies (Ericson, Real-Time Collision Detection, 5.1.5); NaN
/// if the triangle has no area.
fn squared_distance_by_region(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    let (from_a, from_b, from_c) = (p - a, p - b, p - c);
    let (ab_a, ac_a) = (ab.dot(from_a), ac.dot(from_a));
    let (ab_b, ac_b) = (ab.dot(from_b), ac.dot(from_b));
    let (ab_c, ac_c) = (ab.dot(from_c), ac.dot(from_c));
    // Nearest to a corner.
    if ab_a <= 0.0 && ac_a <= 0.0 {
        return from_a.length_squared();
    }
    if ab_b >= 0.0 && ac_b <= ab_b {
        return from_b.length_squared();
    }
    if ac_c >= 0.0 && ab_c <= ac_c {
        return from_c.length_squared();
    }
    // Nearest to an edge: the areas opposite to the corners tell on which side of it the point lies.
    if ab_a * ac_b - ab_b * ac_a <= 0.0 && ab_a >= 0.0 && ab_b <= 0.0 {
        return (from_a - ab * (ab_a / (ab_a - ab_b))).length_squared();
    }
    if ab_c * ac_a - ab_a * ac_c <= 0.0 && ac_a >= 0.0 && ac_c <= 0.0 {
        return (from_a - ac * (ac_a / (ac_a - ac_c))).length_squared();
    }
    let (to_c, to_b) = (ac_b - ab_b, ab_c - ac_c);
    if ab_b * ac_c - ab_c * ac_b <= 0.0 && to_c >= 0.0 && to_b >= 0.0 {
        return (from_b - (c - b) * (to_c / (to_c + to_b))).length_squared();
    }
    let normal = ab.cross(ac);
    let height = normal.dot(from_a);
    height * height / normal.length_squared()
}

#[cfg(test)]
mod tests;
