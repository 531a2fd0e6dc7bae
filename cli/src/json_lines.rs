//! What can go wrong where JSON lines are answered, and how it is said.

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
    let message = error.to_string();
    let end = message.rfind(" at line ").unwrap_or(message.len());
    format!("{}, column {}", &message[..end], error.column())
}

/// Lines of any length make a message of one line.
pub(crate) fn shorten(text: &str) -> String {
    const LENGTH: usize = 100;
    match text.char_indices().nth(LENGTH) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
