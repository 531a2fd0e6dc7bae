//! `stress`: input at the limits of numbers, and beyond. Every row runs in a process of its own, so that a
//! panic is a row of the table and not its end.

mod check;
mod rows;
mod study;

pub(crate) use study::{run, run_row};
