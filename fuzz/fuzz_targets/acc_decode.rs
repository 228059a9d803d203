#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| ivg_bake::fuzz_accumulator(data));
