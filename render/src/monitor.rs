//! How a caller watches long work, and ends it.

use crate::error::RenderError;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Watches work that takes long. Every method does nothing by default, and may be called from any thread.
///
/// This crate has no clock. A caller who wants times measures them: stages that run once are passed to [`Monitor::stage`];
/// stages that alternate on a thread are told apart by [`Monitor::start_lap`] and [`Monitor::lap`].
pub trait Monitor: Sync {
    /// Work of so many units begins: tiles of a picture ([`Prepared::draw`](crate::Prepared::draw)), positions and rounds of a bake
    /// ([`bake_probes`](crate::bake_probes), [`choose_places`](crate::choose_places)). [`look_all`](crate::look_all) and
    /// [`fingerprints`](crate::fingerprints()) leave the call to their caller and only advance.
    fn begin(&self, units: u64) {
        let _ = units;
    }

    /// So many more units are done.
    fn advance(&self, units: u64) {
        let _ = units;
    }

    /// Whether to stop; asked between stages, before every position that is looked from, and after every tile. The work then ends with [`crate::RenderError::Cancelled`].
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Runs a stage; must call `work` once.
    fn stage(&self, name: &'static str, work: &mut dyn FnMut()) {
        let _ = name;
        work();
    }

    /// The calling thread begins with work whose stages alternate.
    fn start_lap(&self) {}

    /// What the calling thread did since its last [`Monitor::start_lap`] or [`Monitor::lap`] was this stage.
    fn lap(&self, stage: &'static str) {
        let _ = stage;
    }

    /// So much more of something was processed.
    fn count(&self, what: &'static str, n: u64) {
        let _ = (what, n);
    }

    /// So much more of something was found not to matter.
    fn skip(&self, what: &'static str, n: u64) {
        let _ = (what, n);
    }
}

/// Watches nothing.
impl Monitor for () {}

/// Whether work is to go on.
pub(crate) fn go_on(monitor: &dyn Monitor) -> Result<(), RenderError> {
    if monitor.is_cancelled() { Err(RenderError::Cancelled) } else { Ok(()) }
}

/// [`Monitor::stage`] for work that gives something.
pub(crate) fn stage<T>(monitor: &dyn Monitor, name: &'static str, work: impl FnOnce() -> T) -> T {
    let (mut work, mut result) = (Some(work), None);
    monitor.stage(name, &mut || result = work.take().map(|work| work()));
    result.expect("Monitor::stage calls its work once")
}

/// Progress as a function that is called with units done and units in all, and a flag that ends the work.
///
/// ```
/// use pointillist_render::Watch;
/// use std::sync::atomic::AtomicBool;
///
/// let stop = AtomicBool::new(false);
/// let report = |done, total| eprintln!("{done} of {total}");
/// let watch = Watch::new().with_progress(&report).with_cancel(&stop);
/// # let _ = watch;
/// ```
#[derive(Default)]
pub struct Watch<'a> {
    progress: Option<&'a (dyn Fn(u64, u64) + Sync)>,
    cancel: Option<&'a AtomicBool>,
    done: AtomicU64,
    total: AtomicU64,
}

impl<'a> Watch<'a> {
    /// Tells nobody.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Calls a function with the units done and the units in all, from any thread.
    #[must_use]
    pub fn with_progress(mut self, progress: &'a (dyn Fn(u64, u64) + Sync)) -> Self {
        self.progress = Some(progress);
        self
    }

    /// Ends the work soon after the flag is set.
    #[must_use]
    pub fn with_cancel(mut self, cancel: &'a AtomicBool) -> Self {
        self.cancel = Some(cancel);
        self
    }

    fn tell(&self, done: u64) {
        if let Some(progress) = self.progress {
            progress(done, self.total.load(Ordering::Relaxed));
        }
    }
}

impl Monitor for Watch<'_> {
    fn begin(&self, units: u64) {
        self.total.store(units, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
        self.tell(0);
    }

    fn advance(&self, units: u64) {
        let before = self.done.fetch_add(units, Ordering::Relaxed);
        self.tell(before + units);
    }

    fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }
}

/// Forwards everything but progress: for a part of work whose units the caller counts.
pub(crate) struct Part<'a>(pub(crate) &'a dyn Monitor);

impl Monitor for Part<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }

    fn stage(&self, name: &'static str, work: &mut dyn FnMut()) {
        self.0.stage(name, work);
    }

    fn start_lap(&self) {
        self.0.start_lap();
    }

    fn lap(&self, stage: &'static str) {
        self.0.lap(stage);
    }

    fn count(&self, what: &'static str, n: u64) {
        self.0.count(what, n);
    }

    fn skip(&self, what: &'static str, n: u64) {
        self.0.skip(what, n);
    }
}
