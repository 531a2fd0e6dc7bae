//! Raw range scans drawn directly: noisy, overlapping, without normals and without preparation.
//!
//! ```
//! use glam::{DVec3, Vec3, dvec3};
//! use pointillist_ibpr::{Cloud, Frame, Options, Projection, Renderer, Scan, View};
//!
//! // A sheet of 100 × 100 points, one unit apart, seen from 200 units away.
//! let points: Vec<DVec3> = (0..10_000).map(|i| dvec3((i % 100) as f64, (i / 100) as f64, 0.0)).collect();
//! let cloud = Cloud::new(&[Scan::new(&points)], Vec3::ONE)?;
//! assert_eq!(cloud.spacing(), 1.0);
//! let (eye, target) = (dvec3(49.5, 49.5, 200.0), dvec3(49.5, 49.5, 0.0));
//! let view = View::look_at(eye, target, DVec3::Y, Projection::Perspective { fov_y_rad: 0.4 }, 64, 64)?;
//! let mut frame = Frame::new();
//! Renderer::new().draw(&cloud, &view, &Options::default(), &mut frame)?;
//! let middle = 32 * 64 + 32;
//! assert!((frame.depth()[middle] - 200.0).abs() < 1e-3);
//! assert_eq!(frame.color()[middle][3], 1.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How a frame is made
//! 1. Blocks outside the view, or that face away, are skipped whole ([`Culling`]).
//! 2. Points are projected into a buffer at picture/S ([`Scale`]); the points of a pixel within γ of its
//!    nearest one are averaged ([`Weighting`]).
//! 3. Gaps between pixels of one surface are filled by pull-push ([`Options::fill`]).
//! 4. Surfaces are fitted to windows of averages ([`Normals`]).
//! 5. Neighbouring averages make faces that end at smooth outlines ([`Options::outline`]), drawn at the picture's size, lit, and written
//!    as layers ([`Frame`]).
//!
//! # Accuracy and cost
//! Positions are `f64` relative to their block, then `f32` in units of the cloud's size; depth is kept relative to the
//! middle of the cloud. Sums run in the cloud's own order, so a picture does not depend on the order of the
//! input or on threads. Faces of the picture and fits of the buffer take more time than points:
//! `studies/results/ibpr.md` has time against error for every option, and the paper's own times beside ours.
//!
//! # Features
//! `rayon` (default): bands of the picture on all cores; results do not change. `invariants`: the module of that name,
//! facts for property tests and fuzzing, also of crates that build on this one.
//!
//! Builds for `wasm32-unknown-unknown` without default features; last bits of pictures may differ there, because
//! logarithms and trigonometric functions come from another library. Figures here and in the README are with thin LTO
//! and `codegen-units = 1` (`[profile.release]` of the program that depends on this crate): without them expect
//! somewhat more.
//!
//! # References
//! \[1\] The paper on image-based point rendering (IBPR) of several range scans: buffer, γ, eight
//! triangles, two passes, layers. \[2\] J. P. Grossman and W. J. Dally, *Point Sample Rendering*, 1998: pull-push.
//! \[3\] C. Boucheny, 2009, §4.4: eye-dome lighting.
#![forbid(unsafe_code)]

mod accumulate;
mod block_view;
mod border;
mod buffer;
mod buffer_map;
mod cloud;
mod cone;
mod cull;
mod error;
mod eye_dome;
mod faces;
mod fill;
mod fit;
mod frame;
mod hidden;
#[cfg(feature = "invariants")]
pub mod invariants;
mod layers;
mod nearest;
mod noise;
mod normals;
mod occupied;
mod options;
mod order;
mod outline;
mod parallel;
mod pixels;
mod prepared;
mod project;
mod raster;
mod render;
mod rules;
mod scan;
mod seams;
mod shade;
mod solid_row;
mod spacing;
mod stray;
mod wanted;

pub use cloud::{Cloud, ScanId};
pub use error::IbprError;
pub use frame::{Frame, FrameCounts};
pub use options::{Culling, EyeDome, Normals, Options, Passes, Scale, Translucency, Weighting};
pub use pointillist_view::{Light, PixelRect, Projected, Projection, Ray, View, ViewError};
pub use render::Renderer;
pub use scan::Scan;

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
