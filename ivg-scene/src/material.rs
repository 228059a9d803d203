use glam::Vec3;

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
    /// Share of mirror reflection in [0, 1]: metallic surfaces of low roughness, OBJ `Ks`/`illum 3`.
    pub specular: f32,
    /// Roughness of the mirror reflection in [0, 1]; 0 is a perfect mirror.
    pub roughness: f32,
    /// Share of transmitted light in [0, 1]: glass.
    pub transmission: f32,
    /// Colour filter of transmitted light, each channel in [0, 1].
    pub transmission_colour: Vec3,
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
            roughness: 1.0,
            transmission: 0.0,
            transmission_colour: Vec3::ONE,
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
