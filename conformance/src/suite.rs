//! The tests of the suite, which `vectors/manifest.json` lists: made from the [`vectors`](crate::vectors), with what OUT of
//! `PROTOCOL.md` must hold, as our decoders show it.

mod clauses;
mod diff;
mod fields;
mod gate;
mod generate;
mod line;
mod lint;
mod needs;
pub mod shown;
pub mod tables;

pub(crate) use fields::{envelopes, fits};
pub use gate::{EXCEPTIONS, gaps};
pub use generate::{EXPECTED, generate};
pub use lint::lint;
