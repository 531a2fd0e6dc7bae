//! The paper's table 3 by measured error: how few probes are as good as a grid.

use std::fmt::Write as _;

use crate::shprobe::layouts::{GRID, Survey, cell_count, light};

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// The paper's counts: of the grid, and of probes and tetrahedra that looked the same.
const PAPERS: [(&str, usize, usize, usize); 3] =
    [("Basic", 64, 13, 14), ("Sponza", 432, 85, 401), ("Sibenik", 432, 39, 124)];

pub(crate) const HEAD: &str = "| scene | grid | its error % | distances | probes of the same error | tetrahedra | error % | of the grid's % | the paper's probes | tetrahedra |\n\
                               | --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";

/// Numbers of probes that are tried.
const COUNTS: [usize; 20] =
    [4, 5, 6, 8, 10, 13, 16, 20, 24, 30, 39, 48, 64, 86, 110, 140, 192, 256, 320, 400];

/// The rows of a scene: fewest adaptive, fitted probes whose error is at most that of the plain grid of tetrahedra, the paper's.
pub(crate) fn rows(survey: &Survey<'_>) -> Result<String, Fault> {
    let name = survey.ground.site.name;
    let Some(&(_, grid, probes, cells)) = PAPERS.iter().find(|p| p.0 == name) else {
        return Ok(String::new());
    };
    let is_grid =
        |l: &&crate::shprobe::layouts::Layout| l.placement == GRID && l.wanted == grid && !l.distances;
    let Some(limit) = survey.layouts.iter().find(is_grid).map(|l| l.wrong.all) else {
        return Ok(String::new());
    };
    let mut text = String::new();
    for distances in [false, true] {
        let _ = write!(
            text,
            "| {name} | {grid} | {:.2} | {} |",
            100.0 * limit,
            if distances { "with" } else { "without" }
        );
        let _ = match fewest(survey, distances, limit)? {
            Some((count, tetrahedra, error)) => write!(
                text,
                " {count} | {tetrahedra} | {:.2} | {:.0} |",
                100.0 * error,
                100.0 * count as f64 / grid as f64
            ),
            None => write!(text, " more than {} | – | – | – |", COUNTS[COUNTS.len() - 1]),
        };
        let _ = writeln!(text, " {probes} | {cells} |");
    }
    Ok(text)
}

/// Halves the list of counts, as if more probes were never worse.
fn fewest(survey: &Survey<'_>, distances: bool, limit: f64) -> Result<Option<(usize, usize, f64)>, Fault> {
    let (mut low, mut high, mut best) = (0, COUNTS.len(), None);
    while low < high {
        let middle = usize::midpoint(low, high);
        let field = survey.chosen(COUNTS[middle], distances)?.fitted.field(distances)?;
        let wrong = survey.truth.wrong(None, |p| light(&field, p));
        if wrong.all <= limit {
            best = Some((field.probe_count(), cell_count(&field), wrong.all));
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Ok(best)
}
