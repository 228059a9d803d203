use std::vec;
use std::vec::Vec;

use quickcheck::quickcheck;

use super::*;

quickcheck! {
    /// Both ways give the same ranges, over more than a block too.
    fn faces_of_slots_are_ranges(gaps: Vec<u8>, dense: u8, times: u8, new: u8) -> bool {
        let mut next = 0u32;
        let mut slots: Vec<u32> = vec![];
        for gap in gaps.iter().cycle().take(gaps.len() * (1 + usize::from(times) % 8)) {
            next += u32::from(gap % (1 + dense % 16));
            slots.push(next);
            next += 1;
        }
        let end = next.div_ceil(3);
        let mut touched = Touched::default();
        touched.resize(end as usize, end as usize);
        slots.iter().for_each(|slot| touched.mark(slot / 3));
        let new_end = end + u32::from(new);
        faces_of(&slots, end, new_end) == touched.report(end, new_end)
    }
}
