//! Which results still stand: those that the present sources made.

use super::provenance::differs_from;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Whether a study's report is there, and all that it names as its makers are commits from which none of its sources differs now.
pub(crate) fn stands(results: &Path, name: &str) -> bool {
    let Ok(text) = std::fs::read_to_string(results.join(format!("{name}.md"))) else { return false };
    let sources = sources(name);
    let mut makers = makers(&text).peekable();
    makers.peek().is_some() && makers.all(|maker| maker.is_some_and(|commit| !differs_from(commit, &sources)))
}

/// Modules for all studies that decide how a table is written, and nothing that is in it.
const WRITING: [&str; 4] = ["kept", "machine", "provenance", "report"];

/// Files and folders that a study measures and is measured by, from the root of the repository: its own and those of `common` that it names, and the crates that
/// its own files name, with those that they depend on. (What it shares with others reads files by other crates; these do not count.)
fn sources(study: &str) -> Vec<String> {
    let mut modules = vec![if study == "together" { "shprobe" } else { study }.to_owned()];
    let mut found = BTreeSet::from(["Cargo.toml", "Cargo.lock"].map(str::to_owned));
    let mut crates = vec![];
    while let Some(module) = modules.pop() {
        let text = text_of(&module);
        // A module is a file, a folder, or both.
        if text.is_empty() || !found.insert(format!("studies/src/{module}")) {
            continue;
        }
        found.insert(format!("studies/src/{module}.rs"));
        let is_common = module.starts_with("common/");
        let shared =
            names_after(&text, "common::").chain(names_after(&text, "super::").filter(|_| is_common));
        modules.extend(shared.filter(|name| !WRITING.contains(name)).map(|name| format!("common/{name}")));
        if is_common {
            continue;
        }
        modules.extend(names_after(&text, "crate::").filter(|name| *name != "common").map(str::to_owned));
        crates.extend(names_after(&text, "pointillist_").map(str::to_owned));
        if text.contains(PROGRAM) {
            crates.push("cli".to_owned());
        }
    }
    while let Some(name) = crates.pop() {
        let manifest = std::fs::read_to_string(root().join(&name).join("Cargo.toml")).unwrap_or_default();
        if !manifest.is_empty() && found.insert(name) {
            let (dependencies, _) = manifest.split_once("[dev-dependencies]").unwrap_or((&manifest, ""));
            crates.extend(names_after(dependencies, "\npointillist-").map(str::to_owned));
        }
    }
    found.into_iter().collect()
}

/// What the files of a study have in them that runs the built program.
const PROGRAM: &str = "format!(\"pointillist{}\"";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All files of a module of the studies.
fn text_of(module: &str) -> String {
    let source = root().join("studies/src").join(module);
    let files = files_in(&source).into_iter().chain([source.with_extension("rs")]);
    files.filter_map(|file| std::fs::read_to_string(file).ok()).collect()
}

/// The files in a folder and those below it; none if it is not there.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    entries.flat_map(|path| if path.is_dir() { files_in(&path) } else { vec![path] }).collect()
}

/// The names that follow a piece of text.
fn names_after<'a>(text: &'a str, before: &'a str) -> impl Iterator<Item = &'a str> {
    let is_end = |c: char| !c.is_ascii_alphanumeric() && c != '_';
    let name = move |rest: &'a str| &rest[..rest.find(is_end).unwrap_or(rest.len())];
    text.split(before).skip(1).map(name).filter(|name| !name.is_empty())
}

/// The commits that a report says it was made on; none in the place of one that had changes.
fn makers(text: &str) -> impl Iterator<Item = Option<&str>> {
    text.split("commit ").skip(1).filter_map(|after| {
        let end = after.find(|c: char| !c.is_ascii_hexdigit()).unwrap_or(after.len());
        let (hash, rest) = after.split_at(end);
        (hash.len() >= 7).then(|| (!rest.starts_with(" with changes")).then_some(hash))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn makers_are_commits_without_changes() {
        let text = "# A\n\nmade this (commit 0123456789, 2026).\n\n## B\n\nMeasured on commit abcdef0123 with changes, 2026.\n\
                    Every commit has such a table; a commit face to face.\n";
        assert_eq!(makers(text).collect::<Vec<_>>(), [Some("0123456789"), None]);
    }

    #[test]
    fn sources_are_what_a_study_measures() {
        let has = |study: &str, source: &str| sources(study).iter().any(|s| s == source);
        for (study, source) in [
            ("dice", "dice"),
            ("dice", "studies/src/dice.rs"),
            ("dice", "studies/src/common/timing.rs"),
            ("shadow", "dice"),
            ("surfel", "view"),
            ("surfel", "studies/src/surfel"),
            ("radiosity", "studies/src/shprobe"),
            ("together", "radiosity"),
            ("speed", "ibpr"),
            ("expected", "octree"),
        ] {
            assert!(has(study, source), "{study} without {source}: {:?}", sources(study));
        }
        for (study, other) in [
            ("dice", "surfel"),
            ("shade", "dice"),
            ("ibpr", "surfel"),
            ("surfel", "studies/src/dice.rs"),
            ("surfel", "studies/src/common/provenance.rs"),
        ] {
            assert!(!has(study, other), "{study} with {other}");
        }
    }

    #[test]
    fn a_report_that_names_no_commit_or_an_unknown_one_does_not_stand() {
        let folder = std::env::temp_dir().join(format!("standing-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for text in ["made by hand\n", "made this (commit 0000000000, 2026)\n"] {
            std::fs::write(folder.join("a.md"), text).unwrap();
            assert!(!stands(&folder, "a"), "{text}");
        }
        assert!(!stands(&folder, "b"));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
