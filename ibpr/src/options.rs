//! Options of a frame.

use crate::error::IbprError;
use crate::scan::Scan;
use glam::Vec3;
use pointillist_view::{Light, PixelRect};

/// Size of a buffer pixel in picture pixels (the paper's S).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Scale {
    /// From the field of view, the distance and the density of the points, times this factor.
    ///
    /// At factor 1 a buffer pixel holds about one point of the surface that is seen.
    Auto(f32),
    /// As [`Scale::Auto`], for points whose distance in the picture is known: those of a level of detail that was chosen for the view, which are
    /// about as far apart near the eye as far away.
    Spaced {
        /// As for [`Scale::Auto`].
        factor: f32,
        /// Distance of neighbouring points in pixels.
        spacing_px: f32,
    },
    /// Fixed, at least 1.
    Fixed(f32),
}

/// How much a point of the surface nearest to the eye counts; u is its depth behind the nearest point
/// of its pixel in units of γ, 0 ≤ u ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Weighting {
    /// `u`, eq. 2 as printed: the nearest point has (almost) no weight.
    Printed,
    /// `1 − u`: largest for the nearest point, so the mean of a noisy surface moves towards the eye.
    Falling,
    /// 1: the plain mean of the slab.
    Even,
    /// `1 − |z − mean|/γ` about the plain mean of the slab: a third walk over the points.
    Symmetric,
}

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Normals {
    /// Least-squares quadratic surfaces over windows that grow with the noise; planes where a window has too few points
    /// to determine curvature.
    Plane,
    /// The mean of up to eight triangles with consecutive neighbours, as in the paper.
    Triangles,
}

/// Back-face culling: which points are skipped because they face away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Culling {
    /// No culling.
    None,
    /// Scans taken from behind, as in the paper: drops points that can be seen.
    Printed,
    /// Scans that are more than 90° + 75° from the view: a scanner sees incidences up to about 75°.
    Scans,
    /// Blocks of points whose normals all face away.
    Blocks,
}

/// Buffers per frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Passes {
    /// One buffer, at the scale S.
    One,
    /// A finer one with `finer`·S under the normal one, which is drawn over it except where points are
    /// dense or the surface is nearly edge-on.
    Two {
        /// The paper uses 0.66 to 0.83.
        finer: f32,
    },
}

/// How translucent surfaces are kept and blended.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Translucency {
    /// Opacity of each surface, 0 to 1; times that of its points, if they have one ([`Scan::with_opacities`](crate::Scan::with_opacities)).
    pub alpha: f32,
    /// Surfaces kept per pixel, 1 to [`Translucency::MOST_LAYERS`]. The paper keeps 5.
    pub layers: usize,
    /// Depth within which points belong to one surface, in spacings. The paper uses 10.
    pub threshold: f32,
}

impl Translucency {
    /// Most layers per pixel.
    pub const MOST_LAYERS: usize = 8;

    /// Five layers, threshold 10, as in the paper.
    #[must_use]
    pub const fn new(alpha: f32) -> Self {
        Self { alpha, layers: 5, threshold: 10.0 }
    }

    /// Sets the number of surfaces kept per pixel, 1 to [`Translucency::MOST_LAYERS`].
    #[must_use]
    pub const fn with_layers(mut self, layers: usize) -> Self {
        self.layers = layers;
        self
    }

    /// Sets the depth within which points belong to one surface, spacings; above 0.
    #[must_use]
    pub const fn with_threshold(mut self, threshold: f32) -> Self {
        self.threshold = threshold;
        self
    }
}

/// Depth shading that needs no normals: pixels behind their surroundings darken (Boucheny 2009).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct EyeDome {
    /// How dark a step gets; 1 is usual.
    pub strength: f32,
    /// Distance of the eight neighbours that are looked at, 1 to 64 pixels.
    pub radius: u32,
}

impl EyeDome {
    /// Darkens by `strength` (at least 0), against neighbours `radius` pixels away (1 to 64).
    #[must_use]
    pub const fn new(strength: f32, radius: u32) -> Self {
        Self { strength, radius }
    }
}

