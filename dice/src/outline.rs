//! Checks and bounds of a polygon, for `split` and `accumulate`.

use glam::DVec2;

use crate::error::DiceError;
use crate::fixed::{self, Fixed};
use crate::grid::{Grid, Point};
use crate::limits::MAX_CELLS;
use crate::window::CellWindow;

/// The ring without corners at its end that repeat its first: closed rings, as in GeoJSON, are what open ones are.
pub(crate) fn open_ring(mut ring: &[DVec2]) -> &[DVec2] {
    while let [first, .., last] = ring
        && first == last
    {
        ring = &ring[..ring.len() - 1];
    }
    ring
}

/// The rows and columns that a polygon touches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extent {
    pub(crate) min: Point,
    pub(crate) max: Point,
    /// Position of a vertex with the smallest y.
    pub(crate) top: usize,
}

impl Extent {
    /// Checks every vertex; `None` for an empty polygon.
    #[inline]
    pub(crate) fn of(polygon: &[DVec2], grid: &Grid) -> Result<Option<Self>, DiceError> {
        let Some(&first) = polygon.first() else { return Ok(None) };
        let first = grid.point(first, 0)?;
        let mut extent = Self { min: first, max: first, top: 0 };
        for (index, &vertex) in polygon.iter().enumerate().skip(1) {
            let p = grid.point(vertex, index)?;
            if p.y < extent.min.y {
                extent.top = index;
            }
            extent.min = Point { x: extent.min.x.min(p.x), y: extent.min.y.min(p.y) };
            extent.max = Point { x: extent.max.x.max(p.x), y: extent.max.y.max(p.y) };
        }
        Ok(Some(extent))
    }

    /// Rows and columns touched.
    #[inline]
    pub(crate) fn rows_and_columns(&self) -> (u64, u64) {
        let lines = |a: Fixed, b: Fixed| u64::from(fixed::ceil(b).abs_diff(fixed::floor(a)));
        (lines(self.min.y, self.max.y), lines(self.min.x, self.max.x))
    }

    /// Rows and columns touched within the window.
    #[inline]
    pub(crate) fn rows_and_columns_in(&self, window: CellWindow) -> (u64, u64) {
        let rows = window.clip_rows(fixed::floor(self.min.y)..fixed::ceil(self.max.y));
        let columns = window.clip_columns(fixed::floor(self.min.x)..fixed::ceil(self.max.x));
        (rows.len() as u64, columns.len() as u64)
    }

    /// Pieces of this area or less are rounding: twice what the crossings of an edge through all rows and columns are off.
    #[inline]
    pub(crate) fn noise(&self) -> Fixed {
        let (rows, columns) = self.rows_and_columns();
        Fixed::from(rows + columns + 64) << 4
    }
}

/// Refuses more than [`MAX_CELLS`].
#[inline]
pub(crate) fn check_count(count: u64) -> Result<(), DiceError> {
    if count > MAX_CELLS { Err(DiceError::TooManyCells { count }) } else { Ok(()) }
}

/// The next position around a ring of `len` vertices.
#[inline]
pub(crate) fn next(index: usize, len: usize) -> usize {
    if index + 1 == len { 0 } else { index + 1 }
}

/// The sign that makes areas right of downward edges positive; `None` if the ring has no area.
pub(crate) fn orientation(ring: &[DVec2], grid: &Grid) -> Option<i8> {
    /// `f64` sums of products are certain of their sign above this part of their terms' sizes, for up to 2²⁰ vertices.
    const CERTAIN: f64 = 1.0 / (1u64 << 32) as f64;
    let (mut sum, mut size) = (0.0, 0.0);
    let (&start, rest) = ring.split_first()?;
    let in_cells = |v: DVec2| (v - start) / grid.cell();
    let mut a = DVec2::ZERO;
    for &v in rest {
        let b = in_cells(v);
        let (forward, backward) = (a.x * b.y, a.y * b.x);
        sum += forward - backward;
        size += forward.abs() + backward.abs();
        a = b;
    }
    if sum.abs() <= CERTAIN * size {
        let point = |i: usize| grid.point(ring[i], i).expect("every vertex was checked at the door");
        let first = point(0);
        sum = precise_area(ring.len(), |i| {
            let p = point(i);
            Point { x: p.x - first.x, y: p.y - first.y }
        })?;
    }
    Some(if sum > 0.0 { -1 } else { 1 })
}

/// The sum of cross products with about 100 bits; `None` if it is zero as far as those tell.
fn precise_area(len: usize, spoke: impl Fn(usize) -> Point) -> Option<f64> {
    /// A sum of this part of its terms or less is rounding: 2⁻⁹⁰.
    const ZERO: f64 = 1.0 / (1u128 << 90) as f64;
    let (mut high, mut low, mut size) = (0.0, 0.0, 0.0);
    let mut add = |v: f64| {
        let sum: f64 = high + v;
        let v_part = sum - high;
        low += (high - (sum - v_part)) + (v - v_part);
        high = sum;
    };
    let pair = |x: Fixed| {
        let head = x as f64;
        (head, (x - head as Fixed) as f64)
    };
    let mut product = |x: Fixed, y: Fixed, sign: f64| {
        let ((x1, x0), (y1, y0)) = (pair(x), pair(y));
        let head = x1 * y1;
        add(sign * head);
        size += head.abs();
        add(sign * (fixed::product_error(x1, y1) + (x1 * y0 + x0 * y1)));
    };
    let mut a = spoke(0);
    for i in 1..len {
        let b = spoke(i);
        product(a.x, b.y, 1.0);
        product(a.y, b.x, -1.0);
        a = b;
    }
    let sum = high + low;
    if sum.abs() <= ZERO * size { None } else { Some(sum) }
}
