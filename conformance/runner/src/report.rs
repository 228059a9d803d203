//! How a run went: as text, JSON, JUnit.

use crate::manifest::Suite;
use crate::run::{Answer, Results, Status};
use crate::words;
use serde::Serialize;
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

/// What is printed, without the [`summary`].
#[must_use]
pub fn text(results: &Results) -> String {
    let mut text = String::new();
    let failed: Vec<&Answer> =
        results.answers.iter().filter(|answer| answer.status == Status::Failed).collect();
    for answer in failed.iter().take(LISTED) {
        text += &format!("FAILED {}: {}\n", answer.id, answer.detail);
        for line in answer.stderr.lines().take(COMPLAINTS) {
            text += &format!("    | {line}\n");
        }
    }
    if failed.len() > LISTED {
        text += &format!("and {} more; --json FILE lists all\n", failed.len() - LISTED);
    }
    if let Some(first) = failed.first() {
        text += &format!("what is in a test, and why: explain {}\n", first.id);
    }
    text += &format!("{}, in {:.1} s\n", results.decoder, results.took.as_secs_f64());
    text
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
            Status::Failed => format!("<failure message=\"{}\"/>", escaped(&answer.detail)),
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
