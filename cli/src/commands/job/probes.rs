//! Probes: a task for each part of them, then one that joins the parts.

use super::{count, file, job, named_from, program, step, template::Node, words};
use crate::commands::Report;
use crate::commands::probe::is_probe_file;
use crate::error::CliError;
use crate::options::{BakeOptions, Command, JobOptions, ProbeCommand, parse};
use crate::probe_io::read_probes;
use crate::scene::{self, Overrides};
use std::path::{Path, PathBuf};

pub(super) fn template(options: &JobOptions, report: &Report<'_>) -> Result<Node, CliError> {
    let probes = options.probes.as_deref().unwrap_or(Path::new("probes.json"));
    let bake = bake_options(options, probes)?;
    let folder = options.output.parent().unwrap_or(Path::new(""));
    let result = options.result.clone().unwrap_or_else(|| folder.join("baked.json"));
    if !is_probe_file(&result) {
        let message = format!("--result {}: a file of probes ends in .json or .probes", result.display());
        return Err(CliError::Usage(message));
    }
    let assignments = bake.set.iter().map(|a| ("--set".to_owned(), a.clone())).collect();
    let loaded =
        report.stats.stage("load", || scene::load_to_bake(&options.scene, &Overrides { assignments }))?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let places = report.stats.stage("load", || read_probes(probes))?.probes.len();
    if places < options.tiles as usize {
        let message = format!("--tiles {}: there are only {places} probes", options.tiles);
        return Err(CliError::Usage(message));
    }
    let extension = result.extension().unwrap_or_default().to_string_lossy().into_owned();
    let name = |path: &Path| named_from(&options.output, path);
    let parameters = vec![
        file(
            "Scene",
            "IN",
            &name(&options.scene)?,
            "The scene; tasks find the files that it names where it says",
        ),
        file("Probes", "IN", &name(probes)?, "Where the probes are"),
        file("Output", "OUT", &name(&result)?, "The baked probes: .json or .probes"),
        count("Parts", options.tiles, u32::try_from(places).unwrap_or(u32::MAX), "Tasks that bake"),
        program(),
    ];
    let part = format!("{{{{Param.Output}}}}.part{{{{Task.Param.Part}}}}.{extension}");
    let mut arguments = words(&[
        "probe",
        "bake",
        "{{Param.Scene}}",
        "{{Param.Probes}}",
        "--part",
        "{{Task.Param.Part}}of{{Param.Parts}}",
        "-o",
        &part,
        "--progress",
        "openjd",
    ]);
    if bake.bounces.is_none() && bake.indirect.is_none() {
        // A bounce would need the light of all parts.
        arguments.extend(words(&["--bounces", "0"]));
    }
    arguments.extend(options.more.iter().map(|word| Node::text(word)));
    let parts = format!("{{{{Param.Output}}}}.part{{tile}}.{extension}");
    let merge =
        ["merge", &parts, "--tiles", "{{Param.Parts}}", "-o", "{{Param.Output}}", "--progress", "openjd"];
    let steps = vec![
        step("Parts", None, &[("Part", "1-{{Param.Parts}}")], arguments),
        step("Merge", Some("Parts"), &[], words(&merge)),
    ];
    Ok(job(options, parameters, steps))
}

fn bake_options(options: &JobOptions, probes: &Path) -> Result<BakeOptions, CliError> {
    let mut line: Vec<String> = ["pointillist", "probe", "bake"].map(str::to_owned).into();
    line.extend(
        [&options.scene, &probes.to_path_buf()].map(|path: &PathBuf| path.to_string_lossy().into_owned()),
    );
    line.extend_from_slice(&options.more);
    let wrong = |message: String| CliError::Usage(format!("options for `probe bake`: {message}"));
    let Command::Probe { command: ProbeCommand::Bake(bake) } = parse(&line).map_err(wrong)? else {
        unreachable!("the line is one of `probe bake`");
    };
    let taken = [
        ("--part", bake.part.is_some()),
        ("-o", bake.output != Path::new("baked.json")),
        ("--stats", bake.common.stats.is_some()),
        ("--progress", bake.common.progress.is_some()),
    ];
    if let Some((option, _)) = taken.iter().find(|(_, given)| *given) {
        return Err(wrong(format!("{option} is what the template says for each task")));
    }
    if bake.bounces.is_some_and(|bounces| bounces > 0) || bake.fit > 0 {
        let message =
            "parts know nothing of one another's light: leave --bounces and --fit out, or use --indirect";
        return Err(wrong(message.to_owned()));
    }
    Ok(bake)
}
