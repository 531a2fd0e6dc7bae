//! `pointillist dice`: polygons in as JSON lines, pieces or cell areas out as JSON lines.

use std::io::Write;

use crate::json_lines::{JsonLinesError, Lines, shorten, strip_place};
use glam::{DVec2, dvec2};
use pointillist_dice::{Accumulator, CellWindow, DiceError, FillRule, Grid, accumulate_filled, split};
use serde::{Deserialize, Serialize};

/// One line of the input.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    #[serde(default)]
    polygon: Option<Vec<[f64; 2]>>,
    #[serde(default)]
    rings: Option<Vec<Vec<[f64; 2]>>>,
    #[serde(default)]
    rule: Option<Rule>,
    #[serde(default)]
    grid: GridFields,
}

/// What is inside of outlines that cross themselves or one another.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Rule {
    EvenOdd,
    NonZero,
}

/// Unit cells at the origin unless said otherwise.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, default)]
struct GridFields {
    origin: [f64; 2],
    cell: [f64; 2],
    /// Columns and rows from cell (0, 0) on that are asked for; all cells if it is not given.
    size: Option<[u32; 2]>,
}

impl Default for GridFields {
    fn default() -> Self {
        Self { origin: [0.0, 0.0], cell: [1.0, 1.0], size: None }
    }
}

impl GridFields {
    fn window(&self) -> CellWindow {
        let end = |count: u32| i32::try_from(count).unwrap_or(i32::MAX);
        self.size.map_or(CellWindow::ALL, |[nx, ny]| CellWindow { x0: 0, y0: 0, x1: end(nx), y1: end(ny) })
    }
}

#[derive(Serialize)]
struct PieceFields {
    cell: [i32; 2],
    area: f64,
    vertices: Vec<[f64; 2]>,
}

#[derive(Serialize)]
struct CellFields {
    cell: [i32; 2],
    area: f64,
    centroid: [f64; 2],
}

/// The expected shape of a line, for messages.
const EXAMPLE: &str =
    r#"a line looks like {"polygon":[[0,0],[1,0],[0,1]],"grid":{"origin":[0,0],"cell":[1,1]}}"#;

/// Cuts every polygon of `lines` by its grid. Blank lines are skipped; every other line gives one line of output:
/// its pieces, or with `areas` its cells. Numbers read back to the same value.
///
/// `areas` takes concave polygons, polygons that cross themselves, and `rings` in the place of `polygon`; `rule` says what is inside:
/// `evenodd` (the default) or `nonzero`. With `size` in the grid only that many columns and rows are answered and paid for.
///
/// Answers are handed on whenever the next line is not there yet, so that it may depend on them.
///
/// # Errors
/// Stops at the first line that cannot be used. The lines before it have been written.
pub(super) fn answer_all(
    lines: &mut Lines<'_>,
    output: &mut dyn Write,
    areas: bool,
) -> Result<(), JsonLinesError> {
    let mut scratch = Accumulator::new();
    while let Some((line, text)) = lines.next_line()? {
        let result = answer(&text, output, areas, &mut scratch);
        result.map_err(|refusal| refusal.into_error(lines.source(), line, &text))?;
        if !lines.at_hand() {
            output.flush().map_err(JsonLinesError::Write)?;
        }
    }
    output.flush().map_err(JsonLinesError::Write)
}

/// Why one line was refused.
enum Refusal {
    Json(serde_json::Error),
    /// Not one polygon, nor rings where they can be.
    Outlines(&'static str),
    Dice(DiceError, String),
    Write(std::io::Error),
}

fn answer(text: &str, output: &mut dyn Write, areas: bool, scratch: &mut Accumulator) -> Result<(), Refusal> {
    let request: Request = serde_json::from_str(text.trim_end()).map_err(Refusal::Json)?;
    let rings = request.outlines(areas)?;
    let of_dice = |error: DiceError| Refusal::Dice(error, value_at_fault(error, &request));
    let [[x0, y0], [dx, dy]] = [request.grid.origin, request.grid.cell];
    let grid = Grid::new(dvec2(x0, y0), dvec2(dx, dy)).map_err(of_dice)?.with_window(request.grid.window());
    if areas {
        write_cells(&rings, request.fill_rule(), &grid, scratch, output, of_dice)
    } else {
        write_pieces(&rings[0], &grid, output, of_dice)
    }
}

impl Request {
    /// The outlines; of pieces exactly one.
    fn outlines(&self, areas: bool) -> Result<Vec<Vec<DVec2>>, Refusal> {
        let points = |ring: &Vec<[f64; 2]>| ring.iter().map(|&v| DVec2::from_array(v)).collect();
        match (&self.polygon, &self.rings) {
            (Some(_), Some(_)) => Err(Refusal::Outlines("`polygon` and `rings` are both given")),
            (None, None) => Err(Refusal::Outlines("missing field `polygon`, or `rings`")),
            (None, Some(_)) if !areas => Err(Refusal::Outlines("`rings` need --areas")),
            (Some(polygon), None) => Ok(vec![points(polygon)]),
            (None, Some(rings)) => Ok(rings.iter().map(points).collect()),
        }
    }

