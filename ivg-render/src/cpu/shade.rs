//! What the camera sees and how it is shaded: the twin of `shaders/shade.wgsl`.

use glam::{Mat4, Vec2, Vec3, Vec4};
use rayon::prelude::*;

use crate::cpu::irradiance::indirect_irradiance;
use crate::cpu::raster::{Region, ScreenTriangle, clip_and_project, to_clip};
use crate::plan::FramePlan;

/// Rows that are filled together.
const BAND_ROWS: usize = 16;

/// No triangle.
const NOTHING: u32 = u32::MAX;

/// A visible point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Surface {
    /// Position in scene space \[m\].
    pub(crate) position: Vec3,
    /// Shading normal, unit length, on the side that is seen.
    pub(crate) normal: Vec3,
    /// Normal of the triangle, unit length, on the side that is seen.
    pub(crate) face_normal: Vec3,
    /// Texture coordinates.
    pub(crate) uv: Vec2,
    /// Index of the material.
    pub(crate) material: u32,
    /// Whether the front is seen.
    pub(crate) front: bool,
}

/// Which triangle each sample of the picture sees.
#[derive(Debug)]
pub(crate) struct View<'plan> {
    plan: &'plan FramePlan<'plan>,
    clip: Vec<Vec4>,
    visible: Vec<u32>,
    materials: Vec<u32>,
}

impl<'plan> View<'plan> {
    pub(crate) fn new(plan: &'plan FramePlan<'plan>) -> Self {
        let (width, height) = plan.sample_size();
        let geometry = &plan.geometry;
        let matrix = Mat4::from_cols_array_2d(&plan.frame.view_projection);
        let clip: Vec<Vec4> = geometry.positions.par_iter().map(|p| to_clip(&matrix, *p)).collect();
        let projected: Vec<ScreenTriangle> = geometry
            .triangles
            .par_iter()
            .enumerate()
            .flat_map_iter(|(index, corners)| {
                let mut parts = Vec::new();
                let corners = corners.map(|corner| clip[corner as usize]);
                clip_and_project(index as u32, corners, [width, height], |part| parts.push(part));
                parts
            })
            .collect();
        let mut bands = vec![Vec::new(); (height as usize).div_ceil(BAND_ROWS)];
        for (index, triangle) in projected.iter().enumerate() {
            let [first, end] = triangle.rows(height).map(|row| row as usize);
            for band in &mut bands[first / BAND_ROWS..end.div_ceil(BAND_ROWS).max(first / BAND_ROWS)] {
                band.push(index as u32);
            }
        }
        let mut visible = vec![NOTHING; width as usize * height as usize];
        let band_samples = BAND_ROWS * width as usize;
        visible.par_chunks_mut(band_samples).zip(&bands).enumerate().for_each(|(band, (samples, list))| {
            let top = (band * BAND_ROWS) as u32;
            let region = Region { x: [0, width], y: [top, top + (samples.len() / width as usize) as u32] };
            let mut depths = vec![0f32; samples.len()];
            for index in list {
                let triangle = &projected[*index as usize];
                triangle.fill(region, |x, y, depth| {
                    let sample = (y - top) as usize * width as usize + x as usize;
                    if depth > depths[sample] {
                        depths[sample] = depth;
                        samples[sample] = triangle.source;
                    }
                });
            }
        });
        let draws = geometry.draws.iter();
        let materials = draws.flat_map(|d| std::iter::repeat_n(d.material, d.triangles.len())).collect();
        Self { plan, clip, visible, materials }
    }

    /// The surface that a sample sees.
    pub(crate) fn surface(&self, sample: usize) -> Option<Surface> {
        let triangle = self.visible[sample];
        if triangle == NOTHING {
            return None;
        }
        let geometry = &self.plan.geometry;
        let corners = geometry.triangles[triangle as usize].map(|corner| corner as usize);
        let weights = self.weights(sample, corners.map(|corner| self.clip[corner]));
        let positions = corners.map(|corner| geometry.positions[corner]);
        let position = mixed(weights, positions);
        let out = (positions[1] - positions[0]).cross(positions[2] - positions[0]).normalize_or_zero();
        let eye = Vec3::from(self.plan.frame.eye);
        let front = out.dot(eye - position) >= 0.0;
        let face_normal = if front { out } else { -out };
        let smooth = mixed(weights, corners.map(|corner| geometry.normals[corner]));
        Some(Surface {
            position,
            normal: shading_normal(smooth, out, front),
            face_normal,
            uv: mixed(weights, corners.map(|corner| geometry.uvs[corner])),
            material: self.materials[triangle as usize],
            front,
        })
    }

    /// Share of each corner in a sample, perspective-correct: homogeneous coordinates of the sample in the triangle
    /// (Olano and Greer 1997), which need no clipping.
    fn weights(&self, sample: usize, clip: [Vec4; 3]) -> [f32; 3] {
        let (width, height) = self.plan.sample_size();
        let x = ((sample % width as usize) as f64 + 0.5) * 2.0 / f64::from(width) - 1.0;
        let y = 1.0 - ((sample / width as usize) as f64 + 0.5) * 2.0 / f64::from(height);
        let [a, b, c] = clip.map(|v| glam::DVec3::new(f64::from(v.x), f64::from(v.y), f64::from(v.w)));
        let ray = glam::DVec3::new(x, y, 1.0);
        let shares = [b.cross(c), c.cross(a), a.cross(b)].map(|edge| edge.dot(ray));
        let sum: f64 = shares.iter().sum();
        // The middle of a pixel may lie a rounding outside the triangle; a triangle seen edge-on has no area.
        if sum == 0.0 { [1.0, 0.0, 0.0] } else { shares.map(|share| (share / sum) as f32) }
    }
}

/// The normal to shade with: `smooth` made unit length on the seen side, or the triangle's own where there is none.
fn shading_normal(smooth: Vec3, out: Vec3, front: bool) -> Vec3 {
    let normal = if smooth.dot(smooth) > 1e-12 { smooth.normalize() } else { out };
    if front { normal } else { -normal }
}

/// Radiance that a surface sends to the eye \[W/(m² sr)\], given its direct irradiance \[W/m²\].
pub(crate) fn radiance(plan: &FramePlan<'_>, surface: &Surface, direct: Vec3) -> Vec3 {
    let material = &plan.materials[surface.material as usize];
    let mut albedo = Vec3::from(material.albedo);
    if let Some(texture) = plan.material_textures[surface.material as usize] {
        albedo *= texture.sample(surface.uv);
    }
    let mut irradiance = direct;
    if let Some(grid) = &plan.grid {
        irradiance +=
            indirect_irradiance(grid, &plan.frame, surface.position, surface.normal, surface.face_normal);
    }
    let emission =
        if surface.front || material.two_sided != 0 { Vec3::from(material.emission) } else { Vec3::ZERO };
    emission + albedo * irradiance / std::f32::consts::PI
}

fn mixed<T>(weights: [f32; 3], corners: [T; 3]) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let [a, b, c] = corners;
    a * weights[0] + b * weights[1] + c * weights[2]
}

#[cfg(test)]
mod tests;
