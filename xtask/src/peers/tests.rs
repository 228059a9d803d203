use super::{Comparison, Request, in_own_workspace, steps};
use crate::runner::list;
use std::path::Path;

fn listing(request: &Request) -> String {
    let mut out = Vec::new();
    list(&steps(Path::new("/folder of ours"), request), &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

fn request() -> Request {
    Request {
        what: Comparison::Mesh,
        meshes: "/some meshes".into(),
        only: Vec::new(),
        quick: false,
        out: "/results".into(),
    }
}

#[test]
fn builds_installs_and_then_measures() {
    let listing = listing(&request());
    let at = |part: &str| listing.find(part).unwrap_or_else(|| panic!("{part} is not in\n{listing}"));
    let order = [
        at("cargo build --locked --release --package ivg-cli"),
        at("--manifest-path tools/peers/Cargo.toml"),
        at("python3 -m venv"),
        at("-m pip install"),
        at("tools/peers/peers.py mesh"),
    ];
    assert!(order.is_sorted(), "{listing}");
}

#[test]
fn what_is_measured_is_passed_on() {
    let all = listing(&request());
    assert!(all.contains("--meshes '/some meshes'") && all.contains("--out /results"), "{all}");
    assert!(!all.contains("--only") && !all.contains("--quick"), "{all}");
    let some = Request {
        what: Comparison::Levels,
        only: vec!["bunny".to_owned(), "igea".to_owned()],
        quick: true,
        ..request()
    };
    let some = listing(&some);
    assert!(some.contains("peers.py levels ") && some.contains("--only bunny --only igea --quick"), "{some}");
    let picture = listing(&Request { what: Comparison::Picture, ..request() });
    assert!(picture.contains("peers.py picture "), "{picture}");
}

#[test]
fn baked_light_is_measured_by_examples_and_installs_its_own_peers() {
    let only = vec!["rays".to_owned()];
    let listing = listing(&Request { what: Comparison::Bake, only, quick: true, ..request() });
    let at = |part: &str| listing.find(part).unwrap_or_else(|| panic!("{part} is not in\n{listing}"));
    let order = [
        at("--package ivg-cli"),
        at("--features rays --example oracle_error"),
        at("--package ivg-scene --example replace"),
        at("--manifest-path tools/peers/Cargo.toml"),
        at("python3 -m venv"),
        at("tools/peers/bake.py --meshes '/some meshes' --out /results --ivg"),
    ];
    assert!(order.is_sorted(), "{listing}");
    assert!(listing.contains("--only rays --quick"), "{listing}");
    assert!(!listing.contains("pip install"), "{listing}");
}

#[test]
fn paths_with_blanks_stay_whole() {
    let listing = listing(&request());
    assert!(listing.contains("'/folder of ours/target/peers/venv/bin/python'"), "{listing}");
    let command = in_own_workspace(Path::new("/folder of ours"), "clippy --all-targets -- -D warnings");
    let command = command.to_string();
    assert!(command.starts_with("cargo clippy --locked --manifest-path tools/peers/Cargo.toml"), "{command}");
    assert!(command.ends_with("--all-targets -- -D warnings"), "{command}");
}