    fn fill_rule(&self) -> FillRule {
        match self.rule {
            None | Some(Rule::EvenOdd) => FillRule::EvenOdd,
            Some(Rule::NonZero) => FillRule::NonZero,
        }
    }

    /// Name and value of a vertex, counted through all outlines.
    fn vertex(&self, index: usize) -> String {
        if let Some(polygon) = &self.polygon {
            return format!("polygon[{index}] = {}", json(&polygon.get(index)));
        }
        let mut before = 0;
        for (i, ring) in self.rings.iter().flatten().enumerate() {
            if let Some(vertex) = ring.get(index - before) {
                return format!("rings[{i}][{}] = {}", index - before, json(vertex));
            }
            before += ring.len();
        }
        "rings".to_owned()
    }

    fn vertex_count(&self) -> usize {
        self.rings.iter().flatten().chain(&self.polygon).map(Vec::len).sum()
    }
}

fn write_pieces(
    polygon: &[DVec2],
    grid: &Grid,
    output: &mut dyn Write,
    of_dice: impl Fn(DiceError) -> Refusal,
) -> Result<(), Refusal> {
    let mut list = List::new("pieces", output);
    split(polygon, grid, |piece| {
        let vertices = piece.vertices.iter().map(DVec2::to_array).collect();
        list.push(&PieceFields { cell: piece.cell.to_array(), area: piece.area, vertices });
    })
    .map_err(of_dice)?;
    list.finish()
}

fn write_cells(
    rings: &[Vec<DVec2>],
    rule: FillRule,
    grid: &Grid,
    scratch: &mut Accumulator,
    output: &mut dyn Write,
    of_dice: impl Fn(DiceError) -> Refusal,
) -> Result<(), Refusal> {
    let mut list = List::new("cells", output);
    let rings: Vec<&[DVec2]> = rings.iter().map(Vec::as_slice).collect();
    accumulate_filled(&rings, rule, grid, scratch, |run| {
        for (cell, centroid) in run.cells(grid) {
            list.push(&CellFields { cell: cell.to_array(), area: run.area, centroid: centroid.to_array() });
        }
    })
    .map_err(of_dice)?;
    list.finish()
}

/// Writes `{"name":[…]}` item by item, so that an answer of millions of cells needs no memory.
struct List<'a> {
    output: &'a mut dyn Write,
    name: &'static str,
    count: usize,
    result: std::io::Result<()>,
}

impl<'a> List<'a> {
    fn new(name: &'static str, output: &'a mut dyn Write) -> Self {
        Self { output, name, count: 0, result: Ok(()) }
    }

    /// After the first failure nothing more is written; [`finish`](Self::finish) tells.
    fn push(&mut self, item: &impl Serialize) {
        if self.result.is_ok() {
            self.result = self.try_push(item);
            self.count += 1;
        }
    }

    fn try_push(&mut self, item: &impl Serialize) -> std::io::Result<()> {
        if self.count == 0 {
            write!(self.output, "{{\"{}\":[", self.name)?;
        } else {
            self.output.write_all(b",")?;
        }
        serde_json::to_writer(&mut *self.output, item).map_err(std::io::Error::from)
    }

    fn finish(self) -> Result<(), Refusal> {
        self.result.map_err(Refusal::Write)?;
        let end = if self.count == 0 { format!("{{\"{}\":[]}}\n", self.name) } else { "]}\n".to_owned() };
        self.output.write_all(end.as_bytes()).map_err(Refusal::Write)
    }
}

/// The field that an error is about, as the user wrote it.
fn value_at_fault(error: DiceError, request: &Request) -> String {
    match error {
        DiceError::NotFinite { index } | DiceError::OutOfRange { index } | DiceError::NotConvex { index } => {
            request.vertex(index)
        }
        DiceError::BadGrid { .. } => {
            format!("grid.origin = {}, grid.cell = {}", json(&request.grid.origin), json(&request.grid.cell))
        }
        _ => format!("polygon with {} vertices", request.vertex_count()),
    }
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

impl Refusal {
    fn into_error(self, source: &str, line: usize, text: &str) -> JsonLinesError {
        let (message, way_out) = match self {
            Self::Write(error) => return JsonLinesError::Write(error),
            Self::Outlines(message) => (message.to_owned(), EXAMPLE.to_owned()),
            Self::Json(error) => (strip_place(&error), EXAMPLE.to_owned()),
            Self::Dice(error @ DiceError::NotConvex { .. }, value) => (
                format!("{value}: the polygon is not convex there ({error})"),
                "use --areas, which accepts polygons of any shape, or triangulate the polygon".to_owned(),
            ),
            Self::Dice(error, value) => (format!("{value}: {error}"), way_out(error).to_owned()),
        };
        JsonLinesError::Input {
            source_name: source.to_owned(),
            line,
            message,
            text: shorten(text.trim()),
            way_out,
        }
    }
}

fn way_out(error: DiceError) -> &'static str {
    match error {
        DiceError::BadGrid { .. } => {
            "give grid.cell two numbers that are not 0 (negative ones count cells downward or to the left) and grid.origin two finite ones"
        }
        DiceError::TooManyCells { .. } => {
            "use a larger grid.cell, or limit the answer with grid.size, the numbers of columns and rows"
        }
        DiceError::OutOfRange { .. } => "move grid.origin to the polygon, or use a larger grid.cell",
        _ => "coordinates must be finite numbers",
    }
}

