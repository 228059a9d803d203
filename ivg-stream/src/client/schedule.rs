//! Which kind of data is asked for next. Pure: bytes received in, a choice out.

/// How geometry and light share the connection.
///
/// Only what a [`Goal`](super::Goal) still lacks is ever asked for: once one kind has reached its goal, every
/// schedule asks for the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Schedule {
    /// One request of geometry, one of light, in turn.
    Alternate,
    /// So that light makes up a stated share of the bytes received, to within one request.
    Proportion {
        /// Share of light in [0, 1]; values outside are taken as the nearer end, NaN as 0.
        light: f32,
    },
    /// All geometry before any light.
    GeometryFirst,
    /// All light before any geometry.
    LightFirst,
}

/// The two kinds of data a scene directory streams.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// Progressive meshes.
    Geometry,
    /// The irradiance grid.
    Light,
}

/// A schedule with what it has to remember.
#[derive(Debug, Clone)]
pub(super) struct Scheduler {
    schedule: Schedule,
    geometry_bytes: u64,
    light_bytes: u64,
    last: Option<Kind>,
}

impl Scheduler {
    pub(super) fn new(schedule: Schedule) -> Self {
        Self { schedule, geometry_bytes: 0, light_bytes: 0, last: None }
    }

    /// The kind to ask for, of those that are wanted; `None` if neither is.
    pub(super) fn next(&self, geometry_wanted: bool, light_wanted: bool) -> Option<Kind> {
        match (geometry_wanted, light_wanted) {
            (false, false) => None,
            (true, false) => Some(Kind::Geometry),
            (false, true) => Some(Kind::Light),
            (true, true) => Some(self.choose()),
        }
    }

    fn choose(&self) -> Kind {
        match self.schedule {
            Schedule::GeometryFirst => Kind::Geometry,
            Schedule::LightFirst => Kind::Light,
            Schedule::Alternate => match self.last {
                Some(Kind::Geometry) => Kind::Light,
                Some(Kind::Light) | None => Kind::Geometry,
            },
            Schedule::Proportion { light } => {
                let share = f64::from(light).clamp(0.0, 1.0);
                // Light lags behind its share of all bytes: light < share * (light + geometry). At the ends 0 and
                // 1 the comparison must not be decided by equality.
                let due = share * self.geometry_bytes as f64;
                let had = (1.0 - share) * self.light_bytes as f64;
                if share >= 1.0 || (share > 0.0 && had < due) { Kind::Light } else { Kind::Geometry }
            }
        }
    }

    /// Notes that a request of `kind` brought `bytes`.
    pub(super) fn note(&mut self, kind: Kind, bytes: u64) {
        self.last = Some(kind);
        match kind {
            Kind::Geometry => self.geometry_bytes = self.geometry_bytes.saturating_add(bytes),
            Kind::Light => self.light_bytes = self.light_bytes.saturating_add(bytes),
        }
    }

    /// Bytes received of `kind`.
    pub(super) fn bytes(&self, kind: Kind) -> u64 {
        match kind {
            Kind::Geometry => self.geometry_bytes,
            Kind::Light => self.light_bytes,
        }
    }
}

#[cfg(test)]
mod tests;
