//! Options of [`bake_probes`](crate::bake_probes).

use pointillist_micropoint::DepthRange;

/// How [`bake_probes`](crate::bake_probes) looks around.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BakeOptions {
    /// Pixels on a side of each of the six pictures of what lights send to surfaces. Default: 128. Light that bounced is seen with half of
    /// them; what bounces further, and what is seen at the places of `fit`, with 32 at most; all with all if `thorough` is set.
    pub resolution: u32,
    /// Highest band of the harmonics. Default: 2.
    pub order: usize,
    /// Texels on a side of each probe's map of distances, which keeps light from passing through walls; 0 for none. Default: 16.
    pub distances: usize,
    /// Bounces of light between surfaces at most. Default: 1.
    pub bounces: u32,
    /// A bounce that changes the mean light by less than this fraction is the last. Default: 0.005.
    pub until: f64,
    /// Further places, at random in the probes' box: the probes then hold the light with which interpolation fits all places best in
    /// the least-squares sense, not what each sees itself. Default: 0, no fit.
    pub fit: usize,
    /// Whether probes hold what surfaces send out by themselves. Default: they do not; such light still bounces.
    pub emission: bool,
    /// Whether every shadow and texel within a pixel is computed, and all captures have all pixels. Default: as finely as the sum over
    /// a capture needs, with half of the pixels on a side for bounced light, and at most 32 before the last bounce.
    pub thorough: bool,
    /// Whether harmonics are damped where irradiance would be negative. Default: they are not.
    pub dering: bool,
    /// Whether probes that see mostly backs of surfaces count like others. Default: they are left out of the light.
    pub keep_buried: bool,
    /// Surfaces outside of these distances are not seen ([`CaptureOptions::depths`](crate::CaptureOptions::depths)). Default: all are.
    pub depths: DepthRange,
}

impl BakeOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self {
        resolution: 128,
        order: 2,
        distances: 16,
        bounces: 1,
        until: 0.005,
        fit: 0,
        emission: false,
        thorough: false,
        dering: false,
        keep_buried: false,
        depths: DepthRange::ALL,
    };

    /// Takes pictures of this many pixels on a side.
    #[must_use]
    pub const fn with_resolution(mut self, resolution: u32) -> Self {
        self.resolution = resolution;
        self
    }

    /// Keeps bands up to this one.
    #[must_use]
    pub const fn with_order(mut self, order: usize) -> Self {
        self.order = order;
        self
    }

    /// Makes maps of distances of this many texels on a side, or none.
    #[must_use]
    pub const fn with_distances(mut self, distances: usize) -> Self {
        self.distances = distances;
        self
    }

    /// Follows light for at most this many bounces.
    #[must_use]
    pub const fn with_bounces(mut self, bounces: u32) -> Self {
        self.bounces = bounces;
        self
    }

    /// Ends when a bounce changes the mean light by less than this fraction.
    #[must_use]
    pub const fn with_until(mut self, until: f64) -> Self {
        self.until = until;
        self
    }

    /// Fits the probes' light to so many further places.
    #[must_use]
    pub const fn with_fit(mut self, fit: usize) -> Self {
        self.fit = fit;
        self
    }

    /// Lets probes hold what surfaces emit, or not.
    #[must_use]
    pub const fn with_emission(mut self, emission: bool) -> Self {
        self.emission = emission;
        self
    }

    /// Computes every shadow and texel within a pixel, or not.
    #[must_use]
    pub const fn with_thorough(mut self, thorough: bool) -> Self {
        self.thorough = thorough;
        self
    }

    /// Damps harmonics where irradiance would be negative, or not.
    #[must_use]
    pub const fn with_dering(mut self, dering: bool) -> Self {
        self.dering = dering;
        self
    }

    /// Keeps probes that see mostly backs of surfaces, or leaves them out.
    #[must_use]
    pub const fn with_keep_buried(mut self, keep_buried: bool) -> Self {
        self.keep_buried = keep_buried;
        self
    }

    /// Sees only surfaces at these distances.
    #[must_use]
    pub const fn with_depths(mut self, depths: DepthRange) -> Self {
        self.depths = depths;
        self
    }
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}
