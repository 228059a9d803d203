//! The fuzz targets: built, and each run for a while. They need an unstable compiler flag, so a nightly toolchain or, where
//! there is none, the default one with `RUSTC_BOOTSTRAP=1`.

use crate::invocation::Invocation;
use crate::runner::Context;
use crate::tools;
use std::path::Path;
use std::time::Instant;

#[cfg(test)]
mod tests;

/// Longest input that the fuzzer makes up \[bytes\]; seeds are smaller, and longer inputs are slower, not better.
const LONGEST_INPUT: u32 = 4096;
/// An input that takes longer than this is a finding \[s\].
const SLOW_INPUT: u32 = 10;
/// A target that uses more memory than this is a finding \[MiB\]; the address sanitiser itself needs a few hundred.
const MEMORY: u32 = 2048;

/// The target that has bugs on purpose.
const PLANTED: &str = "planted";
/// Its bugs: the name, the target whose seeds the fuzzer starts from, and what is said when the bug shows.
const BUGS: [(&str, &str, &str); 5] = [
    ("index-without-check", "ivg_decode", "index out of bounds"),
    ("memory-for-a-declared-count", "ivg_decode", "bytes held at once"),
    ("wrong-level", "pmesh_lod", "depends on the way there"),
    ("c-reads-behind-the-end", "ivg_vs_c", "heap-buffer-overflow"),
    ("c-forgets-the-scale", "ivg_vs_c", "the reader in C"),
];
/// How long the fuzzer may look for each of them \[s\]; most take it a few seconds.
const LONGEST_SEARCH: u32 = 180;

/// Builds all fuzz targets, after checking that their lock file is up to date (`cargo fuzz` has no `--locked`).
///
/// # Errors
///
/// When the lock file is stale or a target does not build.
pub fn build(context: &mut Context) -> Result<(), String> {
    Invocation::cargo("tree --locked --manifest-path fuzz/Cargo.toml").output(context.root())?;
    context.run(&cargo_fuzz(context, "build"))
}

/// Runs each target that `cargo fuzz list` names for so many seconds, from the committed corpus. What the fuzzer adds stays
/// in `target/`; what it finds lies in `fuzz/artifacts/`.
///
/// # Errors
///
/// When a target finds something; the text then names the target and the command.
pub fn run(context: &mut Context, seconds: u32) -> Result<(), String> {
    let listing = cargo_fuzz(context, "list").output(context.root())?;
    let targets: Vec<&str> = listing.split_whitespace().collect();
    if targets.is_empty() {
        return Err("`cargo fuzz list` names no target".to_owned());
    }
    for target in targets.into_iter().filter(|target| *target != PLANTED) {
        let scratch = Path::new("target/fuzz-corpus").join(target);
        std::fs::create_dir_all(context.root().join(&scratch))
            .map_err(|error| format!("cannot make {}: {error}", scratch.display()))?;
        let start = Instant::now();
        context.run(&cargo_fuzz(context, &run_arguments(context.root(), target, seconds)))?;
        println!("{target}: nothing found in {:.0} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}

/// Lets the fuzzer look for bugs that were planted, each from the committed seeds alone.
///
/// # Errors
///
/// When it does not find one of them; the text then names the bug and the command.
pub fn planted(context: &mut Context) -> Result<(), String> {
    for (bug, seeds, said) in BUGS {
        let scratch = Path::new("target/fuzz-planted").join(bug);
        let folder = context.root().join(&scratch);
        // What an earlier run has found would make this one easy.
        let made = match std::fs::remove_dir_all(&folder) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
            _ => std::fs::create_dir_all(&folder),
        };
        made.map_err(|error| format!("cannot make {}: {error}", scratch.display()))?;
        let search = cargo_fuzz(context, &planted_arguments(bug, seeds)).environment("IVG_PLANTED", bug);
        println!("$ {search}");
        let start = Instant::now();
        match search.output(context.root()) {
            Ok(_) => return Err(format!("{bug} was not found in {LONGEST_SEARCH} s by `{search}`")),
            Err(error) if !error.contains(said) => {
                return Err(format!("{bug}: not what was to be found: {error}"));
            }
            Err(_) => println!("{bug}: found in {:.1} s", start.elapsed().as_secs_f64()),
        }
    }
    Ok(())
}

fn planted_arguments(bug: &str, seeds: &str) -> String {
    format!(
        "run {PLANTED} target/fuzz-planted/{bug} fuzz/corpus/{seeds} -- -max_total_time={LONGEST_SEARCH} -seed=1 \
         -max_len={LONGEST_INPUT} -timeout={SLOW_INPUT} -rss_limit_mb={MEMORY} -artifact_prefix=target/fuzz-planted/{bug}-"
    )
}

/// The first folder takes what the fuzzer adds, the others are only read: the generated corpus, or the seeds of a target that the
/// generator does not know. A format's dictionary and its conformance vectors serve all targets whose names begin like it.
fn run_arguments(root: &Path, target: &str, seconds: u32) -> String {
    let format = target.split('_').next().unwrap_or_default();
    let seeds = format!("fuzz/seeds/{target}");
    let seeds = if root.join(&seeds).is_dir() { seeds } else { format!("fuzz/corpus/{target}") };
    let mut folders = format!("target/fuzz-corpus/{target} {seeds}");
    let vectors = format!("conformance/vectors/{format}");
    if root.join(&vectors).is_dir() {
        folders = format!("{folders} {vectors}");
    }
    let dictionary = format!("fuzz/dictionaries/{format}.dict");
    let dictionary =
        if root.join(&dictionary).is_file() { format!(" -dict={dictionary}") } else { String::new() };
    format!(
        "run {target} {folders} -- -max_total_time={seconds} -seed=1 -max_len={LONGEST_INPUT} -timeout={SLOW_INPUT} \
         -rss_limit_mb={MEMORY} -verbosity=0{dictionary}"
    )
}

fn cargo_fuzz(context: &Context, arguments: &str) -> Invocation {
    let invocation = Invocation::cargo("fuzz")
        .path_front(Path::new(tools::FOLDER).join("bin").as_path())
        .arguments(arguments)
        // Safe Rust cannot use its stack after it has returned, and looking for that is a tenth of the time.
        .environment("ASAN_OPTIONS", "detect_stack_use_after_return=0");
    if nightly_is_usable(context.root()) {
        invocation.environment("RUSTUP_TOOLCHAIN", "nightly")
    } else {
        invocation.environment("RUSTC_BOOTSTRAP", "1")
    }
}

/// There is a nightly toolchain, and it is not older than the one that the rest of the suite uses.
fn nightly_is_usable(root: &Path) -> bool {
    let Ok(installed) = Invocation::new("rustup", "toolchain list").output(root) else { return false };
    if !installed.lines().any(|line| line.starts_with("nightly-")) {
        return false;
    }
    let rustc = Invocation::new("rustc", "-vV");
    let default = rustc.output(root).ok().and_then(|text| release(&text));
    let nightly =
        rustc.environment("RUSTUP_TOOLCHAIN", "nightly").output(root).ok().and_then(|text| release(&text));
    matches!((default, nightly), (Some(default), Some(nightly)) if nightly >= default)
}

/// Major and minor version in what `rustc -vV` prints.
fn release(version: &str) -> Option<(u32, u32)> {
    let release = version.lines().find_map(|line| line.strip_prefix("release: "))?;
    let mut numbers = release.split('.').map(str::parse::<u32>);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}
