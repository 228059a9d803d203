use std::vec;
use std::vec::Vec;

use super::*;
use crate::tests::Numbers;

/// Wedges and slots, slots ascending.
struct Given(Vec<(u32, u32)>);

impl Walks for Given {
    fn each(&self, mut visit: impl FnMut(u32, u32)) {
        self.0.iter().for_each(|&(wedge, slot)| visit(wedge, slot));
    }
}

#[test]
fn every_list_has_its_slots_in_as_many_parts_as_it_takes() {
    let mut numbers = Numbers::new(3);
    let given = Given((0..500).map(|slot| (10 + numbers.below(20) as u32, slot)).collect());
    for most in [1, 7, 60, 499, 500, MOST] {
        let mut parts = vec![];
        Lists::build(12..30, &given, most, &mut parts);
        let mut next = 12;
        for part in &parts {
            let wedges = part.wedges();
            assert_eq!(wedges.start, next);
            assert!(wedges.len() == 1 || part.slots.len() as u64 <= most, "{} slots", part.slots.len());
            for wedge in wedges.clone() {
                let slots = given.0.iter().filter(|pair| pair.0 == wedge).map(|pair| &pair.1);
                assert!(part.of(wedge).iter().eq(slots), "wedge {wedge}, {most} at most");
            }
            next = wedges.end;
        }
        let listed = given.0.iter().filter(|pair| (12..30).contains(&pair.0)).count();
        assert_eq!((next, parts.len() == 1), (30, most >= listed as u64));
    }
}

#[test]
fn without_wedges_there_are_no_lists() {
    let mut parts = vec![];
    Lists::build(5..5, &Given(vec![]), MOST, &mut parts);
    assert_eq!(parts[0].wedges(), 5..5);
}
