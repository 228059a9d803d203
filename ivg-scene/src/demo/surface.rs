//! The zero surface of a distance field as a closed triangle mesh (naive surface nets: Gibson 1998, "Constrained elastic
//! surface nets"): one vertex in each cell that the surface crosses, one quadrilateral around each crossed edge.

use glam::{DVec3, Vec3};

/// Edge of the blocks that are skipped as a whole where the surface is far \[samples\].
const BLOCK: usize = 4;
/// How much faster than a true distance a field may change: 1 would be exact; blends and ellipsoids stay below this.
const STEEPNESS: f64 = 1.7;
/// Steps of Newton's method that move a vertex onto the surface.
const PROJECTIONS: usize = 2;

/// A closed surface: positions, unit normals, triangles with fronts outwards (where the field is positive).
pub(super) struct Surface {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Finds the surface inside the box from `min`, with cubic cells of edge `step`, `cells` along each axis.
///
/// The field must be positive on the border of the box.
pub(super) fn extract(field: impl Fn(DVec3) -> f64, min: DVec3, step: f64, cells: [usize; 3]) -> Surface {
    let samples = Samples::new(&field, min, step, cells);
    let mut surface = Surface { positions: Vec::new(), normals: Vec::new(), triangles: Vec::new() };
    let mut vertex_of_cell = vec![u32::MAX; cells[0] * cells[1] * cells[2]];
    let cell_index = |c: [usize; 3]| c[0] + cells[0] * (c[1] + cells[1] * c[2]);

    for k in 0..cells[2] {
        for j in 0..cells[1] {
            for i in 0..cells[0] {
                let Some(local) = samples.crossing_centre([i, j, k]) else { continue };
                vertex_of_cell[cell_index([i, j, k])] = surface.positions.len() as u32;
                let start = min + step * (DVec3::new(i as f64, j as f64, k as f64) + local);
                let (p, normal) = project(&field, start, step);
                surface.positions.push(p.as_vec3());
                surface.normals.push(normal.as_vec3());
            }
        }
    }
    // Each crossed edge lies between two samples; the four cells around it give a quadrilateral.
    for k in 1..cells[2] {
        for j in 1..cells[1] {
            for i in 1..cells[0] {
                let here = samples.inside([i, j, k]);
                for axis in 0..3 {
                    let mut next = [i, j, k];
                    next[axis] += 1;
                    if samples.inside(next) == here {
                        continue;
                    }
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    let around = [(1, 1), (0, 1), (0, 0), (1, 0)].map(|(du, dv)| {
                        let mut cell = [i, j, k];
                        cell[u] -= du;
                        cell[v] -= dv;
                        vertex_of_cell[cell_index(cell)]
                    });
                    surface.add_quad(if here {
                        around
                    } else {
                        [around[3], around[2], around[1], around[0]]
                    });
                }
            }
        }
    }
    surface
}

impl Surface {
    /// Adds a quadrilateral, split along its shorter diagonal.
    fn add_quad(&mut self, q: [u32; 4]) {
        let length = |a: u32, b: u32| self.positions[a as usize].distance_squared(self.positions[b as usize]);
        if length(q[0], q[2]) <= length(q[1], q[3]) {
            self.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]]);
        } else {
            self.triangles.extend([[q[0], q[1], q[3]], [q[1], q[2], q[3]]]);
        }
    }
}

/// A point moved onto the surface, at most by half a cell along each step, and the unit normal there.
fn project(field: &impl Fn(DVec3) -> f64, start: DVec3, step: f64) -> (DVec3, DVec3) {
    let mut p = start;
    for _ in 0..PROJECTIONS {
        let (value, gradient) = value_and_gradient(field, p, step);
        let length2 = gradient.length_squared();
        if length2 < 1e-6 {
            break;
        }
        // A vertex that leaves the neighbourhood of its cell could fold the surface.
        p = start + (p - gradient * (value / length2) - start).clamp_length_max(0.5 * step);
    }
    (p, value_and_gradient(field, p, step).1.try_normalize().unwrap_or(DVec3::Y))
}

/// Value and gradient from four samples at the corners of a small tetrahedron, right to second order.
fn value_and_gradient(field: &impl Fn(DVec3) -> f64, p: DVec3, step: f64) -> (f64, DVec3) {
    let h = 0.05 * step;
    let (mut sum, mut gradient) = (0.0, DVec3::ZERO);
    for [x, y, z] in [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]] {
        let corner = DVec3::new(x, y, z);
        let value = field(p + h * corner);
        sum += value;
        gradient += value * corner;
    }
    (0.25 * sum, gradient / (4.0 * h))
}

/// Values of the field at the corners of all cells; only the sign is right where the surface is far.
struct Samples {
    values: Vec<f32>,
    size: [usize; 3],
}

