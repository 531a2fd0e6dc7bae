//! `dice`.

use super::Report;
use super::json_lines::answer_lines;
use crate::dice_command;
use crate::error::CliError;
use crate::options::DiceOptions;

pub(super) fn run(options: &DiceOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    answer_lines(&report, &options.input, &options.output.path, |input, output, name| {
        report.stats.stage("dice", || dice_command::run(input, output, options.areas, name))
    })
}
