//! Triangles to visible micropoints: exact coverage and exact occlusion in every cell.
//!
//! An observer of a pixel sees Coverage × Alpha × Color, so coverage can be moved into opacity and no
//! sample is needed, nor missed (\[1\], §3). This crate cuts triangles by the cells of the pixel grid,
//! finds out what is visible of each piece, and hands out *micropoints*: a weight, a place on a
//! triangle, and the visible outline, for anyone to shade.
//!
//! ```
//! use glam::DVec3;
//! use pointillist_micropoint::*;
//!
//! // A triangle that covers half of the first pixel of a 2×1 picture.
//! let corners = [DVec3::new(-1.0, 0.5, 0.0), DVec3::new(0.0, -0.5, 0.0), DVec3::new(0.0, 0.5, 0.0)];
//! let geometry = Geometry::new(&corners, &[[0, 1, 2]], &[0], &[SurfaceOpacity::default()])?;
//! let camera = Projection::Orthographic { height: 1.0 };
//! let view = View::look_at(DVec3::Z, DVec3::ZERO, DVec3::Y, camera, 2, 1)?;
//! let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::default())?;
//! let mut tile = Tile::default();
//! renderer.render(renderer.picture(), &mut tile);
//! let weights: Vec<f64> = tile.points().iter().map(|p| p.weight).collect();
//! assert_eq!(weights, [0.5]);
//! # Ok::<(), MicropointError>(())
//! ```
//!
//! # Accuracy and cost
//! Geometry is f64 relative to the eye. Areas are exact up to rounding; where several parts meet in one
//! cell they are clipped against each other, so that what a pixel shows is the exact area integral of
//! piecewise constant colors. Surfaces whose depths differ by less than 1e-10 (relative) coincide.
//! Cost grows with the visible outline, not with hidden or covered area: closed cells refuse what lies
//! behind them, whole clusters at a time, and covered cells are never cut.
//!
//! # Features
//! `rayon` (default): renders tiles on all cores. `invariants`: facts for property tests and fuzzing.
//!
//! # References
//! 1. M. Takakuwa, K. Iigura: *MicroPoint Based Shadow* (§3: micropoints, §4.2.6: resolving).
//! 2. E. Catmull: *A hidden-surface algorithm with anti-aliasing*, SIGGRAPH 1978.
//! 3. L. Carpenter: *The A-buffer, an antialiased hidden surface method*, SIGGRAPH 1984.
#![forbid(unsafe_code)]

mod bounds;
mod build;
mod closed;
mod dicer;
mod divide;
mod error;
mod face;
mod fine;
mod front;
mod geometry;
mod hierarchy;
mod instances;
mod interval;
#[cfg(feature = "invariants")]
pub mod invariants;
mod lens;
mod neighbours;
mod render;
mod resolve;
mod texel;
mod tile;
mod visit;
mod volume;

pub use glam;

pub use bounds::Bounds;
pub use dicer::TileCounts;
pub use error::MicropointError;
pub use face::{
    DepthRange, Face, GridRect, PlainOpacity, ProjectedVertex, Setup, SurfacePoint, TexturedOpacity,
};
pub use front::{Front, Layer, in_front};
pub use geometry::{ClusterTriangle, Geometry, HiddenSides, SurfaceOpacity};
pub use instances::{Placement, Shape};
pub use interval::Interval;
pub use lens::{BoxImage, Lens, LensKind, Plane};
pub use pointillist_view::{PixelRect, Projection, View, ViewError};
pub use render::{MicropointOptions, Renderer};
pub use resolve::Occlusion;
pub use texel::{MOST_TEXELS_ON_A_SIDE, MaskSums, TexelCorner, TexelSums, TexelWrap};
pub use tile::{Fragment, Micropoint, Tile};
pub use visit::{ClusterFace, ClusterView, FaceVisitor, VisitCounts, VisitMemory};

/// The README's examples, compiled and run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
