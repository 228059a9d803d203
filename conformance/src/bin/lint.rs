//! Checks that every file of the suite to refuse has one defect, and that manifest and files fit: `cargo run -p conformance --bin lint`.

#![forbid(unsafe_code)]

use conformance::suite::{gaps, lint};
use conformance_runner::manifest::Suite;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("vectors");
    match lint(&folder).and_then(|found| Ok((found, gaps(&Suite::open(&folder)?.manifest)))) {
        Ok(((wrong, defects), gaps)) if wrong.is_empty() && gaps.is_empty() => {
            println!(
                "{defects} files to refuse, each with one defect or the two that it names; every clause for readers has its tests"
            );
            ExitCode::SUCCESS
        }
        Ok(((wrong, _), gaps)) => {
            wrong.iter().chain(&gaps).for_each(|line| eprintln!("{line}"));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
