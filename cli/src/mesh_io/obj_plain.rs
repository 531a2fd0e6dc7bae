//! OBJ lines that `tobj` reads as they are.
//!
//! A line is plain if `tobj` reads from it what [`super::obj_lines`] would pass on: `v` and `vn` with three words, `vt`
//! with two or three, `f` with three corners or more whose indices have at most nine digits and are not before the
//! first element; all from the first column, of digits, signs, points, exponents and ASCII blanks. Nearly all lines of
//! most files are. A line that is not may still be sound: it is then taken apart, which is slower.

use super::obj_index::{Kinds, Range};

/// What a plain line defines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlainLine {
    /// 0: a position, 1: a texture coordinate, 2: a normal.
    Element(usize),
    Face(Kinds),
}

/// The most digits of an index: all numbers of so many digits fit into an `i32`.
const MOST_DIGITS: usize = 9;

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r')
}

fn is_of_number(byte: u8) -> bool {
    matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E')
}

/// The place of the first byte from `start` on for which `belongs` does not hold.
fn skip(bytes: &[u8], start: usize, belongs: impl Fn(u8) -> bool) -> usize {
    let mut at = start;
    while bytes.get(at).is_some_and(|&byte| belongs(byte)) {
        at += 1;
    }
    at
}

/// The line at the start of `bytes`, with its length in bytes up to and with its end; `None` if it is not plain.
///
/// Notes the indices of a face in `ranges`; of a line that turns out not to be plain, those before the place where it does.
pub(super) fn plain_line(bytes: &[u8], ranges: &mut [Range; 3], line: usize) -> Option<(PlainLine, usize)> {
    let (kind, start) = match bytes {
        [b'v', b' ' | b'\t', ..] => (0, 2),
        [b'v', b't', b' ' | b'\t', ..] => (1, 3),
        [b'v', b'n', b' ' | b'\t', ..] => (2, 3),
        [b'f', b' ' | b'\t', ..] => {
            let (kinds, end) = face(bytes, 2, ranges, line)?;
            return Some((PlainLine::Face(kinds), end));
        }
        _ => return None,
    };
    Some((PlainLine::Element(kind), element(bytes, start, kind)?))
}

/// The end of a line with the numbers of an element. Whether those that `tobj` reads are numbers, it says itself.
fn element(bytes: &[u8], start: usize, kind: usize) -> Option<usize> {
    let (mut at, mut words, mut last) = (start, 0, start..start);
    loop {
        let word = skip(bytes, at, is_blank);
        at = skip(bytes, word, is_of_number);
        if at == word {
            break;
        }
        (words, last) = (words + 1, word..at);
    }
    let end = line_end(bytes, at)?;
    match (kind, words) {
        (0 | 2, 3) | (1, 2) => Some(end),
        // `tobj` does not look at the third number.
        (1, 3) => std::str::from_utf8(&bytes[last]).ok()?.parse::<f64>().is_ok().then_some(end),
        _ => None,
    }
}

/// The place behind the line's end, if the line ends at `at`.
fn line_end(bytes: &[u8], at: usize) -> Option<usize> {
    match bytes.get(at) {
        None => Some(at),
        Some(b'\n') => Some(at + 1),
        Some(_) => None,
    }
}

/// The kinds of index of a face, and the end of its line.
fn face(bytes: &[u8], start: usize, ranges: &mut [Range; 3], line: usize) -> Option<(Kinds, usize)> {
    let (mut at, mut corners, mut kinds) = (start, 0, Kinds::ALL);
    loop {
        at = skip(bytes, at, is_blank);
        if let Some(end) = line_end(bytes, at) {
            return (corners >= 3).then_some((kinds, end));
        }
        let found;
        (found, at) = corner(bytes, at, ranges, line)?;
        kinds = kinds.and(found);
        corners += 1;
    }
}

/// The number that the digits from `start` on make, modulo 2³², and the place behind them.
fn digits(bytes: &[u8], start: usize) -> (i32, usize) {
    let (mut number, mut at) = (0_i32, start);
    while let Some(digit) = bytes.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit < 10) {
        number = number.wrapping_mul(10).wrapping_add(i32::from(digit));
        at += 1;
    }
    (number, at)
}

/// The kinds of index of a corner, and the place behind it.
fn corner(bytes: &[u8], start: usize, ranges: &mut [Range; 3], line: usize) -> Option<(Kinds, usize)> {
    let (mut at, mut present) = (start, [false; 3]);
    for (kind, range) in ranges.iter_mut().enumerate() {
        let is_negative = bytes.get(at) == Some(&b'-');
        let first = at + usize::from(is_negative);
        let number;
        (number, at) = digits(bytes, first);
        if at - first > MOST_DIGITS || (at == first && (is_negative || kind == 0)) {
            return None;
        }
        if at > first {
            range.index(if is_negative { -number } else { number }, line)?;
            present[kind] = true;
        }
        match bytes.get(at) {
            Some(b'/') if kind < 2 => at += 1,
            None => break,
            Some(&byte) if is_blank(byte) || byte == b'\n' => break,
            Some(_) => return None,
        }
    }
    Some((Kinds { uv: present[1], normal: present[2] }, at))
}
