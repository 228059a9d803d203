//! The conformance suite from the command line, with decoders that are one line of shell.

#[allow(dead_code, reason = "shared with the other tests, which use other parts")]
mod support;

use std::path::Path;

use serde_json::Value;
use support::{Workplace, text};

const SUITE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../conformance/vectors");

/// It says what it can do, and refuses every file.
const REFUSES: &str =
    r#"sh -c 'case $0 in capabilities) echo name stern; echo ivg decode;; *) exit 41;; esac'"#;

fn conformance<'a>(arguments: &[&'a str]) -> Vec<&'a str> {
    [&["conformance", "--suite", SUITE], arguments].concat()
}

#[test]
fn a_decoder_that_refuses_everything_passes_what_is_to_be_refused() {
    let place = Workplace::new();
    let only = ["--only", "ivg/000*"];
    let run = place.run(&conformance(&[&["run", "--decoder", REFUSES], &only[..]].concat()));
    let said = text(&run.stdout);
    assert_eq!(run.status.code(), Some(1), "{said}");
    assert!(said.contains("FAILED ivg/0003-packed: expected ok"), "{said}");
    let reports = ["--json", "results.json", "--junit", "results.xml", "--jobs", "1"];
    let refused = [&["run", "--decoder", REFUSES, "--only", "ivg/x-302-*"], &reports[..]].concat();
    let said = text(&place.ok(&conformance(&refused))).to_owned();
    let results: Value = serde_json::from_slice(&place.read("results.json")).unwrap();
    let answers = results["tests"].as_array().unwrap();
    let passed = answers.iter().filter(|answer| answer["status"] == "passed").count();
    assert!(passed >= 2, "{results}");
    let summary = format!("{passed} passed, 0 failed, {} not claimed", answers.len() - passed);
    assert_eq!(said.lines().last(), Some(&*summary));
    assert!(text(&place.read("results.xml")).contains("<testsuite "));
}

#[test]
fn tests_are_listed_and_explained() {
    let place = Workplace::new();
    let listed = place.ok(&conformance(&["list", "--only", "numeric/*"]));
    assert_eq!(text(&listed).lines().count(), 4);
    let explained = place.ok(&conformance(&["explain", "ivg/x-302-origin-nan"]));
    assert!(text(&explained).contains("header.origin"), "{}", text(&explained));
    let both = place.ok(&conformance(&["explain", "ivg/x-118-reserved-and-117-file-bytes"]));
    assert!(text(&both).contains("ivg/x-118-reserved before ivg/x-117-file-bytes"), "{}", text(&both));
}

#[test]
fn what_is_not_there_is_named() {
    let place = Workplace::new();
    let none = place.run(&["conformance", "list"]);
    assert_eq!(none.status.code(), Some(1));
    assert!(text(&none.stderr).contains("--suite"), "{}", text(&none.stderr));
    let unknown = place.run(&conformance(&["explain", "ivg/none"]));
    assert_eq!(unknown.status.code(), Some(1));
    assert!(text(&unknown.stderr).contains("ivg/none"), "{}", text(&unknown.stderr));
    assert!(Path::new(SUITE).join("manifest.json").exists());
}
