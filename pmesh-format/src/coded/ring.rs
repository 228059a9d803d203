//! The faces around a vertex in their order (PMESH-COD-08).

/// The most faces that are put in order.
pub(super) const MOST: usize = 32;

/// So many faces have a faster way: a power of two, and as many as [`Slots::SHORT`](crate::slots::Slots::SHORT).
pub(super) const FEW: usize = 8;

/// A face at a vertex: the vertices that follow it in the face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Spoke {
    /// Place of the slot among those of the vertex, in canonical order.
    pub(super) place: u32,
    /// The next vertex of the face.
    pub(super) out: u32,
    /// The one after it.
    pub(super) back: u32,
}

/// Puts up to [`MOST`] faces, which stand in canonical order, in order, each behind one that it shares an edge with as long as
/// there is one; true if they go round once, the last beside the first.
pub(super) fn order(spokes: &mut [Spoke; MOST], count: usize) -> bool {
    let mut ordered = [spokes[0]; MOST];
    let mut left = u32::MAX.unbounded_shr((MOST - count) as u32) & !1;
    let mut back = spokes[0].back;
    for to in ordered.iter_mut().take(count).skip(1) {
        let mut beside = 0u32;
        for (k, spoke) in spokes[..count].iter().enumerate() {
            beside |= u32::from(spoke.out == back) << k;
        }
        let next = (beside & left).trailing_zeros();
        if next == u32::BITS {
            fans(&mut spokes[..count]);
            return false;
        }
        left &= !(1 << next);
        *to = spokes[next as usize & (MOST - 1)];
        back = to.back;
    }
    if count < 2 || back != spokes[0].out {
        fans(&mut spokes[..count]);
        return false;
    }
    *spokes = ordered;
    true
}

/// Where faces that go round once are among those given, in order; `None` if they do not.
#[cold]
#[inline(never)]
pub(super) fn search(outs: &[u32; MOST], backs: &[u32; MOST], count: usize) -> Option<[u8; MOST]> {
    let mut spokes: [Spoke; MOST] =
        core::array::from_fn(|k| Spoke { place: k as u32, out: outs[k], back: backs[k] });
    order(&mut spokes, count).then(|| spokes.map(|spoke| spoke.place as u8))
}

/// Places in a table of faces by the lowest bits of their outs: a power of two.
const TABLE: usize = 128;

/// Whether faces, `N` at most, go round once; where each is then among those given, in order. Behind the last one `outs` has
/// numbers that no vertex has. `None` is no answer: each face knows one that follows it, but not the one.
#[inline(always)]
pub(super) fn round<const N: usize>(outs: &[u32; N], backs: &[u32; N], count: usize) -> Option<[u8; N]> {
    let mut table = [0u8; TABLE];
    // The first of those with the same out, or the same lowest bits, comes last and stays.
    for (k, &out) in outs.iter().enumerate().take(if N == FEW { N } else { count }).rev() {
        table[out as usize % TABLE] = k as u8;
    }
    let mut order = [0; N];
    let (mut at, mut seen) = (0, 1u32);
    for to in order.get_mut(1..count)? {
        let back = backs[at & (N - 1)];
        at = usize::from(table[back as usize % TABLE]) & (N - 1);
        if outs[at] != back {
            at = outs.iter().position(|&out| out == back)?;
        }
        if seen >> at & 1 == 1 {
            return None;
        }
        seen |= 1 << at;
        *to = at as u8;
    }
    (count >= 2 && backs[at & (N - 1)] == outs[0]).then_some(order)
}

/// Where faces do not go round: first those fans that have a beginning, by the place of their first face, then what is left.
#[cold]
fn fans(spokes: &mut [Spoke]) {
    let count = spokes.len();
    let mut ordered = [Spoke::default(); MOST];
    let mut used = 0u32;
    let mut len = 0;
    let begins = |k: usize| !(0..count).any(|j| j != k && spokes[j].back == spokes[k].out);
    for with_beginning in [true, false] {
        for first in 0..count {
            if used >> first & 1 == 1 || (with_beginning && !begins(first)) {
                continue;
            }
            let mut next = Some(first);
            while let Some(k) = next {
                used |= 1 << k;
                ordered[len] = spokes[k];
                len += 1;
                next = (0..count).find(|&j| used >> j & 1 == 0 && spokes[j].out == spokes[k].back);
            }
        }
    }
    spokes.copy_from_slice(&ordered[..count]);
}

#[cfg(test)]
mod tests;
