//! Which results still stand: those that the present sources made.

use super::provenance::differs_from;
use std::path::Path;

/// Whether a study's report is there, and all that it names as its makers are commits from which no source differs now.
pub(crate) fn stands(results: &Path, name: &str) -> bool {
    let Ok(text) = std::fs::read_to_string(results.join(format!("{name}.md"))) else { return false };
    let mut makers = makers(&text).peekable();
    makers.peek().is_some() && makers.all(|maker| maker.is_some_and(|commit| !differs_from(commit)))
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
