//! The one binary: `ivg`.
fn main() {}
