//! Watches a bake: progress, whether the time is up, and how long each part takes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use ivg_bake::{BakeOptions, BakeStage, Estimator, Monitor};

use crate::progress::BakeBar;

/// The share of a time after which it is said that little is left.
const LITTLE_LEFT: f64 = 0.7;

/// Watches one bake.
#[derive(Debug)]
pub(crate) struct Watch {
    bar: BakeBar,
    /// When reading the scene began.
    start: Instant,
    /// How long everything may take since then \[s\].
    seconds: Option<f64>,
    /// Whether it has been said that the time is too short.
    warned: AtomicBool,
    stages: Mutex<Stages>,
}

#[derive(Debug, Default)]
struct Stages {
    times: Vec<StageTime>,
    /// The part under way, and wall and processor time when it began.
    now: Option<(BakeStage, Instant, Option<Duration>)>,
}

/// How long a part of a bake took, all its stretches together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StageTime {
    pub(crate) stage: BakeStage,
    pub(crate) wall: Duration,
    /// Processor time of all threads; `None` where the system does not tell.
    pub(crate) cpu: Option<Duration>,
}

impl StageTime {
    pub(crate) fn name(&self) -> &'static str {
        match self.stage {
            BakeStage::Preparation => "preparation",
            BakeStage::Photons => "photons",
            BakeStage::Gathering => "gathering",
        }
    }
}

impl Watch {
    /// Watches a bake of a scene whose reading began at `start`; all is to end after so many `seconds`.
    pub(crate) fn new(start: Instant, seconds: Option<f64>, options: &BakeOptions) -> Self {
        let (unit, total) = match options.estimator {
            Estimator::Gather => ("vertices", options.dims.iter().map(|&n| u64::from(n)).product()),
            _ => ("photons", options.photons),
        };
        Self {
            bar: BakeBar::new("bake", total, unit),
            start,
            seconds,
            warned: AtomicBool::new(false),
            stages: Mutex::default(),
        }
    }

    /// Ends the bar, and says how long each part took.
    pub(crate) fn finish(self) -> Vec<StageTime> {
        self.bar.finish();
        let mut stages = self.stages.into_inner().unwrap_or_else(PoisonError::into_inner);
        stages.end();
        stages.times
    }
}

impl Watch {
    /// Says, before the first photon or path, that there is little time left for them.
    fn warn_of_preparation(&self) {
        let Some(seconds) = self.seconds else { return };
        let taken = self.start.elapsed().as_secs_f64();
        if self.warned.swap(true, Ordering::Relaxed) || taken < LITTLE_LEFT * seconds {
            return;
        }
        let left = if taken < seconds {
            "little is left for light"
        } else {
            "the bake takes longer, and traces as little as it can"
        };
        eprintln!(
            "ivg: warning: reading and preparing the scene took {taken:.1} s of the {seconds} s of --time: {left}; a coarser --grid \
             takes less"
        );
    }
}

impl Stages {
    fn end(&mut self) {
        let Some((stage, wall, cpu)) = self.now.take() else { return };
        let cpu = cpu.zip(processor_time()).map(|(before, after)| after.saturating_sub(before));
        let time = StageTime { stage, wall: wall.elapsed(), cpu };
        match self.times.iter_mut().find(|time| time.stage == stage) {
            Some(sum) => {
                sum.wall += time.wall;
                sum.cpu = sum.cpu.zip(time.cpu).map(|(a, b)| a + b);
            }
            None => self.times.push(time),
        }
    }
}

impl Monitor for Watch {
    fn progress(&self, done: u64, total: u64) {
        self.bar.progress(done, total);
    }

    fn time_spent(&self) -> Option<f64> {
        self.seconds.map(|seconds| self.start.elapsed().as_secs_f64() / seconds)
    }

    fn stage(&self, stage: BakeStage) {
        if stage != BakeStage::Preparation {
            self.warn_of_preparation();
        }
        let mut stages = self.stages.lock().unwrap_or_else(PoisonError::into_inner);
        stages.end();
        stages.now = Some((stage, Instant::now(), processor_time()));
    }
}

/// Processor time that this process has taken, all threads together, where Linux tells: fields 14 and 15 of
/// `/proc/self/stat`, in hundredths of a second (proc(5)).
fn processor_time() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program, in brackets, may hold spaces.
    let (_, fields) = text.rsplit_once(')')?;
    let ticks: Vec<u64> = fields.split_whitespace().skip(11).take(2).filter_map(|f| f.parse().ok()).collect();
    (ticks.len() == 2).then(|| Duration::from_millis(10 * (ticks[0] + ticks[1])))
}
