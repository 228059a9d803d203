//! Decoding images into textures.

use std::io::Cursor;

use ::image::{ImageReader, Limits};

use crate::{Texture, TextureFormat};

/// Largest width and height of an image \[texels\]: what GPUs take as one texture.
const MAX_SIDE: u32 = 16_384;
/// Most memory the decoder may use \[bytes\]: a largest image with four bytes a texel.
const MAX_DECODE_BYTES: u64 = 4 * (MAX_SIDE as u64) * (MAX_SIDE as u64);

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
