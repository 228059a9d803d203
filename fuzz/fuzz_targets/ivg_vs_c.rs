#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| conformance_differential::ivg_vs_c(data));
