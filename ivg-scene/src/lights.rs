//! Lights files: lights, sky, camera and unit for a scene whose own file has none. The schema is in `LIGHTS.md`.

use std::f64::consts::PI;

use glam::{DAffine3, DVec3, Vec3};
use serde::Deserialize;
use toml::Spanned;

use crate::geometry::snapped_origin;
use crate::import::folder::Folder;
use crate::import::image;
use crate::{Camera, Light, LightKind, Material, Mesh, Node, Scene, SceneError, SkyImage};

/// Longest lights file \[bytes\].
pub(crate) const MAX_BYTES: u64 = 1 << 20;

/// Vertical field of view of a camera that states none \[degrees\].
const DEFAULT_FOV: f64 = 45.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    unit: Option<Spanned<f64>>,
    sky: Option<Spanned<SkyEntry>>,
    camera: Option<Spanned<CameraEntry>>,
    #[serde(default)]
    light: Vec<Spanned<LightEntry>>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "sky is neither three numbers nor a table of `image`, `rotation` and `scale` with an image"
)]
enum SkyEntry {
    Even([f64; 3]),
    Image(SkyImageEntry),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SkyImageEntry {
    image: String,
    rotation: Option<f64>,
    scale: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraEntry {
    eye: [f64; 3],
    target: [f64; 3],
    up: Option<[f64; 3]>,
    fov: Option<f64>,
}

#[derive(Deserialize, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Rect,
    Point,
    Spot,
    Directional,
}

/// All keys of all kinds; which ones a kind needs and takes is checked after reading, so that errors keep their line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LightEntry {
    kind: Kind,
    name: Option<String>,
    center: Option<[f64; 3]>,
    u: Option<[f64; 3]>,
    v: Option<[f64; 3]>,
    radiance: Option<[f64; 3]>,
    position: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
    intensity: Option<[f64; 3]>,
    power: Option<[f64; 3]>,
    inner: Option<f64>,
    outer: Option<f64>,
    irradiance: Option<[f64; 3]>,
}

/// Adds what the lights file `text` says to a scene: first the scene is scaled by its `unit`, then lights, sky and
/// camera are added (a camera replaces the scene's own). Only [`import::load`](crate::import::load) reads the image of a sky.
///
/// # Errors
///
/// [`SceneError::Line`] for text that is not TOML, unknown or missing keys, and values out of range. The scene may be
/// changed in part then.
pub fn apply(scene: &mut Scene, file: &str, text: &str) -> Result<(), SceneError> {
    apply_beside(scene, file, text, &Folder::none())
}

/// As [`apply`], with the files of a folder.
pub(crate) fn apply_beside(
    scene: &mut Scene,
    file: &str,
    text: &str,
    folder: &Folder,
) -> Result<(), SceneError> {
    let line_at =
        |offset: usize| 1 + text.as_bytes()[..offset.min(text.len())].iter().filter(|b| **b == b'\n').count();
    let parsed: File = toml::from_str(text).map_err(|e| {
        let what = e.message().replace('\n', " ");
        SceneError::line(file, e.span().map_or(1, |s| line_at(s.start)), what)
    })?;
    let fail = |at: usize| move |what: String| SceneError::line(file, line_at(at), what);

    let mut unit = 1.0;
    if let Some(stated) = &parsed.unit {
        unit = *stated.get_ref();
        if !(unit.is_finite() && unit > 0.0) {
            return Err(fail(stated.span().start)(format!("unit {unit} is not a positive number of metres")));
        }
        scale(scene, unit);
    }
    if let Some(sky) = &parsed.sky {
        let fail = fail(sky.span().start);
        match sky.get_ref() {
            SkyEntry::Even(radiance) => scene.sky = Some(radiometric("sky", *radiance).map_err(fail)?),
            SkyEntry::Image(entry) => scene.sky_image = Some(entry.read(folder).map_err(fail)?),
        }
    }
    if let Some(camera) = &parsed.camera {
        scene.camera = Some(camera.get_ref().read(unit).map_err(fail(camera.span().start))?);
    }
    for (i, entry) in parsed.light.iter().enumerate() {
        let light = entry.get_ref();
        let name = light.name.clone().unwrap_or_else(|| format!("light {}", i + 1));
        light.add(scene, name, unit).map_err(fail(entry.span().start))?;
    }
    Ok(())
}

