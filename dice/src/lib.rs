//! Cuts polygons by a grid: every piece, or the exact area and centroid in every cell.
//!
//! ```
//! use glam::{IVec2, dvec2};
//! use pointillist_dice::{Accumulator, Grid, accumulate, split};
//!
//! // A unit square, half a cell off the grid: four cells, a quarter each.
//! let square = [dvec2(0.5, 0.5), dvec2(1.5, 0.5), dvec2(1.5, 1.5), dvec2(0.5, 1.5)];
//! let mut pieces = vec![];
//! split(&square, &Grid::UNIT, |piece| pieces.push((piece.cell, piece.area)))?;
//! assert_eq!(pieces[0], (IVec2::new(0, 0), 0.25));
//! assert_eq!(pieces.len(), 4);
//!
//! // A triangle over 100 × 100 cells: the cells that its edges miss come as runs.
//! let triangle = [dvec2(0.0, 0.0), dvec2(100.0, 0.0), dvec2(0.0, 100.0)];
//! let (mut area, mut runs) = (0.0, 0);
//! accumulate(&triangle, &Grid::UNIT, &mut Accumulator::new(), |run| {
//!     area += run.area * run.columns.len() as f64;
//!     runs += 1;
//! })?;
//! assert_eq!((area, runs), (5000.0, 297));
//! # Ok::<(), pointillist_dice::DiceError>(())
//! ```
//!
//! The crate is plain geometry in two dimensions. [`clip_ring`] clips convex rings of any kind of vertex by a half-space: in three dimensions,
//! before there is a grid, or with what else a vertex carries.
//!
//! # Accuracy and cost
//!
//! Inside, coordinates are fixed point with 2⁻⁹⁶ of a cell, exact for what an `f64` vertex within ±2³⁰ cells can say
//! (from 2⁻⁴³ cells upwards; finer digits are cut off). Which cell a point is in, on which side of a line, and whether a
//! cell is full or empty are decided exactly; crossings of edges with grid lines are off by some 2⁻⁹⁶ cells for each row
//! or column that the edge passes. What is left is the rounding of the results to `f64`: the cell areas of `accumulate`
//! are the exact ones rounded once (half a unit in the last place), wherever the polygon lies; those of `split` lose up
//! to 8 bits more for thin pieces. A sliver's area keeps its digits down to a width of 10⁻¹² cells and beyond. Cells with
//! less than about 2⁻⁸⁵ of their area covered (2⁻⁶⁸ for polygons across 10⁷ cells) are taken as not covered. On grids
//! whose origin and cells are no powers of two, results in input coordinates are rounded to those once more, and two
//! corners of a tiny piece may come out as the same point.
//!
//! [`cut`] is the engine for renderers: one convex piece a cell, in `f64`. The area in a cell is off by at most [`CUT_ERROR`] (2⁻⁴⁹) times
//! the largest coordinate; neighbours share their crossings bit for bit, and a window shows the cells of the whole.
//!
//! [`hide`] finds what is left of a polygon behind other polygons, opaque or translucent.
//!
//! `split` costs time for each piece, `accumulate` for each cell on the outline and each row, both only within the grid's window
//! ([`Grid::with_window`]). The figures are in the README, with the commands that give them.
//!
//! # Maps
//!
//! Rasters of maps are [`Grid`]s with a negative cell height (north-up), polygons of GeoJSON and shapefiles the rings of
//! [`accumulate_filled`], closed or open. The README has an example, the folder `examples` a program (`land_cover`).
//!
//! | | polygons | computes in | bad input |
//! | --- | --- | --- | --- |
//! | [`split`] | convex | fixed point | a typed error |
//! | [`accumulate`] | simple | fixed point | a typed error |
//! | [`accumulate_filled`] | any rings, holes | fixed point; heights of crossings in `f64` | a typed error |
//! | [`cut`] | convex, positive order, at most 12 corners, within ±2³⁰ cells | `f64` | a panic for 13 corners and for NaN, no meaning beyond ±2³⁰ |
//!
//! # Features
//!
//! * `invariants` (off): the module `invariants`, facts that hold for every input, for tests and fuzzing.
//!
//! # References
//!
//! * \[1\] The ternary codes: the appendix on cutting shapes by a grid of a paper on micropoint-based shadows (in Japanese).
//! * \[2\] T. J. Dekker, *A floating-point technique for extending the available precision*, 1971.
#![forbid(unsafe_code)]

mod accumulate;
mod clip;
mod code;
pub mod convex;
mod cut;
mod edge;
mod error;
mod fill;
mod fixed;
mod grid;
pub mod hide;
#[cfg(feature = "invariants")]
pub mod invariants;
pub mod lambert;
mod limits;
mod meet;
mod outline;
mod rule;
mod slabs;
mod split;
mod strip;
mod window;

pub use glam;

pub use accumulate::{Accumulator, Run, accumulate, accumulate_filled};
pub use clip::{clip_ring, share_before_crossing};
pub use code::{Code, CodeKind};
pub use convex::{ConvexPolygon, HalfPlane};
pub use cut::{CUT_ERROR, Cut, MAX_CUT_VERTICES, cut};
pub use error::DiceError;
pub use grid::Grid;
pub use limits::{CONVEXITY_TOLERANCE, MAX_CELLS, MAX_COORDINATE};
pub use rule::FillRule;
pub use split::{Piece, split};
pub use window::CellWindow;

/// The README's examples, compiled and run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
