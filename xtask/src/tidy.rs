//! What no compiler checks: files stay short, nothing is left half done, no path of somebody's machine is in the sources,
//! README and CI name the same commands, every table of the specification is held against the code.

use crate::runner::{Action, Context, Step};
use std::path::{Path, PathBuf};

#[cfg(test)]
mod tests;

/// Lines that a source file may have at most; files of tests may have more.
const LONGEST_FILE: usize = 600;
/// Lines that a `lib.rs` may have at most: documentation, modules, re-exports.
const LONGEST_LIB: usize = 200;
/// Files that may be longer than [`LONGEST_FILE`], each with its reason.
const LONG_FILES: &[(&str, &str)] = &[
    ("conformance/run.py", "a program that is copied as one file"),
    ("conformance/ports/c/ivg.h", "a library that is copied as one file"),
    ("conformance/ports/c/pmesh.h", "a library that is copied as one file"),
    ("spec/tables/clauses.toml", "a list: one entry for each clause, with its tests"),
    ("spec/tables/clauses-pmesh.toml", "a list: one entry for each clause, with its tests"),
    ("spec/tables/errors.toml", "a list: one entry for each error code"),
];
/// Extensions of files that people write code or text in.
const SOURCES: [&str; 11] = ["rs", "wgsl", "md", "toml", "sh", "py", "js", "ts", "c", "h", "yml"];
/// What may not be left in the sources. In pieces, so that this file does not contain them.
const LEFT_OVERS: [&str; 3] = [concat!("TO", "DO"), concat!("FIX", "ME"), concat!("dbg", "!(")];
/// First folders of absolute paths that exist on one machine only.
const MACHINE_FOLDERS: [&str; 3] = ["work", "root", "farm"];

/// The step of the suite.
#[must_use]
pub fn step() -> Step {
    let action = Action::Call(
        "file lengths, left-over markers, machine paths, README and CI, tables",
        Box::new(check),
    );
    Step { name: "tidy", actions: vec![action] }
}

/// A file of the repository that is text.
struct Source {
    /// Relative to the workspace, with `/` between the parts.
    path: String,
    text: String,
}

/// Looks at every file of the workspace that git would not ignore.
///
/// # Errors
///
/// All that is wrong, one line each, or that a file cannot be read.
fn check(context: &mut Context) -> Result<(), String> {
    let root = context.root();
    let sources = read_sources(root)?;
    let text_of = |path: &str| {
        std::fs::read_to_string(root.join(path)).map_err(|error| format!("cannot read {path}: {error}"))
    };
    let mut problems: Vec<String> = sources.iter().flat_map(problems_of).collect();
    problems.extend(stale_exceptions(LONG_FILES, &sources));
    problems.extend(undocumented_commands(&text_of(".ci/run")?, &text_of("README.md")?));
    problems.extend(unreferenced_tables(&sources));
    println!("{} files looked at", sources.len());
    if problems.is_empty() { Ok(()) } else { Err(format!("tidy:\n  {}", problems.join("\n  "))) }
}

fn problems_of(source: &Source) -> Vec<String> {
    let mut problems = Vec::new();
    let name = source.path.rsplit('/').next().unwrap_or_default();
    let longest = if name == "lib.rs" { LONGEST_LIB } else { LONGEST_FILE };
    let lines = source.text.lines().count();
    let excepted = LONG_FILES.iter().any(|(path, _)| *path == source.path);
    let is_code =
        SOURCES.iter().any(|extension| *extension != "md" && name.ends_with(&format!(".{extension}")));
    if is_code && lines > longest && !excepted && !is_test(&source.path) {
        problems.push(format!("{}: {lines} lines, at most {longest}", source.path));
    }
    for (number, line) in (1..).zip(source.text.lines()) {
        if let Some(marker) = LEFT_OVERS.iter().find(|marker| has_marker(line, marker)) {
            problems.push(format!("{}:{number}: left over: {marker}", source.path));
        }
        if let Some(path) = machine_path(line) {
            problems.push(format!("{}:{number}: path of one machine: {path}", source.path));
        }
    }
    problems
}

/// Tests lie in `tests/`, `tests.rs` or `…_tests.rs`.
fn is_test(path: &str) -> bool {
    path.split('/').any(|part| part == "tests" || part == "tests.rs" || part.ends_with("_tests.rs"))
}

/// The line has the marker as a word of its own.
fn has_marker(line: &str, marker: &str) -> bool {
    line.match_indices(marker).any(|(start, _)| {
        let word = |c: char| c.is_alphanumeric() || c == '_';
        let end = start + marker.len();
        !line[..start].ends_with(word) && (marker.ends_with('(') || !line[end..].starts_with(word))
    })
}

