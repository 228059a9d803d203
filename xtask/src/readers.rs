//! The conformance suite on the readers in other languages, and the suite itself: that it takes minutes, and that it finds mistakes.

use crate::archive;
use crate::invocation::Invocation;
use crate::runner::{Action, Context};
use std::path::Path;
use std::time::Instant;

#[cfg(test)]
mod tests;

/// Where the archive is unpacked, as someone without this repository would; made anew each time.
const UNPACKED: &str = "target/conformance-archive";
/// What the archive promises to someone who has a decoder: from the file to the report \[s\].
const FIVE_MINUTES: f64 = 300.0;
/// The lines of the archive's first page that its reader types; a test compares.
const COMPILE: (&str, &str) =
    ("cc", "-std=c99 -O2 -Iconformance/ports/c conformance/adapters/c/adapter.c -o adapter -lm");
const RUN: (&str, &str) = ("python3", "conformance/run.py run --decoder ./adapter");

/// What the step does, in order.
#[must_use]
pub fn actions() -> Vec<Action> {
    let suite = |decoder: &str| {
        let runner = Invocation::new("python3", "conformance/run.py run --decoder");
        Action::Run(runner.argument(decoder))
    };
    vec![
        Action::Call("from the archive to the report in C, timed", Box::new(first_report)),
        Action::Run(Invocation::new("sh", "conformance/ports/c/check.sh")),
        suite("node conformance/adapters/js/adapter.mjs"),
        suite("python3 conformance/adapters/python/adapter.py"),
        Action::Run(Invocation::new("python3", "conformance/mutants/check.py")),
    ]
}

/// Unpacks the archive, compiles the example in C and runs the suite on it, and says how long that took. Slow machines are no
/// failure: whoever waits for more than [`FIVE_MINUTES`] is told.
fn first_report(context: &mut Context) -> Result<(), String> {
    let folder = context.root().join(UNPACKED);
    let archive = archive::files(context.root()).and_then(|files| archive::zip(&files));
    let archive = archive.map_err(|error| format!("cannot pack the suite: {error}"))?;
    let made = match std::fs::remove_dir_all(&folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => std::fs::create_dir_all(&folder),
    };
    made.and_then(|()| std::fs::write(folder.join("suite.zip"), archive))
        .map_err(|error| format!("cannot write to {}: {error}", folder.display()))?;
    let inside = folder.join(archive::FOLDER);
    let start = Instant::now();
    let timed = |what: &str, invocation: &Invocation, folder: &Path| {
        let start = Instant::now();
        println!("$ {invocation}");
        invocation.run(folder).map(|()| (what.to_owned(), start.elapsed().as_secs_f64()))
    };
    let parts = [
        timed("unpack", &Invocation::new("python3", "-m zipfile -e suite.zip ."), &folder)?,
        timed("compile the adapter", &Invocation::new(COMPILE.0, COMPILE.1), &inside)?,
        timed("run and report", &Invocation::new(RUN.0, RUN.1), &inside)?,
    ];
    let parts = parts.map(|(what, seconds)| format!("{what} {seconds:.1} s")).join(", ");
    let total = start.elapsed().as_secs_f64();
    println!("from the archive to the report: {total:.1} s ({parts})");
    if total > FIVE_MINUTES {
        println!("that is more than the five minutes that the suite promises");
    }
    Ok(())
}
