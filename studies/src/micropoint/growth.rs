//! How time grows with the number of parts in a cell: ever more stripes to the horizon.

use crate::common::draw;
use crate::common::report::{Limit, on_one_thread};
use crate::common::scenes;
use crate::common::timing::{Timing, timed};
use pointillist_micropoint::MicropointOptions;
use std::fmt::Write as _;

/// Stripes, each four times as many as before. Most of the parts that are added lie in the few rows at the horizon.
pub(super) const COUNTS: [u32; 5] = [50, 200, 800, 3200, 12_800];

/// For the exponent between two rows. As n log n, and a little for the cells that become crowded.
const GOAL: Limit = Limit::AtMost(1.3);

/// Pixels on a side.
const SIZE: u32 = 256;

/// For a trial.
pub(super) const FEW: &[u32] = COUNTS.split_at(3).0;

/// The section: a table of these counts and seconds with the exponent between each count and the one before.
pub(super) fn section(counts: &[u32]) -> String {
    let mut text = String::from(
        "\n## Parts in a cell\n\nStripes to the horizon, ever more of them; the exponent is that of time against stripes since the row above.\n\n\
         | stripes | seconds | exponent | |\n| ---: | ---: | ---: | --- |\n",
    );
    let mut before: Option<(u32, Timing)> = None;
    for &count in counts {
        let scene = scenes::stripes(SIZE, count);
        let draw = || draw::emissive(&scene, MicropointOptions::DEFAULT).expect("the scene is valid");
        let (time, _) = on_one_thread(|| timed(draw));
        let (exponent, goal) = before.map_or_else(Default::default, |(n, earlier)| {
            let growth = (f64::from(count) / f64::from(n)).ln();
            let exponent = (time.seconds / earlier.seconds).ln() / growth;
            let spread = 0.5 * (time.spread + earlier.spread) / growth;
            (format!("{exponent:.2}"), format!("{GOAL}: {}", GOAL.verdict(exponent, spread)))
        });
        writeln!(text, "| {count} | {time} | {exponent} | {goal} |").expect("writing to a string");
        before = Some((count, time));
    }
    text
}
