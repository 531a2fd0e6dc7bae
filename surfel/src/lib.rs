//! Surfaces as points: even samples of a triangle mesh, each with a disc so large that the discs leave no gap.
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use pointillist_surfel::{Method, SampleOptions, sample};
//!
//! // A unit square of two triangles, sampled by rays a quarter apart: 4 × 4 points.
//! let corners = [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::Y];
//! let options = SampleOptions::DEFAULT.with_method(Method::Ldi).with_spacing(0.25);
//! let points = sample(&corners, &[[0, 1, 2], [0, 2, 3]], &options)?;
//! assert_eq!(points.len(), 16);
//! assert_eq!(points[0].position, dvec3(0.125, 0.125, 0.0));
//! # Ok::<(), pointillist_surfel::SurfelError>(())
//! ```
//!
//! Two ways of choosing the points:
//!
//! * [`Method::Ldi`]: the intersections with three orthogonal grids of parallel rays (\[1\], §5.1). Regular and fast; the
//!   density is `|n|∞ / spacing²`, between 0.58 and 1 points per square of the spacing.
//! * [`Method::Poisson`]: blue noise by the elimination of the most crowded of five times as many random
//!   points (\[2\]). Exactly as many points as asked for, without pattern, evenly over the area.
//!
//! # Accuracy and cost
//! Points lie on their triangles up to rounding, at any distance from the origin. Rays through shared edges and vertices hit
//! exactly once: coverage is decided in integers. The time of `Ldi` is linear in triangles and points, that of `Poisson` is
//! `n log n` in the points. Results do not depend on threads; the points of `Ldi` do not depend on the order of
//! triangles either.
//!
//! # Features
//! `rayon` (default) uses all cores; it never changes a result. `invariants`: facts for property tests and fuzzing.
//!
//! # References
//! 1. H. Pfister, M. Zwicker, J. van Baar, M. Gross: *Surfels: surface elements as rendering primitives*, SIGGRAPH 2000.
//! 2. C. Yuksel: *Sample elimination for generating Poisson disk sample sets*, Eurographics 2015.
#![forbid(unsafe_code)]

mod areas;
mod blue_noise;
mod camera;
mod cloud;
mod cover;
mod eliminate;
mod error;
mod focus;
mod frame;
#[cfg(feature = "invariants")]
pub mod invariants;
mod kernel;
mod lattice;
mod ldi;
mod links;
mod mesh;
mod neighbours;
mod normals;
mod octree;
mod options;
mod packed;
mod paper;
mod parallel;
mod point;
mod points;
mod radius;
mod render;
mod rows;
mod sample;
mod select;
mod shade;
mod splat;
mod tile;
mod view;

pub use cloud::Cloud;
pub use error::SurfelError;
pub use focus::{Focus, field_of_view_rad};
pub use frame::{Frame, FrameCounts};
pub use options::{Light, Options, Procedure};
pub use point::SurfacePoint;
pub use points::Points;
pub use render::Renderer;
pub use sample::{Amount, MAX_COUNT, Method, SampleOptions, sample};
pub use view::{Projection, View};
