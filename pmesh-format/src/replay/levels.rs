//! Which level to show: by what it may cost in accuracy or in faces.

use crate::header::Header;
use crate::storage::Mode;

use super::Replay;

impl Header {
    /// The coarsest level whose stored error is at most `error` \[m\] (PMESH-DIR-05); the finest, which has none, where that is
    /// less than any, negative, or NaN. 0 for a mesh without vertices.
    ///
    /// A viewer that wants no error of more than a number of pixels passes that number times the size of a pixel at the
    /// mesh's nearest point.
    #[must_use]
    pub fn level_of_error(&self, error: f32) -> u32 {
        // Errors never rise from packet to packet.
        let exceeds = |stored: f32| stored.partial_cmp(&error).is_none_or(core::cmp::Ordering::is_gt);
        let packet = self.packets.partition_point(|entry| exceeds(entry.error));
        match self.packets.get(packet) {
            Some(entry) => entry.vertices.start.saturating_add(1).max(self.base_vertices),
            None => self.vertex_count,
        }
    }

    /// Whether the level of `level` vertices is in the file and *whole* (PMESH-LVL-06): every one of a raw file; of a coded file
    /// the coarsest and the last of each packet. In between, coded packets bring their vertices sorted by place: those levels are
    /// valid meshes too, but finer in one place than in another, and two of their faces may lie on the same vertices.
    #[must_use]
    pub fn is_whole_level(&self, level: u32) -> bool {
        let Some(packet) = self.packet_of_level(level) else {
            return self.vertex_count == 0 && level == 0;
        };
        let ends = self.packets.get(packet as usize).map(|entry| entry.vertices.end);
        self.mode == Mode::Raw || level == self.base_vertices || ends == Some(level)
    }
}

impl Replay {
    /// The coarsest level whose stored error is at most `error` \[m\], or the finest that has arrived if that is coarser: see
    /// [`Header::level_of_error`]. `None` before the first packet.
    #[must_use]
    pub fn level_of_error(&self, error: f32) -> Option<u32> {
        self.levels().map(|levels| self.header.level_of_error(error).min(*levels.end()))
    }

    /// The finest level that has arrived and has at most `faces` faces; the coarsest where even that has more. `None` before
    /// the first packet.
    #[must_use]
    pub fn level_of_faces(&self, faces: u32) -> Option<u32> {
        let levels = self.levels()?;
        let found = match &self.steps {
            Some(steps) => levels.start().saturating_add(steps.levels_within(faces)).saturating_sub(1),
            None => self.find_level_of_faces(faces),
        };
        Some(found.clamp(*levels.start(), *levels.end()))
    }
}

#[cfg(test)]
mod tests;
