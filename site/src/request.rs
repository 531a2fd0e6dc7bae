//! Requests: a line of words, and the bytes after it.

use crate::SiteError;
use glam::{DVec3, dvec3};
use std::str::SplitWhitespace;

/// A request whose words are taken one by one.
pub(crate) struct Request<'a> {
    words: SplitWhitespace<'a>,
    /// What comes after the line: a file.
    pub(crate) body: &'a [u8],
}

impl<'a> Request<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let end = bytes.iter().position(|&b| b == b'\n');
        let (line, body) =
            end.map_or((bytes, &bytes[bytes.len()..]), |end| (&bytes[..end], &bytes[end + 1..]));
        // What is not text has no words that anything accepts.
        Self { words: std::str::from_utf8(line).unwrap_or_default().split_whitespace(), body }
    }

    /// The next word.
    pub(crate) fn word(&mut self) -> &'a str {
        self.words.next().unwrap_or_default()
    }

    /// The next word as one of a list.
    pub(crate) fn one_of<T: Copy>(
        &mut self,
        name: &'static str,
        expected: &'static str,
        choices: &[(&str, T)],
    ) -> Result<T, SiteError> {
        let word = self.word();
        let found = choices.iter().find(|(choice, _)| *choice == word);
        found.map(|choice| choice.1).ok_or_else(|| SiteError::Word { name, expected, word: word.to_string() })
    }

    /// The next word as a number from `least` to `most`.
    pub(crate) fn count(&mut self, name: &'static str, least: u32, most: u32) -> Result<u32, SiteError> {
        let word = self.word();
        let expected = "a whole number within the limits of the page";
        let number = word.parse().ok().filter(|n| (least..=most).contains(n));
        number.ok_or_else(|| SiteError::Word { name, expected, word: word.to_string() })
    }

    /// The next word as a finite number.
    pub(crate) fn number(&mut self, name: &'static str) -> Result<f64, SiteError> {
        let word = self.word();
        let number = word.parse().ok().filter(|n: &f64| n.is_finite());
        number.ok_or_else(|| SiteError::Word { name, expected: "a finite number", word: word.to_string() })
    }

    /// The next three words as a position or a direction.
    pub(crate) fn vector(&mut self, name: &'static str) -> Result<DVec3, SiteError> {
        Ok(dvec3(self.number(name)?, self.number(name)?, self.number(name)?))
    }

    /// All words that are left as finite numbers.
    pub(crate) fn numbers(&mut self, name: &'static str) -> Result<Vec<f64>, SiteError> {
        let mut found = vec![];
        while self.words.clone().next().is_some() {
            found.push(self.number(name)?);
        }
        Ok(found)
    }
}
