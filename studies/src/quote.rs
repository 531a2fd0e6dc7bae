//! `quote`: tables of results in READMEs, between marks that say which they are:
//!
//! ```text
//! <!-- quote: surfel.md#beside-the-paper; columns 1 2 4; rows the paper | blended -->
//! …
//! <!-- end of quote -->
//! ```
//!
//! `columns` (from 1) and `rows` (beginnings of their first cells, in their order; `matt / * / exact` of their first three, whatever the second is) may be left out. `quote` writes the tables anew; `quote --check`
//! fails where one would differ by more than figures.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::common::report::Outcome;

const BEGIN: &str = "<!-- quote: ";
const END: &str = "<!-- end of quote -->";

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Rewrites the quotes of all READMEs, or finds those that are out of date; `false` if there are such.
pub(crate) fn run(results: &Path, only_check: bool) -> Outcome {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("the studies are in no workspace")?;
    let (mut quotes, mut stale) = (0, 0);
    for readme in readmes(root)? {
        let text = std::fs::read_to_string(&readme)?;
        let name = readme.strip_prefix(root).unwrap_or(&readme).display().to_string();
        let quoted = Quoted::of(&text, results).map_err(|fault| format!("{name}: {fault}"))?;
        quotes += quoted.count;
        if only_check && without_figures(&quoted.text) != without_figures(&text) {
            eprintln!(
                "{name}: its quotes differ from the results by more than figures; `cargo run -p studies -- quote` mends them"
            );
            stale += 1;
        } else if !only_check && quoted.text != text {
            std::fs::write(&readme, quoted.text)?;
            eprintln!("{name}: written");
        }
    }
    eprintln!("quote: {quotes} tables");
    Ok(stale == 0)
}

/// That of the workspace and those of the folders in it.
fn readmes(root: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut found = vec![root.join("README.md")];
    for entry in std::fs::read_dir(root)? {
        found.push(entry?.path().join("README.md"));
    }
    found.retain(|path| path.is_file());
    found.sort();
    Ok(found)
}

/// A README whose quotes are those of the results now.
struct Quoted {
    text: String,
    count: usize,
}

impl Quoted {
    fn of(text: &str, results: &Path) -> Result<Self, Fault> {
        let (mut written, mut count, mut rest) = (String::new(), 0, text);
        while let Some((before, after)) = rest.split_once(BEGIN) {
            let (mark, after) = after.split_once(" -->").ok_or("a mark of a quote does not end")?;
            let (_, after) =
                after.split_once(END).ok_or_else(|| format!("the quote `{mark}` does not end"))?;
            let table = Wanted::parse(mark)?.read(results)?;
            let _ = write!(written, "{before}{BEGIN}{mark} -->\n{table}{END}");
            (count, rest) = (count + 1, after);
        }
        Ok(Self { text: written + rest, count })
    }
}

/// What a mark asks for.
struct Wanted<'a> {
    file: &'a str,
    /// As links to headings have it.
    heading: &'a str,
    columns: Option<Vec<usize>>,
    rows: Option<Vec<&'a str>>,
}

impl<'a> Wanted<'a> {
    fn parse(mark: &'a str) -> Result<Self, Fault> {
        let mut parts = mark.split("; ");
        let place = parts.next().and_then(|place| place.split_once('#'));
        let (file, heading) = place.ok_or_else(|| format!("`{mark}` names no FILE.md#heading"))?;
        let mut wanted = Self { file, heading, columns: None, rows: None };
        for part in parts {
            match part.split_once(' ') {
                Some(("columns", list)) => {
                    let numbers = list.split(' ').map(str::parse).collect::<Result<_, _>>();
                    wanted.columns = Some(numbers.map_err(|_| format!("`{part}` are not numbers"))?);
                }
                Some(("rows", list)) => wanted.rows = Some(list.split(" | ").collect()),
                _ => return Err(format!("`{part}` is neither columns nor rows").into()),
            }
        }
        Ok(wanted)
    }

    /// The first table below the heading, of the columns and rows that are wanted.
    fn read(&self, results: &Path) -> Result<String, Fault> {
        let text =
            std::fs::read_to_string(results.join(self.file)).map_err(|e| format!("{}: {e}", self.file))?;
        let mut lines = text.lines().skip_while(|line| !is_heading(line, self.heading));
        let heading =
            lines.next().ok_or_else(|| format!("{} has no heading `{}`", self.file, self.heading))?;
        let in_section = lines.take_while(|line| !line.starts_with('#'));
        let table: Vec<&str> = in_section
            .skip_while(|line| !line.starts_with('|'))
            .take_while(|line| line.starts_with('|'))
            .collect();
        let [head, rule, body @ ..] = &table[..] else {
            return Err(format!("no table below `{heading}`").into());
        };
        let mut chosen = vec![*head, *rule];
        match &self.rows {
            None => chosen.extend(body),
            Some(rows) => {
                for row in rows {
                    let found = body.iter().find(|line| begins(line, row));
                    chosen.push(found.ok_or_else(|| format!("no row `{row}` below `{heading}`"))?);
                }
            }
        }
        let lines = chosen.iter().map(|line| self.columns_of(line)).collect::<Result<Vec<_>, _>>()?;
        Ok(lines.join("\n") + "\n")
    }

