//! Options of links by rays.

use crate::error::RadiosityError;

/// How many rays links are found and light is gathered by.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RayOptions {
    /// Side of a square patch that has all [`RayOptions::links`], in the scene's unit; smaller patches have fewer. Default: 0, which stands for 1/64 of the
    /// longest side of the scene.
    pub size: f64,
    /// Links of a large patch, each to the patch that a ray meets; 16 to 65,536. Default: 256.
    pub links: u32,
    /// Longest side, about, down to which patches are divided for drawing where light changes fast, in the scene's unit. Default: infinite, that is, never.
    pub finest: f64,
    /// Aim for the standard error of the irradiance of a vertex, relative to the irradiance there or to a tenth of what a mean part of
    /// the light meets. More rays are taken until it is reached. Default: 0.02: in `book/scenes/guests.toml` the dark room shows no blotches when brightened by
    /// two stops, and does with 0.03.
    pub tolerance: f64,
    /// Most rays of a vertex, about; 128 to 65,536. Default: 2048.
    pub most_rays: u32,
}

impl RayOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self =
        Self { size: 0.0, links: 256, finest: f64::INFINITY, tolerance: 0.02, most_rays: 2048 };

    /// Another size of transport.
    #[must_use]
    pub const fn with_size(mut self, size: f64) -> Self {
        self.size = size;
        self
    }

    /// Another number of links.
    #[must_use]
    pub const fn with_links(mut self, links: u32) -> Self {
        self.links = links;
        self
    }

    /// Patches may become this small for drawing.
    #[must_use]
    pub const fn with_finest(mut self, size: f64) -> Self {
        self.finest = size;
        self
    }

    /// Another aim for the error at vertices.
    #[must_use]
    pub const fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Another limit of rays.
    #[must_use]
    pub const fn with_most_rays(mut self, rays: u32) -> Self {
        self.most_rays = rays;
        self
    }

    pub(crate) fn check(&self) -> Result<(), RadiosityError> {
        let refuse = |name, value, expected| Err(RadiosityError::Option { name, value, expected });
        if !(self.size >= 0.0 && self.size.is_finite()) {
            return refuse("size", self.size, "0 or above");
        }
        if !(16..=1 << 16).contains(&self.links) {
            return refuse("links", f64::from(self.links), "from 16 to 65536");
        }
        if self.finest.is_nan() || self.finest <= 0.0 {
            return refuse("finest", self.finest, "above 0");
        }
        if self.tolerance.is_nan() || self.tolerance <= 0.0 {
            return refuse("tolerance", self.tolerance, "above 0");
        }
        if !(128..=1 << 16).contains(&self.most_rays) {
            return refuse("most_rays", f64::from(self.most_rays), "from 128 to 65536");
        }
        Ok(())
    }
}

impl Default for RayOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
