//! Replies: lines of facts, and the bytes of a picture.

use crate::SiteError;
use std::fmt::{Display, Write};

/// The answer to a request.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reply {
    facts: String,
    pixels: Vec<u8>,
}

impl Reply {
    /// What went wrong, as the fact `error`.
    pub(crate) fn of_error(error: &SiteError) -> Self {
        Self { facts: format!("error {}\n", error.to_string().replace('\n', " ")), pixels: vec![] }
    }

    /// Adds a line. Numbers are written with as many digits as give the same number back.
    pub(crate) fn with<T: Display>(mut self, name: &str, values: impl IntoIterator<Item = T>) -> Self {
        self.facts.push_str(name);
        for value in values {
            write!(self.facts, " {value}").expect("a `String` takes all that is written to it");
        }
        self.facts.push('\n');
        self
    }

    /// Sets the picture: red, green, blue and opacity of each pixel, row by row.
    pub(crate) fn with_pixels(mut self, pixels: Vec<u8>) -> Self {
        self.pixels = pixels;
        self
    }

    /// The lines.
    #[must_use]
    pub fn facts(&self) -> &str {
        &self.facts
    }

    /// The numbers of the fact `name`, if it is there.
    #[must_use]
    pub fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let line = self.facts.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '))?;
        line.split(' ').map(|word| word.parse().ok()).collect()
    }

    /// The picture; empty if there is none.
    #[must_use]
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// As JavaScript takes it: the length of the facts (32 bits, the lowest first), the facts, the picture.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let length = u32::try_from(self.facts.len()).expect("facts are some thousand numbers");
        let mut bytes = Vec::with_capacity(4 + self.facts.len() + self.pixels.len());
        bytes.extend(length.to_le_bytes());
        bytes.extend(self.facts.as_bytes());
        bytes.extend(&self.pixels);
        bytes
    }
}
