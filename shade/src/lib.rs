//! What a surface does with light: lights, BRDFs, normals and textures.
//!
//! Everything here is a pure function of its arguments. Visibility and shadows are left to the caller: this crate computes the light
//! that arrives at a point if nothing is in between, and how much of it leaves towards the eye.
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
//! * [`Light`], [`Incident`]: directional, point, spot, rectangular and polygonal lights in physical units, with inverse-square
//!   or constant/linear/quadratic attenuation.
//! * [`Material`], [`Model`]: Lambert, Phong and Blinn-Phong (plain, energy-conserving, and as in OpenGL's formula), and GGX; [`MerlTable`]:
//!   measured BRDFs; [`directional_albedo`]: how much any of them returns.
//! * [`gl`]: the fixed-function OpenGL formula with its own light and material.
//! * [`vertex_normals`], [`corner_normals`], [`interpolate_normal`], [`interpolate_color`], [`Interpolation`]: flat, Gouraud and
//!   Phong shading, smooth and with creases, and [`turn_to`], [`sees_light`], [`keep_visible`]: the two-sided rule.
//! * [`Wrap`], [`nearest`]: texture wrap modes and nearest lookup on slices; [`AutoUv`]: coordinates for meshes without.
//! * [`UvFrame`]: bump maps and normal maps.
//! * [`Environment`], [`CubeMap`], [`Equirectangular`]: light from far away, mirrored by surfaces of any roughness, and
//!   [`mirror`], [`refract`] for where to look.
//!
//! # Which numbers are `f64`
//!
//! Positions, and what is computed from positions before rounding can do harm, are `f64`: points and lamps, directions of lamps and edges
//! of rectangles ([`Light`]), face normals from corners ([`face_normal`]), texture coordinates ([`nearest`], [`AutoUv`]), and directions
//! into images of the surroundings ([`CubeMap`], [`Equirectangular`]), whose texels may be narrower than an `f32` tells apart. Positions
//! are subtracted before anything is rounded, so a scene far from its origin shades as it does at the origin.
//!
//! What a surface is shaded with is `f32`: unit vectors (normals, to the light, to the eye), colors, BRDFs. `as_vec3` and `as_dvec3` of
//! glam lead from one to the other; [`turn_to`] and everything after it takes `Vec3`.
//!
//! # Accuracy and cost
//!
//! An evaluation costs a few tens of nanoseconds and
//! does not allocate. Tables are made when they are first asked for: the GGX coat's albedo (0.04 s, once), a MERL table
//! (17 MB), the blurred levels of an environment (0.5 s). Finite input gives finite output: irradiance beyond [`LARGEST_IRRADIANCE`] (a point on top of
//! a lamp) is cut there.
//!
//! # Features
//!
//! None is on by default. `invariants`: the module of that name, facts for property tests and fuzzing, also of crates that build on this
//! one.
//!
//! Builds for `wasm32-unknown-unknown`; last bits of light may differ there, because powers and trigonometric functions come from
//! another library. Times are with thin LTO and `codegen-units = 1` in the profile of the dependent program.
//!
//! # References
//!
//! 1. B. T. Phong, *Illumination for computer generated pictures*, CACM 1975.
//! 2. J. F. Blinn, *Models of light reflection for computer synthesized pictures*, SIGGRAPH 1977.
//! 3. E. P. Lafortune, Y. D. Willems, *Using the modified Phong reflectance model for physically based rendering*, 1994.
//! 4. F. Giesen, *Phong and Blinn-Phong normalization factors*, 2009.
//! 5. M. Segal, K. Akeley, *The OpenGL graphics system* (2.1), section 2.14.
//! 6. B. Walter et al., *Microfacet models for refraction through rough surfaces*, EGSR 2007.
//! 7. B. Karis, *Real shading in Unreal Engine 4*, SIGGRAPH 2013 course; S. Lagarde, C. de Rousiers, *Moving Frostbite to
//!    PBR*, 2014 (perceptual roughness, grazing reflectance).
//! 8. E. Heitz, *Understanding the masking-shadowing function in microfacet-based BRDFs*, JCGT 2014.
//! 9. C. Schlick, *An inexpensive BRDF model for physically-based rendering*, 1994.
//! 10. C. Kelemen, L. Szirmay-Kalos, *A microfacet based coupled specular-matte BRDF model*, 2001.
//! 11. E. Heitz, *Sampling the GGX distribution of visible normals*, JCGT 2018.
//! 12. W. Matusik et al., *A data-driven reflectance model*, SIGGRAPH 2003, and the reader of the MERL BRDF database.
//! 13. S. Rusinkiewicz, *A new change of variables for efficient BRDF representation*, 1998.
//! 14. J. F. Blinn, *Simulation of wrinkled surfaces*, SIGGRAPH 1978.
//! 15. M. Mikkelsen, *Bump mapping unparametrized surfaces on the GPU*, 2010 (surface gradients).
//! 16. J. Křivánek, M. Colbert, *Real-time shading with filtered importance sampling*, EGSR 2008.
//! 17. G. Thürmer, C. A. Wüthrich, *Computing vertex normals from polygonal facets*, 1998.
//! 18. M. Olano, D. Baker, *LEAN mapping*, I3D 2010 (moments of slopes).
//! 19. A. S. Kaplanyan, S. Hill, A. Patney, A. Lefohn, *Filtering distributions of normals for shading antialiasing*, HPG 2016.
#![forbid(unsafe_code)]

mod area;
mod auto_uv;
mod brdf;
mod bump;
mod creases;
mod environment;
mod error;
mod fresnel;
mod ggx;
mod ggx_table;
pub mod gl;
mod interpolation;
#[cfg(feature = "invariants")]
pub mod invariants;
mod light;
mod material;
mod merl;
mod normals;
mod outline;
mod quadrature;
mod reach;
mod refraction;
mod roughness;
mod texture;

pub use area::{Emission, Lobe, integrate_line, integrate_polygon};
pub use auto_uv::AutoUv;
pub use bump::{UvFrame, keep_visible, slope_of_heights};
pub use creases::{CornerNormals, corner_normals};
pub use environment::{
    CubeMap, Environment, Equirectangular, cube_direction, cube_place, equirectangular_direction,
    equirectangular_uv,
};
pub use error::{LightError, ShadeError};
pub use ggx_table::coat_albedo;
pub use interpolation::{Interpolation, interpolate_color, interpolate_normal};
pub use light::{DEFAULT_SAMPLES, Falloff, Incident, LARGEST_IRRADIANCE, Light, Source};
pub use material::{DIELECTRIC_REFLECTANCE, Material, Model};
pub use merl::{MERL_DIMENSIONS, MerlTable};
pub use normals::{Weighting, face_normal, sees_light, turn_to, vertex_normals};
pub use outline::{LARGEST_OUTLINE, LightOutline};
pub use quadrature::directional_albedo;
pub use refraction::{Refraction, mirror, refract};
pub use roughness::SMALLEST_ROUGHNESS;
pub use texture::{Wrap, nearest};

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
