use std::collections::BTreeSet;
use std::vec;
use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;
use crate::tests::Numbers;

/// Lists of slots in the plainest form.
fn equal(slots: &Slots, lists: &[BTreeSet<u32>]) -> bool {
    (0..).zip(lists).all(|(vertex, list)| slots.of(vertex).iter().eq(list))
}

quickcheck! {
    /// Any sequence of changes, with lists short and long, gives what sorted sets give; the pool does not grow beyond what
    /// the lists need.
    fn lists_are_sorted_sets(seed: u64) -> bool {
        let mut numbers = Numbers::new(seed);
        let mut slots = Slots::default();
        let mut lists: Vec<BTreeSet<u32>> = vec![];
        let mut next = 0;
        let mut splits: Vec<(u32, u32)> = vec![];
        for _ in 0..400 {
            match numbers.below(4) {
                // New slots, mostly at one vertex.
                0 if !lists.is_empty() => {
                    for _ in 0..numbers.below(60) {
                        let vertex = numbers.below(lists.len()).min(numbers.below(lists.len()));
                        slots.push(vertex as u32, next);
                        lists[vertex].insert(next);
                        next += 1;
                    }
                }
                // The last slots go, which are the last of their lists.
                1 => {
                    for _ in 0..numbers.below(20) {
                        let Some(last) = next.checked_sub(1) else { break };
                        let vertex = lists.iter().position(|list| list.contains(&last)).unwrap();
                        slots.pop(vertex as u32);
                        lists[vertex].remove(&last);
                        next = last;
                    }
                }
                2 => {
                    let child = lists.len();
                    slots.resize(child + 1, 1000);
                    lists.push(BTreeSet::new());
                    if child == 0 {
                        continue;
                    }
                    let parent = numbers.below(child);
                    let chosen: Vec<bool> = lists[parent].iter().map(|_| numbers.below(2) == 0).collect();
                    if chosen.len() <= Slots::SHORT {
                        let bits = (0..).zip(&chosen).map(|(k, &chosen)| u32::from(chosen) << k).sum();
                        let moved = slots.split_short(parent as u32, child as u32, bits).len();
                        assert_eq!(moved, chosen.iter().filter(|&&chosen| chosen).count());
                    } else {
                        slots.split(parent as u32, child as u32, |k| chosen[k]);
                    }
                    let all = core::mem::take(&mut lists[parent]);
                    for (slot, chosen) in all.into_iter().zip(chosen) {
                        lists[if chosen { child } else { parent }].insert(slot);
                    }
                    splits.push((child as u32, parent as u32));
                }
                _ => {
                    let Some((child, parent)) = splits.pop() else { continue };
                    let (mut seen, mut moved) = (vec![], vec![]);
                    slots.merge(child, parent, |slot, was_child| {
                        seen.push(slot);
                        if was_child { moved.push(slot) }
                    });
                    let of_child = core::mem::take(&mut lists[child as usize]);
                    assert!(moved.iter().eq(&of_child));
                    lists[parent as usize].extend(of_child);
                    assert!(seen.iter().eq(&lists[parent as usize]));
                    slots.resize(child as usize, child as usize);
                    lists.pop();
                }
            }
            if !equal(&slots, &lists) {
                return false;
            }
        }
        let long = lists.iter().map(BTreeSet::len).filter(|&len| len > BLOCK);
        let needed: usize = long.map(usize::next_power_of_two).sum();
        // Lists that have shrunk keep their room; half may be unused.
        slots.pool.len() <= 4 * needed + 4 * SPARE
    }
}
