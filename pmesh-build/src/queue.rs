//! A priority queue with at most one candidate for each vertex, which can be replaced.

use crate::input::index;

/// A collapse that may come next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) cost: f64,
    /// The vertex that goes.
    pub(crate) u: u32,
    /// The vertex that it moves onto.
    pub(crate) v: u32,
}

impl Candidate {
    /// Whether it comes before another one: cheaper, or as cheap and of a lower vertex. Two candidates in the queue never
    /// tie, so the order in which they come out does not depend on how they went in.
    fn before(&self, other: &Self) -> bool {
        self.cost.total_cmp(&other.cost).then(self.u.cmp(&other.u)).is_lt()
    }
}

/// A heap in which each node has four children (fewer cache misses than with two), with the place of each vertex.
#[derive(Debug)]
pub(crate) struct Queue {
    heap: Vec<Candidate>,
    /// Where the candidate of each vertex stands in the heap; `ABSENT` if it has none.
    places: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;
const CHILDREN: usize = 4;

impl Queue {
    /// An empty queue for that many vertices.
    pub(crate) fn new(vertices: usize) -> Self {
        Self { heap: Vec::with_capacity(vertices), places: vec![ABSENT; vertices] }
    }

    /// Takes out the candidate that comes first.
    pub(crate) fn pop(&mut self) -> Option<Candidate> {
        let first = self.heap.first().copied()?;
        self.remove(first.u);
        Some(first)
    }

    /// Puts in a candidate, in place of the one that its vertex had.
    pub(crate) fn set(&mut self, candidate: Candidate) {
        let place = match self.places[candidate.u as usize] {
            ABSENT => {
                self.heap.push(candidate);
                self.heap.len() - 1
            }
            place => place as usize,
        };
        self.settle(place, candidate);
    }

    /// Whether vertex `u` has a candidate.
    pub(crate) fn contains(&self, u: u32) -> bool {
        self.places[u as usize] != ABSENT
    }

    /// Takes out the candidate of vertex `u`, if it has one.
    pub(crate) fn remove(&mut self, u: u32) {
        let place = std::mem::replace(&mut self.places[u as usize], ABSENT);
        if place == ABSENT {
            return;
        }
        let last = self.heap.pop().expect("a vertex with a place is in the heap");
        if last.u != u {
            self.settle(place as usize, last);
        }
    }

    /// Writes `candidate` at `place` or wherever above or below it belongs.
    fn settle(&mut self, mut place: usize, candidate: Candidate) {
        while place > 0 {
            let parent = (place - 1) / CHILDREN;
            if !candidate.before(&self.heap[parent]) {
                break;
            }
            self.write(place, self.heap[parent]);
            place = parent;
        }
        loop {
            let first = place * CHILDREN + 1;
            let children = first..(first + CHILDREN).min(self.heap.len());
            let least = children.reduce(|a, b| if self.heap[b].before(&self.heap[a]) { b } else { a });
            match least {
                Some(child) if self.heap[child].before(&candidate) => {
                    self.write(place, self.heap[child]);
                    place = child;
                }
                _ => break,
            }
        }
        self.write(place, candidate);
    }

    fn write(&mut self, place: usize, candidate: Candidate) {
        self.heap[place] = candidate;
        self.places[candidate.u as usize] = index(place);
    }
}

#[cfg(test)]
mod tests;
