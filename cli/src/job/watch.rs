//! The renderer's monitor: what is done goes to the progress bar and to `--stats`.

use super::{Progress, Stats, interrupt};
use pointillist_render::Monitor;

/// Statistics alone, for work that is done before its size is known.
impl Monitor for Stats {
    fn stage(&self, name: &'static str, work: &mut dyn FnMut()) {
        Self::stage(self, name, work);
    }

    fn start_lap(&self) {
        Self::start_lap();
    }

    fn lap(&self, stage: &'static str) {
        Self::lap(self, stage);
    }

    fn count(&self, what: &'static str, n: u64) {
        Self::count(self, what, n);
    }

    fn skip(&self, what: &'static str, n: u64) {
        Self::skip(self, what, n);
    }
}

/// Statistics and progress.
#[derive(Clone, Copy, Debug)]
pub struct Watch<'a> {
    /// The name of the work on the progress bar.
    pub task: &'static str,
    /// How far it is.
    pub progress: &'a Progress,
    /// What it takes.
    pub stats: &'a Stats,
}

impl Monitor for Watch<'_> {
    fn begin(&self, units: u64) {
        self.progress.begin(self.task, units);
    }

    fn advance(&self, units: u64) {
        self.progress.advance(units);
    }

    fn is_cancelled(&self) -> bool {
        interrupt::is_requested()
    }

    fn stage(&self, name: &'static str, work: &mut dyn FnMut()) {
        self.stats.stage(name, work);
    }

    fn start_lap(&self) {
        Stats::start_lap();
    }

    fn lap(&self, stage: &'static str) {
        self.stats.lap(stage);
    }

    fn count(&self, what: &'static str, n: u64) {
        self.stats.count(what, n);
    }

    fn skip(&self, what: &'static str, n: u64) {
        self.stats.skip(what, n);
    }
}
