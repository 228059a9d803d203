//! `ivg`: bakes indirect light, orders meshes, packs, serves, fetches and renders streamed lit scenes.
//!
//! This crate parses arguments, shows progress and prints tables; every algorithm lies in a library crate.

#![forbid(unsafe_code)]

mod args;
mod baking;
mod breakdown;
mod commands;
mod convert;
mod decimation;
mod failure;
mod files;
mod kind;
#[cfg(feature = "gpu")]
mod live;
mod loss;
mod npy;
mod packing;
mod picture;
mod points;
mod progress;
mod reading;
mod rounding;
mod scene_args;
mod table;
mod watch;
mod writing;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Arguments, Command};
use crate::failure::Failure;

fn main() -> ExitCode {
    let result = match Arguments::try_parse() {
        Ok(arguments) => run(arguments.command),
        // Help and version are asked for; everything else is an error, and errors are one line.
        Err(error) if !error.use_stderr() => files::printed(error.print()).map(|()| ExitCode::SUCCESS),
        Err(error) => {
            let failure = Failure::usage(first_paragraph(&error.to_string()));
            eprintln!("ivg: {failure} (see ivg --help)");
            return failure.exit_code();
        }
    };
    match result {
        Ok(code) => code,
        Err(failure) => {
            eprintln!("ivg: {failure}");
            failure.exit_code()
        }
    }
}

fn run(command: Command) -> Result<ExitCode, Failure> {
    match command {
        Command::Demo(arguments) => commands::demo::run(&arguments),
        Command::Plan(arguments) => commands::plan::run(&arguments),
        Command::Bake(arguments) => commands::bake::run(&arguments),
        Command::Merge(arguments) => commands::merge::run(&arguments),
        Command::Robustness(arguments) => commands::robustness::run(&arguments),
        Command::Mesh(arguments) => commands::mesh::run(&arguments),
        Command::Pack(arguments) => commands::pack::run(&arguments),
        Command::Info(arguments) => commands::info::run(&arguments),
        Command::Check(arguments) => commands::check::run(&arguments),
        Command::Recode(arguments) => commands::recode::run(&arguments),
        Command::Sample(arguments) => commands::sample::run(&arguments),
        Command::Extract(arguments) => commands::extract::run(&arguments),
        Command::Render(arguments) => commands::render::run(&arguments),
        Command::Serve(arguments) => commands::serve::run(&arguments),
        Command::Fetch(arguments) => commands::fetch::run(&arguments),
        Command::Conformance(arguments) => commands::conformance::run(&arguments),
    }
}

/// What clap says is wrong, without its usage text.
fn first_paragraph(message: &str) -> &str {
    let message = message.strip_prefix("error: ").unwrap_or(message);
    message.split("\n\n").next().unwrap_or(message)
}
