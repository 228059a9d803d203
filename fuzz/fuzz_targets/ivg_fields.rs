#![no_main]

use conformance::oracles::{edited, ivg_fields};
use conformance::vectors::Format;

libfuzzer_sys::fuzz_target!(|data: &[u8]| {
    ivg_fields(data);
    conformance_differential::ivg_vs_c(&edited(Format::Ivg, data));
});