/// How a frame is drawn. The defaults are what measured best (`studies -- ibpr`).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Size of buffer pixels. Default: [`Scale::Auto`] with [`Options::AUTO_FACTOR`].
    pub scale: Scale,
    /// Thickness of a surface in spacings (or buffer pixels, where those are larger). Default: 2.
    pub gamma: f32,
    /// Default: [`Weighting::Even`].
    pub weighting: Weighting,
    /// Default: [`Normals::Plane`].
    pub normals: Normals,
    /// How far surfaces reach, in buffer pixels; 0 ends them at the outermost means, as printed. Above 0, opaque surfaces of three
    /// pixels and wider end at a smooth outline, which lies right for bodies at 0.3, the default; narrower and translucent ones end so
    /// far beyond their outermost means.
    pub outline: f32,
    /// Levels of pull-push: gaps of less than 2^levels pixels are filled; of
    /// translucent frames only gaps of one pixel, at any level above 0. Default: 2.
    pub fill: u32,
    /// Default: [`Passes::One`].
    pub passes: Passes,
    /// Default: none.
    pub translucency: Option<Translucency>,
    /// Default: [`Culling::Blocks`].
    pub culling: Culling,
    /// Default: [`Light::Eye`].
    pub light: Light,
    /// Ambient share of the light, 0 to 1; the rest is diffuse light from `light`. Default: 0.1.
    pub ambient: f32,
    /// Color of points that have none, linear RGB, each channel from 0 to [`Scan::BRIGHTEST`]. Default: 0.8.
    pub base: Vec3,
    /// Default: none.
    pub eye_dome: Option<EyeDome>,
    /// Whether the frame has normals and counts besides color and depth. Default: false.
    pub surface_layers: bool,
    /// The part of the picture that is wanted; `None`, the default, is all of it. Pixels in it are what they are in the whole picture, bit
    /// for bit; others are undefined. Points are averaged for the whole picture all the same: what fills gaps and how wide normals are
    /// fitted depends on all of them.
    pub window: Option<PixelRect>,
}

impl Default for Options {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Options {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self {
        scale: Scale::Auto(Self::AUTO_FACTOR),
        gamma: 2.0,
        weighting: Weighting::Even,
        normals: Normals::Plane,
        outline: Self::OUTLINE,
        fill: 2,
        passes: Passes::One,
        translucency: None,
        culling: Culling::Blocks,
        light: Light::Eye,
        ambient: 0.1,
        base: Vec3::splat(0.8),
        eye_dome: None,
        surface_layers: false,
        window: None,
    };

    /// Sets the size of buffer pixels.
    #[must_use]
    pub const fn with_scale(mut self, scale: Scale) -> Self {
        self.scale = scale;
        self
    }

    /// Sets the thickness of a surface, spacings; above 0.
    #[must_use]
    pub const fn with_gamma(mut self, gamma: f32) -> Self {
        self.gamma = gamma;
        self
    }

    /// Sets how much each point of a surface counts.
    #[must_use]
    pub const fn with_weighting(mut self, weighting: Weighting) -> Self {
        self.weighting = weighting;
        self
    }

    /// Sets where normals come from.
    #[must_use]
    pub const fn with_normals(mut self, normals: Normals) -> Self {
        self.normals = normals;
        self
    }

    /// Sets how far surfaces reach, buffer pixels; 0 to 1. See [`Options::outline`].
    #[must_use]
    pub const fn with_outline(mut self, outline: f32) -> Self {
        self.outline = outline;
        self
    }

    /// Sets the levels of pull-push, 0 to [`Options::MOST_FILL`].
    #[must_use]
    pub const fn with_fill(mut self, fill: u32) -> Self {
        self.fill = fill;
        self
    }

    /// Sets the number of buffers.
    #[must_use]
    pub const fn with_passes(mut self, passes: Passes) -> Self {
        self.passes = passes;
        self
    }

    /// Sets how surfaces let light through; `None` for opaque ones.
    #[must_use]
    pub const fn with_translucency(mut self, translucency: Option<Translucency>) -> Self {
        self.translucency = translucency;
        self
    }

    /// Sets the rule of back-face culling.
    #[must_use]
    pub const fn with_culling(mut self, culling: Culling) -> Self {
        self.culling = culling;
        self
    }

    /// Sets where light comes from.
    #[must_use]
    pub const fn with_light(mut self, light: Light) -> Self {
        self.light = light;
        self
    }

