//! `report`: one page that opens from disk, of all tables and charts in `studies/results`, and of pictures to look into.

mod pictures;
mod sections;

use crate::common::provenance::provenance;
use crate::common::report::{Outcome, write};
use sections::Section;
use std::fmt::Write as _;
use std::path::Path;

/// The page's own style and script: nothing is loaded.
const STYLE: &str = include_str!("report.css");

/// Writes `report.html` of what is in `out_dir`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let sections = sections::read(out_dir)?;
    if sections.is_empty() {
        return Err(format!("{} holds no tables; run the studies first", out_dir.display()).into());
    }
    write(out_dir, "report.html", &page(&sections, &pictures::frames()?))?;
    eprintln!("report: {}", out_dir.join("report.html").display());
    Ok(true)
}

fn page(sections: &[Section], pictures: &str) -> String {
    let mut links = "<a href=\"#pictures\">pictures</a>\n".to_owned();
    for section in sections {
        let _ = writeln!(links, "<a href=\"#{}\">{}</a>", section.name, section.name.replace('-', " "));
    }
    let bodies: String = sections.iter().map(Section::to_html).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>pointillist: time against error</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>pointillist: time against error</h1>\n\
         <p>Every table and chart of the studies, as they are in the repository; each says what made it. \
         <code>cargo run --release -p studies -- all</code> makes all of them again, <code>-- report</code> this page. \
         The page itself: {}.</p></header>\n<nav>\n{links}</nav>\n<main>\n\
         <section id=\"pictures\">\n<h2>Pictures to look into</h2>\n{pictures}</section>\n{bodies}</main>\n</body>\n</html>\n",
        provenance()
    )
}
