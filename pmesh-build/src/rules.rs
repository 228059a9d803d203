//! Which collapses are allowed.

use glam::DVec3;

use crate::surface::{FEW_FACES, Ring, Surface};

/// How strict the rules are. Each level allows what the ones before it allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Rules {
    /// Borders and seams stay lines, no edge gets more faces than two or than it had, no face turns over or becomes a
    /// sliver.
    Strict,
    /// Borders, seams and topology give way: pinholes, tunnels, islands, fins.
    Topology,
    /// Everything that leaves a face.
    Any,
}

/// Cosine of the angle by which a face may turn in one collapse: about 75 degrees.
const LEAST_TURN_COSINE: f64 = 0.25;
/// Twice the area over the sum of squared edge lengths (an equilateral triangle has 0.29): below it a face is a sliver,
/// and the worst face around a vertex may not become worse still. As a rule for each face alone it would lock scans: the
/// Stanford dragon stops at 16,000 vertices with 0.02 so, at 453 with this.
const SLIVER: f64 = 0.005;
/// Above this many faces around a vertex its ring is not collected for every neighbour that wants to collapse onto it, and
/// no distances to all of them are looked at.
pub(crate) const HUB_FACES: usize = 64;

/// Whether moving `u` onto its neighbour `v` is allowed. `ring` holds the edges of `u`. `coincident`: whether faces on the
/// same three vertices may arise.
pub(crate) fn allowed(
    surface: &Surface,
    u: u32,
    v: u32,
    rules: Rules,
    coincident: bool,
    ring: &Ring,
) -> bool {
    let Some(edge) = ring.edge(v) else { return false };
    if surface.face_count <= edge.faces as usize {
        return false;
    }
    if rules == Rules::Strict && !edge.is_feature() && ring.edges.iter().any(|e| e.is_feature()) {
        return false;
    }
    if rules == Rules::Strict && ring.edges.iter().filter(|e| e.is_feature()).count() > 2 {
        return false;
    }
    if rules < Rules::Any && !shapes_allowed(surface, u, v, rules) {
        return false;
    }
    // A component that is as small as it can be may become two opposite triangles, which then vanish at once.
    let coincident = coincident || (surface.face_count > 4 && surface.is_tetrahedron(u));
    rules == Rules::Any || topology_allowed(surface, u, v, rules, coincident, ring)
}

/// Whether every face that moves with `u` keeps its side, and the worst of them is no sliver, or no worse than the worst was.
fn shapes_allowed(surface: &Surface, u: u32, v: u32, rules: Rules) -> bool {
    let to = surface.positions[v as usize];
    let (mut worst_before, mut worst_after) = (f64::INFINITY, f64::INFINITY);
    for &f in surface.around(u) {
        let face = surface.faces[f as usize];
        let before = surface.triangle(f);
        let old = twice_area(before);
        let old_area = old.length();
        worst_before = worst_before.min(old_area / squared_edges(before));
        if face.contains(&v) {
            continue;
        }
        let after = [0, 1, 2].map(|k| if face[k] == u { to } else { before[k] });
        let new = twice_area(after);
        let new_area = new.length();
        // A face without an area has no side to keep.
        if old_area > 0.0 && (new_area <= 0.0 || old.dot(new) < LEAST_TURN_COSINE * old_area * new_area) {
            return false;
        }
        worst_after = worst_after.min(new_area / squared_edges(after));
    }
    rules > Rules::Strict || worst_after >= SLIVER.min(worst_before)
}
/// The link condition, generalised to edges with any number of faces: after the collapse no edge has more faces than
/// two or than one of the edges that it was made of, and, unless `coincident`, no two faces have the same vertices.
fn topology_allowed(surface: &Surface, u: u32, v: u32, rules: Rules, coincident: bool, ring: &Ring) -> bool {
    let around_v = surface.around(v);
    ring.edges.iter().filter(|e| e.to != v).all(|edge| {
        let x = edge.to;
        // Those around `v` have been fetched already; if they are many, there are fewer around most others.
        let (faces, end) = if around_v.len() > FEW_FACES { (surface.around(x), v) } else { (around_v, x) };
        let there = faces.iter().filter(|&&f| surface.faces[f as usize].contains(&end)).count();
        let faces_there = u32::try_from(there).unwrap_or(u32::MAX);
        if faces_there == 0 {
            return true;
        }
        let faces = || surface.around(x).iter().map(|&f| surface.faces[f as usize]);
        if rules == Rules::Strict {
            let shared =
                u32::try_from(faces().filter(|f| f.contains(&u) && f.contains(&v)).count()).unwrap_or(0);
            let after = (edge.faces - shared) + (faces_there - shared);
            if after > edge.faces.max(faces_there).max(2) {
                return false;
            }
        }
        // A face (u, x, y) that becomes (v, x, y) must not meet one that is there.
        coincident
            || faces().filter(|f| f.contains(&u) && !f.contains(&v)).all(|moved| {
                let y = moved.into_iter().find(|&y| y != u && y != x).unwrap_or(x);
                !faces().any(|f| f.contains(&v) && f.contains(&y) && !f.contains(&u))
            })
    })
}

/// The normal of a triangle, as long as twice its area.
pub(crate) fn twice_area([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

fn squared_edges([a, b, c]: [DVec3; 3]) -> f64 {
    a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a)
}

#[cfg(test)]
mod tests;
