//! Which vertices light reaches, where each one looks from, and which edges between them geometry cuts.
//!
//! **Where a vertex looks from.** A vertex within a 64th of a step from a surface has no side of its own: bounds are
//! often put exactly on the walls. It then looks from a point a 32nd of a step away. Of the points around it, those
//! that see each other form sides; the side is taken that light reaches, then the one with the most seen volume inside
//! the lattice's bounds (so that a wall on the bounds belongs to the room that the bounds enclose), then the one with
//! the most volume at all, then the first.
//!
//! **Validity.** A vertex is invalid (0) if no light reaches it: of 128 random paths from it, with a light sampled at
//! the vertex and at every reflection, fewer than two find light. Parity or back faces alone would have to trust that
//! meshes are closed and wound one way; light knows nothing of that. Together they tell more: a vertex that sees nearly
//! nothing but backs of faces and finds light on fewer than a quarter of its paths lies inside a model whose mesh has
//! holes. It is also invalid if its region is smaller than
//! [`FEWEST_SUB_CELLS`]. Otherwise validity is 255, less where the region is under an eighth of the cell (the share of a
//! vertex in the corner of a room), in proportion. Where no light reaches any vertex, darkness is the truth, and the
//! vertices that see anything are valid.
//!
//! **Blocked edges.** The edge to the next vertex is blocked if geometry lies between the points that the two look from.
//!
//! Where glass is simulated, panes that let most light through are not there for any of this: one sees past them. Solids of glass
//! stop sight, as other solids do, but not the light that is looked for.

use glam::Vec3;

use crate::BakeError;
use crate::accel::Hit;
use crate::centring::Centring;
use crate::dual::Boxes;
use crate::overlap::{closest_point, triangle_meets_box};
use crate::region::{FEWEST_SUB_CELLS, Mask, Region, Regions, SUB, SUB_CELLS};
use crate::sampling::hemisphere;
use crate::sampling::rng::{Purpose, Stream};
use crate::stage::Stage;
use crate::workers::{Workers, map};

/// Distance to a surface below which a vertex looks from a point beside it, in steps.
const TOO_CLOSE: f32 = 1.0 / 64.0;

/// How far beside, in steps along each axis.
pub(crate) const ASIDE: f32 = 1.0 / 32.0;

/// Paths that look for light.
const REACH_PATHS: u32 = 128;

/// Paths that must find it.
const REACH_FOUND: u32 = 2;

/// Paths that must find it from a vertex that sees the backs of faces all around: a quarter. The inside of a scanned model
/// gets a little light through the holes in its mesh; a room whose faces were wound outwards gets as much as any room.
const REACH_FOUND_ENCLOSED: u32 = REACH_PATHS / 4;

/// Share of the first flights that must end at the back of a face for a vertex to be taken for enclosed.
const ENCLOSED: f64 = 0.9;

/// First flights that are looked at before a vertex is taken to lie in the open.
const FEWEST_LOOKS: u32 = 16;

/// Reflections of such a path.
const REACH_BOUNCES: u32 = 8;

/// Cosine below which light that leaves or meets a surface does not count as found. A point in the plane of a ceiling with
/// a light set into it, outside the room, sees the light in theory: from the side, along the ceiling, over the wall.
const GRAZING: f32 = 0.01;

/// Seed of the paths: the surroundings do not depend on the photons' seed.
const REACH_SEED: u64 = 0;

/// Share of a cell from which on a vertex counts fully: the corner of a room.
const FULL_SHARE: u32 = SUB_CELLS / 8;

/// What is known about the surroundings of every vertex.
#[derive(Debug)]
pub(crate) struct Surroundings {
    /// What counts in each dual cell.
    pub(crate) regions: Regions,
    /// 0 = no light … 255 = full weight.
    pub(crate) validity: Vec<u8>,
    /// Bits 0, 1, 2: the edge to the +x, +y, +z neighbour is blocked.
    pub(crate) blocked_edges: Vec<u8>,
    /// Where each vertex looks from, in bake space.
    pub(crate) eyes: Vec<Vec3>,
    /// How means over cells become the light at these points.
    pub(crate) centring: Centring,
}

/// A vertex's point of view.
#[derive(Clone, Copy, Debug)]
struct View {
    eye: Vec3,
    /// What is seen of the cell; `None`: all, no geometry touches it.
    mask: Option<Mask>,
    lit: bool,
}

