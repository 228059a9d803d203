#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| conformance::oracles::ivg_decode(data));
