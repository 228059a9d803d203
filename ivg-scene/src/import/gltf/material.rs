//! Materials and their images.

use std::collections::BTreeMap;

use ::gltf::json;
use ::gltf::json::material::AlphaMode;
use ::gltf::json::texture::{Info, WrappingMode};
use ::gltf::json::validation::Checked;
use glam::{Mat2, Vec2, Vec3};

use super::super::folder::Folder;
use super::super::image;
use super::accessor::Data;
use super::buffers;
use crate::{Material, Scene, SceneError, Texture, Unsupported};

/// How the texture coordinates of a material are made from those of the vertices.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinates {
    /// Which set of coordinates: `TEXCOORD_n`.
    pub(super) set: u32,
    /// The linear part of `KHR_texture_transform`.
    pub(super) linear: Mat2,
    /// Its offset.
    pub(super) offset: Vec2,
}

impl Default for Coordinates {
    fn default() -> Self {
        Self { set: 0, linear: Mat2::IDENTITY, offset: Vec2::ZERO }
    }
}

/// Adds all materials and the images of their base colours to the scene; returns for each material how its texture
/// coordinates are made.
///
/// The base colour is the albedo, also that of metals, for all that draw without mirrors; the share of transmission is taken
/// off it. Metallic and roughness become share and roughness of the mirror reflection. What lets light through is thin, as
/// `KHR_materials_transmission` says, unless `KHR_materials_volume` gives it a thickness.
pub(super) fn read(
    data: &Data<'_>,
    folder: &Folder,
    scene: &mut Scene,
) -> Result<Vec<Coordinates>, SceneError> {
    let mut images = Images { data, folder, loaded: BTreeMap::new() };
    let mut coordinates = Vec::new();
    for (i, source) in data.root.materials.iter().enumerate() {
        let name = source.name.clone().unwrap_or_else(|| format!("material {i}"));
        let object = format!("material \"{name}\"");
        let pbr = &source.pbr_metallic_roughness;
        let [r, g, b, _] = pbr.base_color_factor.0;
        let base = Vec3::new(r, g, b);
        let extensions = source.extensions.as_ref();
        let transmission =
            extensions.and_then(|e| e.transmission.as_ref()).map_or(0.0, |t| t.transmission_factor.0);
        let strength =
            extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |e| e.emissive_strength.0);
        let mut emission = strength * Vec3::from_array(source.emissive_factor.0);

        let mut report =
            |what: &str| scene.unsupported.push(Unsupported { object: object.clone(), what: what.into() });
        if pbr.metallic_roughness_texture.is_some() {
            report("metallic-roughness image: only the factors count");
        }
        if source.normal_texture.is_some() {
            report("normal image: left out");
        }
        if !matches!(source.alpha_mode, Checked::Valid(AlphaMode::Opaque)) {
            report("alpha: treated as opaque");
        }
        if extensions.and_then(|e| e.transmission.as_ref()).is_some_and(|t| t.transmission_texture.is_some())
        {
            report("transmission image: only the factor counts");
        }
        let volume = extensions.and_then(|e| e.volume.as_ref());
        if transmission > 0.0 {
            if volume.is_some_and(|v| v.attenuation_distance.0 < f32::MAX) {
                report("colour of the volume: the glass has the base colour alone");
            }
            if pbr.base_color_texture.is_some() {
                report(
                    "base colour image of a material that lets light through: what passes has the factor alone",
                );
            }
        }
        if let Some(info) = &source.emissive_texture
            && emission != Vec3::ZERO
        {
            report("emissive image: its mean colour is emitted evenly");
            if let Some(texture) = images.get(info, scene) {
                emission *= texture.mean();
            }
        }
        let mut place = Coordinates::default();
        let mut albedo_texture = None;
        if let Some(info) = &pbr.base_color_texture {
            place = coordinates_of(info);
            albedo_texture = images.add(info, scene);
            report_wrapping(data.root, info, &object, scene);
        }
        coordinates.push(place);
        let metallic = pbr.metallic_factor.0 > 0.0;
        scene.materials.push(Material {
            name,
            albedo: base * (1.0 - transmission),
            albedo_texture,
            emission,
            two_sided: source.double_sided,
            specular: pbr.metallic_factor.0,
            specular_colour: if metallic { base } else { Vec3::ONE },
            metallic,
            roughness: pbr.roughness_factor.0,
            transmission,
            transmission_colour: if transmission > 0.0 { base } else { Vec3::ONE },
            thin: transmission > 0.0 && volume.is_none_or(|v| v.thickness_factor.0 <= 0.0),
            refractive_index: extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |i| i.ior.0),
        });
    }
    Ok(coordinates)
}

