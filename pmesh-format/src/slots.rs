//! Which corner slots stand at each vertex: slot = 3 × face + corner, each list ascending.
//!
//! Faces are introduced in ascending order, so that a new face's slots go to the ends of lists, and when it goes they are
//! there again. A vertex has about six slots: a block of eight beside those of its neighbours holds them, and only longer
//! lists lie in a pool.

use alloc::vec::Vec;

use crate::machine::fetch;
use crate::room::{reserve, resize};

/// Slots of a vertex that need no list in the pool.
const BLOCK: usize = 8;

/// The length that stands for a list in the pool; its block holds place, length and room instead of slots.
const POOLED: u8 = u8::MAX;

/// Words of the pool that may be unused before it is worth while to move the lists together.
const SPARE: usize = 1024;

/// A list of slots for each vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slots {
    lens: Vec<u8>,
    blocks: Vec<[u32; BLOCK]>,
    pool: Vec<u32>,
    /// Words of the pool that no list has.
    unused: usize,
    /// For the lists that are being taken apart or put together.
    scratch: [Vec<u32>; 2],
}

impl Slots {
    /// Makes room for that many vertices, `total` in the end; drops the lists of those from there on, which must be empty.
    pub(crate) fn resize(&mut self, vertices: usize, total: usize) {
        resize(&mut self.lens, vertices, total, 0);
        resize(&mut self.blocks, vertices, total, [0; BLOCK]);
    }

    /// Has the list of `vertex` brought near, if it is short.
    #[inline(always)]
    pub(crate) fn fetch(&self, vertex: u32) {
        if let Some(block) = self.blocks.get(vertex as usize) {
            fetch(block);
        }
    }

    /// How many slots `vertex` has.
    #[inline]
    pub(crate) fn count(&self, vertex: u32) -> usize {
        match self.lens[vertex as usize] {
            POOLED => self.blocks[vertex as usize][1] as usize,
            len => usize::from(len),
        }
    }

    /// The words of `vertex` that hold its slots if they are few: some may be left over, or anything else if they are not.
    #[inline]
    pub(crate) fn few(&self, vertex: u32) -> &[u32; BLOCK] {
        &self.blocks[vertex as usize]
    }

    /// The slots of `vertex`, ascending.
    #[inline]
    pub(crate) fn of(&self, vertex: u32) -> &[u32] {
        let block = &self.blocks[vertex as usize];
        match self.lens[vertex as usize] {
            POOLED => &self.pool[place(block)..][..block[1] as usize],
            len => &block[..usize::from(len)],
        }
    }

    /// Puts a slot, greater than all in the list, at the end of the list of `vertex`.
    #[inline]
    pub(crate) fn push(&mut self, vertex: u32, slot: u32) {
        let len = &mut self.lens[vertex as usize];
        if usize::from(*len) < BLOCK {
            self.blocks[vertex as usize][usize::from(*len)] = slot;
            *len += 1;
        } else {
            self.push_pooled(vertex, slot);
        }
    }

    #[cold]
    fn push_pooled(&mut self, vertex: u32, slot: u32) {
        let block = &mut self.blocks[vertex as usize];
        let [_, len, room, ..] = *block;
        if self.lens[vertex as usize] == POOLED && len < room {
            self.pool[place(block) + len as usize] = slot;
            block[1] += 1;
            return;
        }
        let mut list = core::mem::take(&mut self.scratch[0]);
        list.clear();
        list.extend_from_slice(self.of(vertex));
        list.push(slot);
        self.set(vertex, &list);
        self.scratch[0] = list;
    }

    /// Takes the last slot off the list of `vertex`.
    pub(crate) fn pop(&mut self, vertex: u32) {
        let len = &mut self.lens[vertex as usize];
        if *len != POOLED {
            debug_assert_ne!(*len, 0, "the list of vertex {vertex} is empty");
            *len = len.saturating_sub(1);
            return;
        }
        let block = &mut self.blocks[vertex as usize];
        let [_, len, room, ..] = *block;
        block[1] = len - 1;
        if len as usize - 1 <= BLOCK {
            self.lens[vertex as usize] = BLOCK as u8;
            let start = place(block);
            block.copy_from_slice(&self.pool[start..][..BLOCK]);
            self.unused += room as usize;
        }
    }

