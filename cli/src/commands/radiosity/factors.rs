//! `radiosity factors`.

use super::factor_lines;
use crate::commands::Report;
use crate::commands::json_lines::answer_lines;
use crate::error::CliError;
use crate::options::FactorsOptions;
use pointillist_radiosity::FactorOptions;

pub(super) fn run(options: &FactorsOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output.path])?;
    let accuracy = FactorOptions::DEFAULT.with_occluded(options.tolerance);
    answer_lines(&report, &options.input, &options.output.path, |lines, output| {
        let pairs = report.stats.stage("factors", || factor_lines::answer_all(lines, output, &accuracy))?;
        report.stats.count("pairs", pairs);
        Ok(())
    })
}
