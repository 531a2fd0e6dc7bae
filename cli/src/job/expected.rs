//! What a run is expected to take: `--dry-run`.

use crate::memory::human;
use serde::Serialize;
use std::collections::BTreeMap;

/// Time and memory that a run is expected to take, all of it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Expected {
    /// Wall time of the stages by their names in `--stats`, and `total`.
    pub seconds: BTreeMap<String, f64>,
    /// Processor time of all threads, by the same names.
    pub cpu_seconds: BTreeMap<String, f64>,
    /// Memory at the peak.
    pub peak_bytes: u64,
    /// Threads that compute at once: no more than processors.
    pub threads: usize,
    /// What of it is measured, in a sentence.
    pub basis: String,
    /// What will be slow or heavy.
    pub heavy: Vec<String>,
}

impl Expected {
    /// Adds a stage that takes this wall time and processor time.
    pub fn add(&mut self, stage: &str, wall_s: f64, cpu_s: f64) {
        for name in [stage, "total"] {
            *self.seconds.entry(name.to_owned()).or_default() += wall_s;
            *self.cpu_seconds.entry(name.to_owned()).or_default() += cpu_s;
        }
    }

    /// As text for people.
    pub fn to_text(&self) -> String {
        let total = |times: &BTreeMap<String, f64>| times.get("total").copied().unwrap_or_default();
        let mut text = format!(
            "expected: {:.2} s ({:.2} s of processor time on {} threads), {} of memory\n",
            total(&self.seconds),
            total(&self.cpu_seconds),
            self.threads,
            human(u128::from(self.peak_bytes))
        );
        for (stage, seconds) in self.seconds.iter().filter(|(stage, _)| *stage != "total") {
            text += &format!("{stage:>12} {seconds:.2} s\n");
        }
        text += &format!("{}; nothing was written\n", self.basis);
        for heavy in &self.heavy {
            text += &format!("heavy: {heavy}\n");
        }
        text
    }
}
