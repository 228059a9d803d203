//! What a frame consists of, as data: both renderers carry out the same plan. No wgpu here.

use glam::{Mat4, Vec3, Vec4};
use ivg_grid::{IrradianceGrid, Reconstruction, SURFACE_BIAS, SpatialFilter};
use ivg_scene::Texture;

use crate::background::{Background, Panorama};
use crate::geometry::Geometry;
use crate::layout::{
    DIRECTIONAL_TILES, FaceRecord, FrameRecord, LIGHT_DIRECTIONAL, LightRecord, MaterialRecord,
    RECONSTRUCT_HARMONICS, RECONSTRUCT_N_SQUARED, RECONSTRUCT_SIX_VECTOR, RECONSTRUCT_THREE_VECTOR,
    SHADOW_BIAS, SHADOW_BORDER, SHADOW_DEPTH_CAP,
};
use crate::lights::light_records;
use crate::{RenderError, RenderOptions, RenderScene, camera};

/// The camera's view begins at this share of the extent of scene and camera.
const NEAR_SHARE: f64 = 1e-5;

/// One step of a frame. Steps are carried out in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pass {
    /// Depth of the first surface of shadow map face `layer`, into the one scratch map.
    ShadowFirst {
        /// Index into [`FramePlan::faces`].
        layer: u32,
    },
    /// Limit depth of face `layer`, from the scratch map and the second surface, into the map's own layer.
    ShadowLimit {
        /// Index into [`FramePlan::faces`].
        layer: u32,
    },
    /// All triangles seen from the camera, shaded.
    Shade,
}

/// Everything a renderer needs to make one frame of a scene.
#[derive(Debug)]
pub struct FramePlan<'scene> {
    /// Width of the picture \[pixels\].
    pub width: u32,
    /// Height of the picture \[pixels\].
    pub height: u32,
    /// Samples a pixel along each axis.
    pub supersampling: u32,
    /// What is seen where there is no surface.
    pub background: Background<'scene>,
    /// What is drawn.
    pub geometry: Geometry,
    /// What is the same for all pixels.
    pub frame: FrameRecord,
    /// Lights.
    pub lights: Vec<LightRecord>,
    /// Faces of all shadow maps; the index is the layer.
    pub faces: Vec<FaceRecord>,
    /// Materials, as many as the scene has.
    pub materials: Vec<MaterialRecord>,
    /// Texture of each material, where it is used.
    pub material_textures: Vec<Option<&'scene Texture>>,
    /// The grid, if the frame has indirect light.
    pub grid: Option<GridLookup<'scene>>,
}

/// A grid and how it is looked up.
#[derive(Debug, Clone, Copy)]
pub struct GridLookup<'scene> {
    /// The grid, every vertex with a value.
    pub grid: &'scene IrradianceGrid,
    /// How irradiance follows from the values of a vertex; fits what the grid holds.
    pub reconstruction: Reconstruction,
    /// How values are interpolated.
    pub filter: SpatialFilter,
    /// World position of the origin of scene space \[m\].
    pub origin: glam::DVec3,
}

impl<'scene> FramePlan<'scene> {
    /// Checks scene and options and plans a frame. What the options switch off and what the scene does not have
    /// costs nothing: no light, shadow map, texture or grid that is not used is in the plan.
    ///
    /// # Errors
    ///
    /// [`RenderError`]: the first problem of scene, camera or options.
    pub fn new(scene: &'scene RenderScene, options: &RenderOptions) -> Result<Self, RenderError> {
        Self::around(scene, options, &[])
    }

