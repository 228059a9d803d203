use super::{BUGS, planted_arguments, release, run_arguments};

#[test]
fn reads_the_release_of_a_compiler() {
    let text = "rustc 1.97.0-nightly (0123456 2026-05-01)\nhost: x86_64-unknown-linux-gnu\nrelease: 1.97.0-nightly\n";
    assert_eq!(release(text), Some((1, 97)));
    assert_eq!(release("release: 1.100.2"), Some((1, 100)));
    assert_eq!(release("no compiler"), None);
}

#[test]
fn new_inputs_go_to_the_target_folder_and_not_to_the_committed_corpus() {
    let root = tempfile::tempdir().unwrap();
    let arguments = run_arguments(root.path(), "ivg_decode", 7);
    // libFuzzer writes to the first folder and only reads the others.
    assert!(arguments.starts_with("run ivg_decode target/fuzz-corpus/ivg_decode fuzz/corpus/ivg_decode -- "));
    assert!(arguments.contains("-max_total_time=7 ") && !arguments.contains("-dict"));
}

#[test]
fn dictionary_and_vectors_are_shared_by_the_targets_of_a_format() {
    let root = tempfile::tempdir().unwrap();
    for folder in ["fuzz/dictionaries", "conformance/vectors/ivg"] {
        std::fs::create_dir_all(root.path().join(folder)).unwrap();
    }
    std::fs::write(root.path().join("fuzz/dictionaries/ivg.dict"), "").unwrap();
    let arguments = run_arguments(root.path(), "ivg_chunks", 1);
    assert!(arguments.contains("fuzz/corpus/ivg_chunks conformance/vectors/ivg -- "), "{arguments}");
    assert!(arguments.ends_with(" -dict=fuzz/dictionaries/ivg.dict"), "{arguments}");
    let arguments = run_arguments(root.path(), "mesh_build", 1);
    assert!(!arguments.contains("vectors") && !arguments.contains("-dict"), "{arguments}");
}

#[test]
fn seeds_that_nobody_generates_lie_apart() {
    let root = tempfile::tempdir().unwrap();
    std::fs::create_dir_all(root.path().join("fuzz/seeds/acc_decode")).unwrap();
    let arguments = run_arguments(root.path(), "acc_decode", 1);
    assert!(
        arguments.starts_with("run acc_decode target/fuzz-corpus/acc_decode fuzz/seeds/acc_decode -- "),
        "{arguments}"
    );
}

#[test]
fn planted_bugs_are_those_of_the_target_and_are_looked_for_from_seeds_that_exist() {
    let root = crate::workspace_root();
    let read = |path: &str| std::fs::read_to_string(root.join(path)).unwrap();
    let named = read("conformance/src/oracles/planted.rs") + &read("fuzz/fuzz_targets/planted.rs");
    let names = named.lines().filter_map(|line| line.trim().strip_prefix("(\"")?.split_once("\", ")).count();
    assert_eq!(names, BUGS.len());
    for (bug, seeds, _) in BUGS {
        assert!(named.contains(&format!("(\"{bug}\", ")), "{bug}");
        assert!(root.join("fuzz/corpus").join(seeds).is_dir(), "{seeds}");
        assert!(
            planted_arguments(bug, seeds)
                .starts_with(&format!("run planted target/fuzz-planted/{bug} fuzz/corpus/{seeds} -- "))
        );
    }
}
