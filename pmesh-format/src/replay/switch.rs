//! The corners of faces of earlier packets that a raw packet switches (spec, section 7).

use super::Replay;
use super::descent::{Descendants, Descent};
use super::load::Fault;
use crate::bits::{bytes_of, is_padded, number, width};
use crate::code::codes;
use crate::fano::{Reader, Shape, ones};
use crate::header::PacketEntry;
use crate::packet::switch_count;

/// Slots that are read, looked up and written together, each in a loop of its own, so that many of these accesses to memory are
/// under way at once.
const BLOCK: usize = 1024;

/// Wedges that corners may pass for each byte of a payload (PMESH-SWI-07).
pub(crate) const DEPTHS_A_BYTE: u64 = 8;

impl Replay {
    /// Reads the switches, which begin at byte `at`, and lets corners switch; the slots stand in `switched` then.
    pub(super) fn load_switches(
        &mut self,
        payload: &[u8],
        at: usize,
        entry: &PacketEntry,
    ) -> Result<(), Fault> {
        let count = switch_count(payload);
        let limit = 3 * entry.faces.start;
        if count > limit {
            return Err((codes::SWITCH_SLOTS, 0));
        }
        let shape = Shape::new(count, limit);
        let rest = payload.get(at..).unwrap_or(&[]);
        let Some((slots, codes_of_slots)) = rest.split_at_checked(shape.bytes()) else {
            return Err((codes::PACKET_LENGTH, at));
        };
        let first = entry.wedges.start.max(self.first_split_wedge());
        let from = (first - self.first_split_wedge()) as usize;
        let mut descent = core::mem::take(&mut self.descent);
        descent.find(first, &self.targets()[from..], count > 0, self.header.wedge_count as usize);
        let mut result = Ok(());
        if !self.switch(shape, slots, codes_of_slots, &descent) {
            self.switch_back(first);
            result = Err(self.fault_of_switches(shape, rest, at, &descent));
        } else if !self.work_is_allowed(payload.len(), entry.faces.start, &descent) {
            self.switch_back(first);
            result = Err((codes::SWITCH_WORK, 0));
        }
        descent.forget(result.is_err());
        self.descent = descent;
        result
    }

    /// Lets the corners switch; whether all that they are given by is as it should be. What has been switched stands in
    /// `switched`, also if not.
    fn switch(&mut self, shape: Shape, slots: &[u8], to: &[u8], descent: &Descent) -> bool {
        let (first, table) = (descent.first(), descent.table());
        let corners = self.corners.as_flattened_mut();
        let corners = &mut corners[..shape.limit as usize];
        let mut reader = Reader::new(shape, slots);
        self.switched.reserve_exact(shape.count as usize);
        let (mut block, mut had, mut found) = ([0u32; BLOCK], [0u32; BLOCK], [0u32; BLOCK]);
        let mut several = [0u16; BLOCK];
        let mut at = 0u64;
        let mut next = 0u32;
        while reader.left() > 0 {
            let count = reader.left().min(BLOCK);
            let block = &mut block[..count];
            if !reader.fill(block) {
                return false;
            }
            let ascend = block.windows(2).fold(true, |all, pair| all & (pair[0] < pair[1]));
            if !ascend || block[0] < next || block[count - 1] >= shape.limit {
                return false;
            }
            next = block[count - 1] + 1;
            let (had, found) = (&mut had[..count], &mut found[..count]);
            for (had, &slot) in had.iter_mut().zip(&*block) {
                *had = corners[slot as usize];
            }
            // No slot comes twice, so that these are wedges of earlier packets.
            for (found, &had) in found.iter_mut().zip(&*had) {
                *found = table[had as usize];
            }
            let (mut good, mut groups) = (true, 0);
            for (k, (&slot, &found)) in block.iter().zip(&*found).enumerate() {
                corners[slot as usize] = found;
                good &= found >= first;
                several[groups & (BLOCK - 1)] = k as u16;
                groups += usize::from(Descent::is_group(found));
            }
            for &k in &several[..groups] {
                let k = usize::from(k);
                let group = descent.group_of(found[k]);
                let bits = width(group.len() as u32);
                let code = number(to, at, bits);
                at += u64::from(bits);
                let wedge = group.get(code as usize).copied();
                good &= wedge.is_some();
                corners[block[k] as usize] = wedge.unwrap_or(first);
            }
            if !good {
                for (&slot, &had) in block.iter().zip(&*had) {
                    corners[slot as usize] = had;
                }
                return false;
            }
            self.switched.extend_from_slice(block);
        }
        reader.is_clean() && bytes_of(at) == to.len() && is_padded(to, at)
    }

