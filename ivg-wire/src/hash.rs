//! The integer mixing functions that content ids and vertex orders are made of. All arithmetic is modulo 2⁶⁴.

/// The increment of `SplitMix64`: 2⁶⁴ divided by the golden ratio, made odd.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The output function of `SplitMix64` (Steele, Lea and Flood, "Fast splittable pseudorandom number
/// generators", 2014; constants of Stafford's variant 13): a bijection on 64-bit words (COM-INT-02).
#[must_use]
const fn mix64(word: u64) -> u64 {
    let z = (word ^ (word >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Output number `n`, counted from 0, of the `SplitMix64` generator with this seed (COM-INT-02).
#[must_use]
pub const fn splitmix64(seed: u64, n: u64) -> u64 {
    mix64(seed.wrapping_add(GOLDEN.wrapping_mul(n.wrapping_add(1))))
}
