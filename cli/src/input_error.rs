//! What is wrong with an input file, and where.

use std::fmt;

/// Longest piece of a line that is shown; more is cut around the place.
const SHOWN: usize = 100;

/// A file that cannot be used: what was found, where, and what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct InputError {
    /// What is wrong, in one sentence.
    pub message: String,
    /// Name of the file or option, as the user gave it.
    pub source_name: String,
    /// The line at fault, if it is text and known.
    pub place: Option<Place>,
    /// The way out.
    pub help: Option<Box<str>>,
    /// Whether the file is sound but belongs to another scene.
    pub mismatched: bool,
}

/// A place in a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// From 1.
    pub line: usize,
    /// In characters, from 1.
    pub column: usize,
    /// Characters to underline; at least 1.
    pub width: usize,
    /// The whole line.
    pub text: String,
}

impl InputError {
    /// An error about the file as a whole.
    pub fn of_file(source_name: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            message: message.into(),
            source_name: source_name.into(),
            place: None,
            help: None,
            mismatched: false,
        }
    }

    /// An error about the bytes `start..end` of `text`.
    pub fn in_text(
        source_name: &str,
        text: &str,
        start: usize,
        end: usize,
        message: impl Into<String>,
    ) -> Self {
        Self { place: Some(Place::of_span(text, start, end)), ..Self::of_file(source_name, message) }
    }

    /// An error about a whole line, numbered from 1.
    pub fn in_line(source_name: &str, bytes: &[u8], line: usize, message: impl Into<String>) -> Self {
        let text = bytes.split(|&b| b == b'\n').nth(line.saturating_sub(1)).unwrap_or_default();
        let text = String::from_utf8_lossy(text).trim_end().to_owned();
        let indent = text.chars().take_while(|c| c.is_whitespace()).count();
        let width = text.chars().count().saturating_sub(indent).max(1);
        let place = Place { line, column: indent + 1, width, text };
        Self { place: Some(place), ..Self::of_file(source_name, message) }
    }

    /// The same with a way out.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into().into_boxed_str());
        self
    }
}

impl Place {
    /// The place of the bytes `start..end`; only its first line if there are several.
    pub fn of_span(text: &str, start: usize, end: usize) -> Self {
        let start = floor_boundary(text, start);
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let end = floor_boundary(text, end).clamp(start, line_end);
        Self {
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            width: text[start..end].trim_end().chars().count().max(1),
            text: text[line_start..line_end].trim_end().to_owned(),
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(place) = &self.place else {
            write!(f, "{}: {}", self.source_name, self.message)?;
            return self.help.iter().try_for_each(|help| write!(f, "\n  = help: {help}"));
        };
        writeln!(f, "{}:{}:{}: {}", self.source_name, place.line, place.column, self.message)?;
        let number = place.line.to_string();
        let margin = " ".repeat(number.len());
        let (text, skipped) = shown(place);
        let before = " ".repeat(place.column - 1 - skipped);
        let carets = "^".repeat(place.width.min(SHOWN.saturating_sub(before.len()).max(1)));
        writeln!(f, "{margin} |")?;
        writeln!(f, "{number} | {text}")?;
        write!(f, "{margin} | {before}{carets}")?;
        self.help.iter().try_for_each(|help| write!(f, "\n{margin} = help: {help}"))
    }
}

/// The part of the line to print, and how many characters were left out before it.
fn shown(place: &Place) -> (String, usize) {
    let skipped = if place.column > SHOWN { place.column - SHOWN / 2 } else { 0 };
    // One character on the screen for each in the file, so that the carets stay below their place.
    let printable = |c: char| if c.is_control() { ' ' } else { c };
    (place.text.chars().skip(skipped).take(SHOWN).map(printable).collect(), skipped)
}

fn floor_boundary(text: &str, mut at: usize) -> usize {
    at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}
