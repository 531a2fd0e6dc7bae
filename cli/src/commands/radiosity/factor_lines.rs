//! `pointillist radiosity factors`: pairs of polygons in as JSON lines, form factors out as JSON lines.

use std::io::Write;

use crate::json_lines::{JsonLinesError, Lines, shorten, strip_place};
use glam::DVec3;
use pointillist_radiosity::{FactorOptions, Polygon, PolygonError, form_factor};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Lines that are computed together.
const BATCH: usize = 1024;

/// One line of the input.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    from: Vec<[f64; 3]>,
    to: Vec<[f64; 3]>,
    #[serde(default)]
    occluders: Vec<Vec<[f64; 3]>>,
}

#[derive(Serialize)]
struct Answer {
    #[serde(rename = "F")]
    factor: f64,
    error: f64,
}

/// The expected shape of a line, for messages.
const EXAMPLE: &str =
    r#"a line looks like {"from":[[0,0,0],[1,0,0],[0,1,0]],"to":[[0,0,1],[0,1,1],[1,0,1]],"occluders":[]}"#;

/// Answers every line of `lines`, those that are there on all threads at once. Blank lines are skipped. Gives the number of pairs.
///
/// Answers are handed on whenever the next line is not there yet, so that it may depend on them.
///
/// # Errors
/// Stops at the first line that cannot be used. The lines before it have been answered.
pub(super) fn answer_all(
    lines: &mut Lines<'_>,
    output: &mut dyn Write,
    options: &FactorOptions,
) -> Result<u64, JsonLinesError> {
    let mut pairs = 0;
    loop {
        let mut batch = vec![];
        let read = take_batch(lines, &mut batch);
        let answers: Vec<Result<Answer, (String, String)>> =
            batch.par_iter().map(|(_, text)| answer(text, options)).collect();
        for (result, (line, text)) in answers.into_iter().zip(&batch) {
            let answer = result.map_err(|(message, way_out)| JsonLinesError::Input {
                source_name: lines.source().to_owned(),
                line: *line,
                message,
                text: shorten(text.trim()),
                way_out,
            })?;
            serde_json::to_writer(&mut *output, &answer).map_err(|e| JsonLinesError::Write(e.into()))?;
            output.write_all(b"\n").map_err(JsonLinesError::Write)?;
            pairs += 1;
        }
        output.flush().map_err(JsonLinesError::Write)?;
        // A line that cannot be read comes after the answers to those before it.
        if !read? {
            return Ok(pairs);
        }
    }
}

/// Waits for a line and takes those that are there with it; `false` at the end.
fn take_batch(lines: &mut Lines<'_>, batch: &mut Vec<(usize, String)>) -> Result<bool, JsonLinesError> {
    while batch.is_empty() || (batch.len() < BATCH && lines.at_hand()) {
        match lines.next_line()? {
            Some(line) => batch.push(line),
            None => return Ok(false),
        }
    }
    Ok(true)
}

/// The form factor of one line, or what is wrong with it and the way out.
fn answer(text: &str, options: &FactorOptions) -> Result<Answer, (String, String)> {
    let request: Request =
        serde_json::from_str(text).map_err(|error| (strip_place(&error), EXAMPLE.to_owned()))?;
    let from = polygon("from", &request.from)?;
    let to = polygon("to", &request.to)?;
    let mut occluders = Vec::with_capacity(request.occluders.len());
    for (i, ring) in request.occluders.iter().enumerate() {
        occluders.push(polygon(&format!("occluders[{i}]"), ring)?);
    }
    let found = form_factor(&from, &to, &occluders, options);
    Ok(Answer { factor: found.value, error: found.error })
}

fn polygon(field: &str, ring: &[[f64; 3]]) -> Result<Polygon, (String, String)> {
    let vertices: Vec<DVec3> = ring.iter().map(|&v| DVec3::from_array(v)).collect();
    Polygon::new(&vertices).map_err(|error| {
        let way_out = match error {
            PolygonError::NotPlanar { .. } | PolygonError::NotConvex { .. } => {
                "split the polygon into triangles"
            }
            PolygonError::NoArea | PolygonError::TooFewVertices { .. } => {
                "leave out what has no area; it neither gets nor hides light"
            }
            _ => "coordinates must be finite numbers",
        };
        (format!("{field}: {error}"), way_out.to_owned())
    })
}
