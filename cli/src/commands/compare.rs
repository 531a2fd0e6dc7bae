//! `compare`.

use super::Report;
use super::report::{check_output, write_text};
use crate::compare::{Comparison, Page, compare, difference_bytes};
use crate::error::CliError;
use crate::image_io::{Picture, encode_rgb_png, read_picture, write_atomically};
use crate::input::{is_standard, name_of};
use crate::input_error::InputError;
use crate::options::CompareOptions;
use std::path::Path;

pub(super) fn run(options: &CompareOptions) -> Result<(), CliError> {
    check_names(options)?;
    let report = Report::new(&options.common)?
        .reading([&options.a, &options.b])?
        .writing(std::iter::once(&options.output.path).chain(&options.html))?;
    let (a, b) = report.stats.stage("load", || (read_picture(&options.a), read_picture(&options.b)));
    let (a, b) = (a?, b?);
    if a.size != b.size {
        let [[aw, ah], [bw, bh]] = [a.size, b.size];
        let message = format!("is {bw}×{bh}, but {} is {aw}×{ah}", name_of(&options.a));
        let error = InputError::of_file(name_of(&options.b), message);
        return Err(error.with_help("only pictures of the same size can be compared").into());
    }
    let comparison = report.stats.stage("compare", || compare(&a, &b));
    report.stats.count("pixels", u64::from(a.size[0]) * u64::from(a.size[1]));
    report.stats.stage("write", || write(options, &a, &b, &comparison))?;
    report.finish()?;
    let differences = &comparison.differences;
    match options.max_rmse {
        Some(limit) if differences.rmse > limit || differences.nonfinite > 0 => {
            let (rmse, bad) = (differences.rmse, differences.nonfinite);
            let more = if bad > 0 { format!(", and {bad} numbers are not finite") } else { String::new() };
            Err(CliError::Beyond(format!("RMSE {rmse:.3e}; the limit is {limit:.3e}{more}")))
        }
        _ => Ok(()),
    }
}

/// Writes the numbers, and what was asked for beside them.
fn write(
    options: &CompareOptions,
    a: &Picture,
    b: &Picture,
    comparison: &Comparison,
) -> Result<(), CliError> {
    if let Some(path) = &options.diff {
        let bytes = difference_bytes(a, b);
        write_atomically(path, |output| encode_rgb_png(output, &bytes, a.size[0], a.size[1]))
            .map_err(|error| CliError::writing(&path.display().to_string(), &error))?;
    }
    if let Some(path) = &options.html {
        let (name_a, name_b) = (name_of(&options.a), name_of(&options.b));
        let names = [name_a.as_str(), name_b.as_str()];
        let page = Page { names, a, b, comparison, exposure_ev: options.exposure };
        write_text(path, |output| page.write(output))?;
    }
    write_text(&options.output.path, |output| {
        serde_json::to_writer_pretty(&mut *output, &comparison.differences)?;
        writeln!(output)
    })
}

/// The difference is written as PNG and the page as HTML, whatever their names say.
fn check_names(options: &CompareOptions) -> Result<(), CliError> {
    let ends_in = |path: &Path, ends: &[&str]| {
        path.extension().is_some_and(|e| ends.iter().any(|end| e.eq_ignore_ascii_case(end)))
    };
    if options.diff.as_deref().is_some_and(is_standard) {
        let message = "--diff -: a picture is no text, and goes to a file";
        return Err(CliError::Usage(message.to_owned()));
    }
    if let Some(path) = &options.html
        && !is_standard(path)
        && !ends_in(path, &["html", "htm"])
    {
        let path = path.display();
        return Err(CliError::Usage(format!("--html `{path}`: the name of the page ends in .html")));
    }
    match &options.diff {
        Some(path) if !ends_in(path, &["png"]) => {
            let path = path.display();
            Err(CliError::Usage(format!("--diff `{path}`: the name of the difference ends in .png")))
        }
        Some(path) => check_output(path),
        None => Ok(()),
    }
}
