//! Commands that answer JSON lines: where lines come from, and where answers go.

use super::Report;
use super::report::write_text;
use crate::error::CliError;
use crate::input::{cannot_read, is_standard, name_of};
use crate::json_lines::{JsonLinesError, Lines};
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

/// Gives `run` the lines of `input` and where answers to `output` go; `-` is standard input and output.
///
/// # Errors
/// Those of `run`, and files that cannot be opened or written.
pub(super) fn answer_lines(
    report: &Report<'_>,
    input: &Path,
    output: &Path,
    run: impl FnOnce(&mut Lines<'_>, &mut dyn Write) -> Result<(), JsonLinesError>,
) -> Result<(), CliError> {
    let name = name_of(input);
    let stream: Box<dyn Read> = if is_standard(input) {
        Box::new(io::stdin().lock())
    } else {
        Box::new(File::open(input).map_err(|error| cannot_read(&name, &error))?)
    };
    let mut lines = Lines::new(stream, &name);
    let mut stopped = None;
    let answer = |output: &mut dyn Write| {
        run(&mut lines, output).map_err(|error| {
            let kind = match &error {
                JsonLinesError::Write(error) => error.kind(),
                _ => io::ErrorKind::Other,
            };
            stopped = Some(error);
            io::Error::from(kind)
        })
    };
    // On standard output the results of the lines before a bad one stay: they are already read.
    let result = if is_standard(output) {
        let mut output = io::BufWriter::new(io::stdout().lock());
        answer(&mut output)
            .and_then(|()| output.flush())
            .map_err(|error| CliError::writing("standard output", &error))
    } else {
        write_text(output, answer)
    };
    match (stopped, result) {
        (Some(error), _) => Err(error.into()),
        (None, result) => result.and_then(|()| report.finish()),
    }
}
