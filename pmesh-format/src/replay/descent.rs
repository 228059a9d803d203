//! Which wedges of a packet descend from which of earlier packets, and over how many others (PMESH-SWI-04, -07).

use alloc::vec::Vec;

use crate::room::{reserve, resize};

/// Marks the place of a group among what descends from a wedge; wedges have 30 bits (PMESH-LIM-01).
const GROUP: u32 = 1 << 31;

/// What descends from the wedges of earlier packets. Nothing is cleared from packet to packet: wedges before the first of a
/// packet are none of it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Descent {
    /// The first wedge of the packet that becomes another one.
    first: u32,
    /// For each wedge before that: the one that descends from it; [`GROUP`] + the place of a group; or less than `first`.
    of: Vec<u32>,
    /// For each wedge of the packet: the one before the packet that it descends from, and its depth.
    roots: Vec<[u32; 2]>,
    /// For each wedge of the packet: the one before it that descends from the same, or less than `first`.
    before: Vec<u32>,
    /// Places in the packet of wedges that are not the first to descend from theirs: so many.
    further: Vec<u32>,
    several: usize,
    /// Groups: how many, then the wedges, ascending.
    groups: Vec<u32>,
    /// The greatest depth.
    deepest: u32,
}

/// What descends from a wedge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Descendants<'a> {
    None,
    One(u32),
    /// Ascending.
    Several(&'a [u32]),
}

impl Descent {
    /// Takes in a packet whose wedges from `first` on become these, each an earlier one; wedges before `first` have arrived before,
    /// or belong to the base. Only if `all`, what descends from them can be asked for.
    pub(crate) fn find(&mut self, first: u32, targets: &[u32], all: bool, total: usize) {
        let count = targets.len();
        self.first = first;
        self.several = 0;
        self.roots.clear();
        self.roots.reserve_exact(count);
        let mut deepest = 0;
        for &target in targets {
            let [root, depth] = match target.checked_sub(first) {
                None => [target, 1],
                Some(place) => {
                    let [root, depth] = self.roots[place as usize];
                    [root, depth + 1]
                }
            };
            deepest = deepest.max(depth);
            self.roots.push([root, depth]);
        }
        self.deepest = deepest;
        if all {
            self.group(total);
        }
    }

    fn group(&mut self, total: usize) {
        let Self { first, of, roots, before, further, groups, .. } = self;
        let first = *first;
        let count = roots.len();
        resize(of, first as usize, total, 0);
        before.clear();
        before.reserve_exact(count);
        if further.len() < count {
            reserve(further, count - further.len(), total);
            further.resize(count, 0);
        }
        let mut several = 0;
        for (wedge, &[root, _]) in (first..).zip(&*roots) {
            let other = core::mem::replace(&mut of[root as usize], wedge);
            before.push(other);
            further[several] = wedge - first;
            several += usize::from(other >= first);
        }
        self.several = several;
        groups.clear();
        for &place in further[..several].iter().rev() {
            let of = &mut of[roots[place as usize][0] as usize];
            if *of != first + place {
                // Not the last of its group, which is there already.
                continue;
            }
            let start = groups.len();
            reserve(groups, 3, 2 * count);
            groups.push(0);
            let mut wedge = *of;
            while wedge >= first {
                reserve(groups, 1, 2 * count);
                groups.push(wedge);
                wedge = before[(wedge - first) as usize];
            }
            let size = groups.len() - start - 1;
            groups[start] = size as u32;
            groups[start + 1..].reverse();
            *of = GROUP | start as u32;
        }
    }

    /// Makes room for packets of a mesh with that many wedges.
    pub(super) fn reserve(&mut self, wedges: usize) {
        self.of.reserve_exact(wedges);
    }

    /// The first wedge of the packet that becomes another one.
    pub(crate) fn first(&self) -> u32 {
        self.first
    }

    /// The greatest depth of a wedge of the packet (PMESH-SWI-07).
    pub(crate) fn deepest(&self) -> u32 {
        self.deepest
    }

    /// The depth of a wedge.
    #[inline]
    pub(crate) fn depth(&self, wedge: u32) -> u32 {
        wedge.checked_sub(self.first).map_or(0, |place| self.roots[place as usize][1])
    }

    /// The wedge of an earlier packet that a wedge descends from, or is.
    pub(crate) fn root(&self, wedge: u32) -> u32 {
        wedge.checked_sub(self.first).map_or(wedge, |place| self.roots[place as usize][0])
    }

    /// For each wedge of earlier packets: the one that descends from it; more than any wedge where there are several; less than
    /// [`Descent::first`] where there is none.
    #[inline(always)]
    pub(crate) fn table(&self) -> &[u32] {
        &self.of
    }

    /// Whether an entry of the table stands for several wedges.
    #[inline(always)]
    pub(crate) fn is_group(entry: u32) -> bool {
        entry >= GROUP
    }

    /// The wedges that an entry of the table stands for, if they are several.
    #[inline(always)]
    pub(crate) fn group_of(&self, entry: u32) -> &[u32] {
        let (size, rest) = self.groups[(entry ^ GROUP) as usize..].split_first().unwrap_or((&0, &[]));
        &rest[..*size as usize]
    }

    /// What descends from a wedge of an earlier packet.
    pub(crate) fn of(&self, wedge: u32) -> Descendants<'_> {
        match self.of[wedge as usize] {
            entry if entry < self.first => Descendants::None,
            entry if Self::is_group(entry) => Descendants::Several(self.group_of(entry)),
            entry => Descendants::One(entry),
        }
    }

    /// Forgets the packet. What an entry of a packet that is in names is less than the first wedge of the next, unless it is a
    /// group.
    pub(crate) fn forget(&mut self, refused: bool) {
        let Self { of, roots, further, several, .. } = self;
        let mut clear = |root: u32| {
            if let Some(entry) = of.get_mut(root as usize) {
                *entry = 0;
            }
        };
        if refused {
            roots.iter().for_each(|&[root, _]| clear(root));
        } else {
            further[..*several].iter().for_each(|&place| clear(roots[place as usize][0]));
        }
        roots.clear();
        *several = 0;
    }
}

#[cfg(test)]
mod tests;
