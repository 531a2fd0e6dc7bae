//! Point-sampled surfaces (surfels): meshes sampled to discs, and discs drawn with level of detail and depth of field.
//!
//! ```
//! use glam::{DAffine3, DVec3, dvec3};
//! use pointillist_surfel::{Cloud, Focus, Frame, Options, Points, Projection, Renderer, SampleOptions, View, sample};
//!
//! // A unit square of two triangles, facing +Z, as a thousand points.
//! let corners = [DVec3::ZERO, DVec3::X, dvec3(1.0, 1.0, 0.0), DVec3::Y];
//! let points = sample(&corners, &[[0, 1, 2], [0, 2, 3]], &SampleOptions::DEFAULT.with_count(1000))?;
//! let positions: Vec<_> = points.iter().map(|p| p.position).collect();
//! let normals: Vec<_> = points.iter().map(|p| p.normal.as_vec3()).collect();
//! let cloud = Cloud::new(&Points::new(&positions).with_normals(&normals))?;
//!
//! // Seen from 2 in front of its middle: it fills 16 × 16 of 32 × 32 pixels, up to a fraction of a pixel.
//! let from_world = DAffine3::from_translation(dvec3(-0.5, -0.5, -2.0));
//! let view = View::from_matrix(from_world, Projection::Orthographic { height: 2.0 }, 32, 32)?;
//! let mut options = Options::default();
//! let (mut renderer, mut frame) = (Renderer::new(), Frame::new());
//! renderer.draw(&cloud, &view, &options, &mut frame)?;
//! let covered: f32 = frame.color().iter().map(|c| c[3]).sum();
//! assert!((covered / 256.0 - 1.0).abs() < 0.08);
//! assert_eq!(frame.depth()[32 * 16 + 16], 2.0);
//!
//! // The same through a lens that is focused nearer.
//! options.focus = Focus::Lens { aperture: 0.1, focus: 1.5 };
//! renderer.draw(&cloud, &view, &options, &mut frame)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Sampling
//!
//! * [`Method::Ldi`]: the intersections with three orthogonal grids of parallel rays (\[1\], §5.1). Regular and fast;
//!   the density is `|n|∞ / spacing²`, between 0.58 and 1 points per square of the spacing.
//! * [`Method::Poisson`]: blue noise by the elimination of the most crowded of five times as many random
//!   points (\[2\]). Exactly as many points as asked for, without pattern, evenly over the area.
//!
//! # Drawing
//!
//! * [`Cloud`]: an octree whose leaves hold the points and whose inner nodes hold links to a few of them, each with the
//!   area and the mean place, normal and color of what it stands for.
//! * [`Renderer`] takes each part of the cloud from the coarsest level on which about one point falls on a pixel, or,
//!   out of focus, points are as far apart as the blur is wide. Between two levels it draws pairs of neighbours as one
//!   disc. Discs become ellipses with exact perspective and are lit; in each pixel those of the nearest surface are
//!   averaged and composited over what is behind. Points may have opacities ([`Points::with_opacities`]).
//! * Without normals, [`Cloud::new`] estimates them, and looks for the outside of closed surfaces ([`estimate_normals`]).
//! * [`Cloud::parts`] and [`Cloud::join`]: a cloud that is too large to be held is prepared in parts, each with the
//!   points around it, and those parts are drawn together that a view needs.
//! * [`Focus`]: the paper's parameter d (\[3\], §3), or a thin lens, of which d = aperture/focus is the same.
//! * [`Procedure::Paper`]: what the paper does (\[3\]), for comparison.
//!
//! # Accuracy and cost
//! Sampled points lie on their triangles up to rounding; rays through shared edges and vertices hit exactly once:
//! coverage is decided in integers. Drawn positions are those given to 2⁻³² of the cloud's extent. No result depends on
//! threads or on the order of points, and none of drawing on where the cloud lies. Accuracy and time of frames:
//! `studies/results/surfel.md`.
//!
//! # Features
//! `rayon` (default) uses all cores; it never changes a result. `invariants`: the module of that name, facts
//! for property tests and fuzzing, also of crates that build on this one.
//!
//! Builds for `wasm32-unknown-unknown` without default features; last bits of samples and pictures may differ there,
//! because sines and powers come from another library. Figures here and in the README are with thin LTO and
//! `codegen-units = 1` (`[profile.release]` of the program that depends on this crate): without them expect somewhat
//! more.
//!
//! # References
//! 1. H. Pfister, M. Zwicker, J. van Baar, M. Gross: *Surfels: surface elements as rendering primitives*, SIGGRAPH
//!    2000.
//! 2. C. Yuksel: *Sample elimination for generating Poisson disk sample sets*, Eurographics 2015.
//! 3. The seed of this crate: surfel rendering with depth of field by two z-buffers and a filter that follows the
//!    distance (in Japanese; 97,000 points at 400×400 with 0.98 and 0.86 frames a second).
//! 4. J. Křivánek, J. Žára, K. Bouatouch: *Fast depth of field rendering with surface splatting*, CGI 2003: blur as a
//!    level of detail.
#![forbid(unsafe_code)]

mod areas;
mod attributes;
mod batch;
mod blue_noise;
mod camera;
mod cloud;
mod cover;
mod eliminate;
mod ellipse;
mod error;
mod focus;
mod frame;
mod grid;
#[cfg(feature = "invariants")]
pub mod invariants;
mod items;
mod joined;
mod kernel;
mod lattice;
mod layer;
mod ldi;
mod links;
mod mesh;
mod neighbours;
mod node;
mod noise;
mod normals;
mod octree;
mod options;
mod orient;
mod outside;
mod packed;
mod packed_links;
mod pairs;
mod paper;
mod parts;
mod placed;
mod point;
mod points;
mod project;
mod quadric;
mod radius;
mod render;
mod resolve;
mod rows;
mod sample;
mod scene;
mod select;
mod shade;
mod sharpen;
mod signed_sets;
mod spacing;
mod splat;
mod splats;
mod tile;
mod vector;

pub use cloud::Cloud;
pub use error::SurfelError;
pub use focus::{Focus, field_of_view_rad};
pub use frame::{Frame, FrameCounts};
pub use normals::estimate_normals;
pub use options::{Options, Procedure};
pub use parts::{Division, NO_PART};
pub use point::SurfacePoint;
pub use pointillist_view::{Light, PixelRect, Projected, Projection, Ray, View, ViewError};
pub use points::Points;
pub use render::Renderer;
pub use sample::{Amount, MAX_COUNT, Method, SampleOptions, sample, sample_with};

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
