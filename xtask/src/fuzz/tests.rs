use super::{dictionary, release, run_arguments};

#[test]
fn reads_the_release_of_a_compiler() {
    let text = "rustc 1.97.0-nightly (0123456 2026-05-01)\nhost: x86_64-unknown-linux-gnu\nrelease: 1.97.0-nightly\n";
    assert_eq!(release(text), Some((1, 97)));
    assert_eq!(release("release: 1.100.2"), Some((1, 100)));
    assert_eq!(release("no compiler"), None);
}

#[test]
fn new_inputs_go_to_the_target_folder_and_not_to_the_committed_corpus() {
    let arguments = run_arguments("ivg_decode", Some("fuzz/dictionaries/ivg.dict"), 7);
    // libFuzzer writes to the first folder and only reads the others.
    assert!(arguments.starts_with("run ivg_decode target/fuzz-corpus/ivg_decode fuzz/corpus/ivg_decode -- "));
    assert!(
        arguments.contains("-max_total_time=7 ") && arguments.ends_with(" -dict=fuzz/dictionaries/ivg.dict")
    );
    assert!(!run_arguments("mesh_build", None, 7).contains("-dict"));
}

#[test]
fn a_dictionary_is_shared_by_the_targets_of_a_format() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("fuzz/dictionaries");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("ivg.dict"), "").unwrap();
    assert_eq!(dictionary(root.path(), "ivg_chunks").as_deref(), Some("fuzz/dictionaries/ivg.dict"));
    assert_eq!(dictionary(root.path(), "mesh_build"), None);
}
