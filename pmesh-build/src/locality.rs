//! An order of vertices in which neighbours stand near each other: what a collapse looks at then lies in few cache lines.

/// Steps of the curve along each side of the box, in bits.
const BITS: u32 = 16;

/// Where each position lies along a curve through the box of all of them that visits small cubes one after the other (Morton,
/// "A Computer Oriented Geodetic Data Base and a New Technique in File Sequencing", IBM 1966).
pub(crate) fn along_curve(positions: &[[f32; 3]]) -> Vec<u64> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(f64::from(p[axis]));
            high[axis] = high[axis].max(f64::from(p[axis]));
        }
    }
    let side = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    let steps = if side > 0.0 { f64::from((1u32 << BITS) - 1) / side } else { 0.0 };
    let place = |p: &[f32; 3]| {
        let cell = |axis: usize| ((f64::from(p[axis]) - low[axis]) * steps) as u64;
        spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2
    };
    positions.iter().map(place).collect()
}

/// Puts two zeros between the lowest [`BITS`] bits of a number.
fn spread(x: u64) -> u64 {
    let x = (x | x << 16) & 0x0000_FF00_00FF;
    let x = (x | x << 8) & 0x00F0_0F00_F00F;
    let x = (x | x << 4) & 0x0C30_C30C_30C3;
    (x | x << 2) & 0x2492_4924_9249
}

#[cfg(test)]
mod tests;
