//! Is a scene fit to be simulated? The first thing that is not is named.

use glam::{DVec3, Vec3};

use crate::{Camera, Light, LightKind, Material, Mesh, Scene, SceneError, SkyImage, Texture};

/// How far the square of a unit vector's length may be from 1: some ten times what f32 rounding leaves.
const UNIT_TOLERANCE: f32 = 1e-5;

impl Scene {
    /// Checks that the scene can be worked on: every index in range, every number finite, colours, radiances, angles
    /// and sizes in the ranges that their types state.
    ///
    /// # Errors
    ///
    /// [`SceneError::Object`] naming the first object that breaks a rule, and how.
    pub fn check(&self) -> Result<(), SceneError> {
        let found = (self.textures.iter().find_map(|t| fault("texture", &t.name, texture(t))))
            .or_else(|| self.materials.iter().find_map(|m| fault("material", &m.name, self.material(m))))
            .or_else(|| self.meshes.iter().find_map(|m| fault("mesh", &m.name, self.mesh(m))))
            .or_else(|| self.nodes.iter().find_map(|n| fault("node", &n.name, self.node(n))))
            .or_else(|| self.lights.iter().find_map(|l| fault("light", &l.name, light(l))))
            .or_else(|| self.sky.and_then(|s| fault("sky", &self.name, radiant("radiance", s))))
            .or_else(|| self.sky_image.as_ref().and_then(|s| fault("sky image", &s.name, sky_image(s))))
            .or_else(|| self.camera.and_then(|c| fault("camera", &self.name, camera(&c))));
        found.map_or(Ok(()), Err)
    }

    /// Checks that something in the scene emits light: a triangle of an emissive material, a light, or the sky.
    ///
    /// # Errors
    ///
    /// [`SceneError::NoLight`], which names the option that adds one.
    pub fn require_light(&self) -> Result<(), SceneError> {
        let emissive = |m: &u32| self.materials.get(*m as usize).is_some_and(|m| m.emission != Vec3::ZERO);
        let lit = self.lights.iter().any(|l| l.kind.strength() != Vec3::ZERO)
            || self.mean_sky().is_some_and(|s| s != Vec3::ZERO)
            || (self.nodes.iter().filter_map(|n| self.meshes.get(n.mesh as usize)))
                .any(|mesh| mesh.triangle_materials.iter().any(emissive));
        if lit { Ok(()) } else { Err(SceneError::NoLight { scene: self.name.clone() }) }
    }

    fn material(&self, m: &Material) -> Option<String> {
        if let Some(t) = m.albedo_texture
            && t as usize >= self.textures.len()
        {
            return Some(format!("names texture {t}, but there are only {}", self.textures.len()));
        }
        share("albedo", m.albedo)
            .or_else(|| radiant("emission", m.emission))
            .or_else(|| share("share of mirror reflection", Vec3::splat(m.specular)))
            .or_else(|| share("colour of mirror reflection", m.specular_colour))
            .or_else(|| share("roughness", Vec3::splat(m.roughness)))
            .or_else(|| share("share of transmission", Vec3::splat(m.transmission)))
            .or_else(|| share("colour of transmission", m.transmission_colour))
            .or_else(|| {
                let ok = m.refractive_index.is_finite() && m.refractive_index >= 1.0;
                (!ok).then(|| {
                    format!("index of refraction {} is not a number of at least 1", m.refractive_index)
                })
            })
    }

    fn mesh(&self, m: &Mesh) -> Option<String> {
        let vertices = m.positions.len();
        if !m.origin.is_finite() {
            return Some(format!("origin {} is not finite", m.origin));
        }
        if let Some(i) = m.positions.iter().position(|p| !p.is_finite()) {
            return Some(format!("position of vertex {i} is not finite: {}", m.positions[i]));
        }
        if let Some(i) = m.normals.iter().position(|n| !n.is_finite()) {
            return Some(format!("normal of vertex {i} is not finite: {}", m.normals[i]));
        }
        if let Some(i) = m.uvs.iter().position(|uv| !uv.is_finite()) {
            return Some(format!("texture coordinate of vertex {i} is not finite: {}", m.uvs[i]));
        }
        for (what, count) in
            [("normals", m.normals.len()), ("texture coordinates", m.uvs.len()), ("colours", m.colours.len())]
        {
            if count != 0 && count != vertices {
                return Some(format!("{count} {what} for {vertices} vertices"));
            }
        }
        if m.triangle_materials.len() != m.triangles.len() {
            return Some(format!(
                "{} materials for {} triangles",
                m.triangle_materials.len(),
                m.triangles.len()
            ));
        }
        if let Some((t, i)) = m
            .triangles
            .iter()
            .enumerate()
            .find_map(|(t, c)| c.iter().find(|i| **i as usize >= vertices).map(|i| (t, i)))
        {
            return Some(format!("triangle {t} names vertex {i}, but there are only {vertices}"));
        }
        let materials = self.materials.len();
        m.triangle_materials.iter().position(|i| *i as usize >= materials).map(|t| {
            format!("triangle {t} names material {}, but there are only {materials}", m.triangle_materials[t])
        })
    }

