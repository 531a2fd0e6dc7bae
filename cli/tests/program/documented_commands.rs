//! Every command that a README or `--help` shows, run as it is written from the folder of the repository; only sizes are cheaper.

use clap::CommandFactory as _;
use pointillist_cli::options::Cli;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Commands that are not run, with the reason.
const NOT_RUN: [(&str, &str); 2] = [
    ("pointillist man |", "opens a pager"),
    ("cargo ", "what the repository is built with, which its gate runs"),
];

/// What the lines of an example may begin with.
const PROGRAMS: [&str; 5] = ["pointillist", "cargo", "echo", "printf", "mkdir"];

/// The repository, if the tests run in it and not in a package of this crate alone.
fn repository() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    if folder.join("examples/house.toml").is_file() {
        return Some(folder);
    }
    eprintln!("skipped: the examples are not part of this package");
    None
}

/// A folder with a copy of `examples`, with less in the house.
fn stand_in(repository: &Path) -> TempDir {
    let folder = TempDir::new().expect("a temporary folder");
    let copy = folder.path().join("examples");
    std::fs::create_dir(&copy).expect("a folder");
    for entry in std::fs::read_dir(repository.join("examples")).expect("the examples") {
        let path = entry.expect("an example").path();
        std::fs::copy(&path, copy.join(path.file_name().expect("a name"))).expect("a copy");
    }
    // The rooms without their furniture: every face of it would be lit, and light all others.
    let house = std::fs::read_to_string(copy.join("house.obj")).expect("the house");
    let rooms = house.split("o table\n").next().expect("the rooms");
    assert!(rooms.len() < house.len(), "the house has no table any more");
    std::fs::write(copy.join("house.obj"), rooms).expect("the rooms");
    folder
}

/// The commands in lines of text; one that ends in `|` or `\` goes on in the next line. Any other text is a fault: it would be an
/// example that nobody runs.
fn commands_in<'t>(place: &str, lines: impl Iterator<Item = &'t str>) -> Vec<String> {
    let mut found = vec![];
    let mut before = String::new();
    for line in lines.map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let line = before + line;
        before = match line.strip_suffix('\\') {
            Some(half) => half.to_owned(),
            None if line.ends_with('|') => line + " ",
            None => {
                let program = line.split(' ').next().unwrap_or_default();
                assert!(PROGRAMS.contains(&program), "{place}: this is no command: `{line}`");
                found.push(line);
                String::new()
            }
        };
    }
    assert!(before.is_empty(), "{place}: `{before}` does not end");
    found
}

/// The lines of a document's blocks of commands: fenced, and of no other language.
fn fenced(text: &str) -> impl Iterator<Item = &str> {
    let mut language = None;
    text.lines().filter(move |line| {
        let fence = line.trim_start().strip_prefix("```");
        match (fence, language) {
            (Some(name), None) => language = Some(name),
            (Some(_), Some(_)) => language = None,
            _ => {}
        }
        fence.is_none() && matches!(language, Some("" | "sh"))
    })
}

/// The same command with less to do. Each change is one of size; what the command shows stays.
fn cheaply(command: &str) -> String {
    let mut words: Vec<String> = command.split(' ').map(str::to_owned).collect();
    let verb = words.iter().position(|w| w == "pointillist").map_or("", |i| {
        let verb = words.get(i + 1).map_or("", String::as_str);
        if verb == "probe" { words.get(i + 2).map_or("", String::as_str) } else { verb }
    });
    let verb = verb.to_owned();
    let mut set = |option: &str, value: &str, add: bool| {
        if let Some(at) = words.iter().position(|w| w == option) {
            words[at + 1] = value.to_owned();
        } else if add {
            words.extend([option.to_owned(), value.to_owned()]);
        }
    };
    match verb.as_str() {
        "render" | "scan" | "surfel" => set("--size", "24x16", true),
        "sample" => {
            set("--count", "1500", false);
            set("--spacing", "0.3", false);
        }
        "radiosity" => {
            set("--patch", "4", !command.ends_with("factors"));
            set("--adaptive", "3", false);
        }
        "place" => {
            set("--count", "4", !command.contains("--grid"));
            set("--grid", "2x2x1", false);
        }
        "bake" => {
            set("--resolution", "8", true);
            set("--fit", "8", false);
        }
        _ => {}
    }
    words.join(" ")
}

/// Files that a command says it writes.
fn outputs(command: &str) -> Vec<String> {
    let words: Vec<&str> = command.split_whitespace().collect();
    let named = |option: &str| words.iter().position(|w| *w == option).map(|i| words[i + 1].to_owned());
    ["-o", "--diff", "--factors", "--html", "--stats"]
        .into_iter()
        .filter_map(named)
        .filter(|name| name != "-" && !name.starts_with('~'))
        .map(|name| first_frame(&words, name))
        .collect()
}

/// The file of the first frame, where the name is one of many.
fn first_frame(words: &[&str], name: String) -> String {
    let range = words.iter().position(|w| *w == "--frames").map_or("0", |at| words[at + 1]);
    let frame: u32 = range.split('-').next().unwrap_or("0").parse().expect("a frame");
    name.replace("{frame:04}", &format!("{frame:04}")).replace("{frame}", &frame.to_string())
}

