//! What a collapse costs.

use glam::DVec3;

use crate::attributes::Deviations;
use crate::distance::squared_distance;
use crate::hausdorff::Hausdorff;
use crate::options::Cost;
use crate::quadric::Quadric;
use crate::rules::{HUB_FACES, twice_area};
use crate::surface::{Ring, Surface};

/// Weight of the constraint planes along borders, per squared edge length, against face planes per area.
const BORDER_WEIGHT: f64 = 2.0;
/// Weight of the constraint planes along seams. Less than a border's: a seam that moves leaves no gap.
const SEAM_WEIGHT: f64 = 1.0;
/// Share of the squared length of an edge, times the area around the vertex that moves, that is added to a quadric's
/// cost. It decides where quadrics cannot: in flat regions short edges go first, so that triangles stay well shaped. An
/// edge pays as much as for a distance of 1/3000 of its length.
const LENGTH_WEIGHT: f64 = 1e-7;
/// Mean of the squared heights of a cone over its area, per squared height of its tip.
const CONE: f64 = 1.0 / 6.0;
/// Hausdorff distances count from one vertex in this many on. Before, collapses are many and move little.
const HAUSDORFF_SHARE: usize = 8;

/// The costs of all collapses, kept up to date while vertices go.
#[derive(Debug)]
pub(crate) struct Costs<'a> {
    kind: Cost,
    /// Area of the whole surface \[m²\].
    total_area: f64,
    quadrics: Vec<Quadric>,
    /// Each vertex's quadric at its own position, with the deviation of its attributes.
    own: Vec<f64>,
    deviations: Option<Deviations<'a>>,
    hausdorff: Option<Hausdorff>,
}

impl<'a> Costs<'a> {
    /// For the uncollapsed surface.
    pub(crate) fn new(
        kind: Cost,
        surface: &Surface,
        deviations: Option<Deviations<'a>>,
        ring: &mut Ring,
    ) -> Self {
        let mut quadrics = vec![Quadric::default(); surface.positions.len()];
        let mut total_area = 0.0;
        for f in 0..surface.faces.len() {
            let triangle @ [a, ..] = surface.faces[f].map(|v| surface.positions[v as usize]);
            let normal = twice_area(triangle);
            let twice = normal.length();
            total_area += 0.5 * twice;
            if twice > 0.0 {
                for v in surface.faces[f] {
                    quadrics[v as usize].add_plane(normal / twice, a, 0.5 * twice, 0.5 * twice);
                }
            }
        }
        for u in 0..crate::input::index(surface.positions.len()) {
            ring.collect(surface, u);
            for edge in ring.edges.iter().filter(|e| e.is_feature() && e.to > u) {
                let weight = if edge.seam && edge.faces > 1 { SEAM_WEIGHT } else { BORDER_WEIGHT };
                for &f in surface.around(u).iter().filter(|&&f| surface.faces[f as usize].contains(&edge.to))
                {
                    let from = surface.positions[u as usize];
                    let along = surface.positions[edge.to as usize] - from;
                    let across = along.cross(twice_area(surface.triangle(f)));
                    let length = across.length();
                    if length > 0.0 {
                        for v in [u, edge.to] {
                            let weight = weight * along.length_squared();
                            quadrics[v as usize].add_plane(across / length, from, weight, 0.0);
                        }
                    }
                }
            }
        }
        let hausdorff = (kind == Cost::Quadric && total_area > 0.0).then(|| Hausdorff::new(surface));
        let own = vec![0.0; quadrics.len()];
        let mut costs = Self { kind, total_area, own, quadrics, deviations, hausdorff };
        for v in 0..crate::input::index(surface.positions.len()) {
            costs.own[v as usize] = costs.standing(surface, v);
        }
        costs
    }

    /// What moving `u` onto its neighbour `v` costs.
    ///
    /// For quadrics: by how much the squared distances to the planes that both stand for grow, summed over the area. That
    /// keeps the mean distance small; [`Costs::squared_distance`] sees to what has hardly any area.
    pub(crate) fn of(&self, surface: &Surface, u: u32, v: u32) -> f64 {
        let (from, to) = (surface.positions[u as usize], surface.positions[v as usize]);
        match self.kind {
            Cost::Quadric => {
                let length = LENGTH_WEIGHT * self.quadrics[u as usize].area() * from.distance_squared(to);
                (self.sum(surface, u, v) - self.own[u as usize]).max(0.0) + length
            }
            Cost::Melax => from.distance(to) * curvature(surface, u, v),
        }
    }

    /// The area that vertices stand for on average when `left` of them are left \[m²\]: what a squared metre of distance
    /// from the whole surface costs.
    pub(crate) fn average_area(&self, left: usize) -> f64 {
        // Every face counts at each of its three vertices.
        3.0 * self.total_area / left as f64
    }

    /// Whether Hausdorff distances count when `left` vertices are left.
    pub(crate) fn measures(&self, left: usize) -> bool {
        self.hausdorff.is_some() && left * HAUSDORFF_SHARE <= self.quadrics.len()
    }

