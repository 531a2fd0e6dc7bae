//! The renderer's monitor: what is done goes to the progress bar and to `--stats`.

use super::{Progress, Stats, interrupt};
use pointillist_render::Monitor;
use std::sync::atomic::{AtomicU64, Ordering};

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

/// One of several pieces of work that are alike and share a progress bar, such as the frames of a film: to be announced as [`Piece::UNITS`]
/// for each of them.
#[derive(Debug)]
pub struct Piece<'a> {
    watch: Watch<'a>,
    /// Pieces that are finished.
    before: u64,
    /// Of how many.
    count: u64,
    total: AtomicU64,
    done: AtomicU64,
}

impl<'a> Piece<'a> {
    /// Units of the progress bar for each piece.
    pub const UNITS: u64 = 1000;

    /// The piece after so many of so many.
    #[must_use]
    pub fn new(watch: Watch<'a>, before: u64, count: u64) -> Self {
        Self { watch, before, count, total: AtomicU64::new(0), done: AtomicU64::new(0) }
    }
}

impl Monitor for Piece<'_> {
    fn begin(&self, units: u64) {
        self.total.store(units, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    fn advance(&self, units: u64) {
        let done = self.done.fetch_add(units, Ordering::Relaxed) + units;
        let share = done as f64 / self.total.load(Ordering::Relaxed).max(1) as f64;
        self.watch.progress.reach((self.before as f64 + share) / self.count as f64);
    }

    fn is_cancelled(&self) -> bool {
        self.watch.is_cancelled()
    }

    fn stage(&self, name: &'static str, work: &mut dyn FnMut()) {
        self.watch.stage(name, work);
    }

    fn start_lap(&self) {
        self.watch.start_lap();
    }

    fn lap(&self, stage: &'static str) {
        self.watch.lap(stage);
    }

    fn count(&self, what: &'static str, n: u64) {
        self.watch.count(what, n);
    }

    fn skip(&self, what: &'static str, n: u64) {
        self.watch.skip(what, n);
    }
}
