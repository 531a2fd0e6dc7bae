//! Pictures of scenes by micropoints: geometry, textures, lights and a camera in, a lit picture with layers out; no files.
//!
//! ```
//! use glam::{DVec3, Vec3, dvec3};
//! use pointillist_render::shade::{self, Light};
//! use pointillist_render::{Camera, DrawOptions, LightSource, Material, Part, RenderError, Scene, render};
//!
//! // A white square of 2 by 2 in the plane z = 0, seen from 4 units in front of it.
//! let camera = Camera::perspective(DVec3::Z * 4.0, DVec3::ZERO, std::f64::consts::FRAC_PI_2);
//! let mut scene = Scene::new(camera, [32, 32]);
//! scene.add_material(Material::new("white", shade::Material::lambert(Vec3::ONE)));
//! let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| dvec3(x, y, 0.0));
//! scene.mesh.add(&Part::new("square", &corners, &[[0, 1, 2], [0, 2, 3]]))?;
//!
//! // Light along −Z: an irradiance of π on the square, of which it reflects a radiance of 1.
//! let irradiance = Vec3::splat(std::f32::consts::PI);
//! let sun = Light::Directional { direction: DVec3::NEG_Z, irradiance };
//! scene.lights.push(LightSource::new("sun", sun));
//!
//! let frame = render(&scene, &DrawOptions::DEFAULT, &())?;
//! let pixel = |x: usize, y: usize| frame.color[y * 32 + x];
//! assert!((pixel(16, 16)[0] - 1.0).abs() < 1e-6);
//! assert_eq!(pixel(0, 0), [0.0; 4]);
//!
//! // It is 8 of the picture's 32 pixels wide: what all pixels hold is its area.
//! let covered: f32 = frame.color.iter().map(|c| c[3]).sum();
//! assert!((covered - 64.0).abs() < 1e-4);
//! # Ok::<(), RenderError>(())
//! ```
//!
//! * [`Scene`]: plain data, put together by hand ([`Mesh::add`]) or by a reader of files; [`Scene::check`] says what is wrong with it.
//! * [`render`]: one picture. [`Prepared`]: many pictures of one scene, from other cameras ([`Prepared::draw_view`]), or what a light
//!   probe sees ([`Prepared::capture`], [`look_all`]). [`choose_places`], [`bake_probes`]: where light probes are worth most, and what they hold with light reflected
//!   between surfaces; [`Solids`]: where none should be.
//! * [`Frame`]: colour and depth, and the layers that [`DrawOptions`] asks for (normals, albedo, direct light, …).
//! * [`PartialFrame`]: a picture that is drawn in several goes, or in several processes ([`Prepared::continue_view`]).
//! * [`Monitor`]: progress, cancelling, times and counts; `()` watches nothing, [`Watch`] takes a function and a flag.
//! * [`scene_surfaces`], [`Lamps`]: the scene as `pointillist-radiosity` takes it; [`Lightmap`]: baked light as ambient light.
//! * [`emitter`]: a light as `pointillist-shadow` takes it.
//! * [`fingerprint`]: hashes by which unchanged pictures need not be drawn again.
//!
//! # Conventions
//! Right-handed, +Y up, the camera looks along its −Z. Colours are linear; R G B of a pixel is what is seen
//! of surfaces and of the background, A the share that surfaces cover. Radiance, irradiance and intensity are in any one unit. Positions are `DVec3`; colours and unit normals are `Vec3`. Pixels are row by row from the top left corner.
//!
//! # Accuracy and cost
//! Coverage, texture means and shadows are computed over the exact regions of pixels, not at samples; `pointillist-micropoint` and
//! `pointillist-shadow` say how exactly. Each visible micropoint is shaded once, with the means of its maps, so what varies nonlinearly
//! within one cell (a highlight sharper than that, a normal map under a lamp) is approximated. Memory is that of the scene, its
//! textures as sums (about 7 bytes per channel and texel), the frame, and one tile per thread.
//!
//! Figures are of programs built with `lto = "thin"` and `codegen-units = 1`, which inline the kernels of the crates below; the
//! profile of your own workspace decides.
//!
//! # Features
//! `rayon` (default) uses all cores; it never changes a result. `invariants`: facts that hold for every scene, for property tests and
//! fuzzing.
#![forbid(unsafe_code)]

