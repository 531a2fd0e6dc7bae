//! JSON lines that are answered one by one: how they are read, what can go wrong, and how it is said.

use crate::json_words::plain;
use std::io::{BufRead as _, BufReader, Read};

/// Bytes that are read at once, if there are as many: enough lines to keep all threads busy.
const CAPACITY: usize = 1 << 20;

/// Lines of a file or a pipe, which know whether more of them can be had without waiting.
pub struct Lines<'a> {
    reader: BufReader<Box<dyn Read + 'a>>,
    source: String,
    number: usize,
}

impl<'a> Lines<'a> {
    /// `source` is what messages call the input.
    pub fn new(input: Box<dyn Read + 'a>, source: &str) -> Self {
        Self { reader: BufReader::with_capacity(CAPACITY, input), source: source.to_owned(), number: 0 }
    }

    /// What messages call the input.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The next line that is not blank, with its number; `None` at the end. Waits if none is at hand.
    ///
    /// # Errors
    /// The input cannot be read, or is not text.
    pub fn next_line(&mut self) -> Result<Option<(usize, String)>, JsonLinesError> {
        loop {
            let mut bytes = vec![];
            self.number += 1;
            let (line, source_name) = (self.number, &self.source);
            let count = self.reader.read_until(b'\n', &mut bytes).map_err(|error| JsonLinesError::Read {
                source_name: source_name.clone(),
                line,
                error,
            })?;
            if count == 0 {
                return Ok(None);
            }
            let text = String::from_utf8(bytes).map_err(|error| JsonLinesError::Input {
                source_name: source_name.clone(),
                line,
                message: "not UTF-8 text".to_owned(),
                text: shorten(String::from_utf8_lossy(error.as_bytes()).trim()),
                way_out: "each line is JSON, which is written in UTF-8".to_owned(),
            })?;
            if !text.trim().is_empty() {
                return Ok(Some((line, text)));
            }
        }
    }

    /// Whether the next line is there already. If not, whoever writes the lines may be waiting for the answers so far.
    pub fn at_hand(&self) -> bool {
        self.reader.buffer().contains(&b'\n')
    }
}

/// Why it stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JsonLinesError {
    /// A line of the input cannot be used.
    #[error("{source_name}, line {line}: {message}\n  {text}\n  {way_out}")]
    Input {
        /// Name of the file, or `-`.
        source_name: String,
        /// From 1.
        line: usize,
        /// What is wrong, with the field and its value.
        message: String,
        /// The line, shortened.
        text: String,
        /// What to do about it.
        way_out: String,
    },
    /// The input could not be read.
    #[error("{source_name}, line {line}: {error}")]
    Read {
        /// Name of the file, or `-`.
        source_name: String,
        /// From 1.
        line: usize,
        /// What the system says.
        #[source]
        error: std::io::Error,
    },
    /// The output could not be written.
    #[error("writing the result: {0}")]
    Write(#[source] std::io::Error),
}

/// The message with the column; every request is on line 1 as far as the parser knows, so its line would mislead.
pub(crate) fn strip_place(error: &serde_json::Error) -> String {
    let message = plain(&error.to_string());
    let subject = if message.starts_with("is ") || message.starts_with("has ") { "a value " } else { "" };
    format!("{subject}{message}, column {}", error.column())
}

/// Lines of any length make a message of one line.
pub(crate) fn shorten(text: &str) -> String {
    const LENGTH: usize = 100;
    match text.char_indices().nth(LENGTH) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
