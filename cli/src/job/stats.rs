//! What a run took and how much it did: `--stats`.

use super::Expected;
use cpu_time::{ProcessTime, ThreadTime};
use serde::Serialize;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Whether this program was compiled for debugging, with checks and without optimisation.
pub const IS_DEBUG_BUILD: bool = cfg!(debug_assertions);

thread_local! {
    /// When the lap of this thread began.
    static LAP: Cell<Option<ThreadTime>> = const { Cell::new(None) };
}

/// Collects seconds and counts of a run, from any thread.
///
/// A stage that runs once is wrapped in [`Stats::stage`]. Stages that alternate inside parallel work are
/// booked lap by lap on each thread ([`Stats::lap`]); their wall seconds are then their share of processor time, which
/// the caller adds with [`Stats::add_wall`] if it knows better.
#[derive(Debug)]
pub struct Stats {
    start: Instant,
    cpu_start: Option<ProcessTime>,
    record: Mutex<Record>,
}

#[derive(Clone, Debug, Default, Serialize)]
struct Record {
    seconds: BTreeMap<String, f64>,
    cpu_seconds: BTreeMap<String, f64>,
    counts: BTreeMap<String, u64>,
    skipped: BTreeMap<String, u64>,
    #[serde(flatten)]
    figures: BTreeMap<String, f64>,
    peak_bytes: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    expected: Option<Expected>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame_ms: Option<FrameTimes>,
    #[serde(skip_serializing_if = "Option::is_none")]
    frame_cpu_ms: Option<FrameTimes>,
    /// Whether it was not optimised: its seconds are not those of the program that people install.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    debug_build: bool,
    #[serde(skip)]
    frames: Vec<(Duration, Duration)>,
}

/// Milliseconds of one frame of `--repeat`.
#[derive(Clone, Copy, Debug, Serialize)]
struct FrameTimes {
    min: f64,
    median: f64,
}

impl FrameTimes {
    fn of(times: impl Iterator<Item = Duration>) -> Option<Self> {
        let mut ms: Vec<f64> = times.map(|t| t.as_secs_f64() * 1e3).collect();
        ms.sort_by(f64::total_cmp);
        Some(Self { min: *ms.first()?, median: ms[ms.len() / 2] })
    }
}

impl Default for Stats {
    fn default() -> Self {
        Self::new()
    }
}

impl Stats {
    /// Starts the total.
    pub fn new() -> Self {
        Self { start: Instant::now(), cpu_start: ProcessTime::try_now().ok(), record: Mutex::default() }
    }

    /// Runs `work` and books its wall time and the processor time of all threads under `name`.
    pub fn stage<T>(&self, name: &str, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), ProcessTime::try_now().ok());
        let result = work();
        self.add_wall(name, wall.elapsed());
        self.add_cpu(name, cpu.and_then(|start| start.try_elapsed().ok()).unwrap_or_default());
        result
    }

    /// The calling thread begins with work whose stages alternate.
    pub fn start_lap() {
        LAP.set(ThreadTime::try_now().ok());
    }

    /// Books the calling thread's processor time since its last [`Stats::start_lap`] or [`Stats::lap`].
    pub fn lap(&self, name: &str) {
        let used = LAP.get().and_then(|start| start.try_elapsed().ok()).unwrap_or_default();
        self.add_cpu(name, used);
        Self::start_lap();
    }

    /// Adds wall time to a stage.
    pub fn add_wall(&self, name: &str, time: Duration) {
        *self.lock().seconds.entry(name.to_owned()).or_default() += time.as_secs_f64();
    }

    /// Adds processor time to a stage.
    pub fn add_cpu(&self, name: &str, time: Duration) {
        *self.lock().cpu_seconds.entry(name.to_owned()).or_default() += time.as_secs_f64();
    }

    /// Adds to the count of what was processed.
    pub fn count(&self, name: &str, n: u64) {
        *self.lock().counts.entry(name.to_owned()).or_default() += n;
    }

    /// Says a number that a command is asked for.
    pub fn figure(&self, name: &str, value: f64) {
        self.lock().figures.insert(name.to_owned(), value);
    }

    /// Adds to the count of what was found not to matter.
    pub fn skip(&self, name: &str, n: u64) {
        *self.lock().skipped.entry(name.to_owned()).or_default() += n;
    }

    /// Says what `--dry-run` expects.
    pub fn expect(&self, expected: Expected) {
        self.lock().expected = Some(expected);
    }

    /// Processor seconds of some stages so far.
    pub fn cpu_of(&self, stages: &[&str]) -> f64 {
        let record = self.lock();
        stages.iter().filter_map(|stage| record.cpu_seconds.get(*stage)).sum()
    }

    /// Processor seconds of all threads since the start.
    pub fn cpu_elapsed(&self) -> f64 {
        let cpu = self.cpu_start.and_then(|start| start.try_elapsed().ok());
        cpu.unwrap_or_default().as_secs_f64()
    }

    /// Adds a frame of `--repeat`: wall time, and processor time of all threads.
    pub fn frame(&self, wall: Duration, cpu: Duration) {
        self.lock().frames.push((wall, cpu));
    }

    /// The record so far as JSON, with totals and peak memory up to now.
    pub fn to_json(&self) -> serde_json::Value {
        let mut record = self.lock().clone();
        let cpu = self.cpu_start.and_then(|start| start.try_elapsed().ok()).unwrap_or_default();
        record.seconds.insert("total".to_owned(), self.start.elapsed().as_secs_f64());
        record.cpu_seconds.insert("total".to_owned(), cpu.as_secs_f64());
        // The two maps have the same keys; a stage that was timed in one way only has 0 in the other.
        let keys: Vec<String> = record.seconds.keys().chain(record.cpu_seconds.keys()).cloned().collect();
        for key in keys {
            record.seconds.entry(key.clone()).or_default();
            record.cpu_seconds.entry(key).or_default();
        }
        record.debug_build = IS_DEBUG_BUILD;
        record.peak_bytes = crate::memory::peak_bytes();
        record.frame_ms = FrameTimes::of(record.frames.iter().map(|f| f.0));
        record.frame_cpu_ms = FrameTimes::of(record.frames.iter().map(|f| f.1));
        serde_json::json!(record)
    }

    /// Wall time since the start.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    fn lock(&self) -> MutexGuard<'_, Record> {
        // Sums are valid after every line, so a panic elsewhere does not spoil them.
        self.record.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Measures the calling thread's processor time.
#[derive(Debug)]
pub struct ThreadClock(Option<ThreadTime>);

impl ThreadClock {
    /// Starts measuring on this thread.
    pub fn start() -> Self {
        Self(ThreadTime::try_now().ok())
    }

    /// Seconds of processor time since the start.
    pub fn seconds(&self) -> f64 {
        self.0.and_then(|start| start.try_elapsed().ok()).unwrap_or_default().as_secs_f64()
    }
}
