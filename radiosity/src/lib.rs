//! Light between diffuse surfaces: what they exchange, with error bounds, and what they look like in the end.
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use pointillist_radiosity::{FactorOptions, Polygon, form_factor};
//!
//! // Of what leaves the floor of a unit cube, a fifth reaches the ceiling, and another fifth each wall: 0.1998 + 4 · 0.2000 = 1.
//! let square = |o: DVec3, u: DVec3, v: DVec3| Polygon::new(&[o, o + u, o + u + v, o + v]);
//! let floor = square(DVec3::ZERO, DVec3::X, DVec3::Y)?;
//! let ceiling = square(DVec3::Z, DVec3::Y, DVec3::X)?;
//! let wall = square(DVec3::ZERO, DVec3::Y, DVec3::Z)?;
//! let share = |to: &Polygon| form_factor(&floor, to, &[], &FactorOptions::DEFAULT);
//! assert!((share(&ceiling).value - 0.199_824_895_698).abs() < 1e-12);
//! assert!((share(&ceiling).value + 4.0 * share(&wall).value - 1.0).abs() < 1e-12);
//! # Ok::<(), pointillist_radiosity::PolygonError>(())
//! ```
//!
//! * [`form_factor`]: one pair of polygons, with a bound on the error, past any occluders.
//! * [`Scene`]: surfaces, checked and divided into patches; [`Scene::direct`] lights them by lamps.
//! * [`Transport`]: which patches exchange how much, each with each ([`SceneOptions::tolerance`] `None`) or in groups; solved by
//!   [`Transport::gauss_seidel`] or [`Transport::progressive`] with a bound on the error of the result.
//! * [`Scene::seen_from`], [`Scene::importance`], [`Scene::transport_for`]: links that are fine where a camera sees what they carry.
//! * [`RayTransport`]: the same for buildings of many thousand surfaces, with links that rays find ([`Scene::transport_by_rays`]).
//! * [`Solution::bake`] and [`Solution::irradiance`]: light at vertices and at free points.
//! * [`Hemicube`]: the classic method, and the same with exact coverage in its cells.
//!
//! # Accuracy and cost
//! Each pair is computed by the cheapest of three rules that meets the tolerance: quadrature over both areas (far), Lambert's formula at
//! points (of very different size), contours with closed forms where edges are parallel or touch (near). Past occluders what
//! a point sees of a polygon is cut exactly, and only the integral over the points is quadrature. Its error is judged by halving, that is, from
//! samples: what all samples miss by chance is not in the bound.
//!
//! Links by rays are samples: the light at a vertex has the standard error that [`RayOptions::tolerance`] asks for, and that of interpolation. Their
//! cost grows about as the number of surfaces.
//!
//! A hierarchy's error is that of its tolerance. Figures are in the README and `studies/results/radiosity.md`.
//!
//! # Features
//! `rayon` (default) uses all cores; it never changes a result. `invariants`: facts for property tests and fuzzing.
//!
//! # References
//! 1. P. Schröder, P. Hanrahan: *On the form factor between two polygons*, SIGGRAPH 1993.
//! 2. M. F. Cohen, J. R. Wallace: *Radiosity and realistic image synthesis*, 1993; M. F. Cohen, S. E. Chen, J. R. Wallace,
//!    D. P. Greenberg: *A progressive refinement approach to fast radiosity image generation*, SIGGRAPH 1988.
//! 3. P. Hanrahan, D. Salzman, L. Aupperle: *A rapid hierarchical radiosity algorithm*, SIGGRAPH 1991.
//! 4. E. A. Haines, J. R. Wallace: *Shaft culling for efficient ray-cast radiosity*, 1991.
//! 5. M. Feda, W. Purgathofer: *Accelerating radiosity by overshooting*, Eurographics Workshop on Rendering 1992.
//! 6. B. Smits, J. Arvo, D. Greenberg: *A clustering algorithm for radiosity in complex environments*, SIGGRAPH 1994.
//! 7. A. Willmott, P. Heckbert, M. Garland: *Face cluster radiosity*, Eurographics Workshop on Rendering 1999.
//! 8. G. J. Ward, F. M. Rubinstein, R. D. Clear: *A ray tracing solution for diffuse interreflection*, SIGGRAPH 1988.
//! 9. S. Laine, T. Karras: *Stratified sampling for stochastic transparency*, Eurographics Symposium on Rendering 2011.
//! 10. J. Neyman: *On the two different aspects of the representative method*, Journal of the Royal Statistical Society 97, 1934.
//! 11. B. Smits, J. Arvo, D. Salesin: *An importance-driven radiosity algorithm*, SIGGRAPH 1992.
//! 12. P. S. Heckbert: *Discontinuity meshing for radiosity*, Eurographics Workshop on Rendering 1992.
#![forbid(unsafe_code)]
mod assemble;
mod bake;
mod by_hemicube;
mod by_rays;
mod contact;
mod error;
mod estimate;
mod factor;
mod gather;
mod hemicube;
mod importance;
#[cfg(feature = "invariants")]
pub mod invariants;
mod kept;
mod kernel;
mod lamp;
mod link;
mod mesh;
mod patches;
mod polygon;
mod rays;
mod refine;
mod rgb;
mod rows;
mod scene;
mod solve;
mod surface;
mod transport;
mod tree;
mod visible;

pub use glam;

pub use bake::{Baked, BakedTriangle, BakedVertex};
pub use by_rays::{RayCounts, RayOptions, RaySolution, RayTransport};
pub use error::{PolygonError, RadiosityError};
pub use factor::{FactorOptions, FormFactor, form_factor};
pub use hemicube::{Hemicube, HemicubeKind};
pub use lamp::{Irradiance, Lamp};
pub use link::{LinkCounts, RuleCounts};
pub use patches::Patch;
pub use polygon::{Polygon, SHAPE_TOLERANCE};
pub use rgb::Rgb;
pub use scene::{Scene, SceneOptions};
pub use solve::{Solution, SolveOptions};
pub use surface::Surface;
pub use transport::Transport;

/// The README's examples, compiled and run as documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadMe;
