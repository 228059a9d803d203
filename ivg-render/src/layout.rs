//! Numbers and structures that Rust and the shaders share. The tests parse the shaders and compare: nothing here is
//! kept equal by hand alone.

use bytemuck::{Pod, Zeroable};

/// Half width of the shadow filter \[texels\]: the filter is a box of `2 r + 1` texels whose edges move smoothly.
/// Two texels hide the steps between 16 points on an area light and keep contact shadows closed.
pub const SHADOW_FILTER_RADIUS: i32 = 2;

/// Texels around a shadow map face that only the filter reads, so that it never leaves the face.
pub const SHADOW_BORDER: u32 = 4;

/// Smallest distance behind the first surface at which a point counts as shadowed \[texel widths at that
/// distance\]: covers rounding and surfaces that lie in each other.
pub const SHADOW_BIAS: f32 = 0.5;

/// Largest distance behind the first surface at which a point still counts as lit \[texel widths at that distance\].
/// Between the two bounds the middle between first and second surface decides.
pub const SHADOW_DEPTH_CAP: f32 = 16.0;

/// Surfaces nearer to the first one than this share of its depth are not a second surface: the same triangle drawn
/// twice may be rounded differently.
pub const SAME_SURFACE: f32 = 1e-6;

/// Tiles along a side of the shadow map of a directional light.
pub const DIRECTIONAL_TILES: u32 = 4;

/// [`LightRecord::kind`]: a point on an emissive surface.
pub const LIGHT_AREA: u32 = 0;
/// [`LightRecord::kind`]: a point light.
pub const LIGHT_POINT: u32 = 1;
/// [`LightRecord::kind`]: a spot light.
pub const LIGHT_SPOT: u32 = 2;
/// [`LightRecord::kind`]: a directional light.
pub const LIGHT_DIRECTIONAL: u32 = 3;

/// [`FrameRecord::reconstruction`]: the papers' n² blend.
pub const RECONSTRUCT_N_SQUARED: u32 = 0;
/// [`FrameRecord::reconstruction`]: three vectors.
pub const RECONSTRUCT_THREE_VECTOR: u32 = 1;
/// [`FrameRecord::reconstruction`]: six vectors.
pub const RECONSTRUCT_SIX_VECTOR: u32 = 2;
/// [`FrameRecord::reconstruction`]: radiance harmonics.
pub const RECONSTRUCT_HARMONICS: u32 = 3;

/// What radiance harmonics of degree 0 count in the irradiance: the norm of the basis √(1/4π) times π
/// ([`ivg_grid::harmonics`]; Ramamoorthi and Hanrahan 2001, equation 12).
pub const HARMONIC_CONSTANT: f32 = 0.886_226_9;
/// The same for degree 1, beside a component of the normal: √(3/4π) times 2π/3.
pub const HARMONIC_LINEAR: f32 = 1.023_326_7;
/// The same for orders −2, −1 and 1 of degree 2, beside a product of two components: √(15/4π) times π/4.
pub const HARMONIC_MIXED: f32 = 0.858_085_5;
/// The same for order 0 of degree 2, beside 3 z² − 1: √(5/16π) times π/4.
pub const HARMONIC_ZONAL: f32 = 0.247_707_95;
/// The same for order 2 of degree 2, beside x² − y²: √(15/16π) times π/4.
pub const HARMONIC_SQUARE: f32 = 0.429_042_76;

/// A light as the shaders read it; positions and directions in scene space.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct LightRecord {
    /// Where it is \[m\]; for a directional light the middle of the scene.
    pub position: [f32; 3],
    /// One of the `LIGHT_` constants.
    pub kind: u32,
    /// Surface normal, axis of the cone, or the way the light travels; unit length.
    pub axis: [f32; 3],
    /// Area that an area light's point stands for, divided by pi \[m²\]; else 0.
    pub disk: f32,
    /// First direction of the shadow map's frame, perpendicular to `axis`, unit length.
    pub tangent: [f32; 3],
    /// First layer of its shadow map.
    pub first_layer: u32,
    /// Second direction of the shadow map's frame: `axis x tangent`.
    pub bitangent: [f32; 3],
    /// Number of layers of its shadow map; 0 = it casts no shadow.
    pub layers: u32,
    /// Radiance times area \[W/sr\], radiant intensity \[W/sr\], or irradiance \[W/m²\], linear RGB.
    pub strength: [f32; 3],
    /// Distance at which a shadow map has depth 1 \[m\]; for a directional light the radius of the scene \[m\].
    pub reach: f32,
    /// Scale of the cosine to the axis in a spot light's falloff (`KHR_lights_punctual`); else 0.
    pub cone_scale: f32,
    /// Offset in a spot light's falloff; else 1.
    pub cone_offset: f32,
    /// Makes the size a multiple of 16 bytes, as WGSL has it.
    pub padding: [f32; 2],
}

/// What is the same for all pixels of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct FrameRecord {
    /// From scene space to clip space, column by column.
    pub view_projection: [[f32; 4]; 4],
    /// Where the camera is in scene space \[m\].
    pub eye: [f32; 3],
    /// Number of lights.
    pub light_count: u32,
    /// Scene position of grid vertex (0, 0, 0) \[m\].
    pub lattice_origin: [f32; 3],
    /// Texels along the side of a shadow map.
    pub shadow_size: u32,
    /// One divided by the distance of neighbouring vertices along each axis \[1/m\]; 0 on an axis of one vertex.
    pub lattice_inverse_step: [f32; 3],
    /// 1 = indirect light is looked up in the grid.
    pub indirect: u32,
    /// Vertices along each axis.
    pub lattice_dims: [u32; 3],
    /// One of the `RECONSTRUCT_` constants.
    pub reconstruction: u32,
    /// Distance by which lookups are moved along the normal \[m\].
    pub normal_bias: f32,
    /// What the half-precision values of the grid must be multiplied by \[W/m² or W/(m² sr)\].
    pub value_scale: f32,
    /// 0 = trilinear, 1 = tricubic.
    pub filter_kind: u32,
    /// Makes the size a multiple of 16 bytes, as WGSL has it.
    pub padding: u32,
}

/// A material as the shaders read it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct MaterialRecord {
    /// Diffuse albedo, linear RGB.
    pub albedo: [f32; 3],
    /// 1 = multiplied by the texture.
    pub textured: u32,
    /// Emitted radiance \[W/(m² sr)\].
    pub emission: [f32; 3],
    /// 1 = the back reflects and emits as the front does.
    pub two_sided: u32,
}

/// One face of a shadow map as the shaders read it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Pod, Zeroable)]
#[repr(C)]
pub struct FaceRecord {
    /// From scene space to clip space, column by column.
    pub matrix: [[f32; 4]; 4],
    /// 1 = perspective (depth is reach / distance), 0 = parallel (depth falls linearly).
    pub perspective: u32,
    /// [`SHADOW_BIAS`] in units of depth: relative if perspective, else absolute.
    pub bias: f32,
    /// [`SHADOW_DEPTH_CAP`] in units of depth: relative if perspective, else absolute.
    pub cap: f32,
    /// Makes the size a multiple of 16 bytes, as WGSL has it.
    pub padding: u32,
}

#[cfg(all(test, feature = "gpu"))]
mod tests;
