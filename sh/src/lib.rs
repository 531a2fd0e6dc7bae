//! Spherical harmonics of light: images of all directions are projected to a few coefficients, and these give
//! irradiance and glossy light.
//!
//! ```
//! use glam::{DVec3, dvec3};
//! use pointillist_sh::{CubeMap, CubeProjector, IrradianceMatrix, Weights};
//!
//! // A sky that is 2 everywhere, and red from above.
//! let sky = CubeMap::from_fn(32, |direction| dvec3(2.0 + direction.y, 2.0, 2.0))?;
//! let sh = CubeProjector::new(32, 2, Weights::Gregory)?.project(&sky)?;
//!
//! // A constant L gives E = πL; the part y·1 gives A₁ = 2π/3 of itself.
//! let lit = IrradianceMatrix::new(&sh).at(DVec3::Y) / std::f64::consts::PI;
//! assert!((lit - dvec3(2.0 + 2.0 / 3.0, 2.0, 2.0)).length() < 1e-5);
//! # Ok::<(), pointillist_sh::ShError>(())
//! ```
//!
//! The basis is real and orthonormal, without the sign (−1)^m, in world axes, ordered by band l and then by m = −l…l:
//! Y00, Y1−1 ~ y, Y10 ~ z, Y11 ~ x, Y2−2 ~ xy, Y2−1 ~ yz, Y20 ~ 3z² − 1, Y21 ~ xz, Y22 ~ x² − y², … up to
//! [`MAX_ORDER`]. Coefficients are those of radiance, L_lm = ∫ L·Y_lm dω.
//!
//! * Images: [`CubeMap`] and [`Panorama`], projected by [`CubeProjector`] and [`PanoramaProjector`]; [`Response`]
//!   inverts the response of a camera, [`Brackets`] join exposures. [`Weights`] are the quadrature weights of texels.
//! * [`Sh`]: coefficients, of colors or of one number (visibility); evaluated, blended, turned ([`Rotation`]),
//!   multiplied ([`Product`]).
//! * Use: [`Sh::irradiance`] for any order, [`IrradianceMatrix`] and [`Irradiance`] to evaluate it quickly, [`Lobe`]
//!   for glossy reflection, [`Sh::deringed`], [`Sh::split`] and [`DominantLight`] against negative light,
//!   [`Sh::ambient_occlusion`].
//!
//! # Accuracy
//! The basis, rotation, products and irradiance are exact up to rounding (1e-12 of the largest coefficient, 1e-13 for
//! irradiance of order 2, 2e-6 in single precision). Projection of point samples: see [`Weights`]. Minima: see
//! [`Sh::minimum`].
//!
//! # Features
//! `rayon` (default) computes images and sums of panoramas on all cores; it never changes a result. `invariants`: the
//! module of that name, facts for property tests and fuzzing, also of crates that build on this one.
//!
//! Builds for `wasm32-unknown-unknown` without default features; last bits of coefficients differ there from those of
//! x86-64, because sines and powers come from another library. Times in the README are with thin LTO and
//! `codegen-units = 1` in the profile of the dependent program.
//!
//! # References
//! 1. R. Ramamoorthi, P. Hanrahan: *An efficient representation for irradiance environment maps*, SIGGRAPH 2001.
//! 2. R. Green: *Spherical harmonic lighting: the gritty details*, GDC 2003.
//! 3. P.-P. Sloan: *Stupid spherical harmonics (SH) tricks*, GDC 2008.
//! 4. J. Ivanic, K. Ruedenberg: *Rotation matrices for real spherical harmonics*, J. Phys. Chem. 100 (1996); corrected
//!    in J. Phys. Chem. A 102 (1998).
//! 5. P. J. Davis, P. Rabinowitz: *Methods of numerical integration*, 2nd ed. 1984: Gauss–Legendre (2.7), Gregory's end
//!    corrections (2.9), Fejér's first rule (2.5.5).
//! 6. A. Van Oosterom, J. Strackee: *The solid angle of a plane triangle*, IEEE Trans. Biomed. Eng. 30 (1983).
//! 7. B. Karis: *Real shading in Unreal Engine 4*, SIGGRAPH courses 2013: the lobe of a reflection seen along the
//!    normal.

#![forbid(unsafe_code)]

mod basis;
mod brackets;
mod channel;
mod clipping;
mod coefficients;
mod cube_face;
mod cube_map;
mod cube_projector;
mod dominant;
mod eigen;
mod error;
mod gauss_legendre;
#[cfg(feature = "invariants")]
pub mod invariants;
mod irradiance;
mod irradiance_matrix;
mod kernel;
mod legendre;
mod lobe;
mod minimum;
mod moments;
mod occlusion;
mod panorama;
mod panorama_cube;
mod panorama_projector;
mod product;
mod quadrature;
mod response;
mod rotation;
mod search;
mod solid_angle;
mod weights;
mod window;

pub use basis::{MAX_COUNT, MAX_ORDER, basis, basis_l2, coefficient_count, coefficient_index};
pub use brackets::Brackets;
pub use channel::Channel;
pub use clipping::Clipping;
pub use coefficients::Sh;
pub use cube_face::{CubePoint, cube_direction, cube_point};
pub use cube_map::CubeMap;
pub use cube_projector::CubeProjector;
pub use dominant::{DominantLight, Split};
pub use error::ShError;
pub use gauss_legendre::gauss_legendre;
pub use irradiance_matrix::{Irradiance, IrradianceMatrix};
pub use lobe::Lobe;
pub use panorama::Panorama;
pub use panorama_projector::PanoramaProjector;
pub use product::Product;
pub use quadrature::SphereQuadrature;
pub use response::Response;
pub use rotation::Rotation;
pub use solid_angle::texel_solid_angle;
pub use weights::{GREGORY_FROM, Weights};
pub use window::Window;

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