    /// As [`FramePlan::new`], for a frame that also shows what lies in these boxes of scene space \[m\], each the least and
    /// the greatest corner.
    pub(crate) fn around(
        scene: &'scene RenderScene,
        options: &RenderOptions,
        boxes: &[(Vec3, Vec3)],
    ) -> Result<Self, RenderError> {
        options.check()?;
        scene.check()?;
        let geometry = Geometry::new(scene)?.containing(boxes);
        let lights = if options.direct {
            let (materials, origin) = (&scene.materials, scene.origin);
            light_records(&geometry, materials, &scene.lights, origin, options.area_samples, options.shadows)
        } else {
            Vec::new()
        };
        let faces: Vec<FaceRecord> =
            lights.iter().flat_map(|light| face_records(light, options.shadow_size)).collect();
        let texture_of = |index: u32| options.textures.then(|| &scene.textures[index as usize]);
        let material_textures: Vec<Option<&Texture>> =
            scene.materials.iter().map(|material| material.albedo_texture.and_then(texture_of)).collect();
        let materials = scene
            .materials
            .iter()
            .zip(&material_textures)
            .map(|(material, texture)| MaterialRecord {
                albedo: material.albedo.to_array(),
                textured: u32::from(texture.is_some()),
                emission: material.emission.to_array(),
                two_sided: u32::from(material.two_sided),
            })
            .collect();
        if let Some(grid) = scene.grid.as_ref().filter(|_| options.indirect)
            && !options.reconstruction.fits(grid.quantity())
        {
            let (reconstruction, holds) = (options.reconstruction.name(), grid.quantity().name());
            return Err(RenderError::Reconstruction { reconstruction, holds });
        }
        let grid = scene.grid.as_ref().filter(|_| options.indirect).map(|grid| GridLookup {
            grid,
            reconstruction: options.reconstruction,
            filter: options.filter,
            origin: scene.origin,
        });
        let (width, height) = options.sample_size();
        let image = scene.sky_image.as_ref().filter(|_| options.sky);
        let background = Background {
            even: scene.sky.filter(|_| options.sky).unwrap_or(Vec3::ZERO),
            image: image.map(|sky| Panorama::new(sky, &scene.camera, [width, height])).transpose()?,
        };
        let mut plan = Self {
            width: options.width,
            height: options.height,
            supersampling: options.supersampling,
            background,
            geometry,
            frame: FrameRecord::default(),
            lights,
            faces,
            materials,
            material_textures,
            grid,
        };
        plan.frame = plan.frame_record(scene, options)?;
        Ok(plan)
    }

    /// The steps of the frame, in order.
    pub fn passes(&self) -> impl Iterator<Item = Pass> + '_ {
        let layers = 0..self.faces.len() as u32;
        let shadow = layers.flat_map(|layer| [Pass::ShadowFirst { layer }, Pass::ShadowLimit { layer }]);
        shadow.chain(std::iter::once(Pass::Shade))
    }

    /// Width and height of what is rendered before it is reduced to the picture \[samples\].
    #[must_use]
    pub fn sample_size(&self) -> (u32, u32) {
        (self.width * self.supersampling, self.height * self.supersampling)
    }

    fn frame_record(&self, scene: &RenderScene, options: &RenderOptions) -> Result<FrameRecord, RenderError> {
        let (width, height) = options.sample_size();
        let eye = (scene.camera.eye - scene.origin).as_vec3();
        let (low, high) = self.geometry.bounds;
        let extent = f64::from((high.max(eye) - low.min(eye)).length());
        // An empty scene has no extent; any positive distance will do.
        let near = if extent > 0.0 { extent * NEAR_SHARE } else { NEAR_SHARE };
        let aspect = f64::from(width) / f64::from(height);
        let view_projection = camera::view_projection(&scene.camera, scene.origin, aspect, near)?;
        let mut record = FrameRecord {
            view_projection: view_projection.to_cols_array_2d(),
            eye: eye.to_array(),
            light_count: self.lights.len() as u32,
            shadow_size: options.shadow_size,
            ..FrameRecord::default()
        };
        if let Some(lookup) = self.grid {
            let lattice = lookup.grid.lattice();
            let steps = lattice.step.into_iter().filter(|step| *step > 0.0);
            let shortest = steps.reduce(f64::min).unwrap_or(0.0);
            record.indirect = 1;
            record.reconstruction = reconstruction_code(lookup.reconstruction);
            record.filter_kind = u32::from(lookup.filter == SpatialFilter::Tricubic);
            record.lattice_origin = (glam::DVec3::from(lattice.origin) - scene.origin).as_vec3().to_array();
            record.lattice_inverse_step =
                lattice.step.map(|step| if step > 0.0 { (1.0 / step) as f32 } else { 0.0 });
            record.lattice_dims = lattice.dims.map(u32::from);
            record.normal_bias = (SURFACE_BIAS * shortest) as f32;
        }
        Ok(record)
    }
}