    /// Sets the ambient share of the light, 0 to 1.
    #[must_use]
    pub const fn with_ambient(mut self, ambient: f32) -> Self {
        self.ambient = ambient;
        self
    }

    /// Sets the color of points that have none, linear RGB.
    #[must_use]
    pub const fn with_base(mut self, base: Vec3) -> Self {
        self.base = base;
        self
    }

    /// Sets the shading by depth; `None` for none.
    #[must_use]
    pub const fn with_eye_dome(mut self, eye_dome: Option<EyeDome>) -> Self {
        self.eye_dome = eye_dome;
        self
    }

    /// Sets whether the frame gets normals and counts.
    #[must_use]
    pub const fn with_surface_layers(mut self, surface_layers: bool) -> Self {
        self.surface_layers = surface_layers;
        self
    }

    /// Sets the part of the picture that is wanted.
    #[must_use]
    pub const fn with_window(mut self, window: PixelRect) -> Self {
        self.window = Some(window);
        self
    }

    /// Factor of [`Scale::Auto`] by default, found by experiment (`studies -- ibpr`).
    pub const AUTO_FACTOR: f32 = 1.2;

    /// Default of [`Options::outline`], found by experiment (`studies -- ibpr`).
    pub const OUTLINE: f32 = 0.3;

    /// Most levels of pull-push.
    pub const MOST_FILL: u32 = 6;

    pub(crate) fn check(&self) -> Result<(), IbprError> {
        let check = |name, value: f32, good: bool, range| {
            if good { Ok(()) } else { Err(IbprError::BadOption { name, value: f64::from(value), range }) }
        };
        let positive = |v: f32| v > 0.0 && v.is_finite();
        match self.scale {
            Scale::Auto(f) => check("scale factor", f, positive(f), "it must be above 0")?,
            Scale::Spaced { factor, spacing_px } => {
                check("scale factor", factor, positive(factor), "it must be above 0")?;
                check("spacing in pixels", spacing_px, positive(spacing_px), "it must be above 0")?;
            }
            Scale::Fixed(s) => check("scale", s, s >= 1.0 && s.is_finite(), "it must be at least 1")?,
        }
        check("gamma", self.gamma, positive(self.gamma), "it must be above 0")?;
        check("outline", self.outline, (0.0..=1.0).contains(&self.outline), "it must be 0 to 1")?;
        check("fill", self.fill as f32, self.fill <= Self::MOST_FILL, "it must be 0 to 6")?;
        check("ambient", self.ambient, (0.0..=1.0).contains(&self.ambient), "it must be 0 to 1")?;
        if let Passes::Two { finer } = self.passes {
            check("finer", finer, finer > 0.0 && finer <= 1.0, "it must be above 0 and at most 1")?;
        }
        if let Some(t) = self.translucency {
            check("alpha", t.alpha, (0.0..=1.0).contains(&t.alpha), "it must be 0 to 1")?;
            let good = (1..=Translucency::MOST_LAYERS).contains(&t.layers);
            check("layers", t.layers as f32, good, "it must be 1 to 8")?;
            check("threshold", t.threshold, positive(t.threshold), "it must be above 0")?;
        }
        if let Some(e) = self.eye_dome {
            check(
                "strength",
                e.strength,
                e.strength >= 0.0 && e.strength.is_finite(),
                "it must be at least 0",
            )?;
            check("radius", e.radius as f32, (1..=64).contains(&e.radius), "it must be 1 to 64")?;
        }
        check_base(self.base)?;
        if let Light::Towards(d) = self.light {
            check("light", d.x as f32, self.light.is_valid(), "the direction must be finite and not zero")?;
        }
        Ok(())
    }
}

/// Refuses a default color with a channel that is negative, NaN or above [`Scan::BRIGHTEST`].
pub(crate) fn check_base(base: Vec3) -> Result<(), IbprError> {
    match base.to_array().into_iter().find(|c| !(0.0..=Scan::BRIGHTEST).contains(c)) {
        Some(c) => {
            Err(IbprError::BadOption { name: "base", value: f64::from(c), range: "it must be 0 to 1e28" })
        }
        None => Ok(()),
    }
}
