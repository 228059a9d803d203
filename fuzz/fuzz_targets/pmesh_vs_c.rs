#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| conformance_differential::pmesh_vs_c(data));
