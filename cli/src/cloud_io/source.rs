//! A stream of bytes through a buffer of fixed size, by lines or by bytes, that knows where it is.

use super::number::Word;
use crate::input_error::{InputError, Place};
use std::io::Read;

/// Bytes of the buffer, and so the longest line that can be looked at.
const CAPACITY: usize = 1 << 18;

/// A stream of bytes. Memory is [`CAPACITY`], whatever the file says.
pub(super) struct Source<'a> {
    name: &'a str,
    input: Box<dyn Read + 'a>,
    buffer: Vec<u8>,
    /// What of the buffer is still to be read.
    start: usize,
    end: usize,
    /// Where in the stream `start` is.
    offset: u64,
    /// Number of the current line, from 1; 0 before the first.
    line: u64,
    /// The current line in the buffer, without its end.
    current: std::ops::Range<usize>,
}

/// A line of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    /// From 1.
    pub(super) number: u64,
    /// Without line feed and carriage return.
    pub(super) text: &'a [u8],
}

impl Line<'_> {
    /// An error about a word of this line, or about the line as a whole.
    pub(super) fn error(&self, name: &str, word: Option<Word<'_>>, message: impl Into<String>) -> InputError {
        let chars = |bytes: &[u8]| String::from_utf8_lossy(bytes).chars().count();
        let text = self.text.trim_ascii_end();
        let (start, length) = match word {
            Some(word) => (word.start, word.bytes.len()),
            None => {
                let blanks = text.len() - text.trim_ascii_start().len();
                (blanks, text.len() - blanks)
            }
        };
        let place = Place {
            line: usize::try_from(self.number).unwrap_or(usize::MAX),
            column: chars(&self.text[..start]) + 1,
            width: chars(&self.text[start..start + length]).max(1),
            text: String::from_utf8_lossy(text).into_owned(),
        };
        InputError { place: Some(place), ..InputError::of_file(name, message) }
    }

    pub(super) fn is_blank(&self) -> bool {
        self.text.trim_ascii().is_empty()
    }
}

impl<'a> Source<'a> {
    /// `name` is how messages call the stream.
    pub(super) fn new(name: &'a str, input: impl Read + 'a) -> Self {
        Self {
            name,
            input: Box::new(input),
            buffer: vec![0; CAPACITY],
            start: 0,
            end: 0,
            offset: 0,
            line: 0,
            current: 0..0,
        }
    }

    pub(super) fn name(&self) -> &'a str {
        self.name
    }

    /// Bytes read so far, that is, the offset of the next.
    pub(super) fn offset(&self) -> u64 {
        self.offset
    }

    /// Number of the line last read, from 1; 0 before the first.
    pub(super) fn line_number(&self) -> u64 {
        self.line
    }

    /// Gets more bytes behind those that are there; `false` at the end of the stream. The buffer must not be full.
    fn fill(&mut self) -> Result<bool, InputError> {
        if self.end == CAPACITY {
            self.buffer.copy_within(self.start..self.end, 0);
            self.end -= self.start;
            self.start = 0;
        }
        loop {
            match self.input.read(&mut self.buffer[self.end..]) {
                Ok(count) => {
                    self.end += count;
                    return Ok(count > 0);
                }
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => {
                    let read = self.offset + (self.end - self.start) as u64;
                    let message = format!("cannot be read after byte {read}: {error}");
                    return Err(InputError::of_file(self.name, message)
                        .with_help("the file is damaged or was cut off; get it again"));
                }
            }
        }
    }

    fn consume(&mut self, count: usize) {
        self.start += count;
        self.offset += count as u64;
    }

    /// Goes to the next line, which [`Self::line`] then gives; `false` at the end.
    ///
    /// # Errors
    ///
    /// The stream, or a line longer than the buffer.
    pub(super) fn next_line(&mut self) -> Result<bool, InputError> {
        let mut searched = 0;
        let (length, ending) = loop {
            let unseen = &self.buffer[self.start + searched..self.end];
            if let Some(at) = unseen.iter().position(|&byte| byte == b'\n') {
                break (searched + at, 1);
            }
            searched = self.end - self.start;
            if searched == CAPACITY {
                let message = format!("line {} is longer than {CAPACITY} bytes", self.line + 1);
                return Err(InputError::of_file(self.name, message)
                    .with_help("is this text? A line holds one point, and ends with a line feed"));
            }
            if !self.fill()? {
                if searched == 0 {
                    return Ok(false);
                }
                break (searched, 0);
            }
        };
        let start = self.start;
        self.consume(length + ending);
        self.line += 1;
        let text = &self.buffer[start..start + length];
        self.current = start..start + text.strip_suffix(b"\r").unwrap_or(text).len();
        Ok(true)
    }

    /// The line that [`Self::next_line`] went to.
    pub(super) fn line(&self) -> Line<'_> {
        Line { number: self.line, text: &self.buffer[self.current.clone()] }
    }

    /// Passes over a line of any length; `false` at the end.
    pub(super) fn skip_line(&mut self) -> Result<bool, InputError> {
        let mut any = false;
        while self.start < self.end || self.refill()? {
            any = true;
            let unseen = &self.buffer[self.start..self.end];
            if let Some(at) = unseen.iter().position(|&byte| byte == b'\n') {
                self.consume(at + 1);
                break;
            }
            self.consume(unseen.len());
        }
        self.line += u64::from(any);
        Ok(any)
    }

    /// The next `count` bytes, at most 8; nothing if the stream has less.
    #[inline]
    pub(super) fn bytes(&mut self, count: usize) -> Result<Option<&[u8]>, InputError> {
        debug_assert!(count <= 8, "a number has at most 8 bytes");
        while self.end - self.start < count {
            if !self.fill()? {
                return Ok(None);
            }
        }
        let start = self.start;
        self.consume(count);
        Ok(Some(&self.buffer[start..start + count]))
    }

    /// Passes over `count` bytes; gives how many there were.
    pub(super) fn skip(&mut self, count: u64) -> Result<u64, InputError> {
        let mut left = count;
        while left > 0 && (self.start < self.end || self.refill()?) {
            let here = usize::try_from(left).unwrap_or(usize::MAX).min(self.end - self.start);
            self.consume(here);
            left -= here as u64;
        }
        Ok(count - left)
    }

    /// Fills the empty buffer.
    fn refill(&mut self) -> Result<bool, InputError> {
        (self.start, self.end) = (0, 0);
        self.fill()
    }

    /// Reads to the end and gives where the first byte is that is neither blank nor a line end, if any is left.
    ///
    /// To the end, because only there a compressed stream says whether it was whole.
    pub(super) fn drain(&mut self) -> Result<Option<u64>, InputError> {
        let mut found = None;
        while self.start < self.end || self.refill()? {
            let unseen = &self.buffer[self.start..self.end];
            if let Some(at) = unseen.iter().position(|byte| !byte.is_ascii_whitespace()) {
                found = found.or(Some(self.offset + at as u64));
            }
            self.consume(self.end - self.start);
        }
        Ok(found)
    }
}
