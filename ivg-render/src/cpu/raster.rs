//! What a GPU does in hardware between vertex and fragment shader: clipping, viewport, coverage, depth.
//!
//! Coverage is decided as WebGPU devices decide it: vertices are rounded to 1/256 pixel, a sample is covered if its
//! pixel's middle is inside, and on an edge the top-left rule holds, so triangles that share an edge neither overlap
//! nor leave a gap. All of it is integer arithmetic.

use glam::{Mat4, Vec3, Vec4};

/// Binary digits of a pixel that a vertex position keeps.
const SUBPIXEL_BITS: u32 = 8;

/// One pixel in fixed point.
const ONE: i64 = 1 << SUBPIXEL_BITS;

/// Triangles are cut at this many half sides from the middle of the picture: with at most 8192 pixels a side, fixed
/// point coordinates stay below 2^25 and their products below 2^51.
const GUARD_BAND: f32 = 8.0;

/// A triangle in pixels, ready to be filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ScreenTriangle {
    /// Index of the triangle it is, or is a part of.
    pub(crate) source: u32,
    /// Corners in fixed point, in an order that makes the area positive.
    x: [i32; 3],
    y: [i32; 3],
    /// Depth at the middle of pixel (0, 0), and its change a pixel to the right and down.
    depth: [f64; 3],
}

/// A rectangle of pixels, ends excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Region {
    pub(crate) x: [u32; 2],
    pub(crate) y: [u32; 2],
}

/// Transforms points to clip space.
pub(crate) fn to_clip(matrix: &Mat4, position: Vec3) -> Vec4 {
    matrix.x_axis * position.x + matrix.y_axis * position.y + matrix.z_axis * position.z + matrix.w_axis
}

/// Cuts a triangle given in clip space to the view volume and hands on what is left of it, one to six triangles.
pub(crate) fn clip_and_project(
    source: u32,
    corners: [Vec4; 3],
    size: [u32; 2],
    mut emit: impl FnMut(ScreenTriangle),
) {
    // Distances to the planes that bound what is visible; all corners outside one plane: nothing to see.
    let outside_all = |distance: fn(&Vec4) -> f32| corners.iter().all(|c| distance(c) < 0.0);
    if outside_all(|c| c.w - c.x)
        || outside_all(|c| c.w + c.x)
        || outside_all(|c| c.w - c.y)
        || outside_all(|c| c.w + c.y)
        || outside_all(|c| c.w - c.z)
    {
        return;
    }
    const PLANES: [fn(&Vec4) -> f32; 5] = [
        |c| c.w - c.z,
        |c| GUARD_BAND * c.w - c.x,
        |c| GUARD_BAND * c.w + c.x,
        |c| GUARD_BAND * c.w - c.y,
        |c| GUARD_BAND * c.w + c.y,
    ];
    if PLANES.iter().all(|plane| corners.iter().all(|corner| plane(corner) >= 0.0)) {
        emit_projected(source, corners, size, &mut emit);
        return;
    }
    // Sutherland and Hodgman: a convex polygon stays convex, each plane adds one corner at most.
    let mut polygon = [Vec4::ZERO; 8];
    polygon[..3].copy_from_slice(&corners);
    let mut count = 3;
    for plane in PLANES {
        let input = polygon;
        let input_count = count;
        count = 0;
        for index in 0..input_count {
            let (from, to) = (input[index], input[(index + 1) % input_count]);
            let (from_distance, to_distance) = (plane(&from), plane(&to));
            if from_distance >= 0.0 {
                polygon[count] = from;
                count += 1;
            }
            if (from_distance >= 0.0) != (to_distance >= 0.0) {
                polygon[count] = from + (to - from) * (from_distance / (from_distance - to_distance));
                count += 1;
            }
        }
        if count < 3 {
            return;
        }
    }
    for index in 1..count - 1 {
        let part = [polygon[0], polygon[index], polygon[index + 1]];
        emit_projected(source, part, size, &mut emit);
    }
}

