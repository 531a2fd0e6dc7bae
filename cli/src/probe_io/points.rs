//! Lists of positions, and of cells between them, as text or raw binary.

use super::read_probes;
use crate::coordinate::LARGEST;
use crate::input;
use crate::input_error::InputError;
use glam::DVec3;
use pointillist_delaunay::Partition;
use std::io::{self, Write};
use std::path::Path;

/// Positions from text with `x y z` on each line, raw little-endian doubles (`.bin`) or a file of probes (`.json`, `.probes`).
///
/// # Errors
/// What is wrong with the file, with its line.
pub fn read_points(path: &Path) -> Result<Vec<DVec3>, InputError> {
    match input::kind_of(path)?.as_str() {
        "json" | "probes" => Ok(read_probes(path)?.positions()),
        "bin" => read_raw(path),
        _ => Ok(read_rows::<3>(path, "x y z", |_| Ok(()))?.into_iter().map(DVec3::from_array).collect()),
    }
}

fn read_raw(path: &Path) -> Result<Vec<DVec3>, InputError> {
    let bytes = input::read(path)?;
    let (points, rest) = bytes.as_chunks::<24>();
    if !rest.is_empty() {
        let message = format!("has {} bytes, which is no multiple of 24", bytes.len());
        return Err(InputError::of_file(path.display().to_string(), message)
            .with_help("raw points are three little-endian doubles each"));
    }
    let point = |p: &[u8; 24]| {
        let (numbers, _) = p.as_chunks::<8>();
        DVec3::new(
            f64::from_le_bytes(numbers[0]),
            f64::from_le_bytes(numbers[1]),
            f64::from_le_bytes(numbers[2]),
        )
    };
    Ok(points.iter().map(point).collect())
}

/// Lines of `N` numbers; empty lines and those that begin with `#` are left out. `-` is standard input.
///
/// # Errors
/// A line that is not `N` finite numbers, which are called `names`, or that `check` refuses with a message.
pub fn read_rows<const N: usize>(
    path: &Path,
    names: &str,
    check: impl Fn(&[f64; N]) -> Result<(), String>,
) -> Result<Vec<[f64; N]>, InputError> {
    let (name, bytes) = (input::name_of(path), input::read(path)?);
    let mut rows = vec![];
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        let wrong = |what: String| {
            let help = format!("each line is `{names}`, numbers with spaces between them");
            InputError::in_line(&name, &bytes, i + 1, what).with_help(help)
        };
        let mut row = [0.0; N];
        let mut words = text.split([' ', '\t', ',']).filter(|w| !w.is_empty());
        for (k, value) in row.iter_mut().enumerate() {
            let word = words.next().ok_or_else(|| wrong(format!("only {k} numbers of {N}")))?;
            let number: f64 = word.parse().map_err(|_| wrong(format!("`{word}` is not a number")))?;
            if !number.is_finite() || number.abs() > LARGEST {
                return Err(wrong(format!("`{word}` is not finite, or beyond ±{LARGEST:e}")));
            }
            *value = number;
        }
        if let Some(word) = words.next() {
            return Err(wrong(format!("`{word}` is one too many: {N} numbers are needed")));
        }
        check(&row).map_err(wrong)?;
        rows.push(row);
    }
    Ok(rows)
}

/// Writes cells: `# tetrahedra N` and their corners, or `# dimension D` and what there is; raw 32-bit integers if `binary`.
///
/// # Errors
/// Those of the output.
pub fn format_cells(output: &mut dyn Write, partition: &Partition, binary: bool) -> io::Result<()> {
    let write = |output: &mut dyn Write, corners: &[u32]| {
        if binary {
            return corners.iter().try_for_each(|c| output.write_all(&c.to_le_bytes()));
        }
        for (k, corner) in corners.iter().enumerate() {
            write!(output, "{}{corner}", if k == 0 { "" } else { " " })?;
        }
        writeln!(output)
    };
    if !binary {
        match partition {
            Partition::Tetrahedra(t) => writeln!(output, "# tetrahedra {}", t.corners.len())?,
            _ => writeln!(output, "# dimension {}", partition.dimension())?,
        }
    }
    match partition {
        Partition::Tetrahedra(t) => t.corners.iter().try_for_each(|c| write(output, c)),
        // Raw quads hold tetrahedra only; fewer dimensions have none.
        _ if binary => Ok(()),
        Partition::Triangles(t) => t.corners.iter().try_for_each(|c| write(output, c)),
        Partition::Line(line) => line.windows(2).try_for_each(|c| write(output, c)),
        Partition::Point(p) => write(output, &[*p]),
    }
}
