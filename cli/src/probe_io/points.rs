//! Lists of positions, and of cells between them, as text or raw binary.

use super::read_probes;
use crate::input;
use crate::input_error::InputError;
use crate::number_lines;
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
    number_lines::read(path, &format!("each line is `{names}`"), |numbers| {
        let row = <[f64; N]>::try_from(numbers).map_err(|_| match numbers.len() {
            few if few < N => format!("only {few} numbers of {N}"),
            many => format!("{many} numbers are {} too many: {N} are needed", many - N),
        })?;
        check(&row)?;
        Ok(row)
    })
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
