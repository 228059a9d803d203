//! What the nodes of one level get their values from when they are pushed and smoothed.

use super::FillOptions;
use super::marks::{Marks, nodes};
use super::push_pull::{LevelValues, around, lag, mean_of_known};
use super::row::{Range, Row, interpolate, interpolate_both, mean, replace, smooth};
use crate::pyramid::{DIRECTIONS, Level};

/// What the nodes of a level get their values from.
#[derive(Clone, Copy)]
pub(super) struct Pushing<'a, const W: usize> {
    pub(super) options: FillOptions,
    pub(super) level: &'a Level,
    pub(super) parents: &'a Level,
    pub(super) coarser: &'a LevelValues<W>,
    pub(super) range: Range,
}

impl<const W: usize> Pushing<'_, W> {
    /// Pushes stale nodes. `vertices` are the rows of level 0; other levels have their own.
    pub(super) fn push(&self, finer: &mut LevelValues<W>, vertices: &mut [Row<W>], stale: &Marks) {
        let finest = finer.rows.is_empty();
        let mut row = [0.0; W];
        for group in 0..stale.groups() {
            let fresh = self.fillable(finer, group, stale.word(group));
            let near = if self.options.neighbours { fresh & finer.near.word(group) } else { 0 };
            let rows = if finest { &mut *vertices } else { &mut finer.rows };
            let mut changed = fresh;
            for node in nodes(group, near) {
                known_neighbours(&mut row, self.level, &finer.known, rows, node, self.range);
                if finest {
                    rows[node] = row;
                } else if !replace(&mut rows[node], &row) {
                    changed &= !(1 << (node % 64));
                }
            }
            if finest {
                let rows = &mut rows[64 * group..];
                self.interpolate(rows, group, fresh & !near, finer.pairs.word(group));
            } else {
                for node in nodes(group, fresh & !near) {
                    self.interpolate_one(&mut row, node);
                    if !replace(&mut rows[node], &row) {
                        changed &= !(1 << (node % 64));
                    }
                }
            }
            finer.changed.insert_word(group, changed | fresh & !finer.valued.word(group));
            finer.valued.insert_word(group, fresh);
        }
    }

    /// Pushes stale nodes and smooths what has changed by that or lies next to it.
    pub(super) fn push_and_smooth(&self, finer: &mut LevelValues<W>, vertices: &mut [Row<W>], stale: &Marks) {
        let finest = finer.rows.is_empty();
        let groups = stale.groups();
        let neighbours = if self.options.neighbours { u64::MAX } else { 0 };
        // What is smoothed again lies around what has changed, and needs the values before smoothing around it.
        let mut smooths = stale.clone();
        smooths.join(&finer.changed);
        smooths = around(self.level, finest, smooths);
        smooths.map_words(|group, word| {
            self.fillable(finer, group, word) & !(finer.surrounded.word(group) & neighbours)
        });
        let mut needed = around(self.level, finest, smooths.clone());
        needed.join(stale);
        // Smoothing follows so far behind that all neighbours have been pushed, and near enough to find them in the
        // cache.
        let window = finer.rough.len();
        let lag = if finest { lag(self.level) } else { groups };
        let (mut push_at, mut smooth_at) = (0, 0);
        let next = |at: usize| if at + 64 >= window { 0 } else { at + 64 };
        for group in 0..groups + lag {
            if group < groups {
                let needed = needed.word(group);
                let fillable = self.fillable(finer, group, needed);
                let surrounded = finer.surrounded.word(group) & neighbours;
                let fresh = fillable & (stale.word(group) | !surrounded);
                let near = fresh & finer.near.word(group) & neighbours;
                let rows = if finest { &mut *vertices } else { &mut finer.rows };
                for node in nodes(group, needed & !fresh) {
                    finer.rough[push_at + node % 64] = rows[node];
                }
                for node in nodes(group, near) {
                    let to = &mut finer.rough[push_at + node % 64];
                    known_neighbours(to, self.level, &finer.known, rows, node, self.range);
                }
                let to = &mut finer.rough[push_at..];
                self.interpolate(to, group, fresh & !near, finer.pairs.word(group));
                let final_already = fresh & surrounded;
                let mut changed = final_already;
                for node in nodes(group, final_already) {
                    let row = &finer.rough[push_at + node % 64];
                    if finest {
                        rows[node] = *row;
                    } else if !replace(&mut rows[node], row) {
                        changed &= !(1 << (node % 64));
                    }
                }
                finer.changed.insert_word(group, changed | final_already & !finer.valued.word(group));
                finer.valued.insert_word(group, final_already);
                push_at = next(push_at);
            }
            let Some(group) = group.checked_sub(lag) else { continue };
            let smooths = smooths.word(group);
            let mut changed = smooths;
            for node in nodes(group, smooths) {
                let own = smooth_at + node % 64;
                if finest {
                    smoothed(&mut vertices[node], self.level, &finer.rough, node, own, self.range);
                } else {
                    let mut row = [0.0; W];
                    smoothed(&mut row, self.level, &finer.rough, node, own, self.range);
                    if !replace(&mut finer.rows[node], &row) {
                        changed &= !(1 << (node % 64));
                    }
                }
            }
            finer.changed.insert_word(group, changed | smooths & !finer.valued.word(group));
            finer.valued.insert_word(group, smooths);
            smooth_at = next(smooth_at);
        }
    }

    /// Those nodes of a group, among these, that are not known and whose parent has a value.
    #[inline]
    fn fillable(&self, finer: &LevelValues<W>, group: usize, among: u64) -> u64 {
        let missing = among & finer.inner.word(group) & !finer.known.word(group);
        let without = nodes(group, missing)
            .filter(|&node| !self.coarser.valued.contains(self.level.parents[node] as usize));
        without.fold(missing, |word, node| word & !(1 << (node % 64)))
    }

    /// Interpolates these nodes of a group between nodes of the coarser level. The first row belongs to its first node.
    #[inline]
    fn interpolate(&self, to: &mut [Row<W>], group: usize, these: u64, pairs: u64) {
        let low = these & these >> 1 & pairs;
        for node in nodes(group, low) {
            let at = node % 64;
            let both = to[at..].first_chunk_mut().expect("both in a group");
            let (parent, octant) = (self.level.parents[node] as usize, self.level.octant(node));
            let rows = &self.coarser.rows;
            match self.parents.neighbours(parent) {
                Some(neighbours) => {
                    let side = |axis: usize| &rows[neighbours[2 * axis + (octant >> axis & 1)]];
                    let along_x = [&rows[neighbours[0]], &rows[neighbours[1]]];
                    interpolate_both(both, &rows[parent], along_x, [side(1), side(2)], self.range);
                }
                None => {
                    let [low, high] = both;
                    interpolated(low, self.parents, rows, parent, octant, self.range);
                    interpolated(high, self.parents, rows, parent, octant + 1, self.range);
                }
            }
        }
        for node in nodes(group, these & !(low | low << 1)) {
            self.interpolate_one(&mut to[node % 64], node);
        }
    }

    #[inline]
    fn interpolate_one(&self, to: &mut Row<W>, node: usize) {
        let (parent, octant) = (self.level.parents[node] as usize, self.level.octant(node));
        interpolated(to, self.parents, &self.coarser.rows, parent, octant, self.range);
    }
}

