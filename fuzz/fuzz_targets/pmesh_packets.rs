#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| conformance::oracles::pmesh_packets(data));
