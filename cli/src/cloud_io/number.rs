//! Words of a line, and numbers from them.

/// A word and where it is in its line, in bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'a> {
    pub(super) start: usize,
    pub(super) bytes: &'a [u8],
}

impl Word<'_> {
    /// For messages; bytes that are not UTF-8 are replaced, and long words cut.
    pub(super) fn shown(&self) -> String {
        const LONGEST: usize = 40;
        let text = String::from_utf8_lossy(&self.bytes[..self.bytes.len().min(LONGEST)]);
        if self.bytes.len() > LONGEST { format!("{text}…") } else { text.into_owned() }
    }
}

/// The words of a line between blanks and, if `COMMAS`, commas and semicolons.
#[derive(Clone, Debug)]
pub(super) struct Words<'a, const COMMAS: bool> {
    line: &'a [u8],
    at: usize,
}

impl<'a, const COMMAS: bool> Words<'a, COMMAS> {
    pub(super) const fn of(line: &'a [u8]) -> Self {
        Self { line, at: 0 }
    }
}

impl<'a, const COMMAS: bool> Iterator for Words<'a, COMMAS> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        let separates = |byte: u8| {
            matches!(byte, b' ' | b'\t' | b'\r' | b'\x0c') || (COMMAS && matches!(byte, b',' | b';'))
        };
        let start = self.at + self.line[self.at..].iter().position(|&byte| !separates(byte))?;
        let rest = &self.line[start..];
        let length = rest.iter().position(|&byte| separates(byte)).unwrap_or(rest.len());
        self.at = start + length;
        Some(Word { start, bytes: &rest[..length] })
    }
}

/// A number in any spelling that programs write, NaN and infinities included; nothing if it is no number.
pub(super) fn parse_f64(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| spelled_nan(text).then_some(f64::NAN))
}

/// The same rounded to f32 at once, as a binary file would hold it.
pub(super) fn parse_f32(word: &[u8]) -> Option<f32> {
    let text = std::str::from_utf8(word).ok()?;
    text.parse().ok().or_else(|| spelled_nan(text).then_some(f32::NAN))
}

/// `-nan(ind)` and `1.#QNAN`, which the C libraries print for what is not a number.
fn spelled_nan(text: &str) -> bool {
    let text = text.trim_start_matches(['+', '-']);
    let is_nan = text.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("nan("));
    is_nan || text.starts_with("1.#")
}
