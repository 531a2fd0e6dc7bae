//! Reads XYZ text, one point a line.
//!
//! Numbers are separated by blanks, commas or semicolons. The first line with numbers says how many there are in all:
//!
//! * 3: `x y z`
//! * 4: `x y z i`, of which the last is an intensity
//! * 6: `x y z r g b` or `x y z nx ny nz`
//! * 7: `x y z i r g b`, as `.pts` has it
//!
//! Six numbers are decided by the first 65,536 points: normals if any of the last three numbers is negative or if all
//! of the triples have length 1, to 1 %, or 0 (some of them not 0); colours otherwise. Colours run to 255 if the same
//! points have one above 1 or none above 0, and to 1 otherwise. A later line that does not fit is an error, not another
//! guess.
//!
//! A first line of names, as CSV has it, says instead which number is what: `x`, `y`, `z`, `r`, `g`, `b` (or `red`, `green`, `blue`), `nx`,
//! `ny`, `nz`, and the names of [`Scalar`] but `label`; other columns are left out. A first line of words without `x`, `y` and `z` is passed over.
//!
//! A first line with one whole number is the count of points. Empty lines, and lines that begin with `#` or `//`, are
//! passed over; so is the rest of a line from there on.

use super::block::{At, CloudSummary, Gather, Has, MAX_BLOCK_POINTS, Point, Stop};
use super::colour::ColourCode;
use super::format::CloudFormat;
use super::number::{Words, parse_f64};
use super::scalar::{Scalar, Scalars};
use super::source::{Line, Source};
use super::xyz_header::Header;
use super::xyz_row::{Rest, Row, no_number};
use crate::input_error::InputError;
use glam::DVec3;

/// Most numbers of a line.
const MOST: usize = 7;

/// How far the length of a normal may be from 1: programs write as few as two decimals.
const NORMAL_TOLERANCE: f64 = 0.01;

/// Reads a text from its first byte.
pub(super) fn read(mut source: Source<'_>, gather: &mut Gather<'_>) -> Result<CloudSummary, Stop> {
    let name = source.name();
    let mut table = Table::default();
    // The first rows wait here until it is known what they are.
    let mut waiting = Vec::new();
    let mut rest = None;
    while source.next_line()? {
        let Some(row) = table.row(name, &source.line())? else { continue };
        if let Some(rest) = rest {
            push(name, row, rest, gather)?;
            continue;
        }
        waiting.push(row);
        if waiting.len() == MAX_BLOCK_POINTS {
            rest = Some(table.release(name, &mut waiting, gather)?);
        }
    }
    if rest.is_none() {
        table.release(name, &mut waiting, gather)?;
    }
    table.check_count(name)?;
    let mut summary = gather.finish(name, CloudFormat::Xyz)?;
    if let Some(header) = &table.header {
        summary.warnings.extend(header.warning());
    }
    Ok(summary)
}

/// The form of the lines.
#[derive(Default)]
struct Table {
    /// What each column is, if the first line says so.
    header: Option<Header>,
    /// Whether a line of words was passed over or taken as a header: only the first may be one.
    had_words: bool,
    /// Numbers of a line; 0 before the first.
    columns: usize,
    /// The line with the count, and the count.
    announced: Option<(u64, u64)>,
    rows: u64,
}

