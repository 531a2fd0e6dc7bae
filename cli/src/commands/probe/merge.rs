//! Joins what `probe bake --part` wrote.

use super::write;
use crate::commands::Report;
use crate::commands::report::name_of_output;
use crate::error::CliError;
use crate::input::name_of;
use crate::options::MergeOptions;
use crate::probe_io::{ProbeFile, read_probes};

/// `merge` of probes.
pub(in crate::commands) fn merge_probes(options: &MergeOptions, report: &Report<'_>) -> Result<(), CliError> {
    let mut parts = vec![];
    for path in &options.parts {
        let name = name_of(path);
        let file = report.stats.stage("load", || read_probes(path))?;
        if file.part.is_none() || file.first.is_none() {
            return Err(CliError::Parts(format!(
                "{name} was not written by `pointillist probe bake --part`"
            )));
        }
        parts.push((name, file));
    }
    parts.sort_by_key(|(_, file)| file.first);
    let (first_name, first) = &parts[0];
    let mut whole = ProbeFile { part: None, first: None, total: None, ..first.header() };
    let mut next = 0;
    for (name, file) in &parts {
        if file.fingerprint != first.fingerprint || file.total != first.total {
            let message =
                format!("{first_name} and {name} are not parts of the same probes: scene or options differ");
            return Err(CliError::Parts(message));
        }
        let (begins, range) = (file.first.unwrap_or_default(), file.part.as_deref().unwrap_or_default());
        if begins != next {
            let what = if begins > next { "is a gap" } else { "is an overlap" };
            return Err(CliError::Parts(format!("there {what} before {name}, which is part {range}")));
        }
        next = end_of(file).ok_or_else(|| CliError::Parts(format!("{name}: `part` is {range}")))?;
        whole.probes.extend(file.probes.iter().cloned());
    }
    if Some(next) != first.total {
        return Err(CliError::Parts(format!("there is a gap after probe {next}")));
    }
    whole.mark_buried();
    report.stats.count("parts", parts.len() as u64);
    report.stats.stage("write", || write(&options.output, &whole))?;
    report.note(&format!("{} parts joined in {}", parts.len(), name_of_output(&options.output)));
    report.finish()
}

/// Where a part ends among all probes, before any were left out.
fn end_of(file: &ProbeFile) -> Option<usize> {
    let part: crate::options::Tile = file.part.as_deref()?.parse().ok()?;
    Some(file.total?.checked_mul(part.last as usize + 1)? / part.count as usize)
}
