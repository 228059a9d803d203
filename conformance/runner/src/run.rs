//! Runs tests on a decoder.

use crate::capabilities::{Capabilities, Plan};
use crate::layout;
use crate::manifest::{Form, Op, Suite, Test, Verdict};
use crate::process::{self, End, Outcome};
use crate::{sha256, words};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// What to run, and how.
#[derive(Debug, Clone)]
pub struct Options {
    /// The command of the adapter.
    pub decoder: String,
    /// Only tests whose id fits this pattern ([`words::fits`]).
    pub only: Option<String>,
    /// Patterns of tests to leave out.
    pub skip: Vec<String>,
    /// How many tests at a time.
    pub jobs: usize,
    /// How long a test may take.
    pub limit: Duration,
}

/// How long a test may take, and how much longer a table of many megabytes.
pub const LIMIT: Duration = Duration::from_secs(10);
const TABLES_TAKE: u32 = 6;

/// After so many tests without an answer nothing more is started.
const HANGS: usize = 3;

/// How a test went.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// As it must.
    Passed,
    /// Not as it must.
    Failed,
    /// The decoder does not claim to have what it takes.
    NotClaimed,
    /// Left out by the user.
    Skipped,
}

/// How a test went, and why.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Answer {
    /// The test.
    pub id: String,
    /// How it went.
    pub status: Status,
    /// What must come: verdicts, and the code if it is compared.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub expected: String,
    /// What came.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub found: String,
    /// For a failed test, in what it differs.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub detail: String,
    /// What a failed test shows.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub why: String,
    /// The clauses that a failed test is about.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub clauses: Vec<String>,
    /// The beginning of what it printed on standard error.
    #[serde(skip)]
    pub stderr: String,
}

/// How all tests went, in the order of the manifest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Results {
    /// What the decoder calls itself, or its command.
    pub decoder: String,
    /// One for each test that was asked for.
    pub answers: Vec<Answer>,
    /// How long it took.
    pub took: Duration,
}

impl Results {
    /// How many tests went so.
    #[must_use]
    pub fn count(&self, status: Status) -> usize {
        self.answers.iter().filter(|answer| answer.status == status).count()
    }
}

/// Runs the tests of a suite.
///
/// # Errors
///
/// The command cannot be split, no test fits, or there is no room for files; one line that says which.
pub fn run(suite: &Suite, options: &Options) -> Result<Results, String> {
    let command = words::split(&options.decoder)?;
    let began = Instant::now();
    let chosen: Vec<&Test> = suite
        .manifest
        .tests
        .iter()
        .filter(|test| options.only.as_ref().is_none_or(|pattern| words::fits(pattern, &test.id)))
        .collect();
    if chosen.is_empty() {
        return Err("no test fits".to_owned());
    }
    let folder = tempfile::tempdir().map_err(|error| format!("no folder for files: {error}"))?;
    let asked = process::run(&[&command[..], &["capabilities".to_owned()]].concat(), options.limit);
    let capabilities = match asked.end {
        End::Status(0) => Capabilities::parse(&asked.stdout),
        _ => Capabilities::default(),
    };
    let hangs = AtomicUsize::new(usize::from(asked.end == End::Hung));
    let next = AtomicUsize::new(0);
    let answers: Mutex<Vec<Option<Answer>>> = Mutex::new(vec![None; chosen.len()]);
    thread::scope(|scope| {
        for _ in 0..options.jobs.clamp(1, 64) {
            scope.spawn(|| {
                loop {
                    let n = next.fetch_add(1, Ordering::Relaxed);
                    let Some(test) = chosen.get(n) else { return };
                    let out = folder.path().join(format!("out-{n}"));
                    let session = Session {
                        suite,
                        options,
                        command: &command,
                        capabilities: &capabilities,
                        hangs: &hangs,
                    };
                    let answer = session.answer(test, &out);
                    // It may not have been written.
                    let _ = std::fs::remove_file(&out);
                    if let Ok(mut answers) = answers.lock() {
                        answers[n] = Some(answer);
                    }
                }
            });
        }
    });
    let answers = answers.into_inner().unwrap_or_default().into_iter().flatten().collect();
    let decoder = capabilities.name().unwrap_or_else(|| options.decoder.clone());
    Ok(Results { decoder, answers, took: began.elapsed() })
}

/// What all tests of a run share.
struct Session<'a> {
    suite: &'a Suite,
    options: &'a Options,
    command: &'a [String],
    capabilities: &'a Capabilities,
    hangs: &'a AtomicUsize,
}

