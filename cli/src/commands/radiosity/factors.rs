//! `radiosity factors`.

use crate::commands::Report;
use crate::commands::report::write_text;
use crate::error::CliError;
use crate::factors_command::{self, FactorsError};
use crate::input_error::InputError;
use crate::options::FactorsOptions;
use pointillist_radiosity::FactorOptions;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

pub(super) fn run(options: &FactorsOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let name = options.input.display().to_string();
    let mut input: Box<dyn BufRead> = if options.input == Path::new("-") {
        Box::new(io::stdin().lock())
    } else {
        let file = File::open(&options.input)
            .map_err(|error| InputError::of_file(&name, format!("cannot be read: {error}")))?;
        Box::new(BufReader::new(file))
    };
    let accuracy = FactorOptions::DEFAULT.with_occluded(options.tolerance);
    let path = &options.output.path;
    let mut stopped = None;
    let mut answer = |output: &mut dyn Write| {
        let result = report
            .stats
            .stage("factors", || factors_command::run(&mut *input, output, &accuracy, &name))
            .map(|pairs| report.stats.count("pairs", pairs));
        result.map_err(|error| {
            let kind = match &error {
                FactorsError::Write(error) => error.kind(),
                _ => io::ErrorKind::Other,
            };
            stopped = Some(error);
            io::Error::from(kind)
        })
    };
    // On standard output the results of the lines before a bad one stay: they are already read.
    let result = if path == Path::new("-") {
        let mut output = io::BufWriter::new(io::stdout().lock());
        answer(&mut output)
            .and_then(|()| output.flush())
            .map_err(|error| CliError::writing("standard output", &error))
    } else {
        write_text(path, answer)
    };
    match (stopped, result) {
        (Some(error), _) => Err(error.into()),
        (None, result) => result.and_then(|()| report.finish()),
    }
}
