//! Counter-based random numbers: Philox4x32-10.
//!
//! J. Salmon, M. Moraes, R. Dror, D. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011. A draw is a pure
//! function of (seed, item, step, purpose), so that it does not matter which thread traces which photon, nor in
//! which order.

/// What a draw is for: draws for different purposes never share numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub(crate) enum Purpose {
    /// Which light a photon starts from.
    Light = 0,
    /// Where on the light and in which direction.
    Emission = 1,
    /// Russian roulette and direction of a reflection.
    Reflection = 2,
    /// Whether light reaches a vertex.
    Reach = 3,
    /// Direction of a path that gathers light.
    Gather = 4,
    /// Sampling a light from a point.
    NextEvent = 5,
    /// Facets of a rough mirror.
    Facets = 6,
    /// Texel of a sky.
    Sky = 8,
    /// Which vertices light is gathered at to measure bias.
    Probe = 7,
    /// Where in a scene one looks from, and where to.
    View = 9,
}

/// The random numbers of one item (a photon, a path) under one seed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stream {
    key: [u32; 2],
    item: u64,
}

impl Stream {
    /// The numbers of `item` under `seed`.
    pub(crate) fn new(seed: u64, item: u64) -> Self {
        Self { key: [low(seed), high(seed)], item }
    }

    /// Four independent words, each uniform over all of u32.
    #[inline]
    pub(crate) fn words(&self, step: u32, purpose: Purpose) -> [u32; 4] {
        philox([low(self.item), high(self.item), step, purpose as u32], self.key)
    }

    /// Four independent numbers, each uniform in [0, 1).
    #[inline]
    pub(crate) fn uniforms(&self, step: u32, purpose: Purpose) -> [f32; 4] {
        self.words(step, purpose).map(unit)
    }
}

/// A uniform number in [0, 1) from the upper 24 bits of a word; never 1.
#[inline]
pub(crate) fn unit(word: u32) -> f32 {
    (word >> 8) as f32 * (1.0 / 16_777_216.0)
}

fn low(value: u64) -> u32 {
    (value & 0xffff_ffff) as u32
}

fn high(value: u64) -> u32 {
    (value >> 32) as u32
}

/// Philox4x32 with ten rounds (Salmon et al. 2011, section 4.3; constants from table 2).
#[inline]
fn philox(mut counter: [u32; 4], mut key: [u32; 2]) -> [u32; 4] {
    const MULTIPLIERS: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
    const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
    const ROUNDS: u32 = 10;
    for round in 0..ROUNDS {
        if round > 0 {
            key = [key[0].wrapping_add(WEYL[0]), key[1].wrapping_add(WEYL[1])];
        }
        let a = u64::from(MULTIPLIERS[0]) * u64::from(counter[0]);
        let b = u64::from(MULTIPLIERS[1]) * u64::from(counter[2]);
        counter = [high(b) ^ counter[1] ^ key[0], low(b), high(a) ^ counter[3] ^ key[1], low(a)];
    }
    counter
}

#[cfg(test)]
mod tests;
