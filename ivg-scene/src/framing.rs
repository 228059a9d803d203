//! A camera for a scene that has none.

use glam::DVec3;

use crate::{Camera, FlatScene, Scene};

/// Probe lines along each axis, one in the middle of each of PROBES x PROBES cells of the box's face.
const PROBES: usize = 7;
/// Share of probe points that must agree before the scene counts as a room, closed or open to one side. A room is full
/// of free points; between the parts of an object there are few.
const ROOM_SHARE: f64 = 0.3;
/// Vertical field of view of the chosen camera \[rad\]: 45 degrees from outside, wider inside a room.
const FOV_OUTSIDE: f64 = std::f64::consts::FRAC_PI_4;
const FOV_INSIDE: f64 = 1.05;
/// Room left around what is framed.
const MARGIN: f64 = 1.04;
/// Height of the eye in a room, as a share of its height.
const EYE_HEIGHT: f64 = 0.6;

/// The six directions in the order +x -x +y -y +z -z.
const DIRECTIONS: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

impl Scene {
    /// The camera of the scene, or one that shows it.
    ///
    /// The automatic camera takes +y as up. Lines along the three axes probe the bounding box: a point counts as in free
    /// space if the first surface in most directions shows it its front. If many points are free and closed in on all six
    /// sides, the scene is a **closed room**: the eye is placed at the free point from which the view along a
    /// horizontal axis is longest, looking that way. If they are closed in on five sides and open to the same one, it is an **open box**:
    /// the eye stands outside before the opening. Everything else is an **object**: the eye looks at it from the front (+z),
    /// a little from the right and from above.
    #[must_use]
    pub fn camera_or_framed(&self) -> Camera {
        self.camera.unwrap_or_else(|| frame(&self.flatten()))
    }
}

fn frame(flat: &FlatScene) -> Camera {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &i in flat.triangles.iter().flatten() {
        let p = flat.positions[i as usize].as_dvec3();
        (min, max) = (min.min(p), max.max(p));
    }
    if min.cmpgt(max).any() {
        (min, max) = (DVec3::NEG_ONE, DVec3::ONE);
    }
    let probes = Probes::new(flat, min, max);
    let mut camera = match probes.openness() {
        Openness::Closed => inside(&probes),
        Openness::Open(side) => before(min, max, DIRECTIONS[side]),
        Openness::Object => around(min, max),
    };
    camera.eye += flat.origin;
    camera.target += flat.origin;
    if camera.eye == camera.target {
        // So small and so far that f64 cannot hold both.
        camera.eye.z += camera.eye.abs().max_element();
    }
    camera
}

fn camera(eye: DVec3, target: DVec3, fov: f64) -> Camera {
    let axis = (target - eye).normalize_or(DVec3::NEG_Z);
    // Looking straight up or down, +y says nothing about what is up.
    let up = if axis.y.abs() > 0.99 { DVec3::NEG_Z } else { DVec3::Y };
    Camera { eye, target: if eye == target { eye + axis } else { target }, up, vertical_fov: fov as f32 }
}

/// Before an opening, so far that the opening fills a square picture.
fn before(min: DVec3, max: DVec3, outwards: DVec3) -> Camera {
    let centre = 0.5 * (min + max);
    let half = 0.5 * (max - min);
    let across = (half * (DVec3::ONE - outwards.abs())).max_element();
    let distance = (half * outwards.abs()).max_element() + MARGIN * across / (0.5 * FOV_OUTSIDE).tan();
    camera(centre + distance * outwards, centre, FOV_OUTSIDE)
}

/// Around an object, so far that its bounding sphere fits.
fn around(min: DVec3, max: DVec3) -> Camera {
    let centre = 0.5 * (min + max);
    let radius = Some((0.5 * (max - min)).length()).filter(|r| *r > 0.0).unwrap_or(1.0);
    let direction = DVec3::new(0.35, 0.25, 1.0).normalize();
    camera(centre + radius * MARGIN / (0.5 * FOV_OUTSIDE).sin() * direction, centre, FOV_OUTSIDE)
}

/// At the end of the longest free view in a closed room.
fn inside(probes: &Probes) -> Camera {
    let mut best = (f64::NEG_INFINITY, DVec3::ZERO, DVec3::NEG_Z);
    let height = probes.max.y - probes.min.y;
    for index in 0..PROBES.pow(3) {
        let point = probes.point(index);
        let Some(hits) = probes.free(index).filter(|hits| hits.iter().all(Option::is_some)) else { continue };
        let free = hits.map(|hit| hit.map_or(0.0, |(distance, _)| distance));
        // A wall close by spoils the view, and so does an eye at the floor or the ceiling.
        let clearance = free[..2].iter().chain(&free[4..]).fold(f64::INFINITY, |least, f| least.min(*f));
        let off_height = ((point.y - probes.min.y) / height - EYE_HEIGHT).abs();
        for side in [0, 1, 4, 5] {
            let score = free[side] * (1.0 - off_height) + clearance.min(0.1 * free[side]);
            if score > best.0 {
                // Back towards the wall behind, but not into it.
                let behind = 0.7 * free[side ^ 1];
                best = (score, point - behind * DIRECTIONS[side], DIRECTIONS[side] * (free[side] + behind));
            }
        }
    }
    let (_, eye, view) = best;
    let down = DVec3::new(0.0, -0.08 * view.length(), 0.0);
    camera(eye, eye + 0.6 * view + 0.6 * down, FOV_INSIDE)
}

