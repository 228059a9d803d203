//! A program with its arguments, environment and folder, as a value that can be shown, compared and run.

use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

#[cfg(test)]
mod tests;

/// A command line to run. Shown, it is a line that can be pasted into a shell in the workspace folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invocation {
    program: String,
    arguments: Vec<String>,
    environment: Vec<(String, String)>,
    path_front: Option<PathBuf>,
}

impl Invocation {
    /// The program (looked up in `PATH`) and its arguments, separated by blanks; for an argument with a blank inside, use
    /// [`Invocation::argument`].
    #[must_use]
    pub fn new(program: &str, arguments: &str) -> Self {
        Self {
            program: program.to_owned(),
            arguments: arguments.split_whitespace().map(str::to_owned).collect(),
            environment: Vec::new(),
            path_front: None,
        }
    }

    /// `cargo` with these arguments.
    #[must_use]
    pub fn cargo(arguments: &str) -> Self {
        Self::new("cargo", arguments)
    }

    /// Adds arguments, separated by blanks.
    #[must_use]
    pub fn arguments(mut self, arguments: &str) -> Self {
        self.arguments.extend(arguments.split_whitespace().map(str::to_owned));
        self
    }

    /// Adds one argument, taken as it is.
    #[must_use]
    pub fn argument(mut self, argument: impl Into<String>) -> Self {
        self.arguments.push(argument.into());
        self
    }

    /// Sets an environment variable for the program.
    #[must_use]
    pub fn environment(mut self, name: &str, value: &str) -> Self {
        self.environment.push((name.to_owned(), value.to_owned()));
        self
    }

    /// Puts a folder (relative to the workspace) in front of the program's `PATH`.
    #[must_use]
    pub fn path_front(mut self, folder: &Path) -> Self {
        self.path_front = Some(folder.to_path_buf());
        self
    }

    /// Runs the program in `root` with the terminal as its output.
    ///
    /// # Errors
    ///
    /// When the program cannot be started or ends with another status than zero; the text names the command.
    pub fn run(&self, root: &Path) -> Result<(), String> {
        let status = self.command(root).status().map_err(|error| self.not_started(&error))?;
        if status.success() { Ok(()) } else { Err(format!("`{self}` ended with {status}")) }
    }

    /// Runs the program in `root` and returns what it writes to its standard output.
    ///
    /// # Errors
    ///
    /// As [`Invocation::run`]; the text then ends with what the program wrote to its standard error output.
    pub fn output(&self, root: &Path) -> Result<String, String> {
        let output =
            self.command(root).stdin(Stdio::null()).output().map_err(|error| self.not_started(&error))?;
        if output.status.success() {
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        } else {
            let said = String::from_utf8_lossy(&output.stderr);
            Err(format!("`{self}` ended with {}: {}", output.status, said.trim()))
        }
    }

    fn not_started(&self, error: &std::io::Error) -> String {
        format!("`{self}` cannot be started: {error}")
    }

    fn command(&self, root: &Path) -> Command {
        let mut command = Command::new(&self.program);
        command.args(&self.arguments).current_dir(root);
        // `cargo run` describes this crate to us in variables that dependencies' build scripts also read: passed on, they
        // would be built again after each plain `cargo build`.
        for (name, _) in std::env::vars_os() {
            let text = name.to_string_lossy();
            if text == "CARGO" || text.starts_with("CARGO_PKG_") || text.starts_with("CARGO_MANIFEST_") {
                command.env_remove(&name);
            }
        }
        if let Some(folder) = &self.path_front {
            let rest = std::env::var_os("PATH").unwrap_or_default();
            let folders = std::iter::once(root.join(folder)).chain(std::env::split_paths(&rest));
            // A folder with a separator in its name cannot stand in PATH; the tool is then looked up as before.
            if let Ok(path) = std::env::join_paths(folders) {
                command.env("PATH", path);
            }
        }
        command.envs(self.environment.iter().map(|(name, value)| (name, value)));
        command
    }
}

impl fmt::Display for Invocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(folder) = &self.path_front {
            write!(f, "PATH={}:$PATH ", folder.display())?;
        }
        for (name, value) in &self.environment {
            write!(f, "{name}={} ", quoted(value))?;
        }
        f.write_str(&quoted(&self.program))?;
        self.arguments.iter().try_for_each(|argument| write!(f, " {}", quoted(argument)))
    }
}

/// The text as one word of a POSIX shell.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_=./:,+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}