fn emit_projected(source: u32, corners: [Vec4; 3], size: [u32; 2], emit: &mut impl FnMut(ScreenTriangle)) {
    let mut x = [0i32; 3];
    let mut y = [0i32; 3];
    let mut depth = [0f64; 3];
    for (index, corner) in corners.iter().enumerate() {
        let inverse = 1.0 / corner.w;
        if !inverse.is_finite() {
            return;
        }
        x[index] = to_fixed((corner.x * inverse * 0.5 + 0.5) * size[0] as f32);
        y[index] = to_fixed((0.5 - corner.y * inverse * 0.5) * size[1] as f32);
        depth[index] = f64::from(corner.z * inverse);
    }
    let area = |x: &[i32; 3], y: &[i32; 3]| {
        i64::from(x[1] - x[0]) * i64::from(y[2] - y[0]) - i64::from(y[1] - y[0]) * i64::from(x[2] - x[0])
    };
    let mut doubled = area(&x, &y);
    if doubled == 0 {
        return;
    }
    if doubled < 0 {
        x.swap(1, 2);
        y.swap(1, 2);
        depth.swap(1, 2);
        doubled = -doubled;
    }
    // The plane through the three depths, in pixels from the middle of pixel (0, 0).
    let pixel = |fixed: i32| f64::from(fixed) / ONE as f64 - 0.5;
    let [x10, x20] = [1, 2].map(|i| pixel(x[i]) - pixel(x[0]));
    let [y10, y20] = [1, 2].map(|i| pixel(y[i]) - pixel(y[0]));
    let [d10, d20] = [1, 2].map(|i| depth[i] - depth[0]);
    let inverse_area = (ONE * ONE) as f64 / doubled as f64;
    let right = (d10 * y20 - d20 * y10) * inverse_area;
    let down = (d20 * x10 - d10 * x20) * inverse_area;
    let corner = depth[0] - right * pixel(x[0]) - down * pixel(y[0]);
    emit(ScreenTriangle { source, x, y, depth: [corner, right, down] });
}

fn to_fixed(pixels: f32) -> i32 {
    (pixels * ONE as f32).round_ties_even() as i32
}

impl ScreenTriangle {
    /// First and last row, end excluded, that the triangle may touch in a picture of `height` rows.
    pub(crate) fn rows(&self, height: u32) -> [u32; 2] {
        pixel_range(&self.y, [0, height])
    }

    /// Calls `write` with column, row and depth of every covered sample of `region`, row by row.
    pub(crate) fn fill(&self, region: Region, mut write: impl FnMut(u32, u32, f32)) {
        let [left, right] = pixel_range(&self.x, region.x);
        let [top, bottom] = pixel_range(&self.y, region.y);
        if left >= right || top >= bottom {
            return;
        }
        // Edge functions: positive inside, and zero counts on top and left edges only.
        let mut edges = [Edge { value: 0, right: 0, down: 0 }; 3];
        for (index, edge) in edges.iter_mut().enumerate() {
            let next = (index + 1) % 3;
            let (x0, y0) = (i64::from(self.x[index]), i64::from(self.y[index]));
            let (dx, dy) = (i64::from(self.x[next]) - x0, i64::from(self.y[next]) - y0);
            let middle_x = i64::from(left) * ONE + ONE / 2;
            let middle_y = i64::from(top) * ONE + ONE / 2;
            // With y down and a positive area the inside is to the right of each edge as seen along it; an edge that
            // runs up is a left one, a level one that runs to the right is a top one.
            let top_left = dy < 0 || (dy == 0 && dx > 0);
            let value = dx * (middle_y - y0) - dy * (middle_x - x0);
            *edge = Edge { value: value - i64::from(!top_left), right: -dy * ONE, down: dx * ONE };
        }
        let [corner, depth_right, depth_down] = self.depth;
        for y in top..bottom {
            let mut values = edges.map(|edge| edge.value);
            let row_depth = corner + depth_down * f64::from(y);
            for x in left..right {
                if (values[0] | values[1] | values[2]) >= 0 {
                    write(x, y, (row_depth + depth_right * f64::from(x)) as f32);
                }
                for (value, edge) in values.iter_mut().zip(&edges) {
                    *value += edge.right;
                }
            }
            for edge in &mut edges {
                edge.value += edge.down;
            }
        }
    }
}

#[derive(Clone, Copy)]
struct Edge {
    value: i64,
    right: i64,
    down: i64,
}

/// Pixels whose middle may lie between the fixed point coordinates, cut to `limits`.
fn pixel_range(fixed: &[i32; 3], limits: [u32; 2]) -> [u32; 2] {
    let low = fixed.iter().min().map_or(0, |v| i64::from(*v));
    let high = fixed.iter().max().map_or(0, |v| i64::from(*v));
    let first = (low - ONE / 2 + ONE - 1).div_euclid(ONE);
    let end = (high - ONE / 2).div_euclid(ONE) + 1;
    let cut = |pixel: i64| pixel.clamp(i64::from(limits[0]), i64::from(limits[1])) as u32;
    [cut(first), cut(end)]
}

#[cfg(test)]
mod tests;
