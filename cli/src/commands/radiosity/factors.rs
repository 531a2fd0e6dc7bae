//! `radiosity factors`.

use crate::commands::Report;
use crate::commands::json_lines::answer_lines;
use crate::error::CliError;
use crate::factors_command;
use crate::options::FactorsOptions;
use pointillist_radiosity::FactorOptions;

pub(super) fn run(options: &FactorsOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output.path])?;
    let accuracy = FactorOptions::DEFAULT.with_occluded(options.tolerance);
    answer_lines(&report, &options.input, &options.output.path, |lines, output| {
        let pairs = report.stats.stage("factors", || factors_command::run(lines, output, &accuracy))?;
        report.stats.count("pairs", pairs);
        Ok(())
    })
}
