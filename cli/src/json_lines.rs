//! JSON lines that are answered one by one: how they are read, what can go wrong, and how it is said.

use crate::json_words::plain;
use std::io::{self, BufRead as _, BufReader, Read};

/// Bytes that are read at once, if there are as many: enough lines to keep all threads busy.
const CAPACITY: usize = 1 << 20;

/// Longest line in bytes: a polygon of millions of corners. What is longer has lost its line feeds.
const LONGEST_LINE: u64 = 1 << 28;

/// Lines of a file or a pipe, which know whether more of them can be had without waiting.
pub struct Lines<'a> {
    reader: BufReader<Box<dyn Read + 'a>>,
    source: String,
    number: usize,
    longest: u64,
}

impl<'a> Lines<'a> {
    /// `source` is what messages call the input.
    pub fn new(input: Box<dyn Read + 'a>, source: &str) -> Self {
        Self {
            reader: BufReader::with_capacity(CAPACITY, input),
            source: source.to_owned(),
            number: 0,
            longest: LONGEST_LINE,
        }
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
            let longest = self.longest;
            let mut limited = self.reader.by_ref().take(longest + 1);
            let read = limited.read_until(b'\n', &mut bytes).and_then(|count| {
                let too_long = || format!("the line has more than {longest} bytes");
                if count as u64 > longest { Err(io::Error::other(too_long())) } else { Ok(count) }
            });
            let count =
                read.map_err(|error| JsonLinesError::Read { source_name: source_name.clone(), line, error })?;
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

#[cfg(test)]
mod tests {
    use super::Lines;

    #[test]
    fn a_line_that_does_not_end_is_no_reason_to_take_all_memory() {
        let mut lines = Lines::new(Box::new(&b"1234567\n12345678\n"[..]), "-");
        lines.longest = 8;
        assert!(matches!(lines.next_line(), Ok(Some((1, _)))));
        let message = lines.next_line().unwrap_err().to_string();
        assert_eq!(message, "-, line 2: the line has more than 8 bytes");
    }
}
