//! Progress bars for work that takes over a second; nothing is shown when stderr is not a terminal.

use std::cell::RefCell;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

/// How often a bar may be redrawn.
const REDRAW: Duration = Duration::from_millis(100);

/// A bar that counts `unit`s, with a rate and the time left.
pub(crate) fn counter(message: &str, total: u64, unit: &str) -> ProgressBar {
    let bar = ProgressBar::new(total);
    bar.set_style(style(&format!(
        "{{msg:14}} [{{bar:32}}] {{human_pos}}/{{human_len}} {unit}  {{per_sec}}  {{eta}} left"
    )));
    bar.set_message(message.to_owned());
    bar
}

/// A bar from 0 to 100 %.
pub(crate) fn percent(message: &str) -> ProgressBar {
    let bar = ProgressBar::new(1000);
    bar.set_style(style("{msg:14} [{bar:32}] {percent} %  {eta} left"));
    bar.set_message(message.to_owned());
    bar
}

/// A bar that shows how long something takes already, of which nobody knows how much is done.
pub(crate) fn working(message: &str) -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    bar.set_style(style("{msg:14} {spinner} {elapsed}"));
    bar.set_message(message.to_owned());
    bar.enable_steady_tick(REDRAW);
    bar
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template)
        .map_or_else(|_| ProgressStyle::default_bar(), |s| s.progress_chars("=> "))
}

/// Shows the progress of photons or paths.
#[derive(Debug)]
pub(crate) struct BakeBar {
    bar: ProgressBar,
    last: AtomicU64,
}

impl BakeBar {
    pub(crate) fn new(message: &str, total: u64, unit: &str) -> Self {
        Self { bar: counter(message, total, unit), last: AtomicU64::new(0) }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl ivg_bake::Monitor for BakeBar {
    fn progress(&self, done: u64, total: u64) {
        // Several threads report; the bar shows the largest count it was told.
        if self.last.fetch_max(done, Ordering::Relaxed) < done {
            // A bake to an accuracy finds out on its way how many photons it takes.
            if self.bar.length() != Some(total) {
                self.bar.set_length(total);
            }
            self.bar.set_position(done);
        }
    }
}

/// Shows fractions in [0, 1] reported by one thread.
#[derive(Debug)]
pub(crate) struct FractionBar {
    bar: ProgressBar,
    shown: RefCell<std::time::Instant>,
}

impl FractionBar {
    pub(crate) fn new(message: &str) -> Self {
        Self { bar: percent(message), shown: RefCell::new(std::time::Instant::now()) }
    }

    pub(crate) fn set(&self, fraction: f32) {
        let mut shown = self.shown.borrow_mut();
        if shown.elapsed() >= REDRAW {
            *shown = std::time::Instant::now();
            self.bar.set_position((f64::from(fraction) * 1000.0) as u64);
        }
    }

    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// One line on stderr about a step that is done; only where somebody watches.
pub(crate) fn say(line: &str) {
    if std::io::IsTerminal::is_terminal(&std::io::stderr()) {
        eprintln!("{line}");
    }
}
