//! Which faces stand at each vertex, and where they go round once, in that order: nothing has to be put in order again when a
//! vertex is split, since splits that are regular keep the order (PMESH-COD-08, -09).
//!
//! A *slot* is 4 × face + corner here. A list is *round* if its faces go round and no two of them have the same out: their order
//! is the only one then, wherever it begins. Of such lists the outs are known as well. All others are ascending.

use alloc::collections::BTreeMap;
use alloc::vec::Vec;

use super::ring::{FEW, MOST};
use crate::room::resize;

/// Set for a list that is round.
const ROUND: u8 = 0x80;

/// Set for a list that is longer than a row.
const WIDE: u8 = 0x40;

/// The bits that count faces, up to [`MOST`].
const COUNT: u8 = 0x3F;

/// Stands for a list that is longer than [`MOST`].
const HUGE: u8 = WIDE | COUNT;

/// Up to so many faces at a vertex, where they are round: the next vertex and the slot of each.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Fan<const N: usize> {
    pub(super) outs: [u32; N],
    pub(super) slots: [u32; N],
}

impl<const N: usize> Fan<N> {
    pub(super) const EMPTY: Self = Self { outs: [0; N], slots: [0; N] };

    /// The place of a slot that is there.
    #[inline(always)]
    fn place(&self, slot: u32) -> usize {
        let mut place = N - 1;
        for k in (0..N).rev() {
            place = if self.slots[k] == slot { k } else { place };
        }
        place
    }
}

/// A list for each vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct Rings {
    kinds: Vec<u8>,
    rows: Vec<Fan<FEW>>,
    /// Lists of up to [`MOST`] faces: the first out of the row says which.
    wide: Vec<Fan<MOST>>,
    free: Vec<u32>,
    /// Longer lists.
    huge: BTreeMap<u32, Vec<u32>>,
}

/// The slot of the corner before in the same face.
#[inline(always)]
pub(super) fn before(slot: u32) -> u32 {
    if slot & 3 == 0 { slot + 2 } else { slot - 1 }
}

/// The place of a slot among the corners of all faces.
#[inline(always)]
pub(super) fn corner(slot: u32) -> usize {
    (slot - (slot >> 2)) as usize
}

impl Rings {
    /// Makes room for that many vertices, `total` in the end; drops the lists of those from there on.
    pub(super) fn resize(&mut self, vertices: usize, total: usize) {
        resize(&mut self.kinds, vertices, total, 0);
        resize(&mut self.rows, vertices, total, Fan::EMPTY);
    }

    /// The lists of so many vertices, by the corners of all faces; nothing is known of their order.
    pub(super) fn rebuild(&mut self, vertices: usize, corners: &[[u32; 3]]) {
        *self = Self::default();
        self.resize(vertices, usize::MAX);
        for (face, corners) in (0..).zip(corners) {
            for (slot, &vertex) in (4 * face..).zip(corners) {
                self.push(vertex, slot);
            }
        }
    }

    /// How many faces a vertex has.
    #[inline(always)]
    pub(super) fn count(&self, vertex: u32) -> usize {
        match self.kinds[vertex as usize] {
            HUGE => self.huge.get(&vertex).map_or(0, Vec::len),
            kind => usize::from(kind & COUNT),
        }
    }

    /// How many faces a vertex has, any number beyond [`MOST`] for more.
    #[inline(always)]
    pub(super) fn about(&self, vertex: u32) -> usize {
        usize::from(self.kinds[vertex as usize] & COUNT)
    }

    /// The faces of a vertex and how many there are, if they are round and few.
    #[inline(always)]
    pub(super) fn few(&self, vertex: u32) -> Option<(&Fan<FEW>, usize)> {
        let kind = self.kinds[vertex as usize];
        (kind & (ROUND | WIDE) == ROUND).then(|| (&self.rows[vertex as usize], usize::from(kind & COUNT)))
    }

    /// The same if they are round and not few.
    pub(super) fn many(&self, vertex: u32) -> Option<(&Fan<MOST>, usize)> {
        let kind = self.kinds[vertex as usize];
        let place = self.rows[vertex as usize].outs[0];
        (kind & (ROUND | WIDE) == ROUND | WIDE)
            .then(|| (&self.wide[place as usize], usize::from(kind & COUNT)))
    }

    /// The slots of a vertex, ascending.
    pub(super) fn ascending(&self, vertex: u32) -> Vec<u32> {
        let mut list = self.list(vertex).to_vec();
        list.sort_unstable();
        list
    }

    /// The slots of a vertex as they stand.
    pub(super) fn list(&self, vertex: u32) -> &[u32] {
        let row = &self.rows[vertex as usize];
        match self.kinds[vertex as usize] {
            HUGE => self.huge.get(&vertex).map_or(&[], Vec::as_slice),
            kind if kind & WIDE > 0 => &self.wide[row.outs[0] as usize].slots[..usize::from(kind & COUNT)],
            kind => &row.slots[..usize::from(kind & COUNT)],
        }
    }

