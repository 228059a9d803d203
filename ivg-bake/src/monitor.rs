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

    /// Whether to end early with the photons traced so far, as when a time is up; asked between batches of photons. The grid
    /// is then that of the number of photons that [`BakeStats`](crate::BakeStats) tells.
    fn enough(&self) -> bool {
        false
    }

    /// A part of the work begins. Called from one thread.
    fn stage(&self, _stage: BakeStage) {}
}

/// A part of the work of a bake.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BakeStage {
    /// Triangles sorted into a tree, what each vertex sees.
    Preparation,
    /// Photons traced and deposited.
    Photons,
    /// Light gathered at vertices by path tracing.
    Gathering,
}

/// A [`Monitor`] that shows nothing and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Monitor for Silent {
    fn progress(&self, _done: u64, _total: u64) {}
}
