//! What sums depend on, as 64 bits: two accumulators are added only if these are the same.

use core::fmt::{self, Write};

use ivg_scene::{EffectPlan, FlatScene, Need, Scene};
use ivg_wire::splitmix64;

use crate::BakeOptions;

/// Mixes 64-bit words one after the other.
struct Digest(u64);

impl Digest {
    fn word(&mut self, word: u64) {
        self.0 = splitmix64(self.0 ^ word, 0);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.word(u64::from_le_bytes(word));
        }
        self.word(bytes.len() as u64);
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

/// The release, and the target it was compiled for: other ones may round otherwise.
pub(super) fn release() -> u64 {
    let mut digest = Digest(0);
    let target = [std::env::consts::ARCH, std::env::consts::OS, env!("CARGO_PKG_VERSION")];
    target.iter().for_each(|text| digest.bytes(text.as_bytes()));
    digest.0
}

/// Scene, plan and options, but for seed, photons and threads.
pub(super) fn scene(scene: &Scene, flat: &FlatScene, plan: &EffectPlan, options: &BakeOptions) -> u64 {
    let mut digest = Digest(0);
    for texture in &scene.textures {
        digest.bytes(&texture.texels);
        digest.word(u64::from(texture.width));
    }
    let corners = flat.triangles.iter().flatten().chain(&flat.triangle_materials);
    corners.for_each(|&index| digest.word(u64::from(index)));
    let places = flat.positions.iter().flat_map(|p| p.to_array());
    let numbers = places.chain(flat.uvs.iter().flat_map(|uv| uv.to_array()));
    numbers.for_each(|x| digest.word(u64::from(x.to_bits())));
    let needed = plan.effects.iter().filter(|effect| effect.need == Need::Needed).map(|effect| effect.effect);
    let needed: Vec<_> = needed.collect();
    // The text of a number names it exactly, and writing into a digest does not fail.
    let _ = write!(
        digest,
        "{:?} {:?} {:?} {:?} {needed:?} {:?} {:?} {:?} {:?} {:?}",
        scene.materials,
        scene.lights,
        scene.sky,
        flat.origin,
        plan.max_bounces,
        options.dims,
        options.bounds,
        options.estimator,
        options.quantity,
    );
    digest.0
}
