//! Deviation of attributes: how far what faces show moves when a vertex goes, in metres by a weight.

use glam::DVec3;
use pmesh_format::Wedges;

use crate::options::AttributeWeights;
use crate::pairing::pair;
use crate::quadric::Quadric;
use crate::rules::twice_area;
use crate::surface::Surface;

/// For each wedge: over the faces that it stands for, the area-weighted squared deviation of each attribute from its linear
/// course over the face, as a quadratic function of place and attribute (Hoppe, "New Quadric Metric for Simplifying Meshes
/// with Appearance Attributes", IEEE Visualization 1999, section 3, with gradients instead of inverse matrices).
#[derive(Debug)]
pub(crate) struct Deviations<'a> {
    wedges: &'a Wedges,
    /// First wedge of each vertex, and the end.
    first_wedge: Vec<u32>,
    /// Attributes of a wedge that count.
    channels: usize,
    /// `channels` values a wedge, weighted \[m\].
    values: Vec<f64>,
    /// Sum over faces and channels of the squared courses; their `area` is that of the faces.
    squares: Vec<Quadric>,
    /// Sum over faces of the courses, `channels` a wedge: gradient and value at the centre of the mesh, times the area.
    courses: Vec<(DVec3, f64)>,
}

impl<'a> Deviations<'a> {
    /// For the uncollapsed surface; `None` if no attribute counts.
    pub(crate) fn new(
        surface: &Surface,
        wedges: &'a Wedges,
        first_wedge: &[u32],
        weights: &AttributeWeights,
    ) -> Option<Self> {
        let mut values = Vec::new();
        for w in 0..wedges.len() {
            if weights.normal > 0.0 {
                values.extend(
                    wedges.normals.get(w).into_iter().flatten().map(|&x| f64::from(x) * weights.normal),
                );
            }
            if weights.uv > 0.0 {
                values.extend(wedges.uvs.get(w).into_iter().flatten().map(|&x| f64::from(x) * weights.uv));
            }
            if weights.colour > 0.0 {
                let colour = wedges.colours.get(w).into_iter().flatten();
                values.extend(colour.map(|&x| f64::from(x) / 255.0 * weights.colour));
            }
        }
        let channels = values.len().checked_div(wedges.len()).unwrap_or(0);
        if channels == 0 {
            return None;
        }
        let mut result = Self {
            wedges,
            first_wedge: first_wedge.to_vec(),
            channels,
            values,
            squares: vec![Quadric::default(); wedges.len()],
            courses: vec![(DVec3::ZERO, 0.0); wedges.len() * channels],
        };
        for f in 0..crate::input::index(surface.faces.len()) {
            result.add_face(surface.triangle(f), surface.corners[f as usize]);
        }
        Some(result)
    }

    fn add_face(&mut self, triangle @ [a, b, c]: [DVec3; 3], corners: [u32; 3]) {
        let normal = twice_area(triangle);
        let square = normal.length_squared();
        let area = 0.5 * square.sqrt();
        let (across_b, across_c) = ((c - a).cross(normal), normal.cross(b - a));
        for channel in 0..self.channels {
            let [at_a, at_b, at_c] = corners.map(|w| self.values[w as usize * self.channels + channel]);
            let gradient = (across_b * (at_b - at_a) + across_c * (at_c - at_a)) / square;
            // A face without an area has no course.
            if !gradient.is_finite() {
                return;
            }
            let constant = at_a - gradient.dot(a);
            for w in corners {
                let w = w as usize;
                // The area counts once, not for every channel.
                self.squares[w].add_linear(gradient, constant, area, if channel == 0 { area } else { 0.0 });
                let course = &mut self.courses[w * self.channels + channel];
                course.0 += gradient * area;
                course.1 += constant * area;
            }
        }
    }

    fn of_vertex(&self, v: u32) -> std::ops::Range<u32> {
        self.first_wedge[v as usize]..self.first_wedge[v as usize + 1]
    }

    /// The deviation of what wedge `w` stands for, if it stood at `p` and had the attributes of `shown` \[m⁴\].
    fn at(&self, w: u32, p: DVec3, shown: u32) -> f64 {
        let (w, shown) = (w as usize, shown as usize);
        let mut sum = self.squares[w].at(p);
        let courses = &self.courses[w * self.channels..][..self.channels];
        let values = &self.values[shown * self.channels..][..self.channels];
        for (&(gradient, constant), &value) in courses.iter().zip(values) {
            sum += value * (value * self.squares[w].area() - 2.0 * (gradient.dot(p) + constant));
        }
        // Rounding may make it negative, coordinates near the greatest f32 infinite or NaN.
        if sum > 0.0 { sum.min(f64::MAX) } else { 0.0 }
    }

    /// The deviation of what the wedges of `v` stand for.
    pub(crate) fn own(&self, surface: &Surface, v: u32) -> f64 {
        self.of_vertex(v).map(|w| self.at(w, surface.positions[v as usize], w)).sum()
    }

    /// The deviation of what the wedges of `u` stand for once it has moved onto `v`.
    pub(crate) fn moved(&self, surface: &Surface, u: u32, v: u32) -> f64 {
        let mut targets = Vec::new();
        pair(surface, self.wedges, (u, self.of_vertex(u)), (v, self.of_vertex(v)), &mut targets);
        let to = surface.positions[v as usize];
        self.of_vertex(u).zip(targets).map(|(w, target)| self.at(w, to, target)).sum()
    }

    /// Tells that the wedges of `u` have become `targets`, one for each.
    pub(crate) fn collapsed(&mut self, u: u32, targets: &[u32]) {
        for (from, &to) in self.of_vertex(u).zip(targets) {
            let (from, to) = (from as usize, to as usize);
            let moved = self.squares[from];
            self.squares[to].add(&moved);
            for channel in 0..self.channels {
                let (gradient, constant) = self.courses[from * self.channels + channel];
                let course = &mut self.courses[to * self.channels + channel];
                course.0 += gradient;
                course.1 += constant;
            }
        }
    }
}
