//! `compare`.

use super::Report;
use super::report::{check_output, write_text};
use crate::compare::{compare, difference_bytes};
use crate::error::CliError;
use crate::image_io::{encode_rgb_png, read_picture, write_atomically};
use crate::input::{is_standard, name_of};
use crate::input_error::InputError;
use crate::options::CompareOptions;
use std::path::Path;

pub(super) fn run(options: &CompareOptions) -> Result<(), CliError> {
    let report =
        Report::new(&options.common)?.reading([&options.a, &options.b])?.writing([&options.output.path])?;
    if options.diff.as_deref().is_some_and(is_standard) {
        let message = "--diff -: a picture is no text, and goes to a file";
        return Err(CliError::Usage(message.to_owned()));
    }
    if let Some(path) = &options.diff {
        check_diff(path)?;
    }
    let (a, b) = report.stats.stage("load", || (read_picture(&options.a), read_picture(&options.b)));
    let (a, b) = (a?, b?);
    if a.size != b.size {
        let [[aw, ah], [bw, bh]] = [a.size, b.size];
        let message = format!("is {bw}×{bh}, but {} is {aw}×{ah}", name_of(&options.a));
        let error = InputError::of_file(name_of(&options.b), message);
        return Err(error.with_help("only pictures of the same size can be compared").into());
    }
    let differences = report.stats.stage("compare", || compare(&a, &b));
    report.stats.count("pixels", u64::from(a.size[0]) * u64::from(a.size[1]));
    if let Some(path) = &options.diff {
        let bytes = difference_bytes(&a, &b);
        write_atomically(path, |output| encode_rgb_png(output, &bytes, a.size[0], a.size[1]))
            .map_err(|error| CliError::writing(&path.display().to_string(), &error))?;
    }
    write_text(&options.output.path, |output| {
        serde_json::to_writer_pretty(&mut *output, &differences)?;
        writeln!(output)
    })?;
    report.finish()?;
    match options.max_rmse {
        Some(limit) if differences.rmse > limit || differences.nonfinite > 0 => {
            let (rmse, bad) = (differences.rmse, differences.nonfinite);
            let more = if bad > 0 { format!(", and {bad} numbers are not finite") } else { String::new() };
            Err(CliError::Beyond(format!("RMSE {rmse:.3e}; the limit is {limit:.3e}{more}")))
        }
        _ => Ok(()),
    }
}

/// The difference is written as PNG, whatever its name says.
fn check_diff(path: &Path) -> Result<(), CliError> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png")) {
        return check_output(path);
    }
    Err(CliError::Usage(format!("--diff `{}`: the name of the difference ends in .png", path.display())))
}