/// T R S of `KHR_texture_transform`. A positive rotation turns coordinates counter-clockwise as seen with v pointing
/// down (KhronosGroup/glTF#1563: the listing in the extension's text has the sign of the sine the other way round).
fn coordinates_of(info: &Info) -> Coordinates {
    let Some(t) = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref()) else {
        return Coordinates { set: info.tex_coord, ..Coordinates::default() };
    };
    let (sin, cos) = t.rotation.0.sin_cos();
    let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
    Coordinates {
        set: t.tex_coord.unwrap_or(info.tex_coord),
        linear: rotation * Mat2::from_diagonal(Vec2::from_array(t.scale.0)),
        offset: Vec2::from_array(t.offset.0),
    }
}

fn report_wrapping(root: &json::Root, info: &Info, object: &str, scene: &mut Scene) {
    let sampler = root.textures.get(info.index.value()).and_then(|t| root.samplers.get(t.sampler?.value()));
    let repeats = |mode: &Checked<WrappingMode>| matches!(mode, Checked::Valid(WrappingMode::Repeat));
    if let Some(sampler) = sampler
        && !(repeats(&sampler.wrap_s) && repeats(&sampler.wrap_t))
    {
        let what = "image that does not repeat: it repeats outside [0, 1]".into();
        scene.unsupported.push(Unsupported { object: object.into(), what });
    }
}

/// Images that are needed, each decoded once.
struct Images<'a> {
    data: &'a Data<'a>,
    folder: &'a Folder,
    loaded: BTreeMap<usize, Option<u32>>,
}

impl Images<'_> {
    /// The index of the image in the scene; `None` and a warning if it cannot be read.
    fn add(&mut self, info: &Info, scene: &mut Scene) -> Option<u32> {
        let index = self.data.root.textures.get(info.index.value())?.source.value();
        if let Some(known) = self.loaded.get(&index) {
            return *known;
        }
        let texture = match self.load(index) {
            Ok(texture) => {
                scene.textures.push(texture);
                Some(scene.textures.len() as u32 - 1)
            }
            Err(why) => {
                scene.warnings.push(format!("images[{index}]: {why}; the colour factor is used alone"));
                None
            }
        };
        self.loaded.insert(index, texture);
        texture
    }

    /// An image that is needed only while reading.
    fn get(&self, info: &Info, scene: &mut Scene) -> Option<Texture> {
        let index = self.data.root.textures.get(info.index.value())?.source.value();
        match self.load(index) {
            Ok(texture) => Some(texture),
            Err(why) => {
                scene.warnings.push(format!("images[{index}]: {why}; the colour factor is used alone"));
                None
            }
        }
    }

    fn load(&self, index: usize) -> Result<Texture, String> {
        let source = self.data.root.images.get(index).ok_or("does not exist")?;
        let name = source.name.clone().unwrap_or_else(|| match &source.uri {
            Some(uri) if !uri.starts_with("data:") => uri.clone(),
            _ => format!("image {index}"),
        });
        match (&source.buffer_view, &source.uri) {
            (Some(view), _) => image::decode(&name, self.data.view(view.value()).map_err(|e| e.to_string())?),
            (None, Some(uri)) => image::decode(&name, &buffers::fetch(uri, self.folder)?),
            (None, None) => Err("has neither data nor a file".into()),
        }
    }
}
