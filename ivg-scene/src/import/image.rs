//! Decoding images into textures.

use std::io::Cursor;

use ::image::{ImageFormat, ImageReader, Limits};

use glam::Vec3;

use crate::{SkyImage, Texture, TextureFormat};

/// Largest width and height of an image \[texels\]: what GPUs take as one texture.
const MAX_SIDE: u32 = 16_384;
/// Most memory the decoder may use \[bytes\]: a largest image with four bytes a texel.
const MAX_DECODE_BYTES: u64 = 4 * (MAX_SIDE as u64) * (MAX_SIDE as u64);

/// Most memory the decoder of a sky may use \[bytes\]: 8192 x 4096 texels of four f32, twice.
const MAX_SKY_BYTES: u64 = 1 << 30;
/// Most columns that are kept of a sky: a texel is then a third of the moon's width.
const MAX_SKY_WIDTH: u32 = 2048;

/// Decodes a Radiance HDR or OpenEXR image of a sky and multiplies it by `scale`. Alpha is dropped, negative numbers become zero,
/// and more than 2048 columns are reduced to their means.
///
/// # Errors
///
/// Says why the image cannot be used.
pub(crate) fn decode_sky(name: &str, bytes: &[u8], scale: f32, rotation: f32) -> Result<SkyImage, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Hdr | ImageFormat::OpenExr)) {
        return Err("is neither a Radiance HDR nor an OpenEXR image".into());
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_SKY_BYTES);
    reader.limits(limits);
    let image = reader.decode().map_err(|e| e.to_string())?.into_rgb32f();
    let (width, height) = image.dimensions();
    if width == 0 || height == 0 {
        return Err("has no texels".into());
    }
    let scaled = |t: &[f32]| (Vec3::new(t[0], t[1], t[2]) * scale).max(Vec3::ZERO);
    let texels: Vec<[f32; 3]> = image.as_raw().chunks_exact(3).map(|t| scaled(t).to_array()).collect();
    if let Some(at) = image.as_raw().iter().position(|t| !(t * scale).is_finite()) {
        let (column, row) = (at / 3 % width as usize, at / 3 / width as usize);
        return Err(format!("has a texel that is not a finite number (column {column}, row {row})"));
    }
    Ok(SkyImage { name: name.into(), width, height, rotation, texels }.reduced(MAX_SKY_WIDTH))
}

/// Decodes a PNG or JPEG; alpha and more than eight bits a channel are dropped.
///
/// # Errors
///
/// Says why the image cannot be decoded.
pub(crate) fn decode(name: &str, bytes: &[u8]) -> Result<Texture, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_DECODE_BYTES);
    reader.limits(limits);
    let image = reader.decode().map_err(|e| e.to_string())?.into_rgb8();
    let (width, height) = image.dimensions();
    if width == 0 || height == 0 {
        return Err("it has no texels".into());
    }
    Ok(Texture { name: name.into(), width, height, format: TextureFormat::Srgb8, texels: image.into_raw() })
}
