//! From linear light to a display: exposure, clipping, the sRGB transfer curve. There is one curve in this project,
//! so that two pictures of one scene can always be compared.

use glam::Vec3;

use crate::{DisplayImage, Image};

/// Weights of the linear Rec. 709 channels in relative luminance (Rec. ITU-R BT.709-6, item 3.2).
pub const LUMINANCE: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

/// Display value that [`auto_exposure`] gives to a grey of mean logarithmic luminance: the "middle grey" 0.18 of
/// Reinhard et al. 2002, section 3.
const KEY: f32 = 0.18;

/// Share of the pixels that [`auto_exposure`] lets run into clipping at most: light sources seen directly, not lit
/// walls.
const CLIPPED_SHARE: f64 = 0.1;

/// The sRGB transfer curve (IEC 61966-2-1): linear value in [0, 1] to display value in [0, 1].
#[must_use]
pub fn srgb_from_linear(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_from_linear`].
#[must_use]
pub fn linear_from_srgb(display: f32) -> f32 {
    if display <= 0.040_45 { display / 12.92 } else { ((display + 0.055) / 1.055).powf(2.4) }
}

/// The picture for a display: each channel multiplied by `exposure` \[(m² sr)/W\], clipped to [0, 1], put through
/// the sRGB curve and rounded to 8 bits. Not-a-number becomes black.
#[must_use]
pub fn tonemap(image: &Image, exposure: f32) -> DisplayImage {
    let pixels = image.pixels().iter().map(|pixel| display_pixel(*pixel * exposure)).collect();
    DisplayImage::new(image.width(), image.height(), pixels)
}

/// An exposure that suits `image` \[(m² sr)/W\]: the mean logarithmic luminance of the pixels that are not black is
/// shown as middle grey (Reinhard et al. 2002, equations 1 and 2), less if more than 10 % of those pixels would clip.
/// 1 for a black picture.
#[must_use]
pub fn auto_exposure(image: &Image) -> f32 {
    let mut luminances: Vec<f32> =
        image.pixels().iter().map(|p| p.dot(LUMINANCE)).filter(|l| *l > 0.0 && l.is_finite()).collect();
    if luminances.is_empty() {
        return 1.0;
    }
    luminances.sort_by(f32::total_cmp);
    let mean = luminances.iter().map(|l| f64::from(*l).ln()).sum::<f64>() / luminances.len() as f64;
    let last_unclipped = ((luminances.len() - 1) as f64 * (1.0 - CLIPPED_SHARE)) as usize;
    (KEY / mean.exp() as f32).min(1.0 / luminances[last_unclipped])
}

fn display_pixel(linear: Vec3) -> [u8; 3] {
    // `as u8` saturates and maps not-a-number to 0.
    linear.to_array().map(|channel| (srgb_from_linear(channel.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8)
}

#[cfg(test)]
mod tests;
