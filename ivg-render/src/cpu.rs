//! The renderer without a GPU: a rasteriser with the same shadow maps and, shader for shader, the same arithmetic.
//!
//! Pictures do not depend on the number of threads: every sample is computed by itself, and lights are added up in
//! their own order.

mod direct;
mod irradiance;
mod raster;
mod shade;
mod shadow;

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::layout::LightRecord;
use crate::plan::FramePlan;
use crate::{Image, RenderError, RenderOptions, RenderScene};
#[cfg(test)]
pub(crate) use direct::light_irradiance;
use direct::{ShadowMaps, direct_irradiance};
use shade::View;

/// Shadow maps that are in memory at a time \[texels\]: 64 MiB. Lights are taken in groups of this size.
const TEXELS_AT_A_TIME: u64 = 1 << 24;

/// Renders a scene on the CPU, with the threads of rayon's current pool.
///
/// # Errors
///
/// [`RenderError`]: the first problem of scene, camera or options.
pub fn render_cpu(scene: &RenderScene, options: &RenderOptions) -> Result<Image, RenderError> {
    Ok(execute(&FramePlan::new(scene, options)?))
}

/// Carries out a plan.
#[must_use]
pub fn execute(plan: &FramePlan<'_>) -> Image {
    let (width, height) = plan.sample_size();
    let view = View::new(plan);
    let mut direct = vec![Vec3::ZERO; width as usize * height as usize];
    for group in light_groups(&plan.lights, plan.frame.shadow_size) {
        let maps = shadow_maps(plan, group.clone());
        direct.par_iter_mut().enumerate().for_each(|(sample, sum)| {
            if let Some(surface) = view.surface(sample) {
                let (normal, face_normal) = (surface.normal, surface.face_normal);
                *sum += direct_irradiance(
                    &plan.lights[group.clone()],
                    &maps,
                    surface.position,
                    normal,
                    face_normal,
                );
            }
        });
    }
    let mut pixels = direct;
    pixels.par_iter_mut().enumerate().for_each(|(sample, pixel)| {
        *pixel = match view.surface(sample) {
            Some(surface) => shade::radiance(plan, &surface, *pixel),
            None => plan.background.radiance(sample),
        };
    });
    Image::new(width, height, pixels).reduced(plan.supersampling)
}

/// Splits the lights into groups whose shadow maps fit into memory together, one light at least.
fn light_groups(lights: &[LightRecord], shadow_size: u32) -> Vec<Range<usize>> {
    let layers_at_a_time = TEXELS_AT_A_TIME / u64::from(shadow_size).pow(2);
    let mut groups: Vec<Range<usize>> = Vec::new();
    let mut layers = 0;
    for (index, light) in lights.iter().enumerate() {
        layers += u64::from(light.layers);
        match groups.last_mut() {
            Some(group) if layers <= layers_at_a_time || light.layers == 0 => group.end = index + 1,
            _ => {
                groups.push(index..index + 1);
                layers = u64::from(light.layers);
            }
        }
    }
    groups
}

fn shadow_maps(plan: &FramePlan<'_>, group: Range<usize>) -> ShadowMaps {
    let lights = &plan.lights[group];
    let first_layer = lights.first().map_or(0, |light| light.first_layer);
    let end = lights.last().map_or(0, |light| light.first_layer + light.layers);
    let size = plan.frame.shadow_size;
    let layers = plan.faces[first_layer as usize..end as usize]
        .par_iter()
        .map(|face| shadow::face_map(&plan.geometry, face, size))
        .collect();
    ShadowMaps { size, first_layer, layers }
}

#[cfg(test)]
mod tests;
