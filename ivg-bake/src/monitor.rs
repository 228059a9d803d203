/// Follows a bake from outside: progress and cancellation.
///
/// Called from all worker threads. Nothing a monitor does changes a result, except that a cancelled bake has none.
pub trait Monitor: Sync {
    /// `done` of `total` photons have been traced. Called often, with `done` not always ascending between threads.
    fn progress(&self, done: u64, total: u64);

    /// Whether to stop; asked after every few thousand photons.
    fn cancelled(&self) -> bool {
        false
    }
}

/// A [`Monitor`] that shows nothing and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Monitor for Silent {
    fn progress(&self, _done: u64, _total: u64) {}
}
