//! What the tests share: a runtime, a server on loopback, and HTTP spoken by hand.
#![allow(dead_code, reason = "each test binary uses its own part")]

pub(crate) mod faulty;
pub(crate) mod http;
pub(crate) mod scene;
