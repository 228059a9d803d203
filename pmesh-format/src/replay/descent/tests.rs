use std::vec;
use std::vec::Vec;

use super::*;
use crate::tests::Numbers;

/// The words of PMESH-SWI-04 and -07: goes back one by one.
fn by_the_book(first: u32, targets: &[u32], wedge: u32) -> [u32; 2] {
    match wedge.checked_sub(first) {
        None => [wedge, 0],
        Some(place) => {
            let [root, depth] = by_the_book(first, targets, targets[place as usize]);
            [root, depth + 1]
        }
    }
}

#[test]
fn descendants_are_those_of_the_specification() {
    let mut numbers = Numbers::new(7);
    let mut descent = Descent::default();
    let (mut first, mut refused) = (3u32, false);
    for round in 0..300 {
        // Packets that are in, and some that are refused, one after the other; onto few wedges, or many.
        let count = numbers.below(30) as u32;
        let near = 1 + numbers.below(40) as u32;
        let targets: Vec<u32> = (first..first + count)
            .map(|wedge| wedge - 1 - numbers.below(near.min(wedge) as usize) as u32)
            .collect();
        let all = round % 5 != 0;
        descent.find(first, &targets, all, 1000);
        let mut deepest = 0;
        for wedge in 0..first + count {
            let [root, depth] = by_the_book(first, &targets, wedge);
            assert_eq!([descent.root(wedge), descent.depth(wedge)], [root, depth]);
            deepest = deepest.max(depth);
        }
        assert_eq!(descent.deepest(), deepest);
        for wedge in 0..if all { first } else { 0 } {
            let from_it = |other: &u32| by_the_book(first, &targets, *other)[0] == wedge;
            let expected: Vec<u32> = (first..first + count).filter(from_it).collect();
            let found = match descent.of(wedge) {
                Descendants::None => vec![],
                Descendants::One(one) => vec![one],
                Descendants::Several(group) => group.to_vec(),
            };
            assert_eq!(found, expected, "wedge {wedge} in round {round}, after a refused packet: {refused}");
        }
        refused = numbers.below(3) == 0;
        descent.forget(refused);
        first += if refused { 0 } else { count };
    }
    assert!(first > 1000, "{first}");
}
