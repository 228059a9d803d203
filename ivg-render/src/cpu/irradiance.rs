//! Indirect light from the grid: the twin of `shaders/irradiance.wgsl`, which repeats on half-precision textures what
//! [`ivg_grid::spatial`] and [`ivg_grid::reconstruct`] define.

use glam::Vec3;

use crate::layout::FrameRecord;
use crate::plan::GridLookup;

/// Indirect irradiance at a point of a surface \[W/m²\].
pub(crate) fn indirect_irradiance(
    lookup: &GridLookup<'_>,
    frame: &FrameRecord,
    position: Vec3,
    normal: Vec3,
    face_normal: Vec3,
) -> Vec3 {
    let moved = position + face_normal * frame.normal_bias;
    let world = lookup.origin + moved.as_dvec3();
    lookup.grid.irradiance(world, normal, lookup.reconstruction, lookup.filter)
}
