#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| pmesh_build::fuzz_mesh_build(data));
