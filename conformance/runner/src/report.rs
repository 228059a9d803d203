//! How a run went: as text, JSON, JUnit.

use crate::manifest::Suite;
use crate::run::{Answer, Results, Status};
use crate::words;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// The last line: `N passed, N failed`, and what was not run.
#[must_use]
pub fn summary(results: &Results) -> String {
    let mut line =
        format!("{} passed, {} failed", results.count(Status::Passed), results.count(Status::Failed));
    for (status, name) in [(Status::NotClaimed, "not claimed"), (Status::Skipped, "skipped")] {
        let count = results.count(status);
        if count > 0 {
            line += &format!(", {count} {name}");
        }
    }
    line
}

/// Failed tests that are listed in the text.
const LISTED: usize = 40;
/// Lines of standard error that are shown of a failed test.
const COMPLAINTS: usize = 3;
/// Clauses that are named of those of which every test failed.
const CLAUSES: usize = 12;

/// What is printed, without the [`summary`].
#[must_use]
pub fn text(suite: &Suite, results: &Results) -> String {
    let mut text = String::new();
    let failed: Vec<&Answer> =
        results.answers.iter().filter(|answer| answer.status == Status::Failed).collect();
    let listed = telling(&failed);
    for answer in &listed {
        text += &format!("FAILED {}: {}\n", answer.id, answer.detail);
        for line in answer.stderr.lines().take(COMPLAINTS) {
            text += &format!("    | {line}\n");
        }
    }
    if failed.len() > LISTED {
        text += &format!("and {} more; --json FILE lists all\n", failed.len() - LISTED);
    }
    let broken = broken(suite, &results.answers);
    if !broken.is_empty() {
        let more = broken.len().saturating_sub(CLAUSES);
        let more = if more > 0 { format!(", and {more} more") } else { String::new() };
        let named = broken[..broken.len().min(CLAUSES)].join(", ");
        text += &format!("every test of these clauses failed: {named}{more}\n");
    }
    if let Some(first) = listed.first() {
        text += &format!("what is in a test, and why: explain {}\n", first.id);
    }
    text += &format!("{}, in {:.1} s\n", results.decoder, results.took.as_secs_f64());
    text
}

/// As many failed tests as are listed: those first that are about another clause than the ones before, in the order of the suite.
fn telling<'a>(failed: &[&'a Answer]) -> Vec<&'a Answer> {
    let mut clauses = BTreeSet::new();
    let (mut chosen, mut others) = (Vec::new(), Vec::new());
    for (number, answer) in failed.iter().enumerate() {
        let known = clauses.len();
        clauses.extend(&answer.clauses);
        let into = if clauses.len() > known { &mut chosen } else { &mut others };
        into.push(number);
    }
    chosen.append(&mut others);
    chosen.truncate(LISTED);
    chosen.sort_unstable();
    chosen.into_iter().map(|number| failed[number]).collect()
}

/// The clauses of which a test failed and none passed, those with the most failed tests first.
fn broken<'a>(suite: &'a Suite, answers: &[Answer]) -> Vec<&'a str> {
    let (mut failed, mut passed) = (BTreeMap::<&str, usize>::new(), BTreeSet::new());
    for answer in answers {
        for clause in suite.test(&answer.id).into_iter().flat_map(|test| &test.clauses) {
            match answer.status {
                Status::Failed => *failed.entry(clause).or_default() += 1,
                Status::Passed => drop(passed.insert(clause.as_str())),
                Status::NotClaimed | Status::Skipped => {}
            }
        }
    }
    let mut broken: Vec<(&str, usize)> =
        failed.into_iter().filter(|(clause, _)| !passed.contains(clause)).collect();
    broken.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    broken.into_iter().map(|(clause, _)| clause).collect()
}

/// The tests that fit a pattern: id, kind, verdict and code, what it shows; with tabs between.
#[must_use]
pub fn list(suite: &Suite, only: Option<&str>) -> String {
    let tests = suite.manifest.tests.iter();
    let chosen = tests.filter(|test| only.is_none_or(|pattern| words::fits(pattern, &test.id)));
    let line = |test: &crate::manifest::Test| {
        let code = test.code.map_or(String::new(), |code| format!(" {code}"));
        format!("{}\t{}\t{}{code}\t{}\n", test.id, test.kind.name(), test.verdict.name(), test.why)
    };
    chosen.map(line).collect()
}

#[derive(Serialize)]
struct Json<'a> {
    decoder: &'a str,
    passed: usize,
    failed: usize,
    not_claimed: usize,
    skipped: usize,
    tests: &'a [Answer],
}

/// All answers as JSON; the same for the same decoder, whichever program ran it.
#[must_use]
pub fn json(results: &Results) -> String {
    let json = Json {
        decoder: &results.decoder,
        passed: results.count(Status::Passed),
        failed: results.count(Status::Failed),
        not_claimed: results.count(Status::NotClaimed),
        skipped: results.count(Status::Skipped),
        tests: &results.answers,
    };
    // Strings and numbers can always be written.
    serde_json::to_string_pretty(&json).unwrap_or_default() + "\n"
}

/// All answers in the form of JUnit, which build servers read.
#[must_use]
pub fn junit(results: &Results) -> String {
    let left_out = results.count(Status::NotClaimed) + results.count(Status::Skipped);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"conformance\" tests=\"{}\" failures=\"{}\" skipped=\"{left_out}\">\n",
        results.answers.len(),
        results.count(Status::Failed),
    );
    for answer in &results.answers {
        let name = escaped(&answer.id);
        let inner = match answer.status {
            Status::Passed => String::new(),
            Status::Failed => {
                let about = [&[answer.why.clone()][..], &answer.clauses].concat().join("; ");
                format!("<failure message=\"{}\">{}</failure>", escaped(&answer.detail), escaped(&about))
            }
            Status::NotClaimed => "<skipped message=\"not claimed\"/>".to_owned(),
            Status::Skipped => "<skipped/>".to_owned(),
        };
        // A string takes everything.
        let _ = writeln!(text, "  <testcase name=\"{name}\">{inner}</testcase>");
    }
    text + "</testsuite>\n"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
