//! `vectors-f32`: 54 binary32 numbers a vertex (`spec/ivg.md` 6.4).

use super::Broken;
use crate::code::codes;
use crate::quant::power_of_two;
use crate::values::HemisphereVectors;

/// Binary32 numbers of a vertex.
const COMPONENTS: usize = 54;

/// Numbers that are judged at once.
const CHECKED: usize = 64;

/// Finds a number that is not finite, stored or scaled (IVG-VEC-02).
pub(super) fn check(payload: &[u8], scale_exponent: i16) -> Result<(), Broken> {
    let scale = power_of_two(i32::from(scale_exponent));
    let (numbers, _) = payload.as_chunks::<4>();
    let finite = |bytes: &[u8; 4]| (f32::from_le_bytes(*bytes) * scale).is_finite();
    for (chunk, numbers) in numbers.chunks(CHECKED).enumerate() {
        if !numbers.iter().fold(true, |all, number| all & finite(number)) {
            let n = numbers.iter().position(|number| !finite(number)).unwrap_or(0);
            return Err(Broken { code: codes::NOT_FINITE, at: (chunk * CHECKED + n) * 4 });
        }
    }
    Ok(())
}

/// The vectors of the vertices from `first` on (IVG-VEC-01).
pub(super) fn read(payload: &[u8], first: usize, scale_exponent: i16, out: &mut [HemisphereVectors]) {
    let scale = power_of_two(i32::from(scale_exponent));
    let (numbers, _) = payload[first * COMPONENTS * 4..].as_chunks::<4>();
    let components = out.as_flattened_mut().as_flattened_mut().as_flattened_mut();
    for (component, &number) in components.iter_mut().zip(numbers) {
        *component = f32::from_le_bytes(number) * scale;
    }
}