mod ambient;
mod background;
mod bake;
mod bake_options;
mod capture;
mod casters;
mod choose;
mod close_lights;
mod copies;
mod cryptomatte;
mod curvature;
mod detail;
mod detail_maps;
mod direct;
mod draw;
mod emitters;
mod error;
mod face_look;
pub mod fingerprint;
mod fit_places;
mod frame;
mod gather;
mod gloss;
mod indirect;
#[cfg(feature = "invariants")]
pub mod invariants;
mod joined;
mod lamps;
mod lightmap;
mod lights;
mod lit_parts;
mod look;
mod mapped_light;
mod mirrors;
mod monitor;
mod painter;
mod partial;
mod prepared;
mod radiosity_surfaces;
mod reflections;
mod scene;
mod see_through;
mod seen;
mod set_up;
mod shader;
mod shading;
mod shaft;
mod solids;
mod split_surfaces;
mod surfaces;
mod texel_sums;
mod unbaked;
mod uvs;
mod whole;

pub use ambient::Ambient;
pub use bake::{BakedProbe, ProbeBake, bake_probes, bake_probes_in};
pub use bake_options::BakeOptions;
pub use capture::{Capture, CaptureOptions};
pub use choose::{ChooseOptions, Chosen, choose_places};
pub use cryptomatte::{Matte, cryptomatte_hash, cryptomatte_id};
pub use draw::DrawOptions;
pub use error::RenderError;
pub use frame::{Frame, Layer, LayerKind};
pub use indirect::{IndirectError, IndirectOptions, solve_indirect};
pub use lamps::{Lamps, with_lamps};
pub use lightmap::{BakedLight, BakedSide, Lightmap, LightmapError, baked_sides};
pub use lights::emitter;
pub use look::{LookOptions, Seen, buried, fingerprints, look_again, look_all};
pub use monitor::{Monitor, Watch};
pub use partial::PartialFrame;
pub use pointillist_shadow::check_outline;
pub use prepared::{Prepared, PreparedMaps};
pub use radiosity_surfaces::{SceneSurfaces, scene_surfaces};
pub use scene::{
    AmbientLight, Bump, BumpHeight, Camera, Channel, Details, ImageSettings, Instance, LightSource, Map,
    MapPlace, Material, MeasuredBrdf, Mesh, NONE, Object, Part, RenderSettings, Scene, SceneError, SkyLight,
    Surroundings, Texels, Texture, Transmission, UvSet, linear_from_srgb, normal_matrix, srgb_from_linear,
};
pub use solids::Solids;
pub use unbaked::Unbaked;

pub use glam;
/// Light between diffuse surfaces, what [`Lightmap`] and [`Lamps`] speak of.
pub use pointillist_radiosity as radiosity;
/// Spherical harmonics: what probes hold.
pub use pointillist_sh as sh;
/// Lights, materials, environment maps.
pub use pointillist_shade as shade;
/// Fields of light probes.
pub use pointillist_shprobe as shprobe;

pub use pointillist_micropoint::{Bounds, DepthRange, Geometry, MicropointError, Occlusion};
pub use pointillist_shadow::{Emitter, Resolution, ShadowError};
pub use pointillist_view::{PixelRect, Projection, View, ViewError};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// Draws a scene: colour, depth and the layers that are asked for.
///
/// A pixel's value depends on the scene only: not on the window, on tiles or on the number of threads. For several pictures of one
/// scene, [`Prepared`] does what does not depend on the view only once.
///
/// # Errors
/// [`RenderError`] if the scene cannot be drawn, or the monitor cancels.
pub fn render(scene: &Scene, options: &DrawOptions, monitor: &dyn Monitor) -> Result<Frame, RenderError> {
    Prepared::new(scene, monitor)?.draw(options, monitor)
}