impl Surroundings {
    /// Looks around from every vertex.
    ///
    /// # Errors
    ///
    /// [`BakeError::Cancelled`].
    pub(crate) fn new(stage: &Stage<'_>, cells: &Boxes, workers: &Workers<'_>) -> Result<Self, BakeError> {
        let opaque = stage.surfaces.without_panes();
        let triangles = opaque.as_deref().unwrap_or(stage.surfaces.triangles());
        let distances = distances(triangles, cells);
        let sides = SidePoints::new(triangles, cells, &distances);
        let views = map(workers, cells.len(), |vertex| stage.view(cells, vertex, distances[vertex], &sides))?;
        let any_lit = views.iter().any(|view| view.lit);
        let regions = Regions::new(views.iter().map(|view| {
            let counts = view.lit || !any_lit;
            if counts { view.mask.filter_small() } else { Some(Mask::NONE) }
        }));
        let validity: Vec<u8> = (0..cells.len())
            .map(|vertex| {
                let share = (regions.get(vertex).share() * f64::from(SUB_CELLS)) as u32;
                (255 * share.min(FULL_SHARE)).div_ceil(FULL_SHARE) as u8
            })
            .collect();
        let eyes: Vec<Vec3> = views.iter().map(|view| view.eye).collect();
        let blocked_edges = map(workers, cells.len(), |vertex| {
            let at = cells.coords(vertex);
            let mut bits = 0;
            for axis in 0..3 {
                if at[axis] + 1 == cells.count[axis] {
                    continue;
                }
                let mut next = at;
                next[axis] += 1;
                let next = cells.index(next);
                // An edge lies in the two cells it joins: without geometry in them nothing can be in between.
                let touched = distances[vertex].is_finite() || distances[next].is_finite();
                if touched && stage.sight().occluded(eyes[vertex], eyes[next] - eyes[vertex], 1.0) {
                    bits |= 1 << axis;
                }
            }
            bits
        })?;
        let valid = |vertex: usize| validity[vertex] > 0;
        let centring = Centring::new(stage, cells, &regions, &eyes, valid, workers)?;
        Ok(Self { regions, validity, blocked_edges, eyes, centring })
    }

    /// Surroundings in which everything counts: what RR-6983 assumes.
    pub(crate) fn open(cells: &Boxes) -> Self {
        let vertices = cells.len();
        Self {
            regions: Regions::new((0..vertices).map(|_| None)),
            validity: vec![255; vertices],
            blocked_edges: vec![0; vertices],
            eyes: (0..vertices).map(|vertex| cells.middle(cells.coords(vertex))).collect(),
            centring: Centring::even(cells),
        }
    }

    /// Whether geometry touches the dual cell of a vertex and leaves some of it.
    pub(crate) fn is_touched(&self, vertex: usize) -> bool {
        matches!(self.regions.get(vertex), Region::Part(_))
    }

    /// The valid neighbours of a vertex to which the way is free.
    pub(crate) fn open_neighbours(&self, cells: &Boxes, vertex: usize) -> impl Iterator<Item = usize> {
        let at = cells.coords(vertex);
        let neighbours = (0..3).flat_map(move |axis| [(axis, false), (axis, true)]);
        neighbours.filter_map(move |(axis, above)| {
            let mut next = at;
            next[axis] = if above { at[axis] + 1 } else { at[axis].wrapping_sub(1) };
            if next[axis] >= cells.count[axis] {
                return None;
            }
            let next = cells.index(next);
            let lower = if above { vertex } else { next };
            let open = self.blocked_edges[lower] >> axis & 1 == 0;
            (open && self.validity[next] > 0).then_some(next)
        })
    }
}

trait FilterSmall {
    /// The mask, or the empty one if it is too small to make a region.
    fn filter_small(self) -> Self;
}

impl FilterSmall for Option<Mask> {
    fn filter_small(self) -> Self {
        self.map(|mask| if mask.count() < FEWEST_SUB_CELLS { Mask::NONE } else { mask })
    }
}

