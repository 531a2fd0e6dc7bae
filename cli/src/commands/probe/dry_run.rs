//! `probe bake --dry-run`: what baking is expected to take.
//!
//! The scene is loaded and prepared, which is measured. A few of the probes are baked twice: the first time also pays for what is made once, when it is
//! first seen. All probes take as many times as long as the second time as they are more; what they exchange at bounces is little.

use crate::commands::Report;
use crate::error::CliError;
use crate::job::Expected;
use crate::memory;
use crate::scene::{Scene, weight};
use glam::DVec3;
use std::time::Instant;

/// Probes that are baked at most.
const MOST_PROBES: usize = 8;
/// More probes are baked until that takes so long.
const PATIENCE_S: f64 = 1.0;
/// Stages besides the probes' own, such as fitting, are a part of each.
const STAGE: &str = "probes";

/// Bakes some of the probes with `bake`, and scales up. `places` are all that are looked from: probes, and those of `--fit`. `bytes` is what a
/// place keeps.
pub(super) fn expect(
    scene: &Scene,
    positions: &[DVec3],
    places: usize,
    bytes: u64,
    bake: &dyn Fn(&[DVec3]) -> Result<(), CliError>,
    report: &Report<'_>,
) -> Result<Expected, CliError> {
    let threads = report.threads();
    let mut expected = Expected { threads, heavy: weight::heavy(scene), ..Expected::default() };
    expected.add("load", report.stats.elapsed().as_secs_f64(), report.stats.cpu_elapsed());
    if positions.is_empty() {
        expected.peak_bytes = memory::peak_bytes();
        expected.basis = "there are no probes to bake".to_owned();
        return Ok(expected);
    }
    let measure = |at: &[DVec3]| -> Result<(f64, f64), CliError> {
        let (start, cpu) = (Instant::now(), report.stats.cpu_elapsed());
        bake(at)?;
        Ok((start.elapsed().as_secs_f64(), report.stats.cpu_elapsed() - cpu))
    };
    let mut count = 1;
    let mut once = (0.0, 0.0);
    let sampled = loop {
        let sample = spread(positions, count);
        let (first, second) = (measure(&sample)?, measure(&sample)?);
        once.0 += (first.0 - second.0).max(0.0);
        once.1 += (first.1 - second.1).max(0.0);
        if second.0 > PATIENCE_S || count >= MOST_PROBES.min(positions.len()) {
            break second;
        }
        count = (2 * count).min(positions.len());
    };
    expected.add("first use", once.0, once.1);
    let scale = places as f64 / count as f64;
    // Probes are looked from side by side; few of them leave threads idle, and many do not.
    let busy = threads.min(places) as f64;
    expected.add(STAGE, sampled.1 * scale / busy, sampled.1 * scale);
    expected.peak_bytes = memory::peak_bytes() + bytes * places as u64;
    expected.basis = format!(
        "loading was measured; {count} of {places} probes were baked, and the rest is taken to be like them"
    );
    Ok(expected)
}

/// Some positions from all over the list.
fn spread(positions: &[DVec3], count: usize) -> Vec<DVec3> {
    (0..count).map(|k| positions[(2 * k + 1) * positions.len() / (2 * count)]).collect()
}
