//! A camera and its picture: a rigid motion, a projection and a size, validated once, in `f64`.
//!
//! ```
//! use glam::{DVec2, DVec3, dvec2, dvec3};
//! use pointillist_view::{Projection, View, ViewError};
//!
//! // From 10 units in front of the origin, 90° from top to bottom: 20 units there, on 200 pixels.
//! let camera = Projection::Perspective { fov_y_rad: std::f64::consts::FRAC_PI_2 };
//! let view = View::look_at(DVec3::Z * 10.0, DVec3::ZERO, DVec3::Y, camera, 300, 200)?;
//!
//! // One unit to the right and two up is 10 pixels right of the middle (150, 100) and 20 above it.
//! let seen = view.project(dvec3(1.0, 2.0, 0.0)).unwrap();
//! assert!((seen.pixel - dvec2(160.0, 80.0)).length() < 1e-12);
//! assert_eq!(seen.depth, 10.0);
//! assert!((view.unproject(seen.pixel, seen.depth) - dvec3(1.0, 2.0, 0.0)).length() < 1e-14);
//!
//! // The ray of a pixel position passes through everything that is seen there.
//! let ray = view.ray(dvec2(160.0, 80.0));
//! assert!((ray.at(10.0) - dvec3(1.0, 2.0, 0.0)).length() < 1e-14);
//!
//! // What is behind the eye is not in the picture, and a mirrored matrix is no camera.
//! assert_eq!(view.project(DVec3::Z * 11.0), None);
//! let mirror = glam::DAffine3::from_scale(dvec3(-1.0, 1.0, 1.0));
//! assert_eq!(View::from_matrix(mirror, camera, 300, 200), Err(ViewError::Mirrored { determinant: -1.0 }));
//! # Ok::<(), ViewError>(())
//! ```
//!
//! # Conventions
//! * The world is right-handed. The camera looks along its −Z with +Y up, as in OpenGL and glTF.
//! * Pixel positions are continuous: (0, 0) is the top left corner of the picture, x grows to the right and y down, and
//!   the middle of the first pixel is (0.5, 0.5). Pixels are square.
//! * *Depth* is the distance from the eye along the view direction (not along the ray), in world units. It is negative
//!   behind the eye.
//! * A matrix is `view_from_world`: it takes world coordinates into the frame of the camera.
//!
//! # Accuracy and cost
//! All of it is `f64`. Axes are orthonormal within [`View::AXIS_ERROR`] for every accepted input: directions of any
//! length, from the smallest subnormal number to 1e300, and an `up` close to the view direction. Vectors are scaled by
//! powers of two before they are normalised, which rounds nothing, so a scene scaled by a power of two has the same
//! axes bit for bit. [`View::project`] and [`View::unproject`] invert each other within a few ulps of the numbers
//! involved (coordinates of the eye and the point, width of the picture there); the functions of the module
//! `invariants` (feature) state the bounds. They take 4 to 30 nanoseconds each (`benches/camera.rs`) and do not
//! allocate.
//!
//! # Features
//! `invariants`: the module of that name, facts for property tests and fuzzing, also of crates that build on this one.
//!
//! Builds for `wasm32-unknown-unknown`. Everything but the tangent of the field of view is additions, products,
//! quotients and square roots, which are the same to the bit there; [`View::focal_px`] of a perspective view may differ
//! in its last bit. Times are with thin LTO and `codegen-units = 1` in the profile of the dependent program.
#![forbid(unsafe_code)]

mod axes;
mod error;
#[cfg(feature = "invariants")]
pub mod invariants;
mod light;
mod morton;
mod pixel_rect;
mod projection;
mod view;

pub use error::ViewError;
pub use light::Light;
pub use morton::{MORTON_BITS, morton_code};
pub use pixel_rect::PixelRect;
pub use projection::Projection;
pub use view::{Projected, Ray, View};

/// The version of `glam` that this crate's functions take and return.
pub use glam;

/// The README's example, run with those of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