impl Stage<'_> {
    /// The point of view of a vertex whose nearest surface in its cell is at `distance`.
    fn view(&self, cells: &Boxes, vertex: usize, distance: f32, sides: &SidePoints) -> View {
        let at = cells.coords(vertex);
        let middle = cells.middle(at);
        if distance.is_infinite() {
            return View { eye: middle, mask: None, lit: self.reached(middle, vertex) };
        }
        let look = |eye: Vec3| {
            let lit = self.reached(eye, vertex);
            let mask =
                if lit { Mask::seen(self.sight(), eye, cells.corner(at), cells.step) } else { Mask::NONE };
            View { eye, mask: Some(mask), lit }
        };
        let Some(points) = sides.of(vertex) else { return look(middle) };
        // The first point of each side: those that come later see one of them.
        let mut first: Vec<Vec3> = Vec::new();
        for &point in points {
            if first.iter().all(|&other| self.sight().occluded(point, other - point, 1.0)) {
                first.push(point);
            }
        }
        let inside = |[x, y, z]: [usize; 3]| {
            (0..3).all(|a| {
                let half = [x, y, z][a] >= SUB / 2;
                let (lowest, highest) = (at[a] == 0, at[a] + 1 == cells.count[a]);
                !(lowest && !half || highest && half) || cells.count[a] == 1
            })
        };
        let views: Vec<View> = first.into_iter().map(look).collect();
        let rank = |view: &View| {
            let mask = view.mask.unwrap_or(Mask::NONE);
            (view.lit, mask.count_if(inside), mask.count())
        };
        let best = views.iter().fold(None, |best: Option<&View>, view| match best {
            Some(best) if rank(best) >= rank(view) => Some(best),
            _ => Some(view),
        });
        best.copied().unwrap_or(View { eye: middle, mask: Some(Mask::NONE), lit: false })
    }

    /// Whether light, direct or reflected, reaches a point in the open.
    fn reached(&self, point: Vec3, vertex: usize) -> bool {
        let (mut found, mut behind) = (0, 0);
        for path in 0..REACH_PATHS {
            let item = vertex as u64 * u64::from(REACH_PATHS) + u64::from(path);
            let stream = Stream::new(REACH_SEED, item);
            let u = stream.uniforms(0, Purpose::Reach);
            let direction = hemisphere::sphere([u[0], u[1]]);
            let first = self.clear().closest_hit(point, direction, f32::MAX);
            behind += u32::from(first.is_some_and(|hit| self.is_behind(&hit, direction)));
            found += u32::from(self.path_finds_light(point, direction, first, &stream));
            // Most vertices are settled by their first paths.
            let looks = path + 1;
            if found >= REACH_FOUND
                && looks >= FEWEST_LOOKS
                && f64::from(behind) < ENCLOSED * f64::from(looks)
            {
                return true;
            }
        }
        let enclosed = f64::from(behind) >= ENCLOSED * f64::from(REACH_PATHS);
        found >= if enclosed { REACH_FOUND_ENCLOSED } else { REACH_FOUND }
    }

    /// Whether a ray meets a surface from behind.
    fn is_behind(&self, hit: &Hit, direction: Vec3) -> bool {
        self.surfaces.point(hit.triangle, hit.weights).normal.dot(direction) > 0.0
    }

    /// Whether a path from `point`, whose first flight goes along `direction` and ends at `first`, finds light.
    fn path_finds_light(&self, point: Vec3, direction: Vec3, first: Option<Hit>, stream: &Stream) -> bool {
        if self.lit_directly(point, None, stream, 0) {
            return true;
        }
        let (mut direction, mut next) = (direction, first);
        for bounce in 1..=REACH_BOUNCES {
            let Some(hit) = next else {
                return (self.emitters.sky() + self.emitters.sky_image(direction)).max_element() > 0.0;
            };
            let surface = self.surfaces.point(hit.triangle, hit.weights);
            if self.surfaces.emission(hit.triangle, surface.normal, -direction).max_element() > 0.0 {
                return true;
            }
            if !self.surfaces.sends_on(&hit) {
                return false;
            }
            let side = surface.facing(-direction);
            let origin = surface.origin(side);
            if self.lit_directly(origin, Some(side), stream, bounce) {
                return true;
            }
            let u = stream.uniforms(bounce, Purpose::Reach);
            direction = hemisphere::cosine(side, [u[0], u[1]]);
            next = self.clear().closest_hit(origin, direction, f32::MAX);
        }
        false
    }

    /// Whether a place on a light, chosen at random, shines on a point (of a surface with normal `side`).
    fn lit_directly(&self, point: Vec3, side: Option<Vec3>, stream: &Stream, step: u32) -> bool {
        self.emitters.arrive(point, stream, step).is_some_and(|light| {
            side.is_none_or(|side| side.dot(light.direction) > GRAZING)
                && light.cosine > GRAZING
                && !self.clear().occluded(point, light.direction, light.distance)
        })
    }
}

