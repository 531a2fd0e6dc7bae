//! `job`: Open Job Description templates, <https://github.com/OpenJobDescription/openjd-specifications>, `jobtemplate-2023-09`.
//!
//! A template has no arithmetic and no lists that depend on parameters. So tiles are counted from 1 (`--tile 3of8`), and `merge` is given
//! the pattern of its parts' names and their number, not the names.

mod pictures;
mod probes;
mod template;

use super::Report;
use super::report::{check_output, name_of_output, write_text};
use crate::error::CliError;
use crate::input::is_standard;
use crate::options::JobOptions;
use std::path::Path;
use template::Node;

/// Which version of the specification templates follow.
const VERSION: &str = "jobtemplate-2023-09";

/// Seconds between SIGTERM and SIGKILL for a task that is cancelled: time to end the tiles that are begun, and to keep them.
const NOTIFY_SECONDS: i64 = 120;

/// Longest name of a job.
const MOST_NAME: usize = 64;

pub(super) fn run(options: &JobOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let as_json = match options.output.extension().and_then(|e| e.to_str()) {
        _ if is_standard(&options.output) => false,
        Some("json") => true,
        Some("yaml" | "yml") => false,
        _ => {
            let message = format!("`{}`: a template ends in .json or .yaml", options.output.display());
            return Err(CliError::Usage(message));
        }
    };
    check_output(&options.output)?;
    if is_standard(&options.scene) || options.probes.as_deref().is_some_and(is_standard) {
        return Err(CliError::Usage(
            "a job reads its scene and its probes from files, not from `-`".to_owned(),
        ));
    }
    if let Some(word) = options.more.iter().find(|word| word.contains("{{")) {
        return Err(CliError::Usage(format!("`{word}`: in a template, {{{{ begins the name of a parameter")));
    }
    let template = if options.probes.is_some() {
        probes::template(options, &report)?
    } else {
        pictures::template(options, &report)?
    };
    report.stats.stage("write", || {
        write_text(&options.output, |output| {
            let text = if as_json { template.to_json() } else { template.to_yaml() };
            output.write_all(text.as_bytes())
        })
    })?;
    if !is_standard(&options.output) {
        report.note(&format!("{}: submit it, or try it with `openjd run`", name_of_output(&options.output)));
    }
    report.finish()
}

/// A whole template.
fn job(options: &JobOptions, parameters: Vec<Node>, steps: Vec<Node>) -> Node {
    let stem = options.scene.file_stem().unwrap_or_default().to_string_lossy();
    let name: String =
        stem.chars().filter(|c| !c.is_control() && !"{}".contains(*c)).take(MOST_NAME).collect();
    Node::map([
        ("specificationVersion", Node::text(VERSION)),
        ("name", Node::text(if name.is_empty() { "pointillist" } else { &name })),
        ("parameterDefinitions", Node::List(parameters)),
        ("steps", Node::List(steps)),
    ])
}

/// A parameter of the job that is a file.
fn file(name: &str, flow: &str, default: &str, description: &str) -> Node {
    Node::map([
        ("name", Node::text(name)),
        ("type", Node::text("PATH")),
        ("objectType", Node::text("FILE")),
        ("dataFlow", Node::text(flow)),
        ("default", Node::text(default)),
        ("description", Node::text(description)),
    ])
}

/// A parameter of the job that is a count, from 1.
fn count(name: &str, default: u32, most: u32, description: &str) -> Node {
    Node::map([
        ("name", Node::text(name)),
        ("type", Node::text("INT")),
        ("minValue", Node::Number(1)),
        ("maxValue", Node::Number(most.into())),
        ("default", Node::Number(default.into())),
        ("description", Node::text(description)),
    ])
}

/// Where tasks find this program.
fn program() -> Node {
    Node::map([
        ("name", Node::text("Program")),
        ("type", Node::text("STRING")),
        ("default", Node::text("pointillist")),
        ("description", Node::text("The program, by its path where it is not on the search path")),
    ])
}

/// A step that runs this program once for each combination of its task parameters, which are whole numbers.
fn step(name: &str, after: Option<&str>, parameters: &[(&str, &str)], arguments: Vec<Node>) -> Node {
    let parameter = |(name, range): &(&str, &str)| {
        Node::map([("name", Node::text(name)), ("type", Node::text("INT")), ("range", Node::text(range))])
    };
    let mut entries = vec![("name", Node::text(name))];
    if let Some(step) = after {
        entries.push(("dependencies", Node::List(vec![Node::map([("dependsOn", Node::text(step))])])));
    }
    if !parameters.is_empty() {
        let definitions = Node::List(parameters.iter().map(parameter).collect());
        entries.push(("parameterSpace", Node::map([("taskParameterDefinitions", definitions)])));
    }
    let cancelation = Node::map([
        ("mode", Node::text("NOTIFY_THEN_TERMINATE")),
        ("notifyPeriodInSeconds", Node::Number(NOTIFY_SECONDS)),
    ]);
    let run = Node::map([
        ("command", Node::text("{{Param.Program}}")),
        ("args", Node::List(arguments)),
        ("cancelation", cancelation),
    ]);
    entries.push(("script", Node::map([("actions", Node::map([("onRun", run)]))])));
    Node::Map(entries)
}

fn words(list: &[&str]) -> Vec<Node> {
    list.iter().map(|word| Node::text(word)).collect()
}

/// A file as the template names it: relative to the template's folder if it is in there, as the specification wants it, else in full.
fn named_from(template: &Path, file: &Path) -> Result<String, CliError> {
    let failed = |error: std::io::Error| CliError::Failed(format!("{}: {error}", file.display()));
    let folder_of = |path: &Path| {
        let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        // A folder that is not there yet is named as it is written.
        parent.canonicalize().or_else(|_| std::path::absolute(parent))
    };
    // A template on standard output is for the folder that the user is in.
    let base =
        folder_of(if is_standard(template) { Path::new("template") } else { template }).map_err(failed)?;
    let full = folder_of(file).map_err(failed)?.join(file.file_name().unwrap_or_default());
    let named = full.strip_prefix(&base).unwrap_or(&full);
    named.to_str().map(str::to_owned).ok_or_else(|| {
        CliError::Usage(format!("`{}`: a template can only name files in Unicode", file.display()))
    })
}
