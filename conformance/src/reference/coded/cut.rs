//! Faces around a vertex in their order (PMESH-COD-08), and the run of them that switches (PMESH-COD-09).

use super::symbols::{Sixteen, Symbols};
use super::{CORNER, Models, Spoke, fault};
use crate::reference::Fault;

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

/// PMESH-COD-09: the first face of the run, and how many; `None` if the split is not regular.
pub(super) fn run(
    symbols: &mut Symbols<'_>,
    models: &mut Models,
    edges: &[i64],
) -> Result<Option<(usize, usize)>, Fault> {
    let m = edges.len();
    let all: i64 = edges.iter().sum();
    let longest = *edges.iter().max().expect("faces that go round");
    let a = [5, 6, 8].iter().filter(|&&t| 4 * m as i64 * longest >= t * all).count();
    let n = number(symbols.about("length of a run"), &mut models.counts[4 * (m.min(10) - 2) + a]);
    if n == 0 {
        return Ok(None);
    }
    if n >= m {
        return fault(CORNER);
    }
    let between = if n == 1 { 0..2 } else { 1..n };
    let weight = |k: usize| between.clone().map(|j| edges[(k + j) % m]).sum::<i64>();
    let mut ranked: Vec<usize> = (0..m).collect();
    ranked.sort_by_key(|&k| (-weight(k), k));
    let apart = weight(ranked[0]) - weight(ranked[1]);
    let b = [1, 2, 4].iter().filter(|&&t| 8 * m as i64 * apart >= t * all).count();
    let rank = number(
        symbols.about("rank of a run"),
        &mut models.ranks[4 * (9 * (n.min(4) - 1) + m.min(10) - 2) + b],
    );
    match ranked.get(rank) {
        Some(&first) => Ok(Some((first, n))),
        None => fault(CORNER),
    }
}

/// A symbol, and what follows if it is the last.
fn number(symbols: &mut Symbols<'_>, model: &mut Sixteen) -> usize {
    match symbols.sixteen(model) {
        15 => 15 + symbols.raw(5) as usize,
        symbol => symbol as usize,
    }
}
