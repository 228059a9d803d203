//! Bugs on purpose, of which the environment variable `IVG_PLANTED` chooses one: the fuzzer must find it.
#![no_main]

use conformance::oracles::{Oracle, PLANTED};
use conformance_differential::{Mistake, ivg_vs_c_with};
use std::sync::OnceLock;

/// Bugs in the reader in C.
const PLANTED_IN_C: [(&str, Oracle); 2] = [
    ("c-reads-behind-the-end", |data| ivg_vs_c_with(data, Mistake::ReadsBehindTheEnd)),
    ("c-forgets-the-scale", |data| ivg_vs_c_with(data, Mistake::ForgetsTheScale)),
];

static BUG: OnceLock<Oracle> = OnceLock::new();

fn chosen() -> Oracle {
    let name = std::env::var("IVG_PLANTED").unwrap_or_default();
    let bug = PLANTED.into_iter().chain(PLANTED_IN_C).find(|(known, _)| *known == name);
    // No finding: the fuzzer has not begun.
    bug.unwrap_or_else(|| panic!("IVG_PLANTED names no bug: {name:?}")).1
}

libfuzzer_sys::fuzz_target!(
    init: {
        BUG.get_or_init(chosen);
    },
    |data: &[u8]| BUG.get_or_init(chosen)(data)
);
