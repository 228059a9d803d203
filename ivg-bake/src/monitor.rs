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

    /// The share of the time that the bake may take that has passed, 1 when it is up; `None`: it may take what it needs. A bake
    /// with little time keeps some of it for measuring how far off it is.
    fn time_spent(&self) -> Option<f64> {
        None
    }

    /// Whether to end early with what there is, as when a time is up; asked between batches of photons and between the
    /// vertices that light is gathered at. The grid is then that of the number of photons that
    /// [`BakeStats`](crate::BakeStats) tells.
    fn enough(&self) -> bool {
        self.time_spent().is_some_and(|share| share >= 1.0)
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