impl Session<'_> {
    fn answer(&self, test: &Test, out: &Path) -> Answer {
        let bare = |status| Answer {
            id: test.id.clone(),
            status,
            expected: String::new(),
            found: String::new(),
            detail: String::new(),
            why: String::new(),
            clauses: Vec::new(),
            stderr: String::new(),
        };
        let failed =
            || Answer { why: test.why.clone(), clauses: test.clauses.clone(), ..bare(Status::Failed) };
        if self.options.skip.iter().any(|pattern| words::fits(pattern, &test.id)) {
            return bare(Status::Skipped);
        }
        let Plan::Run { verdicts, code, out: compared } = self.capabilities.plan(test) else {
            return bare(Status::NotClaimed);
        };
        let names: Vec<&str> = verdicts.iter().map(|verdict| verdict.name()).collect();
        let expected = match code {
            Some(code) => format!("{} {code}", names.join(" or ")),
            None => names.join(" or "),
        };
        if self.hangs.load(Ordering::Relaxed) >= HANGS {
            let detail = format!("not started: the decoder gave no answer {HANGS} times");
            return Answer { expected, detail, ..failed() };
        }
        let outcome = self.start(test, out);
        if outcome.end == End::Hung {
            self.hangs.fetch_add(1, Ordering::Relaxed);
        }
        let (found, verdict, printed) = seen(&outcome);
        let shown = matches!(verdict, Some(Verdict::Ok | Verdict::NeedMore));
        let detail = match verdict {
            None => found.clone(),
            Some(verdict) if !verdicts.contains(&verdict) => format!("expected {expected}, found {found}"),
            Some(_) if shown && !out.exists() => "OUT was not written".to_owned(),
            // Another verdict that is right too has no code of ours, and another state.
            Some(verdict) if verdict != test.verdict => String::new(),
            Some(_) => match code {
                Some(code) if printed.is_none() => {
                    format!("expected the code {code}, found no code on standard output")
                }
                Some(code) if printed != Some(u32::from(code)) => {
                    format!("expected {expected}, found {found}")
                }
                _ if compared => self.compare(test, out).unwrap_or_else(|error| error),
                _ => String::new(),
            },
        };
        let base = if detail.is_empty() { bare(Status::Passed) } else { failed() };
        Answer { expected, found, detail, stderr: outcome.stderr, ..base }
    }

    fn start(&self, test: &Test, out: &Path) -> Outcome {
        let input = test.file.as_ref().map(|file| self.suite.folder.join(file));
        let input = input.unwrap_or_default();
        let arguments = test.arguments(&input.to_string_lossy(), &out.to_string_lossy());
        let limit = self.options.limit * if test.op == Op::Numeric { TABLES_TAKE } else { 1 };
        process::run(&[self.command, &arguments].concat(), limit)
    }

    /// In what OUT differs; nothing if it does not.
    fn compare(&self, test: &Test, out: &Path) -> Result<String, String> {
        let Some(expected) = &test.out else { return Ok(String::new()) };
        let file = File::open(out).map_err(|error| format!("OUT: {error}"))?;
        if expected.form == Form::Rows {
            let rows =
                self.suite.read(&expected.file).map_err(|error| format!("{}: {error}", expected.file))?;
            return compare_rows(file, &rows, expected.bytes).map_err(|error| format!("OUT: {error}"));
        }
        let mut found = Vec::new();
        // What is longer differs; a byte more is enough to say so.
        let most = expected.bytes + 1;
        file.take(most).read_to_end(&mut found).map_err(|error| format!("OUT: {error}"))?;
        if sha256(&found) == expected.sha256 {
            return Ok(String::new());
        }
        let whole = self.suite.expected(expected)?.unwrap_or_default();
        Ok(layout::difference(test, &whole, &found).unwrap_or_else(|| "the suite is damaged".to_owned()))
    }
}

/// The first row of a table whose hash is another.
fn compare_rows(file: File, hashes: &[u8], bytes: u64) -> io::Result<String> {
    let found = file.metadata()?.len();
    if found != bytes {
        return Ok(format!("OUT has {found} bytes, expected {bytes}"));
    }
    let rows = hashes.len() / 8;
    let mut row = vec![0; usize::try_from(bytes).unwrap_or(0) / rows.max(1)];
    let mut reader = BufReader::with_capacity(1 << 20, file);
    for (n, hash) in hashes.chunks_exact(8).enumerate() {
        reader.read_exact(&mut row)?;
        if Sha256::digest(&row)[..8] != *hash {
            let at = n * row.len();
            return Ok(format!("row {n} of {rows} differs (bytes {at} to {})", at + row.len() - 1));
        }
    }
    Ok(String::new())
}

/// What came, its verdict, and the code that was printed.
fn seen(outcome: &Outcome) -> (String, Option<Verdict>, Option<u32>) {
    let status = match &outcome.end {
        End::Status(status) => *status,
        End::Signal(signal) => return (format!("killed by signal {signal}"), None, None),
        End::Hung => return ("no answer in time".to_owned(), None, None),
        End::NotStarted => return ("could not be started".to_owned(), None, None),
    };
    let Some(verdict) = Verdict::from_status(status) else {
        return (format!("exit status {status}, which is no verdict"), None, None);
    };
    if !matches!(verdict, Verdict::Invalid | Verdict::Unsupported | Verdict::Limit) {
        return (verdict.name().to_owned(), Some(verdict), None);
    }
    let mut numbers = outcome.stdout.lines().next().unwrap_or("").split_whitespace();
    let code: Option<u32> = numbers.next().and_then(|number| number.parse().ok());
    let offset: Option<u64> = numbers.next().and_then(|number| number.parse().ok());
    let mut found = verdict.name().to_owned();
    found.extend(code.map(|code| format!(" {code}")));
    found.extend(code.and(offset).map(|offset| format!(" at {offset}")));
    (found, Some(verdict), code)
}
