//! One line of a text of points.

use super::colour::ColourCode;
use super::number::Word;
use super::scalar::Scalars;
use super::source::Line;
use crate::input_error::InputError;
use glam::DVec3;

/// A line: its position, its colour or else its normal, its normal if it has both, what was measured, its number.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) position: DVec3,
    pub(super) rest: DVec3,
    pub(super) normal: DVec3,
    pub(super) scalars: Scalars<f32>,
    pub(super) line: u64,
}

/// What the numbers beside the position are.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Rest {
    None,
    Colour(ColourCode),
    Normal,
    Both(ColourCode),
}

/// A value that is no number.
pub(super) fn no_number(name: &str, line: &Line<'_>, word: Word<'_>) -> InputError {
    let message = match std::str::from_utf8(word.bytes) {
        Ok(_) => format!("`{}` is no number", word.shown()),
        Err(_) => "this is not UTF-8 text".to_owned(),
    };
    line.error(name, Some(word), message).with_help(
        "a line is `x y z`, `x y z r g b` or `x y z nx ny nz`; lines of words begin with # or //, \
             but for a first line with the names of the columns",
    )
}