#[cfg(test)]
mod tests {
    use super::{Lines, answer_all};

    fn answer(input: &str, areas: bool) -> Result<String, String> {
        let mut output = Vec::new();
        let mut lines = Lines::new(Box::new(input.as_bytes()), "shapes.jsonl");
        answer_all(&mut lines, &mut output, areas).map_err(|e| e.to_string())?;
        String::from_utf8(output).map_err(|e| e.to_string())
    }

    #[test]
    fn a_square_off_the_grid_has_its_quarters() {
        let line = r#"{"polygon":[[0.5,0.5],[1.5,0.5],[1.5,1.5],[0.5,1.5]]}"#;
        let cells = answer(&format!("\n{line}\n  \n"), true).unwrap();
        assert!(
            cells.starts_with(r#"{"cells":[{"cell":[0,0],"area":0.25,"centroid":[0.75,0.75]},"#),
            "{cells}"
        );
        assert_eq!(cells.lines().count(), 1);
        let pieces = answer(line, false).unwrap();
        assert!(
            pieces.starts_with(r#"{"pieces":[{"cell":[0,0],"area":0.25,"vertices":[[0.5,0.5],[1.0,0.5],"#),
            "{pieces}"
        );
    }

    #[test]
    fn numbers_are_read_and_written_exactly() {
        // Read one unit in the last place off unless serde_json has its feature `float_roundtrip`.
        let x = "0.19844004278856286";
        let pieces = answer(&format!(r#"{{"polygon":[[{x},0],[1,0],[1,1]]}}"#), false).unwrap();
        assert!(pieces.contains(x), "{pieces}");
    }

    #[test]
    fn a_size_limits_the_answer_to_its_window() {
        let square = "[[-1,-1],[4e8,-1],[4e8,4e8],[-1,4e8]]";
        let sized = |nx: i64| format!(r#"{{"polygon":{square},"grid":{{"size":[{nx},1]}}}}"#);
        let pieces = answer(&sized(2), false).unwrap();
        assert_eq!(pieces.matches(r#""area":1.0"#).count(), 2, "{pieces}");
        let cells = r#"{"cells":[{"cell":[0,0],"area":1.0,"centroid":[0.5,0.5]}]}"#;
        assert_eq!(answer(&sized(1), true).unwrap(), format!("{cells}\n"));
        assert_eq!(answer(&sized(0), true).unwrap(), "{\"cells\":[]}\n");
        let rings = r#"[[[0,0],[9e7,0],[9e7,9e7],[0,9e7]],[[0,0],[1,0],[1,1],[0,1]]]"#;
        let holed = answer(&format!(r#"{{"rings":{rings},"grid":{{"size":[2,1]}}}}"#), true).unwrap();
        assert_eq!(holed, cells.replace("[0,0]", "[1,0]").replace("[0.5", "[1.5") + "\n");
        let message = answer(&sized(-1), true).unwrap_err();
        assert!(message.contains("-1") && !message.contains("u32"), "{message}");
    }

    #[test]
    fn a_polygon_without_area_has_an_empty_list() {
        assert_eq!(answer(r#"{"polygon":[]}"#, true).unwrap(), "{\"cells\":[]}\n");
        assert_eq!(answer(r#"{"polygon":[[0,0],[1,1],[2,2]]}"#, false).unwrap(), "{\"pieces\":[]}\n");
    }

    #[test]
    fn errors_name_source_line_field_value_and_way_out() {
        let concave = "\n{\"polygon\":[[0,0],[4,0],[1,1],[0,4]]}";
        let message = answer(concave, false).unwrap_err();
        for part in ["shapes.jsonl, line 2", "polygon[2] = [1.0,1.0]", "--areas"] {
            assert!(message.contains(part), "{part} is not in {message}");
        }
        assert!(answer(concave, true).is_ok());
        for (line, part) in [
            (r#"{"polygon":[[0,0],[1e30,0],[0,1]]}"#, "polygon[1] = [1e"),
            (r#"{"polygon":[],"grid":{"cell":[0,1]}}"#, "grid.cell = [0.0,1.0]"),
            (r#"{"polygon":[[0,0],[1e999,0]]}"#, "number out of range"),
            (r#"{"polgyon":[]}"#, "unknown field `polgyon`"),
            (r#"{"polygon":[[0,0],[1e7,0],[1e7,1e7]]}"#, "larger grid.cell"),
            ("nonsense", "a line looks like"),
        ] {
            let message = answer(line, false).unwrap_err();
            assert!(message.contains(part), "{part} is not in {message}");
        }
    }
}