fn scale(scene: &mut Scene, unit: f64) {
    let matrix = DAffine3::from_scale(DVec3::splat(unit));
    for node in &mut scene.nodes {
        node.transform = matrix * node.transform;
    }
    for light in &mut scene.lights {
        match &mut light.kind {
            LightKind::Point { position, .. } | LightKind::Spot { position, .. } => *position *= unit,
            LightKind::Directional { .. } => {}
        }
    }
    if let Some(camera) = &mut scene.camera {
        camera.eye *= unit;
        camera.target *= unit;
    }
}

/// Longest image of a sky \[bytes\].
const MAX_SKY_FILE: u64 = 1 << 30;

impl SkyImageEntry {
    fn read(&self, folder: &Folder) -> Result<SkyImage, String> {
        let (rotation, scale) = (self.rotation.unwrap_or(0.0), self.scale.unwrap_or(1.0));
        if !(rotation.is_finite() && scale.is_finite() && scale >= 0.0) {
            return Err(format!(
                "sky: rotation {rotation} and scale {scale} are not a number of degrees and one of at least 0"
            ));
        }
        let bytes = folder.read(&self.image, MAX_SKY_FILE).map_err(|e| format!("sky: {}", e.0))?;
        image::decode_sky(&self.image, &bytes, scale as f32, rotation.to_radians() as f32)
            .map_err(|why| format!("sky: \"{}\" {why}", self.image))
    }
}

impl CameraEntry {
    fn read(&self, unit: f64) -> Result<Camera, String> {
        let fov = self.fov.unwrap_or(DEFAULT_FOV);
        if !(fov > 0.0 && fov < 180.0) {
            return Err(format!("camera: fov {fov} is not between 0 and 180 degrees"));
        }
        let eye = place("eye", self.eye)? * unit;
        let target = place("target", self.target)? * unit;
        if eye == target {
            return Err("camera: eye and target are the same point".into());
        }
        let up = place("up", self.up.unwrap_or([0.0, 1.0, 0.0]))?;
        Ok(Camera { eye, target, up, vertical_fov: fov.to_radians() as f32 })
    }
}

impl LightEntry {
    /// The keys that are given, by name, without `kind` and `name`.
    fn keys(&self) -> Vec<&'static str> {
        let keys = [
            ("center", self.center.is_some()),
            ("u", self.u.is_some()),
            ("v", self.v.is_some()),
            ("radiance", self.radiance.is_some()),
            ("position", self.position.is_some()),
            ("direction", self.direction.is_some()),
            ("intensity", self.intensity.is_some()),
            ("power", self.power.is_some()),
            ("inner", self.inner.is_some()),
            ("outer", self.outer.is_some()),
            ("irradiance", self.irradiance.is_some()),
        ];
        keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    fn only(&self, kind: &str, known: &[&str]) -> Result<(), String> {
        match self.keys().into_iter().find(|key| !known.contains(key)) {
            Some(key) => Err(format!("a {kind} light has no `{key}`; it has {}", known.join(", "))),
            None => Ok(()),
        }
    }

    fn add(&self, scene: &mut Scene, name: String, unit: f64) -> Result<(), String> {
        let kind = match self.kind {
            Kind::Rect => {
                self.only("rect", &["center", "u", "v", "radiance"])?;
                return self.add_rect(scene, name, unit);
            }
            Kind::Point => {
                self.only("point", &["position", "intensity", "power"])?;
                let position = place("position", needed("point", "position", self.position)?)? * unit;
                LightKind::Point { position, intensity: self.intensity(4.0 * PI)? }
            }
            Kind::Spot => {
                self.only("spot", &["position", "direction", "intensity", "power", "inner", "outer"])?;
                self.spot(unit)?
            }
            Kind::Directional => {
                self.only("directional", &["direction", "irradiance"])?;
                LightKind::Directional {
                    direction: direction(needed("directional", "direction", self.direction)?)?,
                    irradiance: radiometric(
                        "irradiance",
                        needed("directional", "irradiance", self.irradiance)?,
                    )?,
                }
            }
        };
        scene.lights.push(Light { name, kind });
        Ok(())
    }