impl Table {
    /// The numbers of a line; nothing if it holds no point.
    fn row(&mut self, name: &str, line: &Line<'_>) -> Result<Option<Row>, InputError> {
        let text = if line.number == 1 {
            line.text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line.text)
        } else {
            line.text
        };
        let line = &Line { text, ..*line };
        if self.is_header(line) {
            return Ok(None);
        }
        if let Some(header) = &self.header {
            let row = header.row(name, line)?;
            self.rows += u64::from(row.is_some());
            return Ok(row);
        }
        let mut numbers = [0.0; MOST];
        let mut count = 0;
        for word in Words::<true>::of(text) {
            if word.bytes.starts_with(b"#") || word.bytes.starts_with(b"//") {
                break;
            }
            if count == MOST {
                return Err(wrong_count(name, line, "more than seven"));
            }
            numbers[count] = parse_f64(word.bytes).ok_or_else(|| no_number(name, line, word))?;
            count += 1;
        }
        if count == 0 || self.is_count(&numbers[..count], line) {
            return Ok(None);
        }
        self.check_columns(name, line, count)?;
        self.rows += 1;
        let three = |at: usize| DVec3::new(numbers[at], numbers[at + 1], numbers[at + 2]);
        let rest = if count >= 6 { three(count - 3) } else { DVec3::ZERO };
        let mut scalars = Scalars::default();
        if matches!(count, 4 | 7) {
            scalars[Scalar::Intensity as usize] = numbers[3] as f32;
        }
        Ok(Some(Row { position: three(0), rest, normal: DVec3::ZERO, scalars, line: line.number }))
    }

    /// Whether this is a line of words before all numbers; keeps what it says of the columns.
    fn is_header(&mut self, line: &Line<'_>) -> bool {
        let is_first = !self.had_words && self.columns == 0 && self.rows == 0 && self.announced.is_none();
        if !is_first || !Header::is_one(line.text) {
            return false;
        }
        self.had_words = true;
        self.header = Header::of(line.text);
        true
    }

    /// Whether this is the count of points that some programs begin with; keeps it.
    fn is_count(&mut self, numbers: &[f64], line: &Line<'_>) -> bool {
        let &[count] = numbers else { return false };
        let is_first = self.columns == 0 && self.announced.is_none();
        if !is_first || count < 0.0 || count.fract() != 0.0 || !count.is_finite() {
            return false;
        }
        self.announced = Some((line.number, count as u64));
        true
    }

    fn check_columns(&mut self, name: &str, line: &Line<'_>, count: usize) -> Result<(), InputError> {
        if self.columns == 0 {
            if !matches!(count, 3 | 4 | 6 | 7) {
                return Err(wrong_count(name, line, &count.to_string()));
            }
            self.columns = count;
        }
        if self.columns == count {
            return Ok(());
        }
        let message = format!("{count} numbers, but the lines before have {}", self.columns);
        Err(line.error(name, None, message).with_help("every line needs as many numbers as the first"))
    }

    fn check_count(&self, name: &str) -> Result<(), InputError> {
        match self.announced {
            Some((line, count)) if count != self.rows => {
                let message = format!("line {line} announces {count} points, but {} follow", self.rows);
                Err(InputError::of_file(name, message).with_help(
                    "the file was cut off or joined from several; get it again, or remove the line",
                ))
            }
            _ => Ok(()),
        }
    }

    /// Decides what the rows are, and lets them go.
    fn release(&self, name: &str, rows: &mut Vec<Row>, gather: &mut Gather<'_>) -> Result<Rest, Stop> {
        let rest = match (&self.header, self.columns) {
            (Some(header), _) => header.rest(|| decide(rows, false)),
            (None, 6) => decide(rows, true),
            (None, 7) => decide(rows, false),
            (None, _) => Rest::None,
        };
        let has_colours = matches!(rest, Rest::Colour(_) | Rest::Both(_));
        let normals = matches!(rest, Rest::Normal | Rest::Both(_));
        let scalars = match &self.header {
            Some(header) => header.has_scalars(),
            None => Scalar::Intensity.alone(matches!(self.columns, 4 | 7)),
        };
        gather.expect(Has { colours: has_colours, normals, scalars, ..Has::default() });
        for row in std::mem::take(rows) {
            push(name, row, rest, gather)?;
        }
        Ok(rest)
    }
}

fn decide(rows: &[Row], may_be_normals: bool) -> Rest {
    let all = || rows.iter().map(|row| row.rest).filter(|rest| rest.is_finite());
    let is_unit = |rest: DVec3| (rest.length() - 1.0).abs() <= NORMAL_TOLERANCE;
    let are_units = all().all(|rest| is_unit(rest) || rest == DVec3::ZERO) && all().any(is_unit);
    if may_be_normals && (are_units || all().any(|rest| rest.min_element() < 0.0)) {
        return Rest::Normal;
    }
    let highest = all().map(DVec3::max_element).fold(0.0, f64::max);
    Rest::Colour(if highest > 1.0 || highest == 0.0 { ColourCode::Byte } else { ColourCode::Unit })
}

fn push(name: &str, row: Row, rest: Rest, gather: &mut Gather<'_>) -> Result<(), Stop> {
    let mut point = Point { position: row.position, scalars: row.scalars, ..Point::default() };
    match rest {
        Rest::None => {}
        Rest::Normal => point.normal = row.rest.as_vec3(),
        Rest::Colour(code) | Rest::Both(code) => {
            point.normal = row.normal.as_vec3();
            for (linear, stored) in point.colour.iter_mut().zip(row.rest.to_array()) {
                *linear = code.linear(stored).ok_or_else(|| no_colour(name, row.line, stored, code))?;
            }
        }
    }
    gather.push(&point, At::Line(row.line))
}

/// Without the text of the line, which is gone when the first rows are decided.
fn no_colour(name: &str, line: u64, stored: f64, code: ColourCode) -> InputError {
    let message = format!(
        "line {line}: {stored} is no colour from 0 to {}, which the first {MAX_BLOCK_POINTS} points make it out to be",
        code.highest()
    );
    InputError::of_file(name, message)
        .with_help("a PLY file says what its numbers are; or make all colours run from 0 to 255")
}

fn wrong_count(name: &str, line: &Line<'_>, count: &str) -> InputError {
    line.error(name, None, format!("{count} numbers, which is none of the known forms"))
        .with_help("known are `x y z`, `x y z i`, `x y z r g b`, `x y z nx ny nz` and `x y z i r g b`")
}
