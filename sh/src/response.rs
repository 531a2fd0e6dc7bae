//! Inverse response of a camera: from the levels of a photograph to radiance.

use crate::ShError;
use crate::panorama::solid_angle;
use crate::{Clipping, Panorama};

/// How a camera or encoder turns radiance into the 256 levels of a photograph; here to be inverted.
///
/// Radiance is relative: the highest level stands for 1 at exposure 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// The radiance that each level stands for, rising from level to level.
    radiance: [f32; 256],
}

impl Response {
    /// Levels proportional to radiance.
    #[must_use]
    pub fn linear() -> Self {
        Self::of_level(|v| v)
    }

    /// The curve of sRGB (IEC 61966-2-1).
    #[must_use]
    pub fn srgb() -> Self {
        Self::of_level(|v| if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) })
    }

    /// Levels that are radiance to the power 1/`gamma`.
    ///
    /// # Errors
    /// `Gamma` unless it is above 0 and at most 16.
    pub fn gamma(gamma: f64) -> Result<Self, ShError> {
        if gamma > 0.0 && gamma <= 16.0 {
            Ok(Self::of_level(|v| v.powf(gamma)))
        } else {
            Err(ShError::Gamma { gamma })
        }
    }

    /// A camera's measured curve, brightness (0 to 1) at radiances evenly from 0 to 1, such as those of the Columbia
    /// database of response functions: inverted with straight lines between the samples.
    ///
    /// # Errors
    /// `ResponseCurve` if there are less than 2 samples, or one is not finite or not above the one before it.
    pub fn from_curve(brightness: &[f32]) -> Result<Self, ShError> {
        let last = check_rising(brightness)?;
        let first = f64::from(brightness[0]);
        let range = f64::from(brightness[last]) - first;
        Ok(Self::of_level(|v| {
            let wanted = first + v * range;
            let i = brightness.partition_point(|&b| f64::from(b) < wanted).clamp(1, last);
            let (below, above) = (f64::from(brightness[i - 1]), f64::from(brightness[i]));
            (i as f64 - 1.0 + ((wanted - below) / (above - below)).min(1.0)) / last as f64
        }))
    }

    /// The radiance of each of the 256 levels, as calibration from several exposures gives it.
    ///
    /// # Errors
    /// `ResponseCurve` if there are not 256, or one is not finite or not above the one before it.
    pub fn from_levels(radiance: &[f32]) -> Result<Self, ShError> {
        check_rising(radiance)?;
        let radiance =
            radiance.try_into().map_err(|_| ShError::ResponseCurve { index: radiance.len().min(256) })?;
        Ok(Self { radiance })
    }

    fn of_level(radiance: impl Fn(f64) -> f64) -> Self {
        Self { radiance: std::array::from_fn(|level| radiance(level as f64 / 255.0) as f32) }
    }

    /// The radiance of a level, times 2^`exposure_ev`: stops by which the photograph was exposed too little.
    #[must_use]
    pub fn radiance(&self, level: u8, exposure_ev: f32) -> f32 {
        self.radiance[usize::from(level)] * exposure_ev.exp2()
    }

    /// The radiance of all pixels, and which share of them is clipped.
    ///
    /// # Errors
    /// `Exposure` unless it is from −64 to 64.
    pub fn linearise(
        &self,
        pixels: &[[u8; 3]],
        exposure_ev: f32,
    ) -> Result<(Vec<[f32; 3]>, Clipping), ShError> {
        if !(-64.0..=64.0).contains(&exposure_ev) {
            return Err(ShError::Exposure { exposure_ev });
        }
        let table = self.radiance.map(|radiance| radiance * exposure_ev.exp2());
        let mut clipping = Clipping::default();
        let share = 1.0 / pixels.len().max(1) as f64;
        pixels.iter().for_each(|&pixel| clipping.add(pixel, share));
        Ok((pixels.iter().map(|pixel| pixel.map(|level| table[usize::from(level)])).collect(), clipping))
    }
}

/// The last index of numbers that rise.
fn check_rising(values: &[f32]) -> Result<usize, ShError> {
    let is_wrong = |i: &usize| !values[*i].is_finite() || (*i > 0 && values[*i] <= values[*i - 1]);
    match (0..values.len()).find(is_wrong) {
        Some(index) => Err(ShError::ResponseCurve { index }),
        None if values.len() < 2 => Err(ShError::ResponseCurve { index: values.len() }),
        None => Ok(values.len() - 1),
    }
}

impl Panorama {
    /// From a photograph of 8-bit levels: radiance after `response` and exposure (see [`Response::radiance`]), and
    /// which share of the sphere is clipped.
    ///
    /// # Errors
    /// `PanoramaSize`, `Exposure`; `PixelNotFinite` if a calibrated radiance is too large with that exposure.
    pub fn from_photograph(
        width: usize,
        height: usize,
        pixels: &[[u8; 3]],
        response: &Response,
        exposure_ev: f32,
    ) -> Result<(Self, Clipping), ShError> {
        let panorama = Self::new(width, height, &response.linearise(pixels, exposure_ev)?.0)?;
        let mut clipping = Clipping::default();
        for (y, row) in pixels.chunks_exact(width).enumerate() {
            let share = solid_angle(width, height, y) / (4.0 * std::f64::consts::PI);
            row.iter().for_each(|&pixel| clipping.add(pixel, share));
        }
        Ok((panorama, clipping))
    }
}
