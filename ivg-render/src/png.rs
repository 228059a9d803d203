//! Pictures as PNG files: 8-bit sRGB.

use std::fs;
use std::io::Cursor;
use std::path::Path;

use image::{ImageFormat, RgbImage};

use crate::DisplayImage;

/// Why a picture could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PngError {
    /// The file system refused.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The bytes are not a picture this crate reads, or the picture is too large to write.
    #[error("PNG: {0}")]
    Codec(#[from] image::ImageError),
}

/// The bytes of a PNG file that holds `image`.
///
/// # Errors
///
/// [`PngError::Codec`] for a picture without pixels or too large for the format.
pub fn encode(image: &DisplayImage) -> Result<Vec<u8>, PngError> {
    let bytes = image.pixels().as_flattened().to_vec();
    let mut file = Cursor::new(Vec::new());
    RgbImage::from_raw(image.width(), image.height(), bytes)
        .ok_or_else(|| {
            let parameter = image::error::ParameterErrorKind::DimensionMismatch;
            image::ImageError::Parameter(image::error::ParameterError::from_kind(parameter))
        })?
        .write_to(&mut file, ImageFormat::Png)?;
    Ok(file.into_inner())
}

/// The picture in the bytes of a PNG file; other pixel formats are converted, transparency is ignored.
///
/// # Errors
///
/// [`PngError::Codec`] if the bytes are not a PNG file.
pub fn decode(bytes: &[u8]) -> Result<DisplayImage, PngError> {
    let image = image::load_from_memory_with_format(bytes, ImageFormat::Png)?.into_rgb8();
    let (width, height) = image.dimensions();
    Ok(DisplayImage::new(width, height, image.pixels().map(|pixel| pixel.0).collect()))
}

/// Writes `image` to a PNG file: to a neighbour first, then renamed, so that no half-written picture is ever seen
/// under `path`.
///
/// # Errors
///
/// [`PngError::File`] naming the file, or what [`encode`] says.
pub fn write(path: &Path, image: &DisplayImage) -> Result<(), PngError> {
    let bytes = encode(image)?;
    let mut partial = path.as_os_str().to_owned();
    partial.push(".partial");
    let in_file = |source| PngError::File { path: path.display().to_string(), source };
    fs::write(&partial, bytes).and_then(|()| fs::rename(&partial, path)).map_err(|source| {
        // The first failure is what the caller must know; a leftover that cannot be removed changes nothing.
        let _ = fs::remove_file(&partial);
        in_file(source)
    })
}

/// Reads a PNG file.
///
/// # Errors
///
/// [`PngError::File`] naming the file, or what [`decode`] says.
pub fn read(path: &Path) -> Result<DisplayImage, PngError> {
    let bytes =
        fs::read(path).map_err(|source| PngError::File { path: path.display().to_string(), source })?;
    decode(&bytes)
}

#[cfg(test)]
mod tests;