impl Samples {
    fn new(field: &impl Fn(DVec3) -> f64, min: DVec3, step: f64, cells: [usize; 3]) -> Self {
        let size = cells.map(|n| n + 1);
        let mut values = vec![0.0; size[0] * size[1] * size[2]];
        let reach = 0.5 * step * (BLOCK as f64) * 3f64.sqrt() * STEEPNESS;
        let blocks = size.map(|n| n.div_ceil(BLOCK));
        for b in 0..blocks[0] * blocks[1] * blocks[2] {
            let first =
                [b % blocks[0], b / blocks[0] % blocks[1], b / (blocks[0] * blocks[1])].map(|i| i * BLOCK);
            let place = |c: [f64; 3]| min + step * DVec3::from_array(c);
            let middle = field(place(first.map(|i| i as f64 + 0.5 * (BLOCK - 1) as f64)));
            for k in first[2]..(first[2] + BLOCK).min(size[2]) {
                for j in first[1]..(first[1] + BLOCK).min(size[1]) {
                    for i in first[0]..(first[0] + BLOCK).min(size[0]) {
                        let value = if middle.abs() > reach {
                            middle
                        } else {
                            field(place([i as f64, j as f64, k as f64]))
                        };
                        values[i + size[0] * (j + size[1] * k)] = value as f32;
                    }
                }
            }
        }
        let mut samples = Self { values, size };
        samples.make_simple((-0.01 * step) as f32);
        samples
    }

    /// Makes every cell simple, so that one vertex in each gives a manifold: inside and outside corners of a cell are each
    /// connected by edges of the cell. Where they are not, the outside corner nearest to the surface becomes inside, with
    /// the value `filled`, until all is well; that ends, since samples only ever change one way.
    fn make_simple(&mut self, filled: f32) {
        let simple: [bool; 256] = std::array::from_fn(|mask| connected(mask as u8) && connected(!mask as u8));
        let cells = self.size.map(|n| n - 1);
        let mut todo: Vec<[usize; 3]> = Vec::new();
        for cell in 0..cells[0] * cells[1] * cells[2] {
            todo.push([cell % cells[0], cell / cells[0] % cells[1], cell / (cells[0] * cells[1])]);
            while let Some(cell) = todo.pop() {
                let corners = CORNERS.map(|c| [0, 1, 2].map(|axis| cell[axis] + c[axis]));
                let mask = (0..8).fold(0, |mask, n| mask | usize::from(self.inside(corners[n])) << n);
                if simple[mask] {
                    continue;
                }
                let outside = corners.into_iter().filter(|c| !self.inside(*c));
                let Some(nearest) = outside.min_by(|a, b| self.at(*a).total_cmp(&self.at(*b))) else {
                    continue;
                };
                let index = self.index(nearest);
                self.values[index] = filled;
                for c in CORNERS {
                    // The cells that share this sample.
                    let touched = [0, 1, 2].map(|axis| nearest[axis].checked_sub(c[axis]));
                    if let [Some(i), Some(j), Some(k)] = touched
                        && i < cells[0]
                        && j < cells[1]
                        && k < cells[2]
                    {
                        todo.push([i, j, k]);
                    }
                }
            }
        }
    }

    fn index(&self, c: [usize; 3]) -> usize {
        c[0] + self.size[0] * (c[1] + self.size[1] * c[2])
    }

    fn at(&self, c: [usize; 3]) -> f32 {
        self.values[self.index(c)]
    }

    fn inside(&self, c: [usize; 3]) -> bool {
        self.at(c) < 0.0
    }

    /// Mean of the points where the surface crosses the edges of a cell, in cell units; `None` if it does not.
    fn crossing_centre(&self, cell: [usize; 3]) -> Option<DVec3> {
        let values = CORNERS.map(|c| self.at([0, 1, 2].map(|axis| cell[axis] + c[axis])));
        let (mut sum, mut count) = (DVec3::ZERO, 0);
        for n in 0..8 {
            for axis in 0..3 {
                let other = n | 1 << axis;
                if other == n || (values[n] < 0.0) == (values[other] < 0.0) {
                    continue;
                }
                let at = f64::from(values[n]) / (f64::from(values[n]) - f64::from(values[other]));
                let mut p = DVec3::from_array(CORNERS[n].map(|c| c as f64));
                p[axis] = at;
                sum += p;
                count += 1;
            }
        }
        (count > 0).then(|| sum / f64::from(count))
    }
}

/// Corners of a cell; bit `axis` of the number of a corner is its place along that axis.
const CORNERS: [[usize; 3]; 8] =
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]];

/// Whether the corners in `mask` hang together by edges of the cell; none at all do.
fn connected(mask: u8) -> bool {
    let mut reached = mask & mask.wrapping_neg();
    loop {
        let along = |bits: u8, axis: u32, low: u8| (bits & low) << (1 << axis) | (bits & !low) >> (1 << axis);
        let near = along(reached, 0, 0x55) | along(reached, 1, 0x33) | along(reached, 2, 0x0F);
        let next = (reached | near) & mask;
        if next == reached {
            return reached == mask;
        }
        reached = next;
    }
}
