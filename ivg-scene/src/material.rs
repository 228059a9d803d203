use std::f64::consts::PI;
use std::sync::LazyLock;

use glam::{DVec3, Vec2, Vec3};

pub use lobes::Lobes;

mod lobes;

/// How a surface reflects and emits. Colours are linear RGB.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name the scene gives it.
    pub name: String,
    /// Diffuse albedo, each channel in [0, 1]; multiplied by the texture where there is one.
    pub albedo: Vec3,
    /// Index into [`Scene::textures`](crate::Scene::textures) of the albedo texture.
    pub albedo_texture: Option<u32>,
    /// Emitted radiance of the front side \[W/(m² sr)\] (Lambertian), each channel >= 0.
    pub emission: Vec3,
    /// Whether the back side reflects and emits as the front side does.
    pub two_sided: bool,
    /// Share of mirror reflection in [0, 1]: of the metal (glTF), or of a layer that mirrors (OBJ `Ks`); see [`Lobes`].
    pub specular: f32,
    /// Colour of the mirror reflection seen straight on, each channel in [0, 1]; of a metal, multiplied by the albedo
    /// texture where there is one.
    pub specular_colour: Vec3,
    /// Whether the mirror reflection is that of a metal, which takes the place of the albedo; else it adds to it.
    pub metallic: bool,
    /// Roughness of the mirror reflection in [0, 1]; 0 is a perfect mirror.
    pub roughness: f32,
    /// Share of transmitted light in [0, 1]: glass.
    pub transmission: f32,
    /// Colour filter of transmitted light, each channel in [0, 1], at each surface that it passes.
    pub transmission_colour: Vec3,
    /// Whether light goes straight on behind the surface, as through a pane; else a closed mesh is a solid that bends it.
    pub thin: bool,
    /// Index of refraction of the inside, >= 1.
    pub refractive_index: f32,
}

impl Default for Material {
    /// The stated grey of a surface without a material: albedo 0.5, two-sided, nothing else.
    fn default() -> Self {
        Self {
            name: "default".into(),
            albedo: Vec3::splat(0.5),
            albedo_texture: None,
            emission: Vec3::ZERO,
            two_sided: true,
            specular: 0.0,
            specular_colour: Vec3::ONE,
            metallic: false,
            roughness: 1.0,
            transmission: 0.0,
            transmission_colour: Vec3::ONE,
            thin: false,
            refractive_index: 1.5,
        }
    }
}

/// How the bytes of a [`Texture`] are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TextureFormat {
    /// Three bytes a texel, sRGB transfer curve.
    Srgb8,
}

/// An image, row by row from the top, with repeat wrapping and bilinear lookup.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The name the scene gives it, or the file it came from.
    pub name: String,
    /// Width \[texels\], >= 1.
    pub width: u32,
    /// Height \[texels\], >= 1.
    pub height: u32,
    /// How `texels` are stored.
    pub format: TextureFormat,
    /// `width * height * 3` bytes.
    pub texels: Vec<u8>,
}

impl Material {
    /// Power that a surface of this material and of `area` \[m²\] radiates \[W\], linear RGB: pi * area * radiance, and
    /// twice that if it is two-sided.
    #[must_use]
    pub fn emitted_power(&self, area: f64) -> DVec3 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        sides * PI * area * self.emission.as_dvec3()
    }
}

impl Texture {
    /// Colour at a texture coordinate, linear RGB, each channel in [0, 1].
    ///
    /// (0, 0) is the upper left corner of the image and (1, 1) the lower right one; coordinates outside repeat it.
    /// Bilinear between texel centres, computed on linear values. A coordinate that is not finite reads the first texel.
    ///
    /// # Panics
    ///
    /// Panics if the texture has no texels or fewer than its size says ([`Scene::check`](crate::Scene::check)).
    #[must_use]
    pub fn sample(&self, uv: Vec2) -> Vec3 {
        if !uv.is_finite() {
            return self.texel(0, 0);
        }
        let wrap = |t: f32, size: u32| {
            // f64: half a texel of a 16384-texel image needs more bits than f32 leaves for far coordinates.
            let t = f64::from(t);
            let x = (t - t.floor()) * f64::from(size) - 0.5;
            let low = x.floor();
            let first = (low as i64).rem_euclid(i64::from(size)) as u32;
            (first, (first + 1) % size, (x - low) as f32)
        };
        let (x0, x1, fx) = wrap(uv.x, self.width);
        let (y0, y1, fy) = wrap(uv.y, self.height);
        let upper = self.texel(x0, y0).lerp(self.texel(x1, y0), fx);
        let lower = self.texel(x0, y1).lerp(self.texel(x1, y1), fx);
        upper.lerp(lower, fy)
    }

    /// Colour of a texel, linear RGB, each channel in [0, 1]; row 0 is the upper one.
    ///
    /// # Panics
    ///
    /// Panics if the texel is out of range.
    #[must_use]
    pub fn texel(&self, x: u32, y: u32) -> Vec3 {
        assert!(x < self.width && y < self.height, "texel ({x}, {y}) of {}x{}", self.width, self.height);
        let at = 3 * (y as usize * self.width as usize + x as usize);
        match self.format {
            TextureFormat::Srgb8 => {
                Vec3::from_array([0, 1, 2].map(|k| SRGB_TO_LINEAR[usize::from(self.texels[at + k])]))
            }
        }
    }

    /// Mean colour of the whole image, linear RGB, each channel in [0, 1].
    #[must_use]
    pub fn mean(&self) -> Vec3 {
        let mut counts = [[0u64; 256]; 3];
        for texel in self.texels.chunks_exact(3) {
            for (channel, &value) in texel.iter().enumerate() {
                counts[channel][usize::from(value)] += 1;
            }
        }
        let texels = (self.texels.len() / 3).max(1) as f64;
        Vec3::from_array(counts.map(|channel| {
            let sum: f64 =
                channel.iter().zip(SRGB_TO_LINEAR.iter()).map(|(&n, &v)| n as f64 * f64::from(v)).sum();
            (sum / texels) as f32
        }))
    }
}

/// The transfer curve of IEC 61966-2-1 (sRGB) for all 256 codes.
static SRGB_TO_LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|code| {
        let v = code as f64 / 255.0;
        let linear = if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
        linear as f32
    })
});

/// The code whose light is nearest to `linear`; what is outside [0, 1], or not a number, gets the nearer end, or 0.
pub(crate) fn srgb_code(linear: f32) -> u8 {
    let above = SRGB_TO_LINEAR.partition_point(|&light| light <= linear).clamp(1, 255);
    let (low, high) = (SRGB_TO_LINEAR[above - 1], SRGB_TO_LINEAR[above]);
    (if high - linear < linear - low { above } else { above - 1 }) as u8
}

#[cfg(test)]
mod tests;