    fn node(&self, n: &crate::Node) -> Option<String> {
        if n.mesh as usize >= self.meshes.len() {
            return Some(format!("names mesh {}, but there are only {}", n.mesh, self.meshes.len()));
        }
        (!n.transform.is_finite()).then(|| "transform is not finite".into())
    }
}

impl LightKind {
    /// Intensity or irradiance, linear RGB, in the unit of its kind.
    #[must_use]
    pub fn strength(&self) -> Vec3 {
        match *self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Directional { irradiance, .. } => irradiance,
        }
    }
}

fn fault(kind: &str, name: &str, what: Option<String>) -> Option<SceneError> {
    what.map(|what| SceneError::object(kind, name, what))
}

fn texture(t: &Texture) -> Option<String> {
    let expected = u64::from(t.width) * u64::from(t.height) * 3;
    if expected == 0 {
        return Some(format!("has no texels ({}x{})", t.width, t.height));
    }
    (t.texels.len() as u64 != expected)
        .then(|| format!("{} bytes instead of {expected} for {}x{}", t.texels.len(), t.width, t.height))
}

fn sky_image(s: &SkyImage) -> Option<String> {
    let expected = u64::from(s.width) * u64::from(s.height);
    if expected == 0 || s.texels.len() as u64 != expected {
        return Some(format!("{} texels for {}x{}", s.texels.len(), s.width, s.height));
    }
    if !s.rotation.is_finite() {
        return Some(format!("rotation {} is not finite", s.rotation));
    }
    s.texels.iter().find_map(|t| radiant("radiance", Vec3::from_array(*t)))
}

fn light(l: &Light) -> Option<String> {
    match l.kind {
        LightKind::Point { position, intensity } => {
            place(position).or_else(|| radiant("intensity", intensity))
        }
        LightKind::Spot { position, direction, intensity, inner_angle, outer_angle } => place(position)
            .or_else(|| unit(direction))
            .or_else(|| radiant("intensity", intensity))
            .or_else(|| {
                let ok = inner_angle >= 0.0 && inner_angle < outer_angle && outer_angle <= MAX_SPOT_ANGLE;
                (!ok).then(|| {
                    format!(
                        "angles must be 0 <= inner < outer <= pi/2, but are {inner_angle} and {outer_angle}"
                    )
                })
            }),
        LightKind::Directional { direction, irradiance } => {
            unit(direction).or_else(|| radiant("irradiance", irradiance))
        }
    }
}

/// Largest half angle of a spot \[rad\] (`KHR_lights_punctual`), with room for rounding.
const MAX_SPOT_ANGLE: f32 = std::f32::consts::FRAC_PI_2 + 1e-6;

fn camera(c: &Camera) -> Option<String> {
    if !(c.eye.is_finite() && c.target.is_finite() && c.up.is_finite()) {
        return Some("eye, target or up is not finite".into());
    }
    let axis = (c.target - c.eye).normalize_or_zero();
    if axis == DVec3::ZERO {
        return Some("eye and target are the same point".into());
    }
    if axis.cross(c.up.normalize_or_zero()) == DVec3::ZERO {
        return Some("up is zero or parallel to the view axis".into());
    }
    let ok = c.vertical_fov > 0.0 && c.vertical_fov < std::f32::consts::PI;
    (!ok).then(|| format!("vertical field of view {} rad is not in (0, pi)", c.vertical_fov))
}

fn place(p: DVec3) -> Option<String> {
    (!p.is_finite()).then(|| format!("position {p} is not finite"))
}

fn unit(d: Vec3) -> Option<String> {
    let ok = (d.length_squared() - 1.0).abs() <= UNIT_TOLERANCE;
    (!ok).then(|| format!("direction {d} has not unit length"))
}

fn radiant(what: &str, v: Vec3) -> Option<String> {
    let ok = v.is_finite() && v.min_element() >= 0.0;
    (!ok).then(|| format!("{what} {v} is not finite and at least 0"))
}

fn share(what: &str, v: Vec3) -> Option<String> {
    let ok = v.is_finite() && v.min_element() >= 0.0 && v.max_element() <= 1.0;
    (!ok).then(|| format!("{what} {v} is not in [0, 1]"))
}

#[cfg(test)]
mod tests;