    fn spot(&self, unit: f64) -> Result<LightKind, String> {
        let inner = self.inner.unwrap_or(0.0);
        let outer = needed("spot", "outer", self.outer)?;
        if !(inner >= 0.0 && inner < outer && outer <= 90.0) {
            return Err(format!(
                "a spot light needs 0 <= inner < outer <= 90 degrees, but has {inner} and {outer}"
            ));
        }
        let full = LightKind::Spot {
            position: place("position", needed("spot", "position", self.position)?)? * unit,
            direction: direction(needed("spot", "direction", self.direction)?)?,
            intensity: Vec3::ONE,
            inner_angle: inner.to_radians() as f32,
            outer_angle: outer.to_radians() as f32,
        };
        let solid_angle = Light { name: String::new(), kind: full }.power().map_or(1.0, |p| p.x);
        let strength = self.intensity(solid_angle)?;
        Ok(match full {
            LightKind::Spot { position, direction, inner_angle, outer_angle, .. } => {
                LightKind::Spot { position, direction, intensity: strength, inner_angle, outer_angle }
            }
            other => other,
        })
    }

    /// Intensity \[W/sr\], given as such or as power \[W\] over a solid angle \[sr\].
    fn intensity(&self, solid_angle: f64) -> Result<Vec3, String> {
        match (self.intensity, self.power) {
            (Some(intensity), None) => radiometric("intensity", intensity),
            (None, Some(power)) => radiometric("power", power.map(|p| p / solid_angle)),
            _ => Err("a point or spot light needs either `intensity` in W/sr or `power` in W".into()),
        }
    }

    fn add_rect(&self, scene: &mut Scene, name: String, unit: f64) -> Result<(), String> {
        let center = place("center", needed("rect", "center", self.center)?)? * unit;
        let u = place("u", needed("rect", "u", self.u)?)? * unit;
        let v = place("v", needed("rect", "v", self.v)?)? * unit;
        let radiance = radiometric("radiance", needed("rect", "radiance", self.radiance)?)?;
        let normal = u.cross(v);
        if normal == DVec3::ZERO {
            return Err("a rect light needs half edge vectors u and v that span an area".into());
        }
        let corners = [center - u - v, center + u - v, center + u + v, center - u + v];
        let (min, max) = corners.iter().fold((corners[0], corners[0]), |(a, b), c| (a.min(*c), b.max(*c)));
        let origin = snapped_origin(min, max);
        let material = Material {
            name: name.clone(),
            albedo: Vec3::ZERO,
            emission: radiance,
            two_sided: false,
            ..Material::default()
        };
        let mesh = Mesh {
            name: name.clone(),
            origin,
            positions: corners.map(|c| (c - origin).as_vec3()).to_vec(),
            normals: vec![normal.normalize().as_vec3(); 4],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_materials: vec![scene.materials.len() as u32; 2],
            ..Mesh::default()
        };
        scene.nodes.push(Node { name, mesh: scene.meshes.len() as u32, transform: DAffine3::IDENTITY });
        scene.materials.push(material);
        scene.meshes.push(mesh);
        Ok(())
    }
}

fn needed<T>(kind: &str, key: &str, value: Option<T>) -> Result<T, String> {
    value.ok_or_else(|| format!("a {kind} light needs `{key}`"))
}

fn place(key: &str, v: [f64; 3]) -> Result<DVec3, String> {
    let v = DVec3::from_array(v);
    if v.is_finite() { Ok(v) } else { Err(format!("{key} {v} is not finite")) }
}

fn direction(v: [f64; 3]) -> Result<Vec3, String> {
    match place("direction", v)?.try_normalize() {
        Some(unit) => Ok(unit.as_vec3()),
        None => Err("direction is zero".into()),
    }
}

fn radiometric(key: &str, v: [f64; 3]) -> Result<Vec3, String> {
    let v = DVec3::from_array(v).as_vec3();
    let ok = v.is_finite() && v.min_element() >= 0.0;
    if ok { Ok(v) } else { Err(format!("{key} {v} is not three finite numbers of at least 0")) }
}

#[cfg(test)]
mod tests;
