use super::{Selection, selected};
use crate::runner::list;

fn listing(selection: &Selection) -> String {
    let mut out = Vec::new();
    list(&selected(selection), &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn every_cargo_call_that_resolves_dependencies_is_locked() {
    let listing = listing(&Selection::default());
    let calls: Vec<&str> =
        listing.lines().filter(|line| line.contains("cargo ") && line.contains('$')).collect();
    assert!(calls.len() > 6, "{listing}");
    for line in calls {
        assert!(line.contains(" fmt ") || line.contains("--locked"), "{line}");
    }
}

#[test]
fn the_full_suite_has_every_part() {
    let listing = listing(&Selection::default());
    for part in [
        "cargo fmt --all --check",
        "fuzz/Cargo.toml --check",
        "tools/peers/Cargo.toml --check",
        "--all-targets -- -D warnings",
        "--all-targets --no-default-features -- -D warnings",
        "--all-targets --all-features -- -D warnings",
        "RUSTDOCFLAGS=-Dwarnings cargo doc --locked --workspace --no-deps",
        "nostd-link",
        "cargo clippy --locked --manifest-path tools/peers/Cargo.toml",
        "cargo test --locked --manifest-path tools/peers/Cargo.toml",
        "cargo test --locked --workspace --all-features",
        "cargo test --locked --no-default-features",
        "conformance/ports/c/check.sh",
        "node conformance/adapters/js/adapter.mjs",
        "conformance/mutants/check.py",
        "cargo fuzz build",
        "cargo fuzz list",
        "the target `planted`",
    ] {
        assert!(listing.contains(part), "{part} is not in\n{listing}");
    }
}

#[test]
fn the_fast_suite_still_lints_documents_and_tests() {
    let listing = listing(&Selection { fast: true, ..Selection::default() });
    for part in ["cargo clippy", "cargo doc", "cargo test --locked --workspace"] {
        assert!(listing.contains(part), "{part} is not in\n{listing}");
    }
    assert!(
        !listing.contains("fuzz build") && !listing.contains("--all-targets --all-features"),
        "{listing}"
    );
}

#[test]
fn only_picks_by_name() {
    let only = |word: &str| selected(&Selection { only: vec![word.to_owned()], ..Selection::default() });
    assert_eq!(only("clippy").len(), 3);
    assert_eq!(only("tidy").len(), 1);
    assert!(only("no such step").is_empty());
}
