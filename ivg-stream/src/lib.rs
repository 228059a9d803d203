//! Serving and fetching scene directories: HTTP ranges, scheduling, resuming.
#![forbid(unsafe_code)]

mod client;
mod digest;
mod extensions;
mod http;
mod server;

pub use http::media::{MEDIA_TYPE_IVG, MEDIA_TYPE_PMESH};
pub use server::{ServeError, ServerHandle, ServerOptions, serve};