/// The first absolute path in the line that only one machine has.
fn machine_path(line: &str) -> Option<&str> {
    MACHINE_FOLDERS.iter().find_map(|folder| {
        let pattern = format!("/{folder}/");
        line.match_indices(&pattern).find_map(|(start, _)| {
            let part_of_longer = |c: char| c.is_alphanumeric() || "._-~/*}".contains(c);
            let rest = &line[start..];
            let end = rest.find(|c: char| c.is_whitespace() || "\"'`)>".contains(c)).unwrap_or(rest.len());
            (!line[..start].ends_with(part_of_longer)).then_some(&rest[..end])
        })
    })
}

/// Exceptions that are no longer needed.
fn stale_exceptions(exceptions: &[(&str, &str)], sources: &[Source]) -> Vec<String> {
    let needed = |path: &str| {
        sources.iter().any(|source| source.path == path && source.text.lines().count() > LONGEST_FILE)
    };
    let stale = exceptions.iter().filter(|(path, _)| !needed(path));
    stale.map(|(path, _)| format!("{path}: excepted from the longest length without need")).collect()
}

/// Commands that CI runs and the README does not name in a block of code.
fn undocumented_commands(ci: &str, readme: &str) -> Vec<String> {
    let mut in_block = false;
    let mut documented = Vec::new();
    for line in readme.lines() {
        if line.trim_start().starts_with("```") {
            in_block = !in_block;
        } else if in_block {
            documented.push(without_comment(line));
        }
    }
    let commands = ci.lines().map(without_comment).filter(|line| !line.is_empty());
    let commands = commands.filter(|line| !line.starts_with("set ") && !line.starts_with("cd "));
    let commands: Vec<&str> = commands.map(|line| line.strip_prefix("exec ").unwrap_or(line)).collect();
    let mut problems: Vec<String> = commands
        .iter()
        .filter(|command| !documented.contains(command))
        .map(|command| format!("README.md: does not have the command that CI runs: {command}"))
        .collect();
    if commands.is_empty() {
        problems.push(".ci/run: runs nothing".to_owned());
    }
    problems
}

/// The line up to a `#` that begins a word, without blanks at its ends.
fn without_comment(line: &str) -> &str {
    let end = if line.starts_with('#') { Some(0) } else { line.find(" #") };
    line[..end.unwrap_or(line.len())].trim()
}

/// Tables of the specification that no Rust file names: nothing then holds the code against them.
fn unreferenced_tables(sources: &[Source]) -> Vec<String> {
    let tables = sources.iter().filter_map(|source| source.path.strip_prefix("spec/tables/"));
    let named = |table: &str| {
        sources
            .iter()
            .any(|source| source.path.ends_with(".rs") && source.text.contains(&format!("tables/{table}")))
    };
    tables
        .filter(|table| !named(table))
        .map(|table| format!("spec/tables/{table}: no Rust file reads it"))
        .collect()
}

/// All files with text that a person wrote, in order of their paths, without what `.gitignore` names and without `.git`.
fn read_sources(root: &Path) -> Result<Vec<Source>, String> {
    let ignore = std::fs::read_to_string(root.join(".gitignore"))
        .map_err(|error| format!("cannot read .gitignore: {error}"))?;
    let mut ignored = ignored_paths(root, &ignore)?;
    ignored.push(root.join(".git"));
    let mut sources = Vec::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        let failed = |error| format!("cannot read {}: {error}", folder.display());
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if ignored.contains(&path) || path.is_symlink() {
                continue;
            }
            if path.is_dir() {
                folders.push(path);
            } else if is_source(root, &path) {
                let text = std::fs::read_to_string(&path)
                    .map_err(|error| format!("cannot read {}: {error}", path.display()))?;
                sources.push(Source { path: relative(root, &path), text });
            }
        }
    }
    sources.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(sources)
}

fn is_source(root: &Path, path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|extension| SOURCES.contains(&extension))
        || path.parent() == Some(&root.join(".ci"))
}

fn relative(root: &Path, path: &Path) -> String {
    let path = path.strip_prefix(root).unwrap_or(path);
    path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// The paths that `.gitignore` names. Only the form that this repository uses is understood: one path from the root in each
/// line.
fn ignored_paths(root: &Path, ignore: &str) -> Result<Vec<PathBuf>, String> {
    let lines = ignore.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines
        .map(|line| match line.strip_prefix('/') {
            Some(path) if !path.contains(['*', '?', '[', '!']) => Ok(root.join(path.trim_end_matches('/'))),
            _ => Err(format!(".gitignore: {line:?} is not a path from the root, like /target")),
        })
        .collect()
}
