use ivg_grid::{Reconstruction, SpatialFilter};
use ivg_scene::{Effect, EffectPlan};

use crate::RenderError;
use crate::error::MAX_SIDE;

/// Smallest shadow map: a quarter of its half side is border for the filter.
const MIN_SHADOW_SIZE: u32 = 32;

/// What is rendered, and how finely.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RenderOptions {
    /// Width of the picture \[pixels\].
    pub width: u32,
    /// Height of the picture \[pixels\].
    pub height: u32,
    /// Samples a pixel along each axis, 1 to 8: 2 means four samples a pixel. Time grows with the square.
    pub supersampling: u32,
    /// Light straight from the lights.
    pub direct: bool,
    /// Shadow maps for the direct light; without them light goes through everything.
    pub shadows: bool,
    /// Indirect light from the grid, if the scene has one.
    pub indirect: bool,
    /// Albedo textures; without them a surface has its material's own albedo.
    pub textures: bool,
    /// The sky behind everything; without it the background is black.
    pub sky: bool,
    /// Number of points that stand for all emissive surfaces together, 1 to 1024; every connected emissive surface
    /// has one at least. Time and, on a GPU, memory of the shadow maps grow in proportion.
    pub area_samples: u32,
    /// Texels along the side of a shadow map, 32 to 4096. Memory grows with the square.
    pub shadow_size: u32,
    /// How irradiance follows from what the grid holds; it must [fit](Reconstruction::fits) that, and
    /// [`Reconstruction::for_encoding`] is the most accurate one that does.
    pub reconstruction: Reconstruction,
    /// How values are interpolated between the vertices of the grid.
    pub filter: SpatialFilter,
}

impl RenderOptions {
    /// Everything there is, at the default quality: 2 x 2 samples a pixel, 16 points on the area lights, shadow
    /// maps of 512 x 512 texels, trilinear three-vector lookups.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self {
            width,
            height,
            supersampling: 2,
            direct: true,
            shadows: true,
            indirect: true,
            textures: true,
            sky: true,
            area_samples: 16,
            shadow_size: 512,
            reconstruction: Reconstruction::ThreeVector,
            filter: SpatialFilter::Trilinear,
        }
    }

    /// [`RenderOptions::new`] with the effects that `plan` does not name switched off.
    #[must_use]
    pub fn for_plan(plan: &EffectPlan, width: u32, height: u32) -> Self {
        Self {
            direct: plan.needs(Effect::DirectLight),
            shadows: plan.needs(Effect::Shadows),
            indirect: plan.needs(Effect::DiffuseIndirect),
            textures: plan.needs(Effect::Textures),
            sky: plan.needs(Effect::Sky),
            ..Self::new(width, height)
        }
    }

    /// Width and height of what is rendered before it is reduced \[samples\].
    pub(crate) fn sample_size(&self) -> (u32, u32) {
        (self.width * self.supersampling, self.height * self.supersampling)
    }

    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let side = |length: u32| length.saturating_mul(self.supersampling);
        let possible = |length: u32| (1..=MAX_SIDE).contains(&side(length));
        if !(1..=8).contains(&self.supersampling) || !possible(self.width) || !possible(self.height) {
            let Self { width, height, supersampling, .. } = *self;
            return Err(RenderError::Size { width, height, supersampling });
        }
        let in_range = |option, value, low, high, range| {
            let fits = (low..=high).contains(&value);
            if fits { Ok(()) } else { Err(RenderError::Option { option, value, range }) }
        };
        in_range("number of area light samples", self.area_samples, 1, 1024, "1 to 1024")?;
        in_range("size of the shadow maps", self.shadow_size, MIN_SHADOW_SIZE, 4096, "32 to 4096")
    }
}
