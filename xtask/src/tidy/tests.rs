use super::{
    LEFT_OVERS, LONGEST_FILE, LONGEST_LIB, Source, ignored_paths, is_test, machine_path, problems_of,
    read_sources, stale_exceptions, undocumented_commands, unreferenced_tables,
};
use std::path::Path;

fn source(path: &str, text: impl Into<String>) -> Source {
    Source { path: path.to_owned(), text: text.into() }
}

#[test]
fn long_files_are_found_and_tests_excepted() {
    let long = "line\n".repeat(LONGEST_FILE + 1);
    assert_eq!(problems_of(&source("a/src/b.rs", long.clone())).len(), 1);
    assert!(problems_of(&source("a/src/b.rs", "line\n".repeat(LONGEST_FILE))).is_empty());
    assert!(problems_of(&source("a/src/b/tests.rs", long.clone())).is_empty());
    assert!(problems_of(&source("spec/ivg.md", long)).is_empty());
    assert_eq!(problems_of(&source("a/src/lib.rs", "line\n".repeat(LONGEST_LIB + 1))).len(), 1);
}

#[test]
fn tests_are_known_by_their_path() {
    assert!(is_test("a/tests/b.rs") && is_test("a/src/b/tests.rs") && is_test("a/src/b_tests.rs"));
    assert!(!is_test("a/src/contests.rs"));
}

#[test]
fn left_over_markers_are_found_as_words() {
    for marker in LEFT_OVERS {
        let found = problems_of(&source("a.rs", format!("fine\n    // {marker} x)\n")));
        assert_eq!(found.len(), 1, "{marker}");
        assert!(found[0].starts_with("a.rs:2: "), "{found:?}");
    }
    assert!(problems_of(&source("a.rs", format!("{}S", LEFT_OVERS[0]))).is_empty());
}

#[test]
fn paths_of_one_machine_are_found() {
    let path = |folder: &str| format!("/{folder}/somebody/data.obj");
    assert_eq!(machine_path(&format!("read \"{}\"", path("root"))), Some(path("root").as_str()));
    assert_eq!(machine_path(&path("farm")), Some(path("farm").as_str()));
    assert_eq!(machine_path(&format!("https://example.org{}", path("work"))), None);
    assert_eq!(machine_path(&format!("a relative{}", path("work"))), None);
    assert_eq!(machine_path("/usr/share/vulkan"), None);
}

#[test]
fn an_exception_without_need_is_found() {
    let sources = [source("long.rs", "\n".repeat(LONGEST_FILE + 1)), source("short.rs", "\n")];
    assert!(stale_exceptions(&[("long.rs", "reason")], &sources).is_empty());
    assert_eq!(stale_exceptions(&[("short.rs", "reason"), ("gone.rs", "reason")], &sources).len(), 2);
}

#[test]
fn commands_of_ci_must_stand_in_a_block_of_the_readme() {
    let ci = "#!/bin/sh\n# why\nset -eu\ncd \"$(dirname \"$0\")/..\"\nexec cargo xtask test --install\n";
    let block = "text\n```sh\ncargo xtask test --install   # everything\n```\n";
    assert!(undocumented_commands(ci, block).is_empty());
    assert_eq!(undocumented_commands(ci, "cargo xtask test --install\n").len(), 1);
    assert_eq!(undocumented_commands(ci, &block.replace("--install", "")).len(), 1);
    assert_eq!(undocumented_commands("set -eu\n", block).len(), 1);
}

#[test]
fn a_table_that_no_code_names_is_found() {
    let table = source("spec/tables/limits.toml", "");
    let user = source("a/tests/tables.rs", "include_str!(\"../../spec/tables/limits.toml\")");
    assert_eq!(unreferenced_tables(&[source("spec/tables/limits.toml", ""), source("b.rs", "")]).len(), 1);
    assert!(unreferenced_tables(&[table, user]).is_empty());
}

#[test]
fn ignored_files_are_not_read() {
    let root = tempfile::tempdir().unwrap();
    for path in ["target/a.rs", ".git/a.rs", "crate/src/a.rs", ".ci/run", "picture.png"] {
        let path = root.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, "text").unwrap();
    }
    std::fs::write(root.path().join(".gitignore"), "# built\n/target\n").unwrap();
    let found: Vec<String> =
        read_sources(root.path()).unwrap().into_iter().map(|source| source.path).collect();
    assert_eq!(found, [".ci/run", "crate/src/a.rs"]);
    assert!(ignored_paths(Path::new("/"), "*.tmp\n").is_err());
}