/// What the probes say about a scene.
enum Openness {
    Closed,
    /// Open towards this one of the six directions.
    Open(usize),
    Object,
}

/// Distance and whether the front faces the point.
type Hit = (f64, bool);

/// Crossings of the probe lines with the surfaces.
struct Probes {
    min: DVec3,
    max: DVec3,
    /// For each axis and line: where along the axis it crosses a surface, and whether the front faces the axis' positive
    /// direction; sorted.
    crossings: [Vec<Vec<(f64, bool)>>; 3],
}

impl Probes {
    fn new(flat: &FlatScene, min: DVec3, max: DVec3) -> Self {
        let mut probes =
            Self { min, max, crossings: std::array::from_fn(|_| vec![Vec::new(); PROBES * PROBES]) };
        for triangle in 0..flat.triangles.len() {
            let corners = flat.corners(triangle).map(|c| c.as_dvec3());
            for axis in 0..3 {
                probes.cross(corners, axis);
            }
        }
        for line in probes.crossings.iter_mut().flatten() {
            line.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        probes
    }

    /// Adds the crossings of the lines along `axis` with one triangle.
    fn cross(&mut self, corners: [DVec3; 3], axis: usize) {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let range = |along: usize| {
            let values = corners.map(|c| c[along]);
            let cell =
                |x: f64| (x - self.min[along]) / (self.max[along] - self.min[along]) * PROBES as f64 - 0.5;
            let low = cell(values.into_iter().fold(f64::INFINITY, f64::min)).ceil().max(0.0);
            let high =
                cell(values.into_iter().fold(f64::NEG_INFINITY, f64::max)).floor().min((PROBES - 1) as f64);
            // A box without width has no lines across it.
            if low <= high { low as usize..high as usize + 1 } else { 0..0 }
        };
        let (rows, columns) = (range(v), range(u));
        let edge =
            |a: DVec3, b: DVec3, p: [f64; 2]| (b[u] - a[u]) * (p[1] - a[v]) - (b[v] - a[v]) * (p[0] - a[u]);
        let [a, b, c] = corners;
        let area = edge(a, b, [c[u], c[v]]);
        if area == 0.0 {
            return;
        }
        for j in rows {
            for i in columns.clone() {
                let p = [self.place(u, i), self.place(v, j)];
                let weights = [edge(b, c, p) / area, edge(c, a, p) / area, edge(a, b, p) / area];
                if weights.iter().all(|w| *w >= 0.0) {
                    let at = weights[0] * a[axis] + weights[1] * b[axis] + weights[2] * c[axis];
                    self.crossings[axis][j * PROBES + i].push((at, area > 0.0));
                }
            }
        }
    }

    fn place(&self, axis: usize, i: usize) -> f64 {
        self.min[axis] + (self.max[axis] - self.min[axis]) * (i as f64 + 0.5) / PROBES as f64
    }

    fn cell(index: usize) -> [usize; 3] {
        [index % PROBES, index / PROBES % PROBES, index / (PROBES * PROBES)]
    }

    fn point(&self, index: usize) -> DVec3 {
        let c = Self::cell(index);
        DVec3::from_array([0, 1, 2].map(|axis| self.place(axis, c[axis])))
    }

    /// First hits in the six directions from a point in free space; `None` if most of them show their backs or there are
    /// too few.
    fn free(&self, index: usize) -> Option<[Option<Hit>; 6]> {
        let (cell, point) = (Self::cell(index), self.point(index));
        let hits: [Option<Hit>; 6] = std::array::from_fn(|direction| {
            let axis = direction / 2;
            let line = &self.crossings[axis][cell[(axis + 2) % 3] * PROBES + cell[(axis + 1) % 3]];
            let after = line.partition_point(|(at, _)| *at < point[axis]);
            if direction % 2 == 0 {
                line.get(after).map(|(at, positive)| (at - point[axis], !positive))
            } else {
                after.checked_sub(1).map(|before| (point[axis] - line[before].0, line[before].1))
            }
        });
        let fronts = hits.iter().flatten().filter(|(_, front)| *front).count();
        let count = hits.iter().flatten().count();
        (count >= 5 && 3 * fronts >= 2 * count).then_some(hits)
    }

    fn openness(&self) -> Openness {
        let points = PROBES.pow(3);
        let (mut closed, mut open) = (0usize, [0usize; 6]);
        for index in 0..points {
            let Some(hits) = self.free(index) else { continue };
            match hits.iter().position(Option::is_none) {
                None => closed += 1,
                Some(side) => open[side] += 1,
            }
        }
        let enough = |count: usize| count as f64 >= ROOM_SHARE * points as f64;
        let widest = (0..6).rev().max_by_key(|side| open[*side]).unwrap_or(4);
        if enough(open[widest]) && open[widest] > closed {
            Openness::Open(widest)
        } else if enough(closed) {
            Openness::Closed
        } else {
            Openness::Object
        }
    }
}

#[cfg(test)]
mod tests;
