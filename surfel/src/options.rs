//! Options of a frame.

use crate::error::SurfelError;
use crate::focus::Focus;
use crate::points::Points;
use glam::Vec3;
use pointillist_view::{Light, PixelRect};

/// How discs become a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Procedure {
    /// Layers of depth, in each the weighted mean of all discs, shaded once per pixel.
    #[default]
    Blended,
    /// The paper's: a z-buffer of discs, links in the pixels of their centres, a Gaussian filter over holes.
    Paper,
}

/// How a frame is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Options {
    /// Default: [`Focus::Everywhere`].
    pub focus: Focus,
    /// Default: [`Procedure::Blended`].
    pub procedure: Procedure,
    /// Level of detail: points are taken from the coarsest level on which they are at most this many pixels apart, up
    /// to √2 times as far where the surface is seen at an angle; 0 always takes all points. Default: 1.27, found by
    /// experiment: a small object then costs a twentieth of a large one, and about one point falls on a pixel.
    pub level: f32,
    /// Whether nodes that face away or are hidden are skipped, which never changes the picture. Default: true.
    pub culling: bool,
    /// Default: [`Light::Eye`].
    pub light: Light,
    /// Ambient share of the light, 0 to 1; the rest is diffuse light from `light`. Default: 0.1.
    pub ambient: f32,
    /// Color of points that have none, linear RGB. Default: 0.8.
    pub base: Vec3,
    /// Whether the frame gets normals besides color and depth. Default: false.
    pub surface_layers: bool,
    /// The part of the picture that is wanted; `None`, the default, is all of it. Pixels in it are what they are in the whole picture, bit
    /// for bit; others are undefined. [`Procedure::Blended`] draws only tiles that meet it, [`Procedure::Paper`] everything.
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
        focus: Focus::Everywhere,
        procedure: Procedure::Blended,
        level: 1.27,
        culling: true,
        light: Light::Eye,
        ambient: 0.1,
        base: Vec3::splat(0.8),
        surface_layers: false,
        window: None,
    };

    /// Sets the depth of field.
    #[must_use]
    pub const fn with_focus(mut self, focus: Focus) -> Self {
        self.focus = focus;
        self
    }

    /// Sets how discs become a picture.
    #[must_use]
    pub const fn with_procedure(mut self, procedure: Procedure) -> Self {
        self.procedure = procedure;
        self
    }

    /// Sets the distance of points on the picture, pixels; at least 0.
    #[must_use]
    pub const fn with_level(mut self, level: f32) -> Self {
        self.level = level;
        self
    }

    /// Sets whether nodes that face away or are hidden are skipped.
    #[must_use]
    pub const fn with_culling(mut self, culling: bool) -> Self {
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

    /// Sets whether the frame gets normals.
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

    pub(crate) fn check(&self) -> Result<(), SurfelError> {
        let check = |name, value: f32, good: bool, range| {
            if good { Ok(()) } else { Err(SurfelError::BadOption { name, value: f64::from(value), range }) }
        };
        self.focus.check()?;
        check("level", self.level, self.level >= 0.0 && self.level.is_finite(), "it must be at least 0")?;
        check("ambient", self.ambient, (0.0..=1.0).contains(&self.ambient), "it must be 0 to 1")?;
        for c in self.base.to_array() {
            check("base", c, (0.0..=Points::BRIGHTEST).contains(&c), "it must be 0 to 1e30")?;
        }
        if let Light::Towards(d) = self.light {
            check("light", d.x as f32, self.light.is_valid(), "the direction must be finite and not zero")?;
        }
        Ok(())
    }
}
