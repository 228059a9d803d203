//! `cargo xtask`: see the library's documentation, or `cargo xtask --help`.

#![forbid(unsafe_code)]

use clap::{Args, Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use xtask::peers::{self, Comparison, Request};
use xtask::runner::{self, Context};
use xtask::steps::{self, Selection};
use xtask::{archive, tidy, workspace_root};

/// Commands of the workspace.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run the whole suite, stopping at the first failure.
    Test(TestOptions),
    /// Look at the sources: file lengths, left-over markers, machine paths, README and CI agree.
    Tidy,
    /// Pack the conformance suite: vectors, runner, adapters, ports, specification; the same bytes from the same sources.
    ConformanceZip {
        /// The file to write [default: target/ivg-conformance.zip].
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// Install peers from PyPI and crates.io, and print them and this project side by side. Needs Python 3 and the network.
    #[command(subcommand)]
    Peers(PeersCommand),
}

#[derive(Debug, Subcommand)]
enum PeersCommand {
    /// Tables of bytes, speed and distances, and which targets are met; 15 minutes for all meshes.
    Mesh(PeersOptions),
    /// The dragon at 0.2 % and 1 % of its faces as pictures, beside meshoptimizer's.
    Picture(PeersOptions),
    /// Check 200 random levels of each mesh, of raw and of coded files.
    Levels(PeersOptions),
    /// Baked light beside Mitsuba 3 and Embree, and which targets are met; 9 minutes on two idle cores.
    Bake(PeersOptions),
}

#[derive(Debug, Args)]
struct PeersOptions {
    /// Folder with the meshes, which are not part of the project; what is missing is named, with where it can be had.
    #[arg(long, value_name = "DIR")]
    meshes: PathBuf,
    /// Measure only this mesh, or of baked light this row (error, mitsuba, rays, threads, surfaces, memory, dragon); may be
    /// repeated.
    #[arg(long, value_name = "NAME")]
    only: Vec<String>,
    /// For a look: fewer repetitions and samples.
    #[arg(long)]
    quick: bool,
    /// Folder for what is written [default: target/peers].
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Args)]
struct TestOptions {
    /// Install what is missing: a software Vulkan driver, Python and node (apt-get), cargo-fuzz (into target/tools).
    #[arg(long)]
    install: bool,
    /// Leave out fuzzing, readers in other languages and all but the default feature set.
    #[arg(long)]
    fast: bool,
    /// Run only the steps whose name contains WORD; may be repeated.
    #[arg(long, value_name = "WORD")]
    only: Vec<String>,
    /// Name the steps and the commands they run, and do nothing else.
    #[arg(long)]
    list: bool,
    /// How long each fuzz target runs, in seconds.
    #[arg(long, value_name = "SECONDS", default_value_t = 20)]
    fuzz_seconds: u32,
}

/// Writes the archive of the conformance suite; its length.
fn pack(root: &Path, out: &Path) -> std::io::Result<usize> {
    let archive = archive::zip(&archive::files(root)?)?;
    std::fs::create_dir_all(out.parent().unwrap_or(root))?;
    std::fs::write(out, &archive)?;
    Ok(archive.len())
}

fn main() -> ExitCode {
    let mut context = Context::new(workspace_root());
    let passed = match CommandLine::parse().command {
        Command::Test(options) => {
            let selection = Selection {
                install: options.install,
                fast: options.fast,
                only: options.only,
                fuzz_seconds: options.fuzz_seconds,
            };
            let steps = steps::selected(&selection);
            if steps.is_empty() {
                eprintln!(
                    "no step's name contains {:?}; `cargo xtask test --list` names them all",
                    selection.only
                );
                return ExitCode::from(2);
            }
            if options.list {
                runner::list(&steps, &mut std::io::stdout())
            } else {
                let (name, value) = steps::ENVIRONMENT;
                context = context.environment(name, value);
                runner::run(&steps, &mut context, &mut std::io::stdout())
            }
        }
        Command::Peers(command) => {
            let (what, options) = match command {
                PeersCommand::Mesh(options) => (Comparison::Mesh, options),
                PeersCommand::Picture(options) => (Comparison::Picture, options),
                PeersCommand::Levels(options) => (Comparison::Levels, options),
                PeersCommand::Bake(options) => (Comparison::Bake, options),
            };
            // The commands run in the workspace folder; paths that a person types are meant from where that person is.
            let here = std::env::current_dir().unwrap_or_default();
            let out = options.out.map_or_else(|| context.root().join(peers::OUT), |out| here.join(out));
            let meshes = here.join(options.meshes);
            let request = Request { what, meshes, only: options.only, quick: options.quick, out };
            let steps = peers::steps(context.root(), &request);
            runner::run(&steps, &mut context, &mut std::io::stdout())
        }
        Command::ConformanceZip { out } => {
            let here = std::env::current_dir().unwrap_or_default();
            let out =
                out.map_or_else(|| context.root().join("target/ivg-conformance.zip"), |out| here.join(out));
            return match pack(context.root(), &out) {
                Ok(bytes) => {
                    println!("{}: {bytes} bytes", out.display());
                    ExitCode::SUCCESS
                }
                Err(error) => {
                    eprintln!("cannot write {}: {error}", out.display());
                    ExitCode::FAILURE
                }
            };
        }
        Command::Tidy => runner::run(&[tidy::step()], &mut context, &mut std::io::stdout()),
    };
    match passed {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("cannot write to the terminal: {error}");
            ExitCode::FAILURE
        }
    }
}