    /// The squared distance that moving `u`, whose edges are in `ring`, onto its neighbour `v` costs at least \[m²\]: times
    /// [`Costs::average_area`], whatever the quadrics say.
    ///
    /// Quadrics know means over areas, not what sticks out of them, and planes, not where on them the surface ends. So the
    /// greatest distance between the whole surface and what is left of it here counts as if an average vertex were all
    /// that far off. Measured on six scans and models at four levels each, that keeps the greatest distance of all levels
    /// below that of quadrics alone, and the mean of the coarse ones too.
    ///
    /// While few vertices have gone it is not looked at, but thin spikes go even then: their sides keep their planes, and
    /// the tip has hardly any area. Where `u` stands for less area than vertices do on average, its height above the faces
    /// that take its place counts as that of a cone, the mean of whose squared heights is a sixth of its own.
    ///
    /// Exact only between `enough` and `limit`: below, anything as low may come back, above, anything as high.
    pub(crate) fn squared_distance(
        &mut self,
        surface: &Surface,
        ring: &Ring,
        (u, v): (u32, u32),
        left: usize,
        (enough, limit): (f64, f64),
    ) -> f64 {
        if self.hausdorff.is_none() {
            return 0.0;
        }
        let mut least = 0.0;
        if self.quadrics[u as usize].area() < self.average_area(left) {
            let (from, to) = (surface.positions[u as usize], surface.positions[v as usize]);
            let moved = surface
                .around(u)
                .iter()
                .map(|&f| surface.faces[f as usize])
                .filter(|face| !face.contains(&v));
            let height = moved.fold(from.distance_squared(to), |least, face| {
                let corner = |x: u32| if x == u { to } else { surface.positions[x as usize] };
                least.min(squared_distance(from, face.map(corner)))
            });
            least = CONE * height;
        }
        let hub = surface.around(u).len().max(surface.around(v).len()) > HUB_FACES;
        let measures = self.measures(left);
        let Some(hausdorff) = self.hausdorff.as_mut().filter(|_| measures && !hub && least <= limit) else {
            return least;
        };
        hausdorff.squared_distance(surface, ring, (u, v), (least.max(enough), limit))
    }

    /// How far the surface moves, estimated \[m\]: for quadrics the root of the mean over the area of
    /// the squared distances of `v` to the planes that it stands for, and of weighted deviations of attributes; for Melax's cost the cost itself, which is a length.
    pub(crate) fn distance(&self, surface: &Surface, u: u32, v: u32) -> f64 {
        match self.kind {
            Cost::Quadric => {
                let (moving, staying) = (&self.quadrics[u as usize], &self.quadrics[v as usize]);
                let area = moving.area() + staying.area();
                if area > 0.0 { (self.sum(surface, u, v) / area).sqrt() } else { 0.0 }
            }
            Cost::Melax => self.of(surface, u, v),
        }
    }

    /// The squared distances and deviations of what `u` and `v` stand for once `u` has moved onto `v`.
    fn sum(&self, surface: &Surface, u: u32, v: u32) -> f64 {
        let deviation = self.deviations.as_ref().map_or(0.0, |d| d.moved(surface, u, v));
        self.quadrics[u as usize].at(surface.positions[v as usize]) + deviation + self.own[v as usize]
    }

    /// The squared distances and deviations of what `v` stands for.
    fn standing(&self, surface: &Surface, v: u32) -> f64 {
        let deviation = self.deviations.as_ref().map_or(0.0, |d| d.own(surface, v));
        self.quadrics[v as usize].at(surface.positions[v as usize]) + deviation
    }

    /// Tells that `u` has moved onto `v` and its wedges have become `targets`.
    pub(crate) fn collapsed(&mut self, surface: &Surface, u: u32, v: u32, targets: &[u32]) {
        let moved = self.quadrics[u as usize];
        self.quadrics[v as usize].add(&moved);
        if let Some(hausdorff) = &mut self.hausdorff {
            hausdorff.collapsed(u, v);
        }
        if let Some(deviations) = &mut self.deviations {
            deviations.collapsed(u, targets);
        }
        self.own[v as usize] = self.standing(surface, v);
    }
}

/// Melax's curvature term: over the faces around `u`, the greatest turn against the nearest of the faces on the edge,
/// from 0 (flat) to 1 (folded back).
fn curvature(surface: &Surface, u: u32, v: u32) -> f64 {
    let unit = |f: u32| twice_area(surface.triangle(f)).try_normalize().unwrap_or(DVec3::ZERO);
    let around = surface.around(u);
    let sides = || around.iter().filter(|&&f| surface.faces[f as usize].contains(&v));
    let turn = |f: u32| {
        let normal = unit(f);
        sides().map(|&side| (1.0 - normal.dot(unit(side))) * 0.5).fold(1.0, f64::min)
    };
    around.iter().map(|&f| turn(f)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
