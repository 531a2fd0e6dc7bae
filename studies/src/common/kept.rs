//! Sections of a result that could not be measured again stay as they were: without the large data, or without a peer, a study would replace
//! figures by the word that it skipped them.

use super::provenance::provenance;
use super::{data, peers};

/// What stands under a section that was kept, before what is known of its making.
const KEPT: &str = "Kept from an earlier run, since not all that it takes was there this time";

/// Whether some of a text was skipped for want of data or of a peer.
pub(crate) fn lacks_something(text: &str) -> bool {
    text.contains(data::SKIPPED) || text.contains(peers::SKIPPED)
}

/// A report, in which sections that [lack something](lacks_something) are replaced by those of the same heading in the report before, with a note of what these were made by.
pub(crate) fn with_former(text: &str, former: &str) -> String {
    let header = sections(former).next().unwrap_or_default();
    let replaced = sections(text).map(|section| {
        let heading = heading(section).filter(|_| lacks_something(section));
        let same = heading.and_then(|h| sections(former).find(|s| self::heading(s) == Some(h)));
        match same.filter(|s| !lacks_something(s)) {
            Some(kept) if kept.contains(KEPT) => kept.trim_end().to_owned() + "\n\n",
            Some(kept) => {
                let made = made_by(kept).or_else(|| made_by(header));
                let made = made.map_or(String::new(), |made| format!(" ({made})"));
                format!("{}\n\n{KEPT}{made}.\n\n", kept.trim_end())
            }
            None => section.to_owned(),
        }
    });
    replaced.collect::<String>().trim_end().to_owned() + "\n"
}

/// A report with this head whose sections are those of the report before, but for those of `text`, which were measured now: each says on what it was.
pub(crate) fn with_sections(head: &str, before: &str, text: &str) -> String {
    let of = |text: &str| -> Vec<String> {
        sections(text).filter(|s| heading(s).is_some()).map(str::to_owned).collect()
    };
    let mut all = of(before);
    for section in of(text) {
        let section = format!("{}\n\nMeasured on {}.\n", section.trim_end(), provenance());
        match all.iter().position(|s| heading(s) == heading(&section)) {
            Some(place) => all[place] = section,
            None => all.push(section),
        }
    }
    all.iter().fold(head.to_owned(), |whole, section| format!("{whole}\n{}\n", section.trim_end()))
}

/// A text before each heading of the second level; the first piece has none.
fn sections(text: &str) -> impl Iterator<Item = &str> {
    let at = |(place, _): (usize, &str)| place + 1;
    let mut cuts: Vec<usize> = text.match_indices("\n## ").map(at).collect();
    if !text.starts_with("## ") {
        cuts.insert(0, 0);
    }
    let ends: Vec<usize> = cuts.iter().skip(1).copied().chain([text.len()]).collect();
    cuts.into_iter().zip(ends).map(|(from, to)| &text[from..to])
}

fn heading(section: &str) -> Option<&str> {
    section.lines().next().filter(|line| line.starts_with("## "))
}

/// The commit and the date, as [`super::provenance::provenance`] writes them: the last of a text.
fn made_by(text: &str) -> Option<&str> {
    let made = &text[text.rfind("commit ")?..];
    let date = made.find(", 20")?;
    made.get(..date + ", 2026-11-25".len()).filter(|made| !made.contains('\n'))
}

#[cfg(test)]
mod tests {
    use super::data::SKIPPED;
    use super::*;

    const FORMER: &str = "# A study\n\nMade on commit 0123456789 with changes, 2026-11-25, rustc 1.\n\n## Balls\n\n1 s\n\n## Buildings\n\n57 s\n";

    fn without_data() -> String {
        format!(
            "# A study\n\nMade on commit abc, 2026-11-26, rustc 1.\n\n## Balls\n\n2 s\n\n## Buildings\n\n{SKIPPED}\n"
        )
    }

    #[test]
    fn a_part_that_is_measured_alone_leaves_the_others_as_they_were() {
        let text = with_sections("# A study\n", FORMER, "\n## Balls\n\n3 s\n\n## Cubes\n\n4 s\n");
        assert!(text.starts_with("# A study\n\n## Balls\n\n3 s\n\nMeasured on "), "{text}");
        assert!(text.contains("\n\n## Buildings\n\n57 s\n\n## Cubes\n\n4 s\n\nMeasured on "), "{text}");
        assert!(!text.contains("\n1 s"), "{text}");
    }

    #[test]
    fn a_peer_that_is_not_there_keeps_its_last_figures() {
        let lacking = format!("# A study\n\n## Balls\n\n{}\n", peers::skipped("Embree", "PEER"));
        let text = with_former(&lacking, FORMER);
        assert!(text.contains("## Balls\n\n1 s\n") && text.contains(KEPT), "{text}");
    }

    #[test]
    fn what_was_skipped_stays_as_it_was_and_says_of_when_it_is() {
        let text = with_former(&without_data(), FORMER);
        assert!(text.contains("2 s") && !text.contains("1 s"), "what was measured is new: {text}");
        assert!(text.contains("## Buildings\n\n57 s\n") && !text.contains(SKIPPED), "{text}");
        assert!(text.ends_with(&format!("{KEPT} (commit 0123456789 with changes, 2026-11-25).\n")), "{text}");
        assert!(text.starts_with("# A study\n\nMade on commit abc"), "{text}");
        // A third run knows that the section is of the first.
        assert_eq!(with_former(&without_data(), &text), text);
        let measured = without_data().replace(SKIPPED, "41 s");
        assert_eq!(with_former(&measured, &text), measured, "with data nothing is kept");
    }

    #[test]
    fn without_a_former_section_it_is_said_that_it_was_skipped() {
        for former in ["", "# A study\n\n## Balls\n\n1 s\n", &without_data()] {
            assert_eq!(with_former(&without_data(), former), without_data());
        }
    }

    #[test]
    fn a_section_that_names_its_own_commit_is_of_that() {
        let former = FORMER.replace("57 s", "57 s\n\nMeasured on commit 42, 2026-11-24, rustc 1.");
        let text = with_former(&without_data(), &former);
        assert!(text.contains("(commit 42, 2026-11-24)."), "{text}");
    }
}
