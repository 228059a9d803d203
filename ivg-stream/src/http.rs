//! The parts of HTTP that need no connection: ranges, entity tags, paths, media types. Pure functions.

pub(crate) mod media;
pub(crate) mod path;
pub(crate) mod range;
pub(crate) mod tag;