    /// Moves the slots of `parent` whose bit in `chosen` is set, the first slot's in bit 0, to `child`, whose list is empty;
    /// both stay in order. Returns the slots moved. For a list of at most [`Slots::SHORT`] slots, and a child after the parent.
    #[inline]
    pub(crate) fn split_short(&mut self, parent: u32, child: u32, chosen: u32) -> &[u32] {
        let (parent, child) = (parent as usize, child as usize);
        let len = self.lens[parent];
        // A parent comes before its child.
        let (before, after) = self.blocks.split_at_mut(child);
        let (stays, moves) = (&mut before[parent], &mut after[0]);
        // All slots are written to both lists, so that nothing branches on what the bits are; one by one, since a processor
        // waits where it reads as a whole what was written in parts.
        let mut moved = 0usize;
        for k in 0..BLOCK {
            let slot = stays[k];
            moves[moved & (BLOCK - 1)] = slot;
            stays[(k - moved) & (BLOCK - 1)] = slot;
            moved += (chosen >> k & 1) as usize;
        }
        self.lens[parent] = len - moved as u8;
        self.lens[child] = moved as u8;
        &self.blocks[child][..moved]
    }

    /// How many slots a list has that lies in a block: the most that [`Slots::split_short`] takes.
    pub(crate) const SHORT: usize = BLOCK;

    /// Moves the slots of `parent` that `chosen` marks, one entry a slot, to `child`, whose list is empty; both stay in order.
    pub(crate) fn split(&mut self, parent: u32, child: u32, chosen: impl Fn(usize) -> bool) {
        let [mut stays, mut moves] = core::mem::take(&mut self.scratch);
        stays.clear();
        moves.clear();
        for (k, &slot) in self.of(parent).iter().enumerate() {
            if chosen(k) { moves.push(slot) } else { stays.push(slot) }
        }
        self.set(parent, &stays);
        self.set(child, &moves);
        self.scratch = [stays, moves];
    }

    /// Moves all slots of `child` to `parent`; shows `visit` every slot of both in order, and whether it was the child's.
    pub(crate) fn merge(&mut self, child: u32, parent: u32, mut visit: impl FnMut(u32, bool)) {
        let mut merged = core::mem::take(&mut self.scratch[0]);
        merged.clear();
        let (mut first, mut second) = (self.of(child), self.of(parent));
        loop {
            let of_child = match (first.first(), second.first()) {
                (Some(a), Some(b)) => a < b,
                (None, None) => break,
                (a, _) => a.is_some(),
            };
            let from = if of_child { &mut first } else { &mut second };
            if let Some((&slot, rest)) = from.split_first() {
                visit(slot, of_child);
                merged.push(slot);
                *from = rest;
            }
        }
        self.set(child, &[]);
        self.set(parent, &merged);
        self.scratch[0] = merged;
    }

    /// Gives `vertex` this list.
    fn set(&mut self, vertex: u32, list: &[u32]) {
        let vertex = vertex as usize;
        let block = &mut self.blocks[vertex];
        let pooled = self.lens[vertex] == POOLED;
        let room = if pooled { block[2] as usize } else { 0 };
        if list.len() <= BLOCK {
            self.unused += room;
            block[..list.len()].copy_from_slice(list);
            self.lens[vertex] = list.len() as u8;
            return;
        }
        let needed = list.len().next_power_of_two();
        let mut start = place(block);
        if room != needed {
            self.unused += room;
            self.lens[vertex] = 0;
            start = self.allocate(needed);
            self.lens[vertex] = POOLED;
        }
        self.pool[start..start + list.len()].copy_from_slice(list);
        let block = &mut self.blocks[vertex];
        block[1..3].copy_from_slice(&[list.len() as u32, needed as u32]);
        set_place(block, start);
    }

    /// A place in the pool for that many slots; moves all lists together first if half of it is unused.
    fn allocate(&mut self, room: usize) -> usize {
        if self.unused > self.pool.len() / 2 && self.unused > SPARE.max(self.lens.len() / 4) {
            let mut pool = Vec::with_capacity(self.pool.len() - self.unused + room);
            for (block, _) in self.blocks.iter_mut().zip(&self.lens).filter(|(_, len)| **len == POOLED) {
                let list = &self.pool[place(block)..][..block[2] as usize];
                set_place(block, pool.len());
                pool.extend_from_slice(list);
            }
            self.pool = pool;
            self.unused = 0;
        }
        let start = self.pool.len();
        reserve(&mut self.pool, room, 2 * start + room);
        self.pool.resize(start + room, 0);
        start
    }
}

/// Where in the pool the list of a block lies: up to 2³⁰ faces have more slots than 32 bits can count twice.
fn place(block: &[u32; BLOCK]) -> usize {
    (u64::from(block[3]) << 32 | u64::from(block[0])) as usize
}

fn set_place(block: &mut [u32; BLOCK], start: usize) {
    block[0] = start as u32;
    block[3] = (start as u64 >> 32) as u32;
}

#[cfg(test)]
mod tests;
