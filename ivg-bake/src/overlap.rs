//! Triangles against boxes and points: exact geometry without rays.

use glam::Vec3;

/// Whether a triangle and a box (middle, half size) have a point in common (T. Akenine-Möller, "Fast 3D triangle-box
/// overlap testing", 2001: the thirteen separating axes).
pub(crate) fn triangle_meets_box(triangle: &[Vec3; 3], middle: Vec3, half: Vec3) -> bool {
    let [a, b, c] = triangle.map(|p| p - middle);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    if low.cmpgt(half).any() || high.cmplt(-half).any() {
        return false;
    }
    let edges = [b - a, c - b, a - c];
    let apart = |axis: Vec3| {
        let [pa, pb, pc] = [a.dot(axis), b.dot(axis), c.dot(axis)];
        let reach = half.dot(axis.abs());
        pa.min(pb).min(pc) > reach || pa.max(pb).max(pc) < -reach
    };
    let separated = edges.iter().any(|&edge| Vec3::AXES.iter().any(|&axis| apart(axis.cross(edge))));
    !separated && !apart(edges[0].cross(edges[1]))
}

/// The point of a triangle closest to `p` (C. Ericson, "Real-time collision detection", 2005, section 5.1.5).
pub(crate) fn closest_point(triangle: &[Vec3; 3], p: Vec3) -> Vec3 {
    let [a, b, c] = *triangle;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    // A triangle without area may leave nothing to divide by; its corner is as close as its plane.
    if sum <= 0.0 { a } else { a + ab * (vb / sum) + ac * (vc / sum) }
}

#[cfg(test)]
mod tests;
