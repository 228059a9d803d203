#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| ivg_scene::fuzz::scene_import(data));
