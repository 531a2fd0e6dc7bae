//! Light between probes: the light that arrives at some points in space, as spherical harmonics, is interpolated at any
//! other.
//!
//! ```
//! use glam::{DVec3, Vec3, dvec3};
//! use pointillist_sh::Sh;
//! use pointillist_shprobe::{Field, Hint};
//!
//! // Four probes; the radiance of each is the same from everywhere, and grows along x.
//! let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
//! let radiance = positions.map(|p| Sh::constant(DVec3::splat(1.0 + p.x), 2));
//! let radiance: Vec<Sh> = radiance.into_iter().collect::<Result<_, _>>()?;
//! let field = Field::new(&positions, &radiance)?;
//!
//! // Between them the radiance is 1.25 where x is a quarter, and irradiance is π times that.
//! let mut hint = Hint::default();
//! let light = field.light(dvec3(0.25, 0.25, 0.25), &mut hint)?.at(Vec3::Y);
//! assert!((light - Vec3::splat(1.25 * std::f32::consts::PI)).length() < 1e-6);
//! # Ok::<(), pointillist_shprobe::ProbeError>(())
//! ```
//!
//! * [`Field`]: light at a position, on a surface, and on many moving objects at once.
//! * [`DistanceMap`]: distances to what a probe sees, so that light does not pass through walls.
//! * [`place`]: where to put probes; [`place::adaptive`] chooses them by the error of interpolation.
//!
//! What probes hold are functions of the crate [`sh`]; the space between them is divided by the crate [`delaunay`],
//! into tetrahedra, or triangles, segments or a point where probes span less. Beyond their hull the light is that at
//! the hull's nearest point. Where it is known what probes see, a position takes from the nearest that see it; surfaces
//! always take from probes in front of them.
//!
//! Capturing what a probe sees is left to the caller: any renderer can make the six pictures of a cube map.
//!
//! # Accuracy and cost
//! Cells are exact for any positions. Weights sum to 1 and are continuous, also across the hull; those of cells reproduce
//! linear functions up to rounding, those by distances nearly. Up to 24 probes that see a position light it. Ten thousand moving objects take 0.6 ms on two threads, and
//! with distances some ten times as long, more where no probe sees them.
//!
//! # Features
//! `rayon` (default) uses all cores; it never changes a result. `invariants`: the module of that name, facts for
//! property tests and fuzzing, also of crates that build on this one; those about cells and harmonics are in
//! [`delaunay`] and [`sh`], with their feature of that name.
//!
//! Builds for `wasm32-unknown-unknown` without default features. Cells and [`place::grid`], [`place::random`] and
//! [`place::spread`] are the same to the bit there; last bits of light, and with them ties of [`place::adaptive`], may
//! differ, because `sh` uses sines and powers of another library. Times are with thin LTO and `codegen-units = 1` in
//! the profile of the dependent program.
//!
//! # References
//! 1. The seed of this crate: capture-based lighting (in Japanese): probes, nine coefficients, Delaunay tetrahedra,
//!    barycentric blending.
//! 2. R. Ramamoorthi, P. Hanrahan: *An efficient representation for irradiance environment maps*, SIGGRAPH 2001.
//! 3. R. Cupisz: *Light probe interpolation using tetrahedral tessellations*, GDC 2012.
//! 4. Z. Majercik, J.-P. Guertin, D. Nowrouzezahrai, M. McGuire: *Dynamic diffuse global illumination with ray-traced
//!    irradiance fields*, JCGT 2019: octahedral maps of distance, and visibility from them.
//! 5. W. Donnelly, A. Lauritzen: *Variance shadow maps*, I3D 2006.
//! 6. L. Kavan, A. W. Bargteil, P.-P. Sloan: *Least squares vertex baking*, EGSR 2011.
#![forbid(unsafe_code)]

mod distance;
mod edit;
mod error;
mod field;
mod glossy;
#[cfg(feature = "invariants")]
pub mod invariants;
mod near_cube;
mod octahedron;
pub mod place;
mod sight;
mod tree;

use pointillist_parallel as parallel;

pub use distance::{DEFAULT_DISTANCE_SIZE, DistanceMap};
pub use error::ProbeError;
pub use field::{Field, LitObject};
pub use glossy::Glossy;
/// The cells between probes.
pub use pointillist_delaunay as delaunay;
pub use pointillist_delaunay::Hint;
/// The functions that probes hold.
pub use pointillist_sh as sh;

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
