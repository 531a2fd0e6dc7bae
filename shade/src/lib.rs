//! What a surface does with light: lights, BRDFs, normals and textures.
//!
//! Everything here is a pure function of its arguments. Who sees what, and who shadows whom, is the caller's
//! business; this crate says how much light *would* arrive and how much of it leaves towards the eye.
//!
//! ```
//! use glam::{DVec3, Vec3, dvec3};
//! use pointillist_shade::{Falloff, Light, Material};
//!
//! // A lamp of π candela, one metre above a white Lambert surface, gives radiance 1 in every direction.
//! let lamp = Light::Point {
//!     position: dvec3(0.0, 1.0, 0.0),
//!     intensity: Vec3::splat(std::f32::consts::PI),
//!     falloff: Falloff::InverseSquare,
//! };
//! let incident = lamp.illuminate(0, DVec3::ZERO);
//! let white = Material::lambert(Vec3::ONE);
//! let radiance = white.reflect(&incident, Vec3::Y, Vec3::new(0.6, 0.8, 0.0));
//! assert!((radiance - Vec3::ONE).length() < 1e-6);
//! ```
//!
//! # Parts
//!
//! * [`Light`], [`Incident`]: directional, point, spot and rectangular lights in physical units, with inverse-square
//!   or constant/linear/quadratic attenuation.
//! * [`Material`], [`Model`]: Lambert, Phong and Blinn-Phong, the last two plain and energy-conserving.
//! * [`gl`]: the fixed-function OpenGL formula with its own light and material.
//! * [`vertex_normals`], [`interpolate_normal`], [`interpolate_color`], [`Interpolation`]: flat, Gouraud and Phong
//!   shading, and [`turn_to`] and [`sees_light`]: the two-sided rule.
//! * [`Wrap`], [`nearest`]: texture wrap modes and nearest lookup on slices.
//!
//! # Accuracy and cost
//!
//! Positions are `f64` and are subtracted before anything is rounded to `f32`, so a scene far from its origin shades
//! as it does at the origin. Directions and colours are `f32`; an evaluation costs a few tens of nanoseconds and
//! does not allocate. Finite input gives finite output: irradiance beyond [`LARGEST_IRRADIANCE`] (a point on top of
//! a lamp) is cut there.
//!
//! # References
//!
//! 1. B. T. Phong, *Illumination for computer generated pictures*, CACM 1975.
//! 2. J. F. Blinn, *Models of light reflection for computer synthesized pictures*, SIGGRAPH 1977.
//! 3. E. P. Lafortune, Y. D. Willems, *Using the modified Phong reflectance model for physically based rendering*, 1994.
//! 4. F. Giesen, *Phong and Blinn-Phong normalization factors*, 2009.
//! 5. M. Segal, K. Akeley, *The OpenGL graphics system* (2.1), section 2.14.
#![forbid(unsafe_code)]

mod brdf;
mod error;
pub mod gl;
mod interpolation;
mod light;
mod material;
mod normals;
mod texture;

pub use error::ShadeError;
pub use interpolation::{Interpolation, interpolate_color, interpolate_normal};
pub use light::{Falloff, Incident, LARGEST_IRRADIANCE, Light, Source};
pub use material::{Material, Model};
pub use normals::{Weighting, face_normal, sees_light, turn_to, vertex_normals};
pub use texture::{Wrap, nearest};
