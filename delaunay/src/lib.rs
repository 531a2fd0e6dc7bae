//! Exact Delaunay tetrahedra of any points, in safe Rust: built, changed point by point, and queried.
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use pointillist_delaunay::{Delaunay, Locator};
//!
//! // The corners of a cube and its middle: each face is the base of two tetrahedra.
//! let corner = |i: u32| [f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)];
//! let mut points: Vec<[f64; 3]> = (0..8).map(corner).collect();
//! points.push([0.5; 3]);
//! let mut delaunay = Delaunay::new(&points)?;
//! let partition = delaunay.partition();
//! assert_eq!((partition.cell_count(), partition.hull().len()), (12, 12));
//!
//! // Which points a position lies between, and how much of each it takes.
//! let locator = Locator::new(delaunay.points(), &partition)?;
//! let blend = locator.locate_anywhere(dvec3(0.5, 0.5, 0.25))?;
//! let mixed: DVec3 = blend.parts().map(|(point, weight)| delaunay.points()[point as usize] * weight).sum();
//! assert!((mixed - dvec3(0.5, 0.5, 0.25)).length() < 1e-15);
//!
//! // Without the middle the cube is divided into five or six.
//! delaunay.remove(8)?;
//! assert!((5..=6).contains(&delaunay.partition().cell_count()));
//! # Ok::<(), pointillist_delaunay::DelaunayError>(())
//! ```
//!
//! * [`Delaunay`]: built from points, changed by [`insert`](Delaunay::insert) and [`remove`](Delaunay::remove).
//!   Tetrahedra where the points span space, triangles in a plane, segments on a line, a point where all coincide.
//! * [`Partition`]: the cells as plain lists. [`Partition::cells`] and their neighbours, [`Partition::hull`],
//!   [`Partition::graph`] with the edges and the vertices around a vertex, [`Cell::circumcentre`] for the Voronoi
//!   diagram, [`Partition::verify`].
//! * [`Locator`]: the cell that holds a position, and barycentric weights that are continuous everywhere, also beyond
//!   the hull.
//! * [`NearestVertex`]: the point nearest to a position.
//!
//! # Accuracy
//! Every decision of [`Delaunay`], [`NearestVertex`] and [`Partition::verify`] is exact, for all finite coordinates.
//! Coordinates are multiplied by a power of two and, where that does not round, counted from the least of their axis. A
//! determinant in `f64` decides where it exceeds its error bound. Elsewhere,
//!
//! * differences that are integers up to 659 after scaling, as those of most grids, need nothing more: `f64` does not
//!   round there;
//! * integers up to about 2²⁴ are decided in `i128`;
//! * other differences are cut to integers of 61 bits, where that is exact or what is cut off cannot change the sign,
//!   and the rest goes to Shewchuk's expansions (\[5\]), while the lowest bit of all coordinates is worth at least
//!   2⁻²⁰⁰ of the largest coordinate;
//! * all else, such as 1e-300 beside 1 or 1e300 beside 1e-300, is decided in integers of any size.
//!
//! Points on a common sphere are divided by a symbolic perturbation (\[3\]): the later of two points in lexicographic
//! order counts as lifted infinitely more. So there is one result for every set of points, it has no flat cell, and
//! order, threads and history do not matter: cells are reported in an order that depends on the points alone (along a
//! Hilbert curve), named by the first of those that coincide.
//!
//! Points in a plane get the exact Delaunay triangles of that plane, also of a tilted one. Points on a line are ordered
//! along it.
//!
//! [`Locator`] computes in `f64`: weights sum to 1 within 1e-14 and reproduce linear functions up to rounding. Cells that
//! are flat up to rounding, as there are between four points of a tilted square, are passed: a position in one gets the
//! weights of a cell beside it. Rounded points of a tilted plane or line have no other cells, and
//! [`Partition::up_to_rounding`] gives them triangles or segments. [`circumcentre`] states its bound.
//!
//! # Cost
//! About linear for points spread evenly in space, and for grids; in the worst case, points on a curve, the number of
//! tetrahedra is quadratic. 32 bytes a cell, about 7 cells a point. Inserting and removing cost a walk, which from an
//! arbitrary place takes about n^⅓ steps, and as much as there is to change; all is built anew where the dimension
//! changes. [`Delaunay::partition`] sorts and copies all cells: about half as much as building.
//!
//! # Features
//! `rayon` (default) uses all cores; it never changes a result. `invariants`: the module of that name, facts for
//! property tests and fuzzing, also of crates that build on this one.
//!
//! Builds for `wasm32-unknown-unknown` without default features. Cells, circumcentres and nearest vertices are the same
//! to the bit there: decisions are exact, and circumcentres take additions, products and quotients alone. So were
//! weights, of 3000 random points and of a grid. Times in the README are with thin LTO and `codegen-units = 1` in the
//! profile of the dependent program.
//!
//! # References
//! 1. A. Bowyer: *Computing Dirichlet tessellations*, The Computer Journal 24, 1981.
//! 2. D. F. Watson: *Computing the n-dimensional Delaunay tessellation*, The Computer Journal 24, 1981.
//! 3. O. Devillers, M. Teillaud: *Perturbations for Delaunay and weighted Delaunay 3D triangulations*, Computational
//!    Geometry 44, 2011.
//! 4. N. Amenta, S. Choi, G. Rote: *Incremental constructions con BRIO*, SoCG 2003.
//! 5. J. R. Shewchuk: *Adaptive precision floating-point arithmetic and fast robust geometric predicates*, Discrete &
//!    Computational Geometry 18, 1997.
//! 6. D. Funke, P. Sanders: *Parallel d-D Delaunay triangulations in shared and distributed memory*, ALENEX 2017.
#![forbid(unsafe_code)]

mod blend;
mod cells;
mod circumcentre;
mod error;
mod facets;
mod flat;
mod graph;
mod hull;
#[cfg(feature = "invariants")]
pub mod invariants;
mod locator;
mod nearest;
mod partition;
mod scale;
mod simplex;
mod triangulation;
mod verify;
mod vertices;
mod walk;
mod wide;

use pointillist_parallel as parallel;

pub use blend::Blend;
pub use cells::Cell;
pub use circumcentre::circumcentre;
pub use error::DelaunayError;
pub use facets::Facet;
pub use graph::Graph;
pub use locator::{Hint, Locator};
pub use nearest::NearestVertex;
pub use partition::{OUTSIDE, Partition, Tetrahedra, Triangles};
pub use triangulation::Delaunay;

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
