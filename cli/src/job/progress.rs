//! How far a run is: a bar on a terminal, lines for a job scheduler, or nothing.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Where progress is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgressMode {
    /// A bar on standard error if that is a terminal.
    #[default]
    Auto,
    /// `openjd_progress: N` lines on standard output.
    OpenJd,
    /// The same on standard error, because standard output is the result.
    OpenJdOnStderr,
    /// Nobody.
    Off,
}

/// Counts finished work, from any thread.
#[derive(Debug)]
pub struct Progress {
    bar: Option<ProgressBar>,
    mode: ProgressMode,
    done: AtomicU64,
    total: AtomicU64,
    /// The last percentage printed, plus one; 0 before the first.
    printed: Mutex<u64>,
}

impl Progress {
    /// Nothing done, nothing to do.
    pub fn new(mode: ProgressMode) -> Self {
        let bar = (mode == ProgressMode::Auto && std::io::stderr().is_terminal()).then(|| {
            let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{msg:>9} [{bar:40}] {percent:>3} %  {eta} left");
            bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
            bar
        });
        Self { bar, mode, done: AtomicU64::new(0), total: AtomicU64::new(0), printed: Mutex::new(0) }
    }

    /// Says what is going on and how many units of it there are; all stages that follow one another should be
    /// announced once, with their sum.
    pub fn begin(&self, name: &'static str, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.set_message(name);
            bar.set_length(total);
            bar.set_position(0);
        }
        self.print(0);
    }

    /// Adds finished units.
    pub fn advance(&self, units: u64) {
        let done = self.done.fetch_add(units, Ordering::Relaxed) + units;
        if let Some(bar) = &self.bar {
            bar.set_position(done);
        }
        self.print(done);
    }

    /// Goes on to this share of all units, unless that would be back.
    pub fn reach(&self, share: f64) {
        let total = self.total.load(Ordering::Relaxed);
        let wanted = (share.clamp(0.0, 1.0) * total as f64) as u64;
        let before = self.done.fetch_max(wanted, Ordering::Relaxed);
        if wanted > before {
            if let Some(bar) = &self.bar {
                bar.set_position(wanted);
            }
            self.print(wanted);
        }
    }

    /// Removes the bar, or prints the last line.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        self.print(self.total.load(Ordering::Relaxed));
    }

    fn print(&self, done: u64) {
        let total = self.total.load(Ordering::Relaxed);
        let is_lines = matches!(self.mode, ProgressMode::OpenJd | ProgressMode::OpenJdOnStderr);
        if !is_lines || total == 0 {
            return;
        }
        let percent = (u128::from(done.min(total)) * 100 / u128::from(total)) as u64;
        // Held while the line is printed: a thread that raised the number but printed later would go back.
        let mut printed = self.printed.lock().unwrap_or_else(PoisonError::into_inner);
        if *printed < percent + 1 {
            *printed = percent + 1;
            let line = format!("openjd_progress: {percent}\n");
            // A reader that went away is no reason to stop drawing.
            let _ = if self.mode == ProgressMode::OpenJd {
                let mut out = std::io::stdout().lock();
                out.write_all(line.as_bytes()).and_then(|()| out.flush())
            } else {
                std::io::stderr().write_all(line.as_bytes())
            };
        }
    }
}
