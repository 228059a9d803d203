//! Arguments of the conformance suite.

use std::path::PathBuf;

use clap::{Args, Subcommand};

#[derive(Debug, Args)]
pub(crate) struct ConformanceArguments {
    #[command(subcommand)]
    pub(crate) command: ConformanceCommand,
    /// Folder of the suite's vectors [default: conformance/vectors or vectors].
    #[arg(long, value_name = "DIR", global = true)]
    pub(crate) suite: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ConformanceCommand {
    /// Run the suite on a decoder; the last line is `N passed, N failed`, the exit status 1 if any failed.
    Run(RunArguments),
    /// Its tests: id, kind, verdict and error code, what each shows.
    List {
        /// Only tests whose id contains this, or fits it where it has a `*`.
        #[arg(long, value_name = "PATTERN")]
        only: Option<String>,
    },
    /// Everything about one test: what it shows, the clauses, how its file is made of its twin.
    Explain {
        /// Id of the test.
        id: String,
        /// Run it on this decoder too, and name the first number that differs.
        #[arg(long, value_name = "CMD")]
        decoder: Option<String>,
    },
}

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// Command of the decoder's adapter (see conformance/PROTOCOL.md).
    #[arg(long, value_name = "CMD")]
    pub(crate) decoder: String,
    /// Only tests whose id contains this, or fits it where it has a `*`.
    #[arg(long, value_name = "PATTERN")]
    pub(crate) only: Option<String>,
    /// Leave out the tests that this list names: one pattern a line.
    #[arg(long, value_name = "FILE")]
    pub(crate) skip: Option<PathBuf>,
    /// Write all results as JSON.
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    /// Write all results as JUnit XML.
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    /// How many tests run at a time [default: one for each core].
    #[arg(long, value_name = "N", value_parser = crate::scene_args::count::<usize>)]
    pub(crate) jobs: Option<usize>,
    /// Seconds that a test may take; a table six times as long.
    #[arg(long, value_name = "SECONDS", default_value_t = 10, value_parser = crate::scene_args::count::<u64>)]
    pub(crate) timeout: u64,
}
