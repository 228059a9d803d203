//! Runs a list of steps in order, stops at the first failure, and sums up.

use crate::invocation::Invocation;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[cfg(test)]
mod tests;

/// Where steps run and what they learnt of each other.
#[derive(Debug)]
pub struct Context {
    root: PathBuf,
    environment: Vec<(&'static str, &'static str)>,
}

impl Context {
    /// Steps run in this folder, the workspace's.
    #[must_use]
    pub fn new(root: PathBuf) -> Self {
        Self { root, environment: Vec::new() }
    }

    /// Sets an environment variable for every program that steps run, unless the person who started us set it.
    #[must_use]
    pub fn environment(mut self, name: &'static str, value: &'static str) -> Self {
        if std::env::var_os(name).is_none() {
            self.environment.push((name, value));
        }
        self
    }

    /// The folder of the workspace.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Shows the command on standard output and runs it.
    ///
    /// # Errors
    ///
    /// When it cannot be started or fails; the text names the command.
    pub fn run(&self, invocation: &Invocation) -> Result<(), String> {
        let invocation = self
            .environment
            .iter()
            .fold(invocation.clone(), |invocation, (name, value)| invocation.environment(name, value));
        println!("$ {invocation}");
        invocation.run(&self.root)
    }
}

/// A function that is part of a step; the error text says what is wrong and what to do.
pub type Check = Box<dyn Fn(&mut Context) -> Result<(), String>>;

/// One thing that a step does.
pub enum Action {
    /// Runs a program.
    Run(Invocation),
    /// Calls a function of ours; the text describes it in `--list`.
    Call(&'static str, Check),
}

impl fmt::Debug for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Run(invocation) => write!(f, "$ {invocation}"),
            Self::Call(description, _) => write!(f, "({description})"),
        }
    }
}

/// A named part of the suite. It passes when all its actions do.
#[derive(Debug)]
pub struct Step {
    /// What a person calls it, in a few words.
    pub name: &'static str,
    /// What it does, in order.
    pub actions: Vec<Action>,
}

/// How a step ended.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Outcome {
    Passed(Duration),
    Failed(Duration, String),
    NotRun,
}

/// Names the steps and what they do, and says that this went well.
///
/// # Errors
///
/// When `out` cannot be written.
pub fn list(steps: &[Step], out: &mut dyn Write) -> io::Result<bool> {
    for step in steps {
        writeln!(out, "{}", step.name)?;
        for action in &step.actions {
            writeln!(out, "    {action}")?;
        }
    }
    Ok(true)
}

/// Runs the steps in order until one fails, with a heading for each and a table with times at the end, whose last line is
/// `N passed, N failed`. True when all passed.
///
/// # Errors
///
/// When `out` cannot be written.
pub fn run(steps: &[Step], context: &mut Context, out: &mut dyn Write) -> io::Result<bool> {
    let mut outcomes = Vec::with_capacity(steps.len());
    let mut failed = false;
    for (number, step) in (1..).zip(steps) {
        if failed {
            outcomes.push(Outcome::NotRun);
            continue;
        }
        writeln!(out, "\n=== {number}/{}: {}", steps.len(), step.name)?;
        out.flush()?;
        let start = Instant::now();
        let result = step.actions.iter().try_for_each(|action| match action {
            Action::Run(invocation) => context.run(invocation),
            Action::Call(_, function) => function(context),
        });
        let elapsed = start.elapsed();
        match result {
            Ok(()) => {
                writeln!(out, "=== {}: passed in {}", step.name, seconds(elapsed))?;
                outcomes.push(Outcome::Passed(elapsed));
            }
            Err(reason) => {
                failed = true;
                writeln!(out, "=== {}: FAILED after {}", step.name, seconds(elapsed))?;
                outcomes.push(Outcome::Failed(elapsed, reason));
            }
        }
    }
    summarise(steps, &outcomes, out)?;
    Ok(!failed)
}

fn summarise(steps: &[Step], outcomes: &[Outcome], out: &mut dyn Write) -> io::Result<()> {
    let width = steps.iter().map(|step| step.name.chars().count()).max().unwrap_or(0);
    writeln!(out, "\n=== summary")?;
    for (step, outcome) in steps.iter().zip(outcomes) {
        let (word, time) = match outcome {
            Outcome::Passed(time) => ("passed", seconds(*time)),
            Outcome::Failed(time, _) => ("FAILED", seconds(*time)),
            Outcome::NotRun => ("not run", String::new()),
        };
        writeln!(out, "{:width$}  {word:7} {time:>9}", step.name)?;
    }
    for outcome in outcomes {
        if let Outcome::Failed(_, reason) = outcome {
            writeln!(out, "\nfailed: {reason}")?;
        }
    }
    let passed = outcomes.iter().filter(|outcome| matches!(outcome, Outcome::Passed(_))).count();
    let failed = outcomes.iter().filter(|outcome| matches!(outcome, Outcome::Failed(..))).count();
    writeln!(out, "{passed} passed, {failed} failed")?;
    out.flush()
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}