    /// Gives the corners that have switched their wedges of before the packet again.
    fn switch_back(&mut self, first: u32) {
        let from = self.first_split_wedge();
        let targets = if self.attributes().seams { &self.wedge_targets } else { &self.parents };
        let corners = self.corners.as_flattened_mut();
        for slot in self.switched.drain(..) {
            let corner = &mut corners[slot as usize];
            while *corner >= first {
                *corner = targets[(*corner - from) as usize];
            }
        }
    }

    /// Whether corners of new faces and those that have switched have passed no more wedges than the payload allows
    /// (PMESH-SWI-07).
    fn work_is_allowed(&self, bytes: usize, first_face: u32, descent: &Descent) -> bool {
        let most = DEPTHS_A_BYTE * bytes as u64;
        let new = self.corners[first_face as usize..].as_flattened();
        let count = (new.len() + self.switched.len()) as u64;
        if count * u64::from(descent.deepest()) <= most {
            return true;
        }
        let corners = self.corners.as_flattened();
        let switched = self.switched.iter().map(|&slot| corners[slot as usize]);
        let depths = new.iter().copied().chain(switched).map(|wedge| u64::from(descent.depth(wedge)));
        depths.sum::<u64>() <= most
    }

    /// The first rule that the switches break: they begin at byte `at` and are these bytes; nothing is switched.
    #[cold]
    fn fault_of_switches(&self, shape: Shape, bytes: &[u8], at: usize, descent: &Descent) -> Fault {
        let (slots, to) = bytes.split_at(shape.bytes());
        let (low, high) = slots.split_at(shape.low_bytes());
        let to_at = at + slots.len();
        let right = ones(high, shape.high_bits) == u64::from(shape.count);
        let mut all = alloc::vec![0; if right { shape.count as usize } else { 0 }];
        let read = Reader::new(shape, slots).fill(&mut all);
        let ascend = all.windows(2).all(|pair| pair[0] < pair[1]);
        if !right || !read || !ascend || all.last().is_some_and(|&last| last >= shape.limit) {
            return (codes::SWITCH_SLOTS, at);
        }
        if !is_padded(low, shape.low_bits()) {
            return (codes::PACKET_PADDING, at + low.len() - 1);
        }
        if !is_padded(high, shape.high_bits) {
            return (codes::PACKET_PADDING, to_at - 1);
        }
        let mut bit = 0u64;
        let corners = self.corners.as_flattened();
        for slot in all {
            let count = match descent.of(corners[slot as usize]) {
                Descendants::None => return (codes::SWITCH, to_at),
                Descendants::One(_) => 1,
                Descendants::Several(group) => group.len() as u32,
            };
            let code = number(to, bit, width(count));
            bit += u64::from(width(count));
            if bytes_of(bit) > to.len() {
                return (codes::PACKET_LENGTH, to_at);
            }
            if code >= count {
                return (codes::SWITCH, to_at);
            }
        }
        let used = bytes_of(bit);
        if !is_padded(&to[..used], bit) {
            return (codes::PACKET_PADDING, to_at + used - 1);
        }
        debug_assert!(used < to.len(), "switches were refused for nothing");
        (codes::PACKET_LENGTH, to_at + used)
    }
}

#[cfg(test)]
mod tests;
