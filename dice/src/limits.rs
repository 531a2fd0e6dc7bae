//! The limits of the input and of the work, in one place for the checks and for the messages of [`DiceError`](crate::DiceError).

/// Vertices must lie within this many cells of the grid's origin, so that every cell near them has an `i32` number.
pub const MAX_COORDINATE: f64 = (1u64 << 30) as f64;

/// The largest number of cells that one call visits; a polygon that meets more is refused before the first one.
pub const MAX_CELLS: u64 = 1 << 28;

/// An outline that turns the wrong way by less than this (sine of the angle) still counts as convex in [`split`](crate::split()):
/// vertices that were computed are rarely exactly on one line. Such a polygon is cut as its convex rows.
pub const CONVEXITY_TOLERANCE: f64 = 1e-9;
