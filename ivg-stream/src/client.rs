//! The streaming client: what `spec/stream.md` section 2 asks of one.

mod assembly;
mod contents;
mod download;
mod error;
mod link;
mod options;
mod reader;
mod schedule;
mod session;
mod transport;
mod url;

pub(crate) use assembly::Assembly;
pub(crate) use contents::{check_grid, read_mesh};
pub use error::FetchError;
pub use options::{Event, EventKind, FetchOptions, Goal, Observer, Progress, SceneLimits};
pub(crate) use reader::FileReader;
pub use schedule::{Kind, Schedule};
pub use session::Session;
pub(crate) use url::SCENE_FILE;
pub use url::UrlError;
