//! Progressive meshes and baked light beside the tools that a user would pick instead. The measuring lies in `tools/peers`,
//! Rust programs in a workspace of its own and Python files, and in examples of our crates; here they are built, their peers are
//! installed, and they are called.

use crate::invocation::Invocation;
use crate::runner::{Action, Step};
use std::path::{Path, PathBuf};

#[cfg(test)]
mod tests;

/// The workspace of the measuring programs.
const FOLDER: &str = "tools/peers";
/// Where results, the peers from PyPI and the measuring programs go unless something else is asked for.
pub const OUT: &str = "target/peers";

/// The examples that measure baked light.
const EXAMPLES: [&str; 2] = [
    "build --locked --release --package ivg-bake --features rays --example oracle_error --example near_surfaces --example rays",
    "build --locked --release --package ivg-scene --example replace",
];

/// What is compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Comparison {
    /// Bytes, speed and distances as tables.
    Mesh,
    /// Coarse levels as pictures.
    Picture,
    /// Random levels of our files: are they valid?
    Levels,
    /// Error, time, rays, threads and memory of baked light as tables.
    Bake,
}

impl Comparison {
    fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Picture => "picture",
            Self::Levels => "levels",
            Self::Bake => "bake",
        }
    }
}

/// A comparison and how to make it.
#[derive(Debug, Clone)]
pub struct Request {
    /// What is compared.
    pub what: Comparison,
    /// The folder with the meshes.
    pub meshes: PathBuf,
    /// If not empty: these meshes only, or rows of baked light.
    pub only: Vec<String>,
    /// Fewer repetitions and samples.
    pub quick: bool,
    /// The folder for what is written.
    pub out: PathBuf,
}

/// The steps of a comparison: build, install, measure.
#[must_use]
pub fn steps(root: &Path, request: &Request) -> Vec<Step> {
    let target = target_folder(root);
    let environment = root.join(OUT).join("venv");
    let python = environment.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let python = python.to_string_lossy();
    let light = request.what == Comparison::Bake;
    let measure = Invocation::new(&python, "-B");
    let measure = if light {
        measure.argument(format!("{FOLDER}/bake.py"))
    } else {
        measure.argument(format!("{FOLDER}/peers.py")).argument(request.what.name())
    };
    let mut measure = measure
        .argument("--meshes")
        .argument(request.meshes.to_string_lossy())
        .argument("--out")
        .argument(request.out.to_string_lossy())
        .argument("--ivg")
        .argument(target.join("release/ivg").to_string_lossy())
        .argument("--programs")
        .argument(target.join("release").to_string_lossy());
    for name in &request.only {
        measure = measure.argument("--only").argument(name);
    }
    if request.quick {
        measure = measure.argument("--quick");
    }
    let mut builds = vec![Invocation::cargo("build --locked --release --package ivg-cli")];
    let mut installs = vec![Invocation::new("python3", "-m venv").argument(environment.to_string_lossy())];
    if light {
        builds.extend(EXAMPLES.map(Invocation::cargo));
        // `bake.py` installs its peers itself: one that cannot be had costs its rows alone.
    } else {
        installs.push(
            Invocation::new(&python, "-m pip install --quiet --disable-pip-version-check --requirement")
                .argument(format!("{FOLDER}/requirements.txt")),
        );
    }
    builds.push(in_own_workspace(root, "build --release"));
    let run = |commands: Vec<Invocation>| commands.into_iter().map(Action::Run).collect();
    vec![
        Step { name: "build", actions: run(builds) },
        Step { name: "install peers", actions: run(installs) },
        Step { name: request.what.name(), actions: vec![Action::Run(measure)] },
    ]
}

/// A call of cargo for the measuring programs. They share the target folder of the workspace, so that what both use is built
/// once.
#[must_use]
pub fn in_own_workspace(root: &Path, arguments: &str) -> Invocation {
    let (command, rest) = arguments.split_once(' ').unwrap_or((arguments, ""));
    Invocation::cargo(command)
        .arguments(&format!("--locked --manifest-path {FOLDER}/Cargo.toml --target-dir"))
        .argument(target_folder(root).to_string_lossy())
        .arguments(rest)
}

/// Where cargo builds the workspace.
fn target_folder(root: &Path) -> PathBuf {
    root.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}
