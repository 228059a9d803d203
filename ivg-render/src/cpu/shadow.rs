//! Shadow map faces on the CPU: the twin of `shaders/shadow.wgsl`.
//!
//! A face stores, for each texel, the *limit depth*: a point is shadowed if it lies behind it. It is the middle
//! between the first and the second surface seen from the light (Woo 1992), at least [`SHADOW_BIAS`] and at most
//! [`SHADOW_DEPTH_CAP`] texel widths behind the first. So a surface does not shadow itself however it is inclined or
//! curved, room corners stay free of dark seams, and what stands on a floor is shadowed up to the contact.
//!
//! [`SHADOW_BIAS`]: crate::layout::SHADOW_BIAS
//! [`SHADOW_DEPTH_CAP`]: crate::layout::SHADOW_DEPTH_CAP

use glam::Mat4;

use crate::cpu::raster::{Region, clip_and_project, to_clip};
use crate::geometry::Geometry;
use crate::layout::{FaceRecord, SAME_SURFACE};

/// Limit depths of a face, row by row from the top; depth is 1 near the light, 0 far away or where nothing is.
pub(crate) fn face_map(geometry: &Geometry, face: &FaceRecord, size: u32) -> Vec<f32> {
    let matrix = Mat4::from_cols_array_2d(&face.matrix);
    let clip: Vec<_> = geometry.positions.iter().map(|position| to_clip(&matrix, *position)).collect();
    let texels = size as usize * size as usize;
    let (mut first, mut second) = (vec![0f32; texels], vec![0f32; texels]);
    let region = Region { x: [0, size], y: [0, size] };
    for (index, triangle) in geometry.triangles.iter().enumerate() {
        let corners = triangle.map(|corner| clip[corner as usize]);
        clip_and_project(index as u32, corners, [size, size], |triangle| {
            triangle.fill(region, |x, y, depth| {
                let texel = y as usize * size as usize + x as usize;
                insert(&mut first[texel], &mut second[texel], depth);
            });
        });
    }
    for (first, second) in first.iter_mut().zip(second) {
        *first = shadow_limit(face, *first, second);
    }
    first
}

/// Keeps the two largest depths; what is as good as equal to the first is no second surface.
fn insert(first: &mut f32, second: &mut f32, depth: f32) {
    if depth > *first {
        if *first < depth * (1.0 - SAME_SURFACE) {
            *second = *first;
        }
        *first = depth;
    } else if depth < *first * (1.0 - SAME_SURFACE) && depth > *second {
        *second = depth;
    }
}

/// The limit depth from the depths of the first and second surface (0 = there is none).
pub(crate) fn shadow_limit(face: &FaceRecord, first: f32, second: f32) -> f32 {
    if face.perspective != 0 {
        // Depth is reach / distance: the middle of two distances is the harmonic mean of the depths.
        let middle = if first > 0.0 { 2.0 * first * second / (first + second) } else { 0.0 };
        middle.max(first / (1.0 + face.cap)).min(first / (1.0 + face.bias))
    } else {
        let middle = 0.5 * (first + second);
        let capped = if second > 0.0 { middle.max(first - face.cap) } else { first - face.cap };
        capped.min(first - face.bias).max(0.0)
    }
}

#[cfg(test)]
mod tests;
