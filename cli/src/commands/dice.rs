//! `dice`.

use super::Report;
use super::json_lines::answer_lines;
use crate::dice_command;
use crate::error::CliError;
use crate::options::DiceOptions;

pub(super) fn run(options: &DiceOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output.path])?;
    answer_lines(&report, &options.input, &options.output.path, |lines, output| {
        report.stats.stage("dice", || dice_command::run(lines, output, options.areas))
    })
}
