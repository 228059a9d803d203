//! The faces around a vertex in their order (PMESH-COD-08).

/// The most faces that are put in order.
pub(super) const MOST: usize = 32;

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

/// Puts up to [`MOST`] faces in order, each behind one that it shares an edge with as long as there is one; true if they
/// go round once, the last beside the first.
pub(super) fn order(spokes: &mut [Spoke]) -> bool {
    let count = spokes.len();
    for k in 1..count {
        let back = spokes[k - 1].back;
        let Some(next) = (k..count).find(|&j| spokes[j].out == back) else {
            fans(spokes);
            return false;
        };
        spokes[k..=next].rotate_right(1);
    }
    let round = count > 1 && spokes[count - 1].back == spokes[0].out;
    if !round {
        fans(spokes);
    }
    round
}

/// Where faces do not go round: first those fans that have a beginning, by the place of their first face, then what is left.
#[cold]
fn fans(spokes: &mut [Spoke]) {
    spokes.sort_unstable_by_key(|spoke| spoke.place);
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
