//! Whether every clause that binds readers has a test that it is kept and a test of what breaks it.

use super::clauses::Clauses;
use conformance_runner::manifest::{Manifest, Test, Verdict};
use std::collections::BTreeSet;

/// What a clause has no test of, and why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Exception {
    /// The clause.
    pub clause: &'static str,
    /// Whether it has no test with a file to accept.
    pub positive: bool,
    /// Whether it has no test with a file to refuse.
    pub negative: bool,
    /// Why none can be made.
    pub why: &'static str,
}

const fn no_negative(clause: &'static str, why: &'static str) -> Exception {
    Exception { clause, positive: false, negative: true, why }
}

const fn neither(clause: &'static str, why: &'static str) -> Exception {
    Exception { clause, positive: true, negative: true, why }
}

/// The clauses without some test.
pub const EXCEPTIONS: [Exception; 12] = [
    neither("COM-CHK-08", "65,536 chunks: our limit of 1024 comes first, so no file here shows code 109"),
    neither(
        "COM-REC-06",
        "a record that is read alone; the commands of an adapter take files, so none shows code 113",
    ),
    Exception { clause: "COM-VERD-03", positive: true, negative: false, why: "only what follows a refusal" },
    no_negative("COM-STR-01", "only about beginnings of valid files; a reader that breaks it refuses them"),
    no_negative("COM-REC-02", "no file is refused for the generation of corners or bundles"),
    no_negative("IVG-HDR-03", "any seed is right"),
    neither("IVG-UPD-03", "records that come again; the commands of an adapter take files"),
    neither("IVG-LIM-02", "a bound on work, which no verdict shows; ivg-format/tests/laws counts"),
    neither("IVG-LIM-03", "a bound on memory, which no verdict shows; conformance/tests/bounds.rs counts"),
    no_negative("PMESH-LVL-01", "a reader that breaks it shows another mesh; no file breaks it"),
    no_negative("PMESH-LVL-05", "what is touched when the level changes, which no OUT shows"),
    no_negative("IVG-STR-01", "a reader that breaks it shows another grid; no file breaks it"),
];

/// Clauses without tests that are no exceptions, and exceptions that are none.
#[must_use]
pub fn gaps(manifest: &Manifest) -> Vec<String> {
    let accepted = |test: &Test| matches!(test.verdict, Verdict::Ok | Verdict::NeedMore);
    let find = |id: &String| manifest.tests.iter().find(|test| test.id == *id);
    let (mut positive, mut negative) = (BTreeSet::new(), BTreeSet::new());
    for test in &manifest.tests {
        // Other commands with a file to refuse are tests of what is wrong with it, whatever they say themselves.
        let refused =
            !accepted(test) || test.of.as_ref().and_then(find).is_some_and(|whole| !accepted(whole));
        let set = if refused { &mut negative } else { &mut positive };
        set.extend(&test.clauses);
        // The twin keeps the rule that the file breaks.
        if test.twin.is_some() {
            positive.extend(&test.clauses);
        }
    }
    let mut gaps = Vec::new();
    for clause in Clauses::read().readers {
        // Every test is one of verdicts.
        if clause == "COM-VERD-01" {
            continue;
        }
        let exception = EXCEPTIONS.iter().find(|exception| exception.clause == clause);
        for (kind, there, excepted) in [
            ("positive", positive.contains(&clause), exception.is_some_and(|exception| exception.positive)),
            ("negative", negative.contains(&clause), exception.is_some_and(|exception| exception.negative)),
        ] {
            match (there, excepted) {
                (false, false) => gaps.push(format!("{clause} has no {kind} test")),
                (true, true) => {
                    gaps.push(format!("{clause} has a {kind} test, and is listed as having none"));
                }
                _ => {}
            }
        }
    }
    gaps
}
