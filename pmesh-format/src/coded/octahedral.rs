//! Normals as points of an unfolded octahedron, in whole numbers (PMESH-COD-16; Meyer et al., "On floating-point normal
//! vectors", 2010).

/// The two coordinates of a normal on the unfolded octahedron.
pub(super) type Code = [i32; 2];

/// The octahedron |x| + |y| + |z| = M.
#[derive(Clone, Copy, Debug)]
pub(super) struct Octahedral {
    /// The greatest magnitude of a coordinate, M = 2ᵇ⁻¹ − 1.
    most: i32,
}

impl Octahedral {
    /// With that many bits a coordinate, 4 to 16.
    pub(super) fn new(bits: u8) -> Self {
        Self { most: (1 << (bits.clamp(4, 16) - 1)) - 1 }
    }

    /// The greatest magnitude of a coordinate.
    pub(super) fn most(self) -> i32 {
        self.most
    }

    /// Whether both coordinates are in range.
    pub(super) fn contains(self, code: Code) -> bool {
        code.iter().all(|x| (-self.most..=self.most).contains(x))
    }

    /// Whether a code is nearer to −z than to +z.
    pub(super) fn is_below(self, [u, v]: Code) -> bool {
        u.abs() + v.abs() > self.most
    }

    /// The octahedron unfolded around −z instead of +z. Doing it twice gives the same code back if that is the one of its
    /// direction which [`Octahedral::nearest`] takes.
    pub(super) fn turned(self, [u, v]: Code) -> Code {
        [sign(u) * (self.most - v.abs()), sign(v) * (self.most - u.abs())]
    }

    /// The point of the octahedron.
    pub(super) fn point(self, code: Code) -> [i32; 3] {
        let [u, v] = code;
        let z = self.most - u.abs() - v.abs();
        let [x, y] = if z < 0 { self.turned(code) } else { code };
        [x, y, z]
    }

    /// The direction of unit length.
    pub(super) fn direction(self, code: Code) -> [f32; 3] {
        let point = self.point(code);
        // The coordinates are at most 2¹⁵ and add up to M: the sum of squares is less than 2³⁰.
        let squared: i32 = point.iter().map(|x| x * x).sum();
        let length = root(squared as u32);
        point.map(|x| (f64::from(x) / length) as f32)
    }

    /// The code of the direction of a vector of whole numbers, each less than 2⁴⁰; `None` for the zero vector.
    pub(super) fn project(self, [x, y, z]: [i64; 3]) -> Option<Code> {
        let sum = x.abs() + y.abs() + z.abs();
        if sum == 0 {
            return None;
        }
        let scaled = |c: i64| (2 * c * i64::from(self.most) + sum).div_euclid(2 * sum) as i32;
        let code = [scaled(x), scaled(y)];
        Some(if z < 0 { self.turned(code) } else { code })
    }

    /// The code nearest to a normal, which need not have unit length; that of +z if it has none.
    pub(super) fn nearest(self, normal: [f32; 3]) -> Code {
        let [x, y, z] = normal.map(f64::from);
        let sum = x.abs() + y.abs() + z.abs();
        if sum == 0.0 {
            return [0, 0];
        }
        let most = f64::from(self.most);
        let [x, y, z] = [x, y, z].map(|c| c / sum * most);
        let side = |c: f64| if c < 0.0 { -1.0 } else { 1.0 };
        let [u, v] = if z < 0.0 { [side(x) * (most - y.abs()), side(y) * (most - x.abs())] } else { [x, y] };
        let mut best = ([0, 0], -1.0);
        for k in 0..4 {
            let above = |c: f64, more: bool| {
                let low = c as i32 - i32::from(f64::from(c as i32) > c);
                (low + i32::from(more)).clamp(-self.most, self.most)
            };
            let code = self.lowest([above(u, k & 1 == 1), above(v, k & 2 == 2)]);
            let [a, b, c] = self.point(code).map(f64::from);
            let dot = a * x + b * y + c * z;
            // Signed square of the cosine, up to a factor that all have.
            let near = dot * dot.abs() / (a * a + b * b + c * c);
            if near > best.1 {
                best = (code, near);
            }
        }
        best.0
    }

    /// On the rim several codes have one direction: the one that [`Octahedral::turned`] gives back.
    fn lowest(self, [u, v]: Code) -> Code {
        let rim = |x: i32| x.abs() == self.most;
        [if rim(v) { u.abs() } else { u }, if rim(u) { v.abs() } else { v }]
    }
}

fn sign(x: i32) -> i32 {
    if x < 0 { -1 } else { 1 }
}

/// Bits, one less or not, that a number is moved to before its root is taken in whole numbers: the root has half as many, more
/// than binary64.
const ROOT_BITS: u32 = 112;

/// The root of a whole number from 1 on, the binary64 number nearest to it: libraries without one need none.
fn root(squared: u32) -> f64 {
    let x = f64::from(squared);
    // Half the exponent, then Heron's steps, each of which doubles the bits that are right.
    let mut y = f64::from_bits((x.to_bits() >> 1) + (1023 << 51));
    for _ in 0..5 {
        y = 0.5 * (y + x / y);
    }
    let shift = (ROOT_BITS - (u32::BITS - squared.leading_zeros())) / 2;
    let target = u128::from(squared) << (2 * shift);
    let mut whole = (y * (1u64 << shift) as f64) as u64;
    let square = |x: u64| u128::from(x) * u128::from(x);
    while square(whole) > target {
        whole -= 1;
    }
    while square(whole + 1) <= target {
        whole += 1;
    }
    // What is cut off is never half a step, so that one bit below says on which side the root lies.
    let inexact = u64::from(square(whole) != target);
    (whole << 1 | inexact) as f64 / (1u64 << (shift + 1)) as f64
}

#[cfg(test)]
mod tests;