/// Calls `visit(triangle, cell)` for each cell that a triangle touches.
fn for_each_touch(triangles: &[[Vec3; 3]], cells: &Boxes, mut visit: impl FnMut(&[Vec3; 3], [usize; 3])) {
    let half = Vec3::from(cells.step) * 0.5;
    for triangle in triangles {
        let [a, b, c] = *triangle;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let range: [(usize, usize); 3] = core::array::from_fn(|axis| {
            let place = |x: f32| (x - cells.low[axis]) / cells.step[axis];
            // Saturating casts: what lies below the lowest cell ends at 0. One more cell against rounding.
            let first = (place(low[axis]) - 0.01).max(0.0) as usize;
            let last = (place(high[axis]) + 0.01).clamp(-1.0, cells.count[axis] as f32) + 1.0;
            (first, (last as usize).min(cells.count[axis]))
        });
        for k in range[2].0..range[2].1 {
            for j in range[1].0..range[1].1 {
                for i in range[0].0..range[0].1 {
                    if triangle_meets_box(triangle, cells.middle([i, j, k]), half) {
                        visit(triangle, [i, j, k]);
                    }
                }
            }
        }
    }
}

/// Distance from each vertex to the nearest triangle that touches its cell, in the shortest step; infinite if none.
fn distances(triangles: &[[Vec3; 3]], cells: &Boxes) -> Vec<f32> {
    let shortest = Vec3::from(cells.step).min_element();
    let mut distances = vec![f32::INFINITY; cells.len()];
    for_each_touch(triangles, cells, |triangle, at| {
        let middle = cells.middle(at);
        let nearest = &mut distances[cells.index(at)];
        *nearest = nearest.min(closest_point(triangle, middle).distance(middle) / shortest);
    });
    distances
}

/// For each vertex that is too close to a surface: the points around it that are not.
#[derive(Debug)]
struct SidePoints {
    /// Index into `points` of each vertex, or none.
    slots: Vec<Option<u32>>,
    points: Vec<Vec<Vec3>>,
}

impl SidePoints {
    fn new(triangles: &[[Vec3; 3]], cells: &Boxes, distances: &[f32]) -> Self {
        let mut slots = vec![None; cells.len()];
        let mut points: Vec<Vec<Vec3>> = Vec::new();
        for (vertex, _) in distances.iter().enumerate().filter(|(_, distance)| **distance < TOO_CLOSE) {
            slots[vertex] = Some(points.len() as u32);
            let middle = cells.middle(cells.coords(vertex));
            let offset = Vec3::from(cells.step) * ASIDE;
            points.push(directions().map(|direction| middle + direction * offset).collect());
        }
        // A point along the normal of a surface is a 32nd of a step away from it; half of that keeps the points of the
        // two sides and drops those that lie in it.
        let clearance = 0.5 * ASIDE * Vec3::from(cells.step).min_element();
        for_each_touch(triangles, cells, |triangle, at| {
            if let Some(slot) = slots[cells.index(at)] {
                let slot: u32 = slot;
                points[slot as usize].retain(|&p| closest_point(triangle, p).distance(p) >= clearance);
            }
        });
        Self { slots, points }
    }

    fn of(&self, vertex: usize) -> Option<&[Vec3]> {
        self.slots[vertex].map(|slot| self.points[slot as usize].as_slice())
    }
}

/// The 26 directions to the neighbours on a lattice: along the axes, then across edges, then across corners.
fn directions() -> impl Iterator<Item = Vec3> {
    let all = (0..27).map(|n| Vec3::new((n % 3) as f32, (n / 3 % 3) as f32, (n / 9) as f32) - 1.0);
    (1..=3).flat_map(move |axes| all.clone().filter(move |d| d.length_squared() as i32 == axes))
}

#[cfg(test)]
mod tests;
