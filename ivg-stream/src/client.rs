//! The streaming client.

mod download;
mod schedule;
mod transport;
mod url;
