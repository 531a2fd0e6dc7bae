//! `mutants`: how many small faults in the code make a test fail, from the runs of `.ci/mutants`.

use std::fmt::Write as _;
use std::path::Path;

use crate::common::provenance::provenance;
use crate::common::report::Outcome;

/// Where `.ci/mutants` leaves a folder for each run.
const RUNS: &str = "../target/mutants";

/// One run of `cargo mutants`.
struct Run {
    name: String,
    caught: usize,
    /// Faults that no test saw.
    missed: Vec<String>,
    /// Tests that did not end: seen, too.
    timeouts: usize,
    /// What does not compile.
    unviable: usize,
}

impl Run {
    fn read(folder: &Path, name: String) -> std::io::Result<Self> {
        let lines = |list: &str| -> std::io::Result<Vec<String>> {
            let text = std::fs::read_to_string(folder.join("mutants.out").join(format!("{list}.txt")))?;
            Ok(text.lines().map(str::to_owned).collect())
        };
        Ok(Self {
            name,
            caught: lines("caught")?.len(),
            missed: lines("missed")?,
            timeouts: lines("timeout")?.len(),
            unviable: lines("unviable")?.len(),
        })
    }

    fn seen(&self) -> usize {
        self.caught + self.timeouts
    }

    /// Of the faults that compile, the share that was seen.
    fn score(&self) -> f64 {
        self.seen() as f64 / (self.seen() + self.missed.len()).max(1) as f64
    }
}

/// Writes `mutants.md`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(RUNS);
    let entries = std::fs::read_dir(&folder)
        .map_err(|fault| format!("{}: {fault}; `.ci/mutants` makes it", folder.display()))?;
    let mut runs = vec![];
    for entry in entries {
        let entry = entry?;
        runs.push(Run::read(&entry.path(), entry.file_name().to_string_lossy().into_owned())?);
    }
    runs.sort_by(|a, b| a.name.cmp(&b.name));
    std::fs::write(out_dir.join("mutants.md"), table(&runs))?;
    Ok(true)
}

fn table(runs: &[Run]) -> String {
    let mut text = format!(
        "# Faults that tests see\n\n`.ci/mutants` made this ({}). `cargo mutants` puts one small fault into the code at a time (another operator, another \
         result) and runs the tests of the crate. Of the faults that compile, the score is the share that made a test fail or never end. A sample, evenly \
         spread over the code, except where all were tried. Equivalent code and the facts of property tests themselves are left out, see \
         `.cargo/mutants.toml`.\n\n| code | faults | seen | not seen | score |\n| --- | ---: | ---: | ---: | ---: |\n",
        provenance()
    );
    for run in runs {
        let (seen, missed) = (run.seen(), run.missed.len());
        let _ = writeln!(
            text,
            "| {} | {} | {seen} | {missed} | {:.0} % |",
            run.name,
            seen + missed + run.unviable,
            100.0 * run.score()
        );
    }
    text += "\nNot seen:\n\n";
    for missed in runs.iter().flat_map(|run| &run.missed) {
        let _ = writeln!(text, "* `{missed}`");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_that_never_end_are_seen_and_those_that_do_not_compile_do_not_count() {
        let missed = vec!["a.rs:1:2: replace f -> bool with true".to_owned()];
        let run = Run { name: "x".to_owned(), caught: 6, missed, timeouts: 1, unviable: 5 };
        assert_eq!(run.score(), 7.0 / 8.0);
        let text = table(&[run]);
        assert!(text.contains("| x | 13 | 7 | 1 | 88 % |"), "{text}");
        assert!(text.contains("* `a.rs:1:2: replace"), "{text}");
    }
}