fn reconstruction_code(reconstruction: Reconstruction) -> u32 {
    match reconstruction {
        Reconstruction::NSquared => RECONSTRUCT_N_SQUARED,
        Reconstruction::SixVector => RECONSTRUCT_SIX_VECTOR,
        Reconstruction::Harmonics => RECONSTRUCT_HARMONICS,
        _ => RECONSTRUCT_THREE_VECTOR,
    }
}

/// The faces of a light's shadow map.
///
/// Perspective faces look along +axis, +tangent, -tangent, +bitangent, -bitangent, -axis of the light's frame; with
/// u, v, w the light's coordinates in the order that puts the face's own axis last, clip space is (s u, s v, reach,
/// w), so depth is reach / w. The tiles of a directional light share the square of half side `reach` around the
/// scene; depth falls linearly from 1 to 0 through the scene's sphere.
fn face_records(light: &LightRecord, shadow_size: u32) -> impl Iterator<Item = FaceRecord> + use<> {
    let position = Vec3::from(light.position);
    let row = |direction: [f32; 3]| {
        let direction = Vec3::from(direction);
        direction.extend(-direction.dot(position))
    };
    let frame = [row(light.tangent), row(light.bitangent), row(light.axis)];
    let (reach, directional) = (light.reach, light.kind == LIGHT_DIRECTIONAL);
    let scale = inner_scale(shadow_size);
    (0..light.layers).map(move |face| {
        if directional {
            tile_record(frame, reach, face, scale, shadow_size)
        } else {
            cube_record(frame, reach, face, scale, shadow_size)
        }
    })
}

fn cube_record(frame: [Vec4; 3], reach: f32, face: u32, scale: f32, shadow_size: u32) -> FaceRecord {
    let [x, y, z] = frame;
    let (u, v, w) = match face {
        0 => (x, y, z),
        1 => (y, z, x),
        2 => (y, z, -x),
        3 => (x, z, y),
        4 => (x, z, -y),
        _ => (x, y, -z),
    };
    let rows = [u * scale, v * scale, Vec4::new(0.0, 0.0, 0.0, reach), w];
    // Width of a texel at distance 1 from the light.
    let texel = 2.0 / (scale * shadow_size as f32);
    FaceRecord {
        matrix: columns(rows),
        perspective: 1,
        bias: SHADOW_BIAS * texel,
        cap: SHADOW_DEPTH_CAP * texel,
        padding: 0,
    }
}

fn tile_record(frame: [Vec4; 3], reach: f32, face: u32, scale: f32, shadow_size: u32) -> FaceRecord {
    let [x, y, z] = frame;
    let tiles = DIRECTIONAL_TILES as f32;
    // Middle of the tile in the square from -1 to 1.
    let middle = |index: u32| (2.0 * index as f32 + 1.0) / tiles - 1.0;
    let tile = |coordinate: Vec4, index: u32| {
        (coordinate / reach - Vec4::new(0.0, 0.0, 0.0, middle(index))) * (tiles * scale)
    };
    let one = Vec4::new(0.0, 0.0, 0.0, 1.0);
    let depth = (one - z / reach) * 0.5;
    let rows = [tile(x, face % DIRECTIONAL_TILES), tile(y, face / DIRECTIONAL_TILES), depth, one];
    // Depth of a texel's width: depth 1 is 2 reach long, a tile is 2 reach / tiles wide.
    let texel = 1.0 / (tiles * scale * shadow_size as f32);
    FaceRecord {
        matrix: columns(rows),
        perspective: 0,
        bias: SHADOW_BIAS * texel,
        cap: SHADOW_DEPTH_CAP * texel,
        padding: 0,
    }
}

/// Share of a face's half side that shows its own part of the world; the rest is border for the filter.
#[must_use]
pub(crate) fn inner_scale(shadow_size: u32) -> f32 {
    (shadow_size - 2 * SHADOW_BORDER) as f32 / shadow_size as f32
}

fn columns(rows: [Vec4; 4]) -> [[f32; 4]; 4] {
    Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose().to_cols_array_2d()
}

#[cfg(test)]
mod tests;
