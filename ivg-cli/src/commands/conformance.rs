use std::fs;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use conformance_runner::explain::explain;
use conformance_runner::manifest::Suite;
use conformance_runner::run::{LIMIT, Options, Results, Status, run as run_suite};
use conformance_runner::{report, words};

use crate::args::{ConformanceArguments, ConformanceCommand, RunArguments};
use crate::failure::Failure;
use crate::files;

pub(crate) fn run(arguments: &ConformanceArguments) -> Result<ExitCode, Failure> {
    let suite = Suite::find(arguments.suite.as_deref()).map_err(Failure::new)?;
    match &arguments.command {
        ConformanceCommand::Run(arguments) => run_all(&suite, arguments),
        ConformanceCommand::List { only } => {
            files::print(&report::list(&suite, only.as_deref()))?;
            Ok(ExitCode::SUCCESS)
        }
        ConformanceCommand::Explain { id, decoder } => {
            files::print(&explain(&suite, id).map_err(Failure::new)?)?;
            let Some(decoder) = decoder else { return Ok(ExitCode::SUCCESS) };
            // No other id contains a star, and none is fitted by this one but itself.
            let options = options(decoder, Some(id.clone() + "*"), Vec::new(), 1, LIMIT);
            let mut results = run_suite(&suite, &options).map_err(Failure::new)?;
            results.answers.retain(|answer| answer.id == *id);
            files::print("\n")?;
            finish(&suite, &results)
        }
    }
}

fn options(decoder: &str, only: Option<String>, skip: Vec<String>, jobs: usize, limit: Duration) -> Options {
    Options { decoder: decoder.to_owned(), only, skip, jobs, limit }
}

fn run_all(suite: &Suite, arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let skip = match &arguments.skip {
        Some(path) => words::patterns(&fs::read_to_string(path).map_err(|error| Failure::file(path, error))?),
        None => Vec::new(),
    };
    let jobs =
        arguments.jobs.or_else(|| std::thread::available_parallelism().ok().map(usize::from)).unwrap_or(1);
    let limit = Duration::from_secs(arguments.timeout);
    let options = options(&arguments.decoder, arguments.only.clone(), skip, jobs, limit);
    let results = run_suite(suite, &options).map_err(Failure::new)?;
    let write = |path: Option<&Path>, text: fn(&Results) -> String| match path {
        Some(path) => fs::write(path, text(&results)).map_err(|error| Failure::file(path, error)),
        None => Ok(()),
    };
    write(arguments.json.as_deref(), report::json)?;
    write(arguments.junit.as_deref(), report::junit)?;
    finish(suite, &results)
}

/// Prints how it went.
fn finish(suite: &Suite, results: &Results) -> Result<ExitCode, Failure> {
    files::print(&report::text(suite, results))?;
    files::print(&format!("{}\n", report::summary(results)))?;
    Ok(if results.count(Status::Failed) == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}
