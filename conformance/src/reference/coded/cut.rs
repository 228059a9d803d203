//! Faces around a vertex in their order (PMESH-COD-08), and the run of them that switches (PMESH-COD-09).

use super::symbols::Symbols;
use super::{Models, Spoke, logarithm};

/// PMESH-COD-08: the faces in their order, and whether they go round.
pub(super) fn ordered(ascending: &[Spoke]) -> (Vec<Spoke>, bool) {
    if ascending.is_empty() || ascending.len() > 32 {
        return (ascending.to_vec(), false);
    }
    let follow = |first: usize, left: &mut Vec<Spoke>| {
        let mut chain = vec![left.remove(first)];
        while let Some(next) = left.iter().position(|spoke| spoke.out == chain[chain.len() - 1].back) {
            chain.push(left.remove(next));
        }
        chain
    };
    let mut left = ascending.to_vec();
    let chain = follow(0, &mut left);
    if left.is_empty() && chain.len() >= 2 && chain[chain.len() - 1].back == chain[0].out {
        return (chain, true);
    }
    let mut left = ascending.to_vec();
    let mut order = Vec::new();
    for first in ascending {
        let begins = !ascending.iter().any(|other| other.slot != first.slot && other.back == first.out);
        if let (true, Some(at)) = (begins, left.iter().position(|spoke| spoke.slot == first.slot)) {
            order.extend(follow(at, &mut left));
        }
    }
    while !left.is_empty() {
        order.extend(follow(0, &mut left));
    }
    (order, false)
}

/// PMESH-COD-09: the first face of the run, and how many.
pub(super) fn run(symbols: &mut Symbols<'_>, models: &mut Models, edges: &[i64]) -> (usize, usize) {
    let m = edges.len();
    if m == 2 {
        return (usize::from(symbols.bit(&mut models.further[7])), 1);
    }
    let mean = logarithm(edges.iter().sum::<i64>() / m as i64);
    let u: Vec<usize> =
        edges.iter().map(|&e| ((logarithm(e) - mean).div_euclid(4) + 8).clamp(0, 15) as usize).collect();
    let (after, before) = (|k: usize| (k + 1) % m, |k: usize| (k + m - 1) % m);
    let mut ranked: Vec<usize> = (0..m).collect();
    ranked.sort_by_key(|&k| (-edges[k], k));
    if symbols.bit(&mut models.single[16 * (m.min(10) - 3) + u[ranked[0]]]) {
        let mut faces: Vec<usize> = (0..m).collect();
        faces.sort_by_key(|&k| (-(edges[k] + edges[after(k)]), k));
        let mut rank = 0;
        while rank + 1 < m && symbols.bit(&mut models.further[rank.min(6)]) {
            rank += 1;
        }
        return (faces[rank], 1);
    }
    let mut outside = Vec::new();
    let mut seed = ranked[m - 1];
    for (rank, &k) in ranked[..m - 1].iter().enumerate() {
        let model = 16 * (16 * rank.min(3) + u[k]) + u[before(k)].max(u[after(k)]);
        if symbols.bit(&mut models.seed[model]) {
            seed = k;
            break;
        }
        outside.push(k);
    }
    let (mut low, mut high, mut n) = (seed, seed, 1);
    let down_first = edges[before(seed)] >= edges[after(seed)];
    for side in 0..2 {
        let down = (side == 0) == down_first;
        while n + 3 <= m {
            let k = if down { before(low) } else { after(high) };
            if outside.contains(&k) {
                break;
            }
            let model = 16 * (8 * (2 * (n.min(4) - 1) + side) + (m - n).min(7)) + u[k];
            if !symbols.bit(&mut models.extend[model]) {
                break;
            }
            n += 1;
            if down { low = k } else { high = k }
        }
    }
    (before(low), n + 1)
}
