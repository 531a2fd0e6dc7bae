//! The `range_grid` of a Stanford range scan, from which the spacing of its points is taken.

use super::super::block::RangeGrid;
use super::header::Header;
use crate::memory::{MemoryError, Meter};
use glam::{DVec3, Vec3};

/// Reads the cells of a `range_grid`.
///
/// Keeps twelve bytes a point, and four for each pair of neighbours: the only part of a file that is held whole, and
/// only of files with such a grid, which one turn of a scanner fills.
pub(super) struct GridReader {
    cols: u64,
    rows: u64,
    /// Relative to `origin`, so that f32 is enough whatever the frame.
    positions: Vec<Vec3>,
    /// The first point that is finite.
    origin: Option<DVec3>,
    /// The position in the cell before, if that is of the same row and no hole.
    previous: Option<Vec3>,
    cell: u64,
    filled: u64,
    distances: Vec<f32>,
    meter: Meter,
}

/// A position and the distance to a neighbour.
const GRID_POINT_BYTES: u64 = 16;

impl GridReader {
    /// For a header with a grid, if the grid comes after the points and has as many cells as its sides say.
    pub(super) fn of(header: &Header, warnings: &mut Vec<String>) -> Option<Self> {
        let place = |name: &str| header.elements.iter().position(|element| element.name == name);
        let grid = place("range_grid")?;
        let count = header.elements[grid].count;
        let lists = header.elements[grid].properties.iter().filter(|p| super::header::list_of(p).is_some());
        let sides = header.cols.zip(header.rows);
        let fits = sides.is_some_and(|(cols, rows)| cols.checked_mul(rows) == Some(count) && count > 0);
        if !fits || place("vertex") > Some(grid) || lists.count() != 1 {
            warnings.push(format!(
                "the range grid of {count} cells was not used: `obj_info num_cols` × `num_rows` must be \
                 their number, each must have one list, and the vertices must come first"
            ));
            return None;
        }
        let (cols, rows) = sides?;
        Some(Self {
            cols,
            rows,
            positions: Vec::new(),
            origin: None,
            previous: None,
            cell: 0,
            filled: 0,
            distances: Vec::new(),
            meter: Meter::default(),
        })
    }

    /// Takes the next point.
    pub(super) fn keep(&mut self, position: DVec3) -> Result<(), MemoryError> {
        if self.origin.is_none() && position.is_finite() {
            self.origin = Some(position);
        }
        self.positions.push((position - self.origin.unwrap_or_default()).as_vec3());
        self.meter.add(GRID_POINT_BYTES, || "the points of its grid take".to_owned())
    }

    /// Takes the next cell: the vertex in it, or nothing for a hole.
    pub(super) fn cell(&mut self, vertex: Option<f64>) -> Result<(), String> {
        if self.cell.is_multiple_of(self.cols) {
            self.previous = None;
        }
        self.cell += 1;
        let position = match vertex {
            None => None,
            Some(index) => {
                let count = self.positions.len();
                let is_index = index >= 0.0 && index < count as f64;
                let found = is_index.then(|| self.positions[index as usize]);
                Some(found.ok_or_else(|| format!("the cell names vertex {index}, but there are {count}"))?)
            }
        };
        self.filled += u64::from(position.is_some());
        if let Some((a, b)) = self.previous.zip(position) {
            let distance = a.distance(b);
            if distance.is_finite() {
                self.distances.push(distance);
            }
        }
        self.previous = position;
        Ok(())
    }

    /// Sums up.
    pub(super) fn finish(mut self) -> RangeGrid {
        let middle = self.distances.len() / 2;
        let spacing = (!self.distances.is_empty())
            .then(|| f64::from(*self.distances.select_nth_unstable_by(middle, f32::total_cmp).1));
        RangeGrid { cols: self.cols, rows: self.rows, filled: self.filled, spacing }
    }
}
