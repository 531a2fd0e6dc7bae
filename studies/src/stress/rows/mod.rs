//! The rows of the stress report: crate by crate, and what files and callers get wrong.

use crate::stress::check::{Check, Verdict};

mod bad_input;
mod pictures;
mod points;
mod probes;
mod rooms;

/// Every row, in the order of the report.
pub(crate) fn all() -> Vec<Check> {
    let mut rows = vec![];
    pictures::add(&mut rows);
    points::add(&mut rows);
    probes::add(&mut rows);
    rooms::add(&mut rows);
    bad_input::add(&mut rows);
    rows
}

fn row(
    rows: &mut Vec<Check>,
    input: impl Into<String>,
    expected: &'static str,
    run: impl Fn() -> Verdict + 'static,
) {
    rows.push(Check { input: input.into(), expected, run: Box::new(run) });
}
