//! The seeds of the fuzz target `scene_import`, and what it found on this machine, through the body of the target.
#![cfg(feature = "fuzz")]

use ivg_scene::import::from_bytes;
use std::fs;
use std::path::{Path, PathBuf};

fn inputs(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(folder).join("scene_import");
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn seeds_and_findings_pass() {
    let seeds = inputs("fuzz/corpus");
    assert!(!seeds.is_empty(), "no seeds");
    for file in seeds.into_iter().chain(inputs("fuzz/artifacts")) {
        println!("{}", file.display());
        ivg_scene::fuzz_scene_import(&fs::read(file).unwrap());
    }
}

#[test]
fn seeds_are_scenes() {
    let names = ["obj", "ply", "glb", "gltf"];
    for file in inputs("fuzz/corpus").into_iter().filter(|file| !file.ends_with("lights")) {
        let bytes = fs::read(&file).unwrap();
        let name = format!("seed.{}", names[usize::from(bytes[0])]);
        let scene =
            from_bytes(&name, &bytes[1..]).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert!(!scene.meshes.is_empty(), "{}", file.display());
    }
}