    /// Gives a vertex up to [`FEW`] faces that are round, `fan` without what is left over; it had few before.
    #[inline(always)]
    pub(super) fn set_few(&mut self, vertex: u32, fan: &Fan<FEW>, count: usize) {
        self.rows[vertex as usize] = *fan;
        self.kinds[vertex as usize] = ROUND | count as u8;
    }

    /// Gives a vertex a list: with outs it is round, otherwise ascending.
    #[cold]
    #[inline(never)]
    pub(super) fn set(&mut self, vertex: u32, outs: Option<&[u32]>, slots: &[u32]) {
        let kind = self.kinds[vertex as usize];
        let mut place = None;
        if kind == HUGE {
            self.huge.remove(&vertex);
        } else if kind & WIDE > 0 {
            place = Some(self.rows[vertex as usize].outs[0]);
        }
        let count = slots.len();
        if !(FEW + 1..=MOST).contains(&count) {
            self.free.extend(place);
        }
        let round = if outs.is_some() { ROUND } else { 0 };
        let outs = outs.unwrap_or_default();
        let kind = match count {
            0..=FEW => {
                let row = &mut self.rows[vertex as usize];
                row.outs[..outs.len()].copy_from_slice(outs);
                row.slots[..count].copy_from_slice(slots);
                round | count as u8
            }
            ..=MOST => {
                let place = place.or_else(|| self.free.pop()).unwrap_or_else(|| {
                    self.wide.push(Fan::EMPTY);
                    self.wide.len() as u32 - 1
                });
                let fan = &mut self.wide[place as usize];
                fan.outs[..outs.len()].copy_from_slice(outs);
                fan.slots[..count].copy_from_slice(slots);
                self.rows[vertex as usize].outs[0] = place;
                round | WIDE | count as u8
            }
            _ => {
                self.huge.insert(vertex, slots.to_vec());
                HUGE
            }
        };
        self.kinds[vertex as usize] = kind;
    }

    /// Forgets in which order the faces of a vertex go round.
    pub(super) fn loosen(&mut self, vertex: u32) {
        if self.kinds[vertex as usize] & ROUND > 0 {
            let list = self.ascending(vertex);
            self.set(vertex, None, &list);
        }
    }

    /// Adds a slot that is greater than all others of the vertex.
    pub(super) fn push(&mut self, vertex: u32, slot: u32) {
        let mut list = self.ascending(vertex);
        list.push(slot);
        self.set(vertex, None, &list);
    }

    /// Another vertex becomes the out of a face.
    #[inline(always)]
    pub(super) fn turn(&mut self, vertex: u32, slot: u32, out: u32) {
        let kind = self.kinds[vertex as usize];
        if kind & (ROUND | WIDE) == ROUND {
            let row = &mut self.rows[vertex as usize];
            for k in 0..FEW {
                row.outs[k] = if row.slots[k] == slot { out } else { row.outs[k] };
            }
        } else if kind & ROUND > 0 {
            let fan = &mut self.wide[self.rows[vertex as usize].outs[0] as usize];
            fan.outs[fan.place(slot)] = out;
        }
    }

    /// A face comes before that of the slot `at`, whose out becomes `then`.
    #[inline(always)]
    pub(super) fn insert(&mut self, vertex: u32, at: u32, [slot, out]: [u32; 2], then: u32) {
        let kind = self.kinds[vertex as usize];
        if kind & (ROUND | WIDE) != ROUND || usize::from(kind & COUNT) == FEW {
            return self.insert_any(vertex, at, [slot, out], then);
        }
        let row = &mut self.rows[vertex as usize];
        let old = *row;
        let place = old.place(at) & (FEW - 1);
        for k in 1..FEW {
            row.outs[k] = old.outs[if k > place { k - 1 } else { k }];
            row.slots[k] = old.slots[if k > place { k - 1 } else { k }];
        }
        row.outs[place] = out;
        row.slots[place] = slot;
        row.outs[(place + 1) & (FEW - 1)] = then;
        self.kinds[vertex as usize] = kind + 1;
    }

    #[cold]
    #[inline(never)]
    fn insert_any(&mut self, vertex: u32, at: u32, [slot, out]: [u32; 2], then: u32) {
        let kind = self.kinds[vertex as usize];
        if kind & ROUND == 0 {
            return self.push(vertex, slot);
        }
        let count = usize::from(kind & COUNT);
        let row = &self.rows[vertex as usize];
        let fan = if kind & WIDE > 0 { Some(&self.wide[row.outs[0] as usize]) } else { None };
        let mut slots = fan.map_or(&row.slots[..], |fan| &fan.slots[..])[..count].to_vec();
        let mut outs = fan.map_or(&row.outs[..], |fan| &fan.outs[..])[..count].to_vec();
        let place = slots.iter().position(|&slot| slot == at).unwrap_or(0);
        outs[place] = then;
        outs.insert(place, out);
        slots.insert(place, slot);
        if slots.len() > MOST {
            slots.sort_unstable();
            return self.set(vertex, None, &slots);
        }
        self.set(vertex, Some(&outs), &slots);
    }
}
