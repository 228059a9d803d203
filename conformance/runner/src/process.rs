//! Starts a program, waits for it no longer than it may take, and keeps what it printed.

use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// How a program ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// With this exit status.
    Status(i32),
    /// Killed by a signal.
    Signal(i32),
    /// It did not end in time and was killed.
    Hung,
    /// It could not be started; what it complained of says why.
    NotStarted,
}

/// What a program did.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// The beginning of what it printed.
    pub stdout: String,
    /// The beginning of what it complained of.
    pub stderr: String,
}

/// What is kept of each of the two streams \[bytes\]; the rest is read and forgotten, so that no program waits for us.
const KEPT: usize = 64 << 10;

/// Runs `words` with an empty standard input.
#[must_use]
pub fn run(words: &[String], limit: Duration) -> Outcome {
    let not_started = |why: String| Outcome { end: End::NotStarted, stdout: String::new(), stderr: why };
    let Some((program, arguments)) = words.split_first() else { return not_started("no command".to_owned()) };
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // So that those that a script starts can be ended with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) => return not_started(error.to_string()),
    };
    let streams = (child.stdout.take(), child.stderr.take());
    let stdout = streams.0.map(|stream| thread::spawn(|| beginning(stream)));
    let stderr = streams.1.map(|stream| thread::spawn(|| beginning(stream)));
    let deadline = Instant::now() + limit;
    let mut pause = Duration::from_micros(200);
    let end = loop {
        match child.try_wait() {
            Ok(Some(status)) => {
                break status.code().map_or_else(|| End::Signal(signal(&status)), End::Status);
            }
            Ok(None) if Instant::now() < deadline => {
                thread::sleep(pause);
                pause = (pause * 2).min(Duration::from_millis(10));
            }
            waiting => {
                end_all(&mut child);
                break if waiting.is_ok() { End::Hung } else { End::NotStarted };
            }
        }
    };
    // Whom it started itself may keep the streams open after it was killed: then what they print is not waited for.
    let text = |stream: Option<thread::JoinHandle<String>>| match stream {
        Some(stream) if end != End::Hung || stream.is_finished() => stream.join().unwrap_or_default(),
        _ => String::new(),
    };
    Outcome { stdout: text(stdout), stderr: text(stderr), end }
}

/// Kills a program and those that it started. They may have ended in between, which is no harm.
fn end_all(child: &mut Child) {
    #[cfg(unix)]
    let _ = rustix::process::kill_process_group(
        rustix::process::Pid::from_child(child),
        rustix::process::Signal::KILL,
    );
    let _ = child.kill();
    let _ = child.wait();
}

#[cfg(unix)]
fn signal(status: &std::process::ExitStatus) -> i32 {
    std::os::unix::process::ExitStatusExt::signal(status).unwrap_or(0)
}

#[cfg(not(unix))]
fn signal(_: &std::process::ExitStatus) -> i32 {
    0
}

fn beginning(mut stream: impl Read) -> String {
    let mut kept = Vec::new();
    let mut block = [0; 4096];
    while let Ok(length @ 1..) = stream.read(&mut block) {
        let room = KEPT.saturating_sub(kept.len());
        kept.extend_from_slice(&block[..length.min(room)]);
    }
    String::from_utf8_lossy(&kept).into_owned()
}
