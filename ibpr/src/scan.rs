//! One range scan, as slices of its caller.

use crate::error::IbprError;
use glam::DVec3;

/// Points that were measured together, in world space.
#[derive(Clone, Copy, Debug)]
pub struct Scan<'a> {
    pub(crate) positions: &'a [DVec3],
    pub(crate) colors: Option<&'a [[f32; 3]]>,
    pub(crate) opacities: Option<&'a [f32]>,
    pub(crate) spacing: Option<f64>,
    pub(crate) towards_scanner: Option<DVec3>,
}

impl<'a> Scan<'a> {
    /// Largest absolute value of a coordinate, a quarter of `f64::MAX`: differences of coordinates, and twice those,
    /// are finite.
    pub const FARTHEST: f64 = 0.25 * f64::MAX;

    /// Largest channel of a color: sums over the 2³² points that a pixel may have are finite in `f32`.
    pub const BRIGHTEST: f32 = 1e28;

    /// Points without color, whose spacing is estimated and whose scanner is unknown.
    #[must_use]
    pub fn new(positions: &'a [DVec3]) -> Self {
        Self { positions, colors: None, opacities: None, spacing: None, towards_scanner: None }
    }

    /// Linear RGB of each point.
    #[must_use]
    pub fn with_colors(mut self, colors: &'a [[f32; 3]]) -> Self {
        self.colors = Some(colors);
        self
    }

    /// Opacity of each point, 0 to 1: counts in translucent frames, times [`Translucency::alpha`](crate::Translucency::alpha).
    #[must_use]
    pub fn with_opacities(mut self, opacities: &'a [f32]) -> Self {
        self.opacities = Some(opacities);
        self
    }

    /// Distance between neighbouring points in world units (the scan resolution).
    #[must_use]
    pub fn with_spacing(mut self, spacing: f64) -> Self {
        self.spacing = Some(spacing);
        self
    }

    /// Direction from the object to the scanner, of any length: points that face away from the eye can then be skipped.
    #[must_use]
    pub fn with_scanner(mut self, towards: DVec3) -> Self {
        self.towards_scanner = Some(towards);
        self
    }

    /// Checks lengths, ranges and finiteness; `scan` is its index in the caller's slice.
    pub(crate) fn check(&self, scan: usize) -> Result<(), IbprError> {
        // Not `max_element`, which ignores NaN.
        let near = |p: &DVec3| p.abs().cmple(DVec3::splat(Self::FARTHEST)).all();
        if let Some(index) = self.positions.iter().position(|p| !near(p)) {
            let (finite, value) = (self.positions[index].is_finite(), self.positions[index].to_array());
            return Err(match finite {
                true => IbprError::PointTooFar { scan, index, value },
                false => IbprError::PointNotFinite { scan, index, value },
            });
        }
        if let Some(colors) = self.colors {
            if colors.len() != self.positions.len() {
                let (colors, points) = (colors.len(), self.positions.len());
                return Err(IbprError::LengthMismatch { scan, colors, points });
            }
            let good = |c: &[f32; 3]| c.iter().all(|v| (0.0..=Self::BRIGHTEST).contains(v));
            if let Some(index) = colors.iter().position(|c| !good(c)) {
                return Err(IbprError::BadColor { scan, index, value: colors[index] });
            }
        }
        if let Some(opacities) = self.opacities {
            if opacities.len() != self.positions.len() {
                let (opacities, points) = (opacities.len(), self.positions.len());
                return Err(IbprError::OpacityCount { scan, opacities, points });
            }
            if let Some(index) = opacities.iter().position(|v| !(0.0..=1.0).contains(v)) {
                return Err(IbprError::BadOpacity { scan, index, value: opacities[index] });
            }
        }
        match self.spacing {
            Some(spacing) if !(spacing > 0.0 && spacing.is_finite()) => {
                return Err(IbprError::BadSpacing { scan, spacing });
            }
            _ => {}
        }
        match self.towards_scanner {
            Some(d) if unit(d).is_none() => Err(IbprError::BadDirection { scan, value: d.to_array() }),
            _ => Ok(()),
        }
    }
}

/// The direction of a vector of any finite length above 0.
pub(crate) fn unit(v: DVec3) -> Option<DVec3> {
    // The squares of 1e200 and 1e-200 overflow and underflow: such vectors are divided by their largest coordinate
    // first.
    let is_normal = (1e-280..=1e280).contains(&v.length_squared());
    if is_normal { v.try_normalize() } else { (v / v.abs().max_element()).try_normalize() }
}
