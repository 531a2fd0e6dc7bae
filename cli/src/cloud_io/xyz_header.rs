//! The first line of a text of points, if it names the columns.

use super::number::{Word, Words, parse_f64};
use super::scalar::{SCALARS, Scalar, Scalars};
use super::source::Line;
use super::xyz_row::{Rest, Row, no_number};
use crate::input_error::InputError;
use glam::DVec3;

/// Names of columns in lower case, by their meaning: position, colour, normal.
const NAMES: [&[&str]; 9] = [
    &["x"],
    &["y"],
    &["z"],
    &["r", "red"],
    &["g", "green"],
    &["b", "blue"],
    &["nx", "normal_x", "normalx"],
    &["ny", "normal_y", "normaly"],
    &["nz", "normal_z", "normalz"],
];

/// Values of a line: by [`NAMES`], then by [`Scalar`].
const VALUES: usize = NAMES.len() + SCALARS;

/// Which column is what.
pub(super) struct Header {
    /// For each column which of the [`VALUES`] it is, or nothing for one that is left out.
    meanings: Vec<Option<usize>>,
    /// What is between values, if not blanks.
    separator: Option<u8>,
    /// Columns that are left out.
    unused: Vec<String>,
    has_colours: bool,
    has_normals: bool,
    has_scalars: Scalars<bool>,
}

/// The values of a line. Where the names have commas or semicolons between them, a value may be empty or have blanks in it.
fn values_of(text: &[u8], separator: Option<u8>) -> Vec<Word<'_>> {
    let Some(separator) = separator else { return Words::<true>::of(text).collect() };
    let mut start = 0;
    let word = |part: &[u8]| {
        let blanks = part.len() - part.trim_ascii_start().len();
        let found = start + blanks;
        start += part.len() + 1;
        (found, part.trim_ascii().len())
    };
    let places: Vec<(usize, usize)> = text.split(|&byte| byte == separator).map(word).collect();
    places.into_iter().map(|(start, length)| Word { start, bytes: &text[start..start + length] }).collect()
}

/// Names of columns, in lower case and without quotes, and what is between them.
fn words(text: &[u8]) -> (Vec<String>, Option<u8>) {
    let separator = [b',', b';'].into_iter().find(|byte| text.contains(byte));
    let plain =
        |word: Word<'_>| String::from_utf8_lossy(word.bytes).trim_matches(['"', '\'']).trim().to_lowercase();
    (values_of(text, separator).into_iter().map(plain).collect(), separator)
}

impl Header {
    /// Whether a line is words: no number, and no comment.
    pub(super) fn is_one(text: &[u8]) -> bool {
        let first = Words::<true>::of(text).next();
        let is_comment = first.is_some_and(|w| w.bytes.starts_with(b"#") || w.bytes.starts_with(b"//"));
        let is_text = std::str::from_utf8(text).is_ok();
        let is_name = |word: &String| word.starts_with(|c: char| c.is_alphabetic() || c == '_');
        let (words, _) = words(text);
        let is_number = |word: &String| parse_f64(word.as_bytes()).is_some();
        is_text && !is_comment && !words.is_empty() && words.iter().all(|w| is_name(w) && !is_number(w))
    }

    /// What a line of words says; nothing if it does not name x, y and z.
    pub(super) fn of(text: &[u8]) -> Option<Self> {
        let (words, separator) = words(text);
        let mut found = [false; VALUES];
        let meaning = |word: &String| {
            // In text, labels are words as often as not.
            let scalar = || Some(NAMES.len() + Scalar::of_name(word).filter(|_| word != "label")? as usize);
            let meaning = NAMES.iter().position(|names| names.contains(&word.as_str())).or_else(scalar)?;
            // Of two columns with one name the first counts.
            (!std::mem::replace(&mut found[meaning], true)).then_some(meaning)
        };
        let mut meanings: Vec<Option<usize>> = words.iter().map(meaning).collect();
        if !found[..3].iter().all(|&f| f) {
            return None;
        }
        let whole = |three: usize| found[three..three + 3].iter().all(|&f| f);
        let (has_colours, has_normals) = (whole(3), whole(6));
        for meaning in &mut meanings {
            let is_used = |m: &usize| match *m {
                0..3 => true,
                3..6 => has_colours,
                6..9 => has_normals,
                _ => true,
            };
            *meaning = meaning.filter(is_used);
        }
        let unused =
            words.into_iter().zip(&meanings).filter(|(_, m)| m.is_none()).map(|(word, _)| word).collect();
        let has_scalars = std::array::from_fn(|i| found[NAMES.len() + i]);
        Some(Self { meanings, separator, unused, has_colours, has_normals, has_scalars })
    }

    /// The point of a line; nothing if the line is empty or a comment.
    pub(super) fn row(&self, name: &str, line: &Line<'_>) -> Result<Option<Row>, InputError> {
        if line.is_blank() || line.text.trim_ascii_start().starts_with(b"#") {
            return Ok(None);
        }
        let mut values = [0.0; VALUES];
        let mut count = 0;
        for word in values_of(line.text, self.separator) {
            // Columns that are left out may hold anything.
            if let Some(Some(meaning)) = self.meanings.get(count) {
                values[*meaning] = parse_f64(word.bytes).ok_or_else(|| no_number(name, line, word))?;
            }
            count += 1;
        }
        if count != self.meanings.len() {
            let message = format!("{count} values, but the first line names {} columns", self.meanings.len());
            return Err(line
                .error(name, None, message)
                .with_help("every line needs a value for each column"));
        }
        let three = |at: usize| DVec3::new(values[at], values[at + 1], values[at + 2]);
        let rest = if self.has_colours { three(3) } else { three(6) };
        let scalars = std::array::from_fn(|i| values[NAMES.len() + i] as f32);
        Ok(Some(Row { position: three(0), rest, normal: three(6), scalars, line: line.number }))
    }

    /// What the rows have; `colours` decides how theirs are stored.
    pub(super) fn rest(&self, colours: impl FnOnce() -> Rest) -> Rest {
        match (self.has_colours, self.has_normals) {
            (false, false) => Rest::None,
            (false, true) => Rest::Normal,
            (true, has_normals) => match colours() {
                Rest::Colour(code) if has_normals => Rest::Both(code),
                rest => rest,
            },
        }
    }

    /// Which measured values the rows have.
    pub(super) const fn has_scalars(&self) -> Scalars<bool> {
        self.has_scalars
    }

    /// Which columns were left out.
    pub(super) fn warning(&self) -> Option<String> {
        let names = self.unused.join("`, `");
        (!self.unused.is_empty())
            .then(|| format!("columns that points have no use for were left out: `{names}`"))
    }
}