/// The mean of the known neighbours of a node that is not known, as [`mean_of_known`].
#[inline]
fn known_neighbours<const W: usize>(
    to: &mut Row<W>,
    level: &Level,
    known: &Marks,
    rows: &[Row<W>],
    node: usize,
    range: Range,
) -> bool {
    match level.neighbours(node) {
        Some(neighbours) => mean_of_known(to, neighbours.into_iter(), known, rows, range),
        None => {
            let all: Vec<u32> = (0..DIRECTIONS).flat_map(|direction| level.links(node, direction)).collect();
            mean_of_known(to, all.iter().map(|&node| node as usize), known, rows, range)
        }
    }
}

/// The value at the children in an octant of `parent`: linear interpolation towards its three neighbours on their
/// side; where there is none, the parent stands for it.
#[inline]
fn interpolated<const W: usize>(
    to: &mut Row<W>,
    level: &Level,
    rows: &[Row<W>],
    parent: usize,
    octant: usize,
    range: Range,
) {
    let directions = [0, 1, 2].map(|axis| 2 * axis + (octant >> axis & 1));
    match level.neighbours(parent) {
        Some(neighbours) => {
            interpolate(to, &rows[parent], directions.map(|direction| &rows[neighbours[direction]]), range);
        }
        None => {
            let means = directions.map(|direction| linked(level, rows, parent, direction, range));
            interpolate(to, &rows[parent], means.each_ref(), range);
        }
    }
}

/// The value of a node after smoothing. All linked neighbours have values, for they are joined to each other; where
/// there is none, the node's own stands for it. The node's row before smoothing is number `own`; those of its neighbours
/// are as far from it as their numbers, beyond the end they begin again.
#[inline]
fn smoothed<const W: usize>(
    to: &mut Row<W>,
    level: &Level,
    rough: &[Row<W>],
    node: usize,
    own: usize,
    range: Range,
) {
    match level.neighbours(node) {
        Some([a, b, c, d, e, f]) => {
            let before = |other: usize| {
                let place = own.wrapping_sub(node - other);
                &rough[place.min(place.wrapping_add(rough.len()))]
            };
            let after = |other: usize| {
                let place = own + (other - node);
                &rough[place.min(place.wrapping_sub(rough.len()))]
            };
            let neighbours = [before(a), after(b), before(c), after(d), before(e), after(f)];
            smooth(to, &rough[own], neighbours, range);
        }
        None => {
            // Only above level 0, where each node has its own row.
            let means: [Row<W>; DIRECTIONS] =
                std::array::from_fn(|direction| linked(level, rough, node, direction, range));
            smooth(to, &rough[node], means.each_ref(), range);
        }
    }
}

/// The mean of the nodes linked in a direction; a node's own value where there is none.
fn linked<const W: usize>(
    level: &Level,
    rows: &[Row<W>],
    node: usize,
    direction: usize,
    range: Range,
) -> Row<W> {
    let links: Vec<&Row<W>> = level.links(node, direction).map(|other| &rows[other as usize]).collect();
    let mut row = rows[node];
    if !links.is_empty() {
        mean(&mut row, &links, range);
    }
    row
}
