//! `dice`.

use super::Report;
use super::json_lines::answer_lines;
use super::polygon_lines;
use crate::error::CliError;
use crate::options::DiceOptions;

pub(super) fn run(options: &DiceOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output.path])?;
    answer_lines(&report, &options.input, &options.output.path, |lines, output| {
        report.stats.stage("dice", || polygon_lines::answer_all(lines, output, options.areas))
    })
}
