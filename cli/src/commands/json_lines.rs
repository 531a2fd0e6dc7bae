//! Commands that answer JSON lines: where lines come from, and where answers go.

use super::Report;
use super::report::{check_output, write_text};
use crate::error::CliError;
use crate::input_error::InputError;
use crate::json_lines::JsonLinesError;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

/// Gives `run` the lines of `input` and where answers to `output` go; `-` is standard input and output.
///
/// # Errors
/// Those of `run`, and files that cannot be opened or written.
pub(super) fn answer_lines(
    report: &Report<'_>,
    input: &Path,
    output: &Path,
    run: impl FnOnce(&mut dyn BufRead, &mut dyn Write, &str) -> Result<(), JsonLinesError>,
) -> Result<(), CliError> {
    check_output(output)?;
    let name = input.display().to_string();
    let mut lines: Box<dyn BufRead> = if input == Path::new("-") {
        Box::new(io::stdin().lock())
    } else {
        let file = File::open(input)
            .map_err(|error| InputError::of_file(&name, format!("cannot be read: {error}")))?;
        Box::new(BufReader::new(file))
    };
    let mut stopped = None;
    let answer = |output: &mut dyn Write| {
        run(&mut *lines, output, &name).map_err(|error| {
            let kind = match &error {
                JsonLinesError::Write(error) => error.kind(),
                _ => io::ErrorKind::Other,
            };
            stopped = Some(error);
            io::Error::from(kind)
        })
    };
    // On standard output the results of the lines before a bad one stay: they are already read.
    let result = if output == Path::new("-") {
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