/// Runs commands one after the other in a folder of their own; `place` says where they stand.
fn run_all(repository: &Path, place: &str, commands: &[String]) {
    let folder = stand_in(repository);
    let binary = assert_cmd::cargo::cargo_bin!("pointillist");
    let path = std::env::join_paths(
        std::iter::once(binary.parent().expect("a folder").to_path_buf())
            .chain(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default())),
    )
    .expect("a search path");
    for command in commands {
        if NOT_RUN.iter().any(|(start, _)| command.starts_with(start)) {
            continue;
        }
        let line = cheaply(command);
        let run = Command::new("sh")
            .arg("-c")
            .arg(&line)
            .env("PATH", &path)
            .env("HOME", folder.path())
            .current_dir(folder.path())
            .output();
        let run = run.expect("a shell");
        let message = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{place}: `{command}`\nrun as `{line}`: {message}");
        for name in outputs(command) {
            let length = folder.path().join(&name).metadata().map_or(0, |data| data.len());
            assert!(length > 0, "{place}: `{command}` wrote no {name}");
        }
    }
}

#[test]
fn every_command_of_the_documents_runs() {
    let Some(repository) = repository() else { return };
    let folders =
        std::fs::read_dir(&repository).expect("the repository").map(|e| e.expect("an entry").path());
    let mut documents = vec![repository.join("README.md")];
    documents.extend(folders.map(|folder| folder.join("README.md")).filter(|readme| readme.is_file()));
    let docs =
        std::fs::read_dir(repository.join("docs")).expect("documents").map(|e| e.expect("an entry").path());
    documents.extend(docs.filter(|path| path.extension().is_some_and(|e| e == "md")));
    let mut count = 0;
    for document in documents {
        let text = std::fs::read_to_string(&document).expect("text");
        let place = document.display().to_string();
        let commands = commands_in(&place, fenced(&text));
        count += commands.len();
        run_all(&repository, &place, &commands);
    }
    assert!(count >= 10, "{count} commands found in the documents");
}

#[test]
fn every_command_of_the_examples_themselves_runs() {
    let Some(repository) = repository() else { return };
    let mut count = 0;
    for entry in std::fs::read_dir(repository.join("examples")).expect("the examples") {
        let path = entry.expect("an example").path();
        if path.extension().is_none_or(|end| end != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("text");
        let place = path.display().to_string();
        // Commands are indented, so that they differ from what is said about them.
        let lines = text.lines().filter_map(|line| line.strip_prefix("#   "));
        let commands = commands_in(&place, lines);
        count += commands.len();
        run_all(&repository, &place, &commands);
    }
    assert!(count > 0, "the examples name no command");
}

/// Runs the examples in the help of a command and of those below it.
fn run_help(repository: &Path, command: &clap::Command, name: &str) -> usize {
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    let place = format!("{name} --help");
    // What is not indented is said about the commands.
    let commands = commands_in(&place, help.lines().filter(|line| line.starts_with(' ')));
    run_all(repository, &place, &commands);
    let below =
        command.get_subcommands().map(|sub| run_help(repository, sub, &format!("{name} {}", sub.get_name())));
    commands.len() + below.sum::<usize>()
}

/// The examples in the help of some commands; the tests run side by side.
fn run_help_of(names: &[&str]) {
    let Some(repository) = repository() else { return };
    let root = Cli::command();
    for name in names {
        let command = root.find_subcommand(name).expect("a command");
        assert!(
            run_help(&repository, command, &format!("pointillist {name}")) > 0,
            "{name} shows no example"
        );
    }
}

#[test]
fn every_example_of_the_help_of_pictures_runs() {
    run_help_of(&["render", "scan", "sample", "surfel"]);
}

#[test]
fn every_example_of_the_help_of_baked_light_runs() {
    run_help_of(&["probe", "radiosity"]);
}

#[test]
fn every_example_of_the_help_of_files_runs() {
    run_help_of(&["dice", "compare", "info", "check", "job", "merge", "completions", "man"]);
}

#[test]
fn no_command_with_examples_is_left_out() {
    let tested = [
        "render",
        "scan",
        "sample",
        "surfel",
        "probe",
        "radiosity",
        "dice",
        "compare",
        "info",
        "check",
        "job",
        "merge",
        "completions",
        "man",
    ];
    for command in Cli::command().get_subcommands() {
        let name = command.get_name();
        assert!(tested.contains(&name) || name == "help", "the examples of `{name}` are not run");
    }
}

#[test]
fn a_command_that_names_a_missing_file_fails() {
    let Some(repository) = repository() else { return };
    let command = "pointillist check examples/not-there.toml".to_owned();
    let run = std::panic::catch_unwind(|| run_all(&repository, "a test", &[command]));
    let message = run.expect_err("it must fail");
    let message = message.downcast_ref::<String>().expect("a message");
    assert!(message.contains("not-there.toml"), "{message}");
}

#[test]
fn commands_may_go_on_in_the_next_line() {
    let text = "```sh\n# first\necho 1 |\n  pointillist dice\npointillist render \\\n  a.toml\n```\nprose\n```rust\nlet a;\n```\n";
    let commands = commands_in("a test", fenced(text));
    assert_eq!(commands, ["echo 1 | pointillist dice", "pointillist render a.toml"]);
}

#[test]
#[should_panic(expected = "this is no command: `ponitillist render`")]
fn a_line_that_is_no_command_fails() {
    commands_in("a test", ["ponitillist render"].into_iter());
}
