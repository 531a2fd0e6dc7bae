//! How much of a light reaches each visible piece of a surface, without shadow maps, bias or rays.
//!
//! The *shape* of each visible piece is carried to the light (\[1\], §4): projected onto a light screen
//! and compared there with the triangles between it and the light. What is left of its area is the
//! lit fraction.
//!
//! # Accuracy and cost
//! Under the correlated rule the fraction is exact up to rounding: receivers are clipped by their
//! casters, and two surfaces are compared by their planes, so that no bias is needed and neighbours
//! never darken each other. Cost: one projection per receiver, and a cut per receiver on a shadow edge;
//! groups of receivers without casters, and groups behind one large caster, are settled as a whole.
//!
//! What a point sees of a light with an area ([`AreaLight`]) is exact up to rounding, but for casters nearer to the point than 10⁻⁶ of its
//! distance from the light's plane, along the light's normal, and for masks, which weaken light by their mean over each part. A receiver
//! is asked at its middle, or at those of its pieces ([`AreaOptions`]). The same holds of a line that shines ([`LineLight`]). Cost: a microsecond or two for each point in a penumbra, less
//! elsewhere; masks cost a cut of the light for each of them.
//!
//! # Features
//! `rayon` (default) is passed on to `pointillist-micropoint`. `invariants`: facts for property tests
//! and fuzzing.
//!
//! # References
//! 1. M. Takakuwa, K. Iigura: *MicroPoint Based Shadow*, §4.
//! 2. P. Atherton, K. Weiler, D. Greenberg: *Polygon shadow generation*, SIGGRAPH 1978.
#![forbid(unsafe_code)]

mod area;
mod casters;
mod cells;
mod copies;
mod counts;
mod covered;
mod ends;
mod error;
mod exact;
mod grid;
#[cfg(feature = "invariants")]
pub mod invariants;
mod layers;
mod light;
mod line;
mod lit_regions;
mod options;
mod overlap;
mod pieces;
mod query;
mod receiver;
mod scratch;
mod screen;
mod target;
mod whole_faces;

pub use glam;
/// What the viewer sees, and what casts shadows.
pub use pointillist_micropoint as micropoint;

pub use area::{AreaLight, AreaOptions, AreaScratch, LARGEST_OUTLINE, SeenLight, check_outline};
pub use counts::{AreaCounts, ShadowCounts};
pub use error::ShadowError;
pub use light::ShadowLight;
pub use line::{LineLight, LineScratch, SeenLine};
pub use lit_regions::LitRegion;
pub use options::{Resolution, ShadowOptions};
pub use receiver::{Receivers, Viewer};
pub use scratch::ShadowScratch;
pub use screen::Emitter;

/// The README's examples, compiled and run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
