//! How far two pictures are apart. Every figure here is zero for equal pictures only, and each has a test in which a
//! wrong picture makes it fail.

use crate::tonemap::{linear_from_srgb, tonemap};
use crate::{DisplayImage, Image};

/// The two pictures do not have the same size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("pictures of different size: {} x {} and {} x {} pixels", first.0, first.1, second.0, second.1)]
pub struct SizeMismatch {
    /// Width and height of the first picture \[pixels\].
    pub first: (u32, u32),
    /// Width and height of the second picture \[pixels\].
    pub second: (u32, u32),
}

/// Chromaticity-free white of the display: CIE 1931 tristimulus values of D65 (IEC 61966-2-1).
const WHITE_D65: [f64; 3] = [0.950_47, 1.0, 1.088_83];

/// Linear Rec. 709 RGB to CIE XYZ under D65 (IEC 61966-2-1).
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// Root mean square difference over all pixels and channels of two linear pictures \[W/(m² sr)\]. Not-a-number in
/// either picture makes the result not-a-number, which is below no bound.
///
/// # Errors
///
/// [`SizeMismatch`].
pub fn rmse(first: &Image, second: &Image) -> Result<f64, SizeMismatch> {
    same_size((first.width(), first.height()), (second.width(), second.height()))?;
    let pairs = first.pixels().iter().zip(second.pixels());
    Ok(root_mean_square(pairs.map(|(a, b)| (*a - *b).to_array().map(f64::from))))
}

/// Root mean square difference over all pixels and channels of two display pictures, in 8-bit codes (0 to 255).
///
/// # Errors
///
/// [`SizeMismatch`].
pub fn rmse_display(first: &DisplayImage, second: &DisplayImage) -> Result<f64, SizeMismatch> {
    same_size((first.width(), first.height()), (second.width(), second.height()))?;
    let pairs = first.pixels().iter().zip(second.pixels());
    Ok(root_mean_square(
        pairs.map(|(a, b)| [0, 1, 2].map(|channel| f64::from(a[channel]) - f64::from(b[channel]))),
    ))
}

/// Mean CIE 1976 colour difference over all pixels of two display pictures, divided by 100: 0 for equal pictures, 1
/// for white against black. White point D65. This is the "Lab difference" that Web3D 2008 reports.
///
/// # Errors
///
/// [`SizeMismatch`].
pub fn cie76(first: &DisplayImage, second: &DisplayImage) -> Result<f64, SizeMismatch> {
    same_size((first.width(), first.height()), (second.width(), second.height()))?;
    let sum: f64 = first
        .pixels()
        .iter()
        .zip(second.pixels())
        .map(|(a, b)| {
            let (a, b) = (lab(*a), lab(*b));
            let square: f64 = a.iter().zip(&b).map(|(x, y)| (x - y) * (x - y)).sum();
            square.sqrt()
        })
        .sum();
    Ok(sum / first.pixels().len().max(1) as f64 / 100.0)
}

/// [`cie76`] of two linear pictures after [`tonemap`] with one exposure \[(m² sr)/W\] for both.
///
/// # Errors
///
/// [`SizeMismatch`].
pub fn cie76_exposed(first: &Image, second: &Image, exposure: f32) -> Result<f64, SizeMismatch> {
    cie76(&tonemap(first, exposure), &tonemap(second, exposure))
}

/// How the pixels of two linear pictures differ, for a bound that most pixels keep and a stated few may break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Largest difference of a channel \[W/(m² sr)\]; infinite if either picture holds not-a-number.
    pub largest: f32,
    /// Column and row of the pixel where it is.
    pub at: (u32, u32),
    /// Number of pixels with a channel that differs by more than the tolerance.
    pub beyond_tolerance: usize,
}

/// Compares two linear pictures pixel by pixel. A channel is beyond tolerance if it differs by more than
/// `absolute` \[W/(m² sr)\] plus `relative` times the larger of the two values, or if either is not-a-number.
///
/// # Errors
///
/// [`SizeMismatch`].
pub fn difference(
    first: &Image,
    second: &Image,
    absolute: f32,
    relative: f32,
) -> Result<Difference, SizeMismatch> {
    same_size((first.width(), first.height()), (second.width(), second.height()))?;
    let mut result = Difference { largest: 0.0, at: (0, 0), beyond_tolerance: 0 };
    for (index, (a, b)) in first.pixels().iter().zip(second.pixels()).enumerate() {
        let mut beyond = false;
        for (a, b) in a.to_array().into_iter().zip(b.to_array()) {
            let apart = if a == b { 0.0 } else { (a - b).abs() };
            let apart = if apart.is_nan() { f32::INFINITY } else { apart };
            beyond |= apart > absolute + relative * a.abs().max(b.abs()) || apart == f32::INFINITY;
            if apart > result.largest {
                let width = first.width() as usize;
                result.largest = apart;
                result.at = ((index % width) as u32, (index / width) as u32);
            }
        }
        result.beyond_tolerance += usize::from(beyond);
    }
    Ok(result)
}

fn same_size(first: (u32, u32), second: (u32, u32)) -> Result<(), SizeMismatch> {
    if first == second { Ok(()) } else { Err(SizeMismatch { first, second }) }
}

fn root_mean_square(differences: impl Iterator<Item = [f64; 3]>) -> f64 {
    let mut sum = 0.0;
    let mut count = 0u64;
    for difference in differences {
        sum += difference.iter().map(|d| d * d).sum::<f64>();
        count += 3;
    }
    (sum / count.max(1) as f64).sqrt()
}

/// CIE L*a*b* 1976 of an sRGB pixel under D65 (CIE 15:2004, section 8.2.1).
fn lab(pixel: [u8; 3]) -> [f64; 3] {
    let rgb = pixel.map(|code| f64::from(linear_from_srgb(f32::from(code) / 255.0)));
    let mut relative = [0.0; 3];
    for ((value, row), white) in relative.iter_mut().zip(&XYZ_FROM_RGB).zip(&WHITE_D65) {
        let xyz: f64 = row.iter().zip(&rgb).map(|(m, c)| m * c).sum();
        *value = lab_curve(xyz / white);
    }
    let [x, y, z] = relative;
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn lab_curve(t: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if t > DELTA * DELTA * DELTA { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
}

#[cfg(test)]
mod tests;
