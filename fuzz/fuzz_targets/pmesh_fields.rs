#![no_main]

use conformance::oracles::{edited, pmesh_fields};
use conformance::vectors::Format;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    pmesh_fields(data);
    conformance_differential::pmesh_vs_c(&edited(Format::Pmesh, data));
});
