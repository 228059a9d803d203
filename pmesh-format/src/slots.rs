//! Which corner slots stand at each vertex: slot = 3 × face + corner, lists in descending order (PMESH-SWI-01).
//!
//! Faces are introduced in ascending order, so a new face's slots go to the head of a list, and when it goes they are
//! there again: singly linked lists are enough.

use alloc::vec::Vec;

const NONE: u32 = u32::MAX;

/// A list of slots for each vertex.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slots {
    heads: Vec<u32>,
    next: Vec<u32>,
}

impl Slots {
    /// Makes room for that many vertices and faces.
    pub(crate) fn resize(&mut self, vertices: usize, faces: usize) {
        self.heads.resize(vertices, NONE);
        self.next.resize(faces.saturating_mul(3), NONE);
    }

    /// Puts a slot, greater than all in the list, at the head of the list of `vertex`.
    pub(crate) fn push(&mut self, vertex: u32, slot: u32) {
        self.next[slot as usize] = self.heads[vertex as usize];
        self.heads[vertex as usize] = slot;
    }

    /// Takes the head off the list of `vertex`.
    pub(crate) fn pop(&mut self, vertex: u32) {
        let head = self.heads[vertex as usize];
        debug_assert_ne!(head, NONE, "the list of vertex {vertex} is empty");
        self.heads[vertex as usize] = self.next[head as usize];
    }

    /// Shows the slots of `vertex`, descending.
    pub(crate) fn visit(&self, vertex: u32, mut visit: impl FnMut(u32)) {
        let mut slot = self.heads[vertex as usize];
        while slot != NONE {
            visit(slot);
            slot = self.next[slot as usize];
        }
    }

    /// Moves the slots of `parent` for which `moves` says so to `child`, whose list is empty; both stay in order.
    ///
    /// # Errors
    /// What `moves` returns; no slot has been moved then.
    pub(crate) fn split<E>(
        &mut self,
        parent: u32,
        child: u32,
        mut moves: impl FnMut(u32) -> Result<bool, E>,
    ) -> Result<(), E> {
        let mut chosen = Chain::new();
        let mut stays = Chain::new();
        let mut slot = self.heads[parent as usize];
        while slot != NONE {
            let next = self.next[slot as usize];
            match moves(slot) {
                Ok(true) => chosen.append(slot, &mut self.next),
                Ok(false) => stays.append(slot, &mut self.next),
                Err(error) => {
                    // What has been taken apart so far is put together again in front of the rest.
                    chosen.finish(&mut self.next);
                    stays.finish(&mut self.next);
                    let front = merge(chosen.head, stays.head, &mut self.next, |_, _| {});
                    self.heads[parent as usize] = join(front, slot, &mut self.next);
                    return Err(error);
                }
            }
            slot = next;
        }
        chosen.finish(&mut self.next);
        stays.finish(&mut self.next);
        self.heads[parent as usize] = stays.head;
        self.heads[child as usize] = chosen.head;
        Ok(())
    }

    /// Moves all slots of `child` to `parent`; shows `visit` every slot of both in order, and whether it was the child's.
    pub(crate) fn merge(&mut self, child: u32, parent: u32, visit: impl FnMut(u32, bool)) {
        let (a, b) = (self.heads[child as usize], self.heads[parent as usize]);
        self.heads[parent as usize] = merge(a, b, &mut self.next, visit);
        self.heads[child as usize] = NONE;
    }
}

/// A list that is being built.
struct Chain {
    head: u32,
    tail: u32,
}

impl Chain {
    const fn new() -> Self {
        Self { head: NONE, tail: NONE }
    }

    fn append(&mut self, slot: u32, next: &mut [u32]) {
        if self.tail == NONE {
            self.head = slot;
        } else {
            next[self.tail as usize] = slot;
        }
        self.tail = slot;
    }

    fn finish(&self, next: &mut [u32]) {
        if self.tail != NONE {
            next[self.tail as usize] = NONE;
        }
    }
}

/// Merges two descending lists and returns the head; `visit` is told whether a slot was in the first.
fn merge(mut first: u32, mut second: u32, next: &mut [u32], mut visit: impl FnMut(u32, bool)) -> u32 {
    let mut merged = Chain::new();
    while first != NONE || second != NONE {
        // The greater one comes first; NONE, the greatest number of all, counts as the end.
        let from_first = second == NONE || (first != NONE && first > second);
        let from = if from_first { &mut first } else { &mut second };
        let slot = *from;
        *from = next[slot as usize];
        visit(slot, from_first);
        merged.append(slot, next);
    }
    merged.finish(next);
    merged.head
}

/// Puts `rest` behind the last slot of a list.
fn join(head: u32, rest: u32, next: &mut [u32]) -> u32 {
    if head == NONE {
        return rest;
    }
    let mut last = head;
    while next[last as usize] != NONE {
        last = next[last as usize];
    }
    next[last as usize] = rest;
    head
}
