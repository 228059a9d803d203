//! The suite: what `cargo xtask test` does, in order. Quick looks come first, so that most mistakes show in seconds.
//!
//! All cargo calls share profile, flags and target folder, so that each dependency is checked once and built once: the
//! lints and the documentation share one set of artefacts, the tests another; a second feature set builds again only what
//! it changes. Every call says `--locked`: the lock file is part of the source.

use crate::invocation::Invocation;
use crate::runner::{Action, Context, Step};
use crate::{fuzz, peers, readers, tidy, tools, workspace_root};

#[cfg(test)]
mod tests;

/// What incremental compilation keeps for the next build is two thirds of the target folder (11 of 17 GB), and the suite,
/// which builds five sets of features, cannot count on a large disk; nor does it build anything twice.
pub const ENVIRONMENT: (&str, &str) = ("CARGO_INCREMENTAL", "0");

/// Which steps are asked for, and how.
#[derive(Debug, Clone, Default)]
pub struct Selection {
    /// Install what is missing.
    pub install: bool,
    /// Leave out fuzzing, readers in other languages and all but the default feature set.
    pub fast: bool,
    /// If not empty: only steps whose name contains one of these.
    pub only: Vec<String>,
    /// How long each fuzz target runs \[s\].
    pub fuzz_seconds: u32,
}

/// Crates whose default features can be left away; tested in that form too. (`--workspace --no-default-features` alone would
/// not do: there, crates that ask for `std` switch it on for all.)
const WITHOUT_DEFAULT_FEATURES: [&str; 4] = ["ivg-wire", "ivg-format", "pmesh-format", "ivg-render"];

/// The steps that the selection asks for, in order.
#[must_use]
pub fn selected(selection: &Selection) -> Vec<Step> {
    let mut steps = all(selection);
    if !selection.only.is_empty() {
        steps.retain(|step| selection.only.iter().any(|word| step.name.contains(word.as_str())));
    }
    steps
}

fn all(selection: &Selection) -> Vec<Step> {
    let full = !selection.fast;
    let mut steps = vec![
        tools_step(selection),
        step(
            "format",
            [
                cargo("fmt --all --check"),
                cargo("fmt --manifest-path fuzz/Cargo.toml --check"),
                cargo("fmt --manifest-path conformance/nostd-link/Cargo.toml --check"),
                cargo("fmt --manifest-path tools/peers/Cargo.toml --check"),
            ],
        ),
        tidy::step(),
        step("clippy, default features", [clippy("")]),
    ];
    if full {
        steps.push(step("clippy, no default features", [clippy("--no-default-features")]));
        steps.push(step("clippy, all features", [clippy("--all-features")]));
        let lints = peers::in_own_workspace(&workspace_root(), "clippy --all-targets -- -D warnings");
        let tests = peers::in_own_workspace(&workspace_root(), "test");
        steps.push(step("comparison with peers", [Action::Run(lints), Action::Run(tests)]));
    }
    steps.push(step(
        "documentation",
        [Action::Run(
            Invocation::cargo("doc --locked --workspace --no-deps --all-features")
                .environment("RUSTDOCFLAGS", "-Dwarnings"),
        )],
    ));
    let link = "--locked --manifest-path conformance/nostd-link/Cargo.toml";
    steps.push(step(
        "link without std",
        [cargo(&format!("build {link}")), cargo(&format!("clippy {link} -- -D warnings"))],
    ));
    if full {
        // A feature only adds items, so that this is all that the default features test, and more.
        steps.push(step("tests, all features", [cargo("test --locked --workspace --all-features")]));
        let packages = WITHOUT_DEFAULT_FEATURES.map(|name| format!("-p {name}")).join(" ");
        steps.push(step(
            "tests, no default features",
            [cargo(&format!("test --locked --no-default-features {packages}"))],
        ));
        steps.push(Step { name: "readers in other languages", actions: readers::actions() });
        steps.push(step("fuzz targets build", [call("cargo fuzz build", fuzz::build)]));
        steps.push(step(
            "fuzz-planted: bugs that the fuzzer must find",
            [call("the target `planted`, once for each of its bugs", fuzz::planted)],
        ));
        let seconds = selection.fuzz_seconds;
        steps.push(step(
            "fuzz targets run",
            [call("each target that `cargo fuzz list` names, for some seconds", move |context| {
                fuzz::run(context, seconds)
            })],
        ));
    } else {
        steps.push(step("tests, default features", [cargo("test --locked --workspace")]));
    }
    steps
}

fn tools_step(selection: &Selection) -> Step {
    let (install, full) = (selection.install, !selection.fast);
    step(
        "tools",
        [call("compilers, Vulkan driver, Python, node, cargo-fuzz: found or installed", move |context| {
            tools::ensure(context, install, full)
        })],
    )
}

fn step<const N: usize>(name: &'static str, actions: [Action; N]) -> Step {
    Step { name, actions: actions.into() }
}

fn cargo(arguments: &str) -> Action {
    Action::Run(Invocation::cargo(arguments))
}

fn clippy(features: &str) -> Action {
    cargo(&format!("clippy --locked --workspace --all-targets {features} -- -D warnings"))
}

fn call(
    description: &'static str,
    function: impl Fn(&mut Context) -> Result<(), String> + 'static,
) -> Action {
    Action::Call(description, Box::new(function))
}
