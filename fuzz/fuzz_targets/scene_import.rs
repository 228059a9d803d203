#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| ivg_scene::fuzz_scene_import(data));
