//! A study's tables as a part of the page, its charts among them.

use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd, html};
use std::fmt::Write as _;
use std::path::Path;

/// Rows beyond which a table is folded up.
const LONG: usize = 30;

/// What one file `NAME.md` holds.
pub(super) struct Section {
    /// Of the file, without its ending; the place on the page.
    pub(super) name: String,
    markdown: String,
    /// SVG files whose names begin with that of the section, and of no other.
    charts: Vec<String>,
}

/// Names in the order of the page; those that are not here come last, by name.
const ORDER: [&str; 18] = [
    "real",
    "micropoint",
    "micropoint-foliage",
    "micropoint-checker",
    "shadow",
    "shadow-area",
    "shade",
    "shprobe",
    "shprobe-light",
    "together",
    "radiosity",
    "surfel",
    "clouds",
    "ibpr",
    "dice",
    "speed",
    "growth",
    "skip",
];

/// All tables of a folder with their charts.
pub(super) fn read(folder: &Path) -> std::io::Result<Vec<Section>> {
    let mut files: Vec<String> = vec![];
    for entry in std::fs::read_dir(folder)? {
        files.push(entry?.file_name().to_string_lossy().into_owned());
    }
    files.sort();
    let mut names: Vec<&str> = files.iter().filter_map(|file| file.strip_suffix(".md")).collect();
    names.sort_by_key(|name| (ORDER.iter().position(|known| known == name).unwrap_or(ORDER.len()), *name));
    let owner = |chart: &str| {
        let stem = chart.strip_suffix(".svg")?;
        names
            .iter()
            .copied()
            .filter(|name| stem == *name || stem.starts_with(&format!("{name}-")))
            .max_by_key(|n| n.len())
    };
    let mut sections = vec![];
    for name in &names {
        let markdown = std::fs::read_to_string(folder.join(format!("{name}.md")))?;
        let own = files.iter().filter(|file| owner(file) == Some(name));
        let charts = own.map(|file| std::fs::read_to_string(folder.join(file))).collect::<Result<_, _>>()?;
        sections.push(Section { name: (*name).to_owned(), markdown, charts });
    }
    Ok(sections)
}

impl Section {
    pub(super) fn to_html(&self) -> String {
        let mut text = format!("<section id=\"{}\">\n", self.name);
        let charts: String = self.charts.iter().fold(String::new(), |mut text, svg| {
            let _ = writeln!(text, "<figure>{}</figure>", without_prologue(svg));
            text
        });
        let body = body(&self.markdown);
        // After the title and what is said of how it was measured.
        let place = body.find("<h3>").unwrap_or(body.len());
        let _ = writeln!(text, "{}{charts}{}</section>", &body[..place], &body[place..]);
        text
    }
}

/// An SVG from its element on.
fn without_prologue(svg: &str) -> &str {
    svg.find("<svg").map_or(svg, |at| &svg[at..])
}

/// The text as HTML: headings one level lower, tables that scroll by themselves and are folded up where they are long.
fn body(markdown: &str) -> String {
    let events: Vec<Event<'_>> = Parser::new_ext(markdown, Options::ENABLE_TABLES).collect();
    let mut out: Vec<Event<'_>> = Vec::with_capacity(events.len());
    let raw = |text: String| Event::Html(CowStr::from(text));
    let mut folded = false;
    for (i, event) in events.iter().enumerate() {
        match event {
            Event::Start(Tag::Table(_)) => {
                let rows = rows_of(&events[i..]);
                folded = rows > LONG;
                let head =
                    if folded { format!("<details><summary>{rows} rows</summary>") } else { String::new() };
                out.extend([raw(head + "<div class=\"table\">"), event.clone()]);
            }
            Event::End(TagEnd::Table) => {
                let end = if folded { "</div></details>\n" } else { "</div>\n" };
                out.extend([event.clone(), raw(end.to_owned())]);
            }
            Event::Start(Tag::Heading { level, .. }) => out.push(raw(format!("<h{}>", *level as u32 + 1))),
            Event::End(TagEnd::Heading(level)) => out.push(raw(format!("</h{}>\n", *level as u32 + 1))),
            other => out.push(other.clone()),
        }
    }
    let mut text = String::new();
    html::push_html(&mut text, out.into_iter());
    text
}

/// Rows below the head of the table that these events begin with.
fn rows_of(events: &[Event<'_>]) -> usize {
    let of_table = events.iter().take_while(|event| !matches!(event, Event::End(TagEnd::Table)));
    of_table.filter(|event| matches!(event, Event::Start(Tag::TableRow))).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_go_down_and_long_tables_are_folded() {
        let table = |rows: usize| format!("| a | b |\n| --- | --- |\n{}", "| 1 | <b> |\n".repeat(rows));
        let html =
            body(&format!("# Title\n\ntext\n\n## Part\n\n{}\n## Next\n\n{}", table(3), table(LONG + 1)));
        assert!(html.contains("<h2>Title</h2>") && html.contains("<h3>Part</h3>"), "{html}");
        assert_eq!(html.matches("<details>").count(), 1, "{html}");
        assert_eq!(html.matches("</details>").count(), 1, "{html}");
        assert!(html.contains(&format!("{} rows", LONG + 1)));
        assert_eq!(html.matches("<div class=\"table\">").count(), html.matches("</div>").count());
    }

    #[test]
    fn charts_belong_to_the_longest_name_that_they_begin_with() {
        let folder = std::env::temp_dir().join(format!("report-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for name in ["shadow", "shadow-area", "zebra"] {
            std::fs::write(folder.join(format!("{name}.md")), format!("# About {name}\n\nHow.\n\n## Rows\n"))
                .unwrap();
        }
        for name in ["shadow", "shadow-area", "shadow-map"] {
            std::fs::write(folder.join(format!("{name}.svg")), format!("<?xml?><svg id=\"{name}\"/>"))
                .unwrap();
        }
        let sections = read(&folder);
        std::fs::remove_dir_all(&folder).unwrap();
        let sections = sections.unwrap();
        let names: Vec<&str> = sections.iter().map(|section| section.name.as_str()).collect();
        assert_eq!(names, ["shadow", "shadow-area", "zebra"]);
        let charts: Vec<usize> = sections.iter().map(|section| section.charts.len()).collect();
        assert_eq!(charts, [2, 1, 0]);
        let html = sections[0].to_html();
        let place = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text} is missing in {html}"));
        assert!(place("How.") < place("<svg id=\"shadow\"/>") && place("shadow-map") < place("<h3>Rows"));
        assert!(!html.contains("<?xml"));
    }
}