    fn columns_of(&self, line: &str) -> Result<String, Fault> {
        let Some(columns) = &self.columns else { return Ok(line.to_owned()) };
        let cells = cells(line);
        let of = |&column: &usize| {
            let cell = column.checked_sub(1).and_then(|index| cells.get(index));
            cell.copied().ok_or_else(|| format!("{} has no column {column}", self.file))
        };
        let chosen = columns.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        Ok(format!("| {} |", chosen.join(" | ")))
    }
}

/// Whether the first cells of a row begin as a mark has it: `matt / * / exact`.
fn begins(line: &str, beginnings: &str) -> bool {
    let (cells, beginnings): (_, Vec<&str>) = (cells(line), beginnings.split(" / ").collect());
    let fits = |(cell, start): (&&str, &&str)| *start == "*" || cell.starts_with(start);
    cells.len() >= beginnings.len() && cells.iter().zip(&beginnings).all(fits)
}

/// The cells of a row of a table.
fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_start_matches('|').trim_end_matches('|').split('|').map(str::trim).collect()
}

/// Whether a line is the heading that a link calls so.
fn is_heading(line: &str, link: &str) -> bool {
    let title = line.trim_start_matches('#').trim();
    let kept = title.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-');
    line.starts_with('#')
        && kept.flat_map(char::to_lowercase).map(|c| if c == ' ' { '-' } else { c }).eq(link.chars())
}

/// A text without its numbers and what spread and verdict make of them.
fn without_figures(text: &str) -> String {
    let mut kept = String::new();
    let mut is_figure = false;
    for c in text.chars() {
        let goes_on = c.is_ascii_digit() || (is_figure && ".,e-+×".contains(c));
        if goes_on && !is_figure {
            kept.push('0');
        } else if !goes_on {
            kept.push(c);
        }
        is_figure = goes_on;
    }
    // ± and noise come and go with the quiet of the machine.
    kept.replace(" ± 0 %", "").replace(", noisy", "")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quoted(readme: &str) -> Result<String, String> {
        let folder = std::env::temp_dir().join(format!(
            "quote-{}-{:?}",
            std::process::id(),
            std::thread::current().id()
        ));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        let table = "# Title\n\n| other |\n| --- |\n\n## One, and two\n\nText.\n\n| name | s | RMSE |\n| --- | ---: | ---: |\n| a b | 1 | 2 |\n| c | 3 | 4 |\n";
        std::fs::write(folder.join("x.md"), table).expect("a file");
        let found = Quoted::of(readme, &folder).map(|q| q.text).map_err(|e| e.to_string());
        std::fs::remove_dir_all(&folder).expect("the folder");
        found
    }

    #[test]
    fn tables_are_quoted_whole_or_in_part() {
        let whole =
            quoted("A.\n<!-- quote: x.md#one-and-two -->\nold\n<!-- end of quote -->\nB.").expect("a quote");
        assert!(
            whole.starts_with("A.\n<!-- quote: x.md#one-and-two -->\n| name | s | RMSE |\n| --- |"),
            "{whole}"
        );
        assert!(whole.ends_with("| c | 3 | 4 |\n<!-- end of quote -->\nB."), "{whole}");
        let part =
            quoted("<!-- quote: x.md#one-and-two; columns 1 3; rows * / 3 | a -->\n<!-- end of quote -->")
                .expect("a quote");
        assert!(
            part.contains("-->\n| name | RMSE |\n| --- | ---: |\n| c | 4 |\n| a b | 2 |\n<!--"),
            "{part}"
        );
    }

    #[test]
    fn what_is_not_there_is_named() {
        let fault = |mark: &str| {
            quoted(&format!("<!-- quote: {mark} -->\n<!-- end of quote -->")).expect_err("a fault")
        };
        assert!(fault("y.md#one").contains("y.md"));
        assert!(fault("x.md#three").contains("no heading `three`"));
        assert!(fault("x.md#one-and-two; rows d").contains("no row `d`"));
        assert!(fault("x.md#one-and-two; rows * / 2").contains("no row `* / 2`"));
        assert!(fault("x.md#one-and-two; columns 4").contains("no column 4"));
        assert!(quoted("<!-- quote: x.md#one-and-two -->").expect_err("no end").contains("does not end"));
    }

    #[test]
    fn figures_may_change_and_words_may_not() {
        assert_eq!(without_figures("| a | 1.2e-5, 3 % |"), without_figures("| a | 7, 12.5 % |"));
        assert_eq!(without_figures("0.1 ± 4 %"), without_figures("0.234"));
        assert_ne!(without_figures("| a | 1 |"), without_figures("| b | 1 |"));
    }
}
