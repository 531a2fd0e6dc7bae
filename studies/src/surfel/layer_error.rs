//! How far a picture with its layers is from a reference, by the definitions of the points' checks: sRGB over the box of
//! the surface and 8 pixels around; depth, normals and holes over the interior.

use std::ops::Range;

use glam::Vec3;

use crate::common::frame_error::{EDGE, grown, quantile, srgb};
use crate::common::picture_layers::PictureLayers;
use crate::common::similarity::mean_similarity;

/// Pixels around the surface in which colours are compared.
const MARGIN: usize = 8;

/// Distances in world units, angles in degrees, shares in percent.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LayerError {
    /// dB.
    pub(crate) psnr: f64,
    /// Structural similarity, 1 where nothing differs.
    pub(crate) ssim: f64,
    /// Largest difference of a displayed channel, of 1.
    pub(crate) largest: f64,
    /// Interior pixels without a surface.
    pub(crate) holes: f64,
    /// Pixels more than [`EDGE`] outside the outline, per pixel of the surface.
    pub(crate) spill: f64,
    pub(crate) depth_rmse: f64,
    /// Median of depth − true depth.
    pub(crate) depth_bias: f64,
    pub(crate) normal_mean: f64,
    pub(crate) normal_median: f64,
}

/// A reference with the masks that errors are measured in.
pub(crate) struct LayerMeasure {
    truth: PictureLayers,
    interior: Vec<usize>,
    outside: Vec<usize>,
    surface_pixels: usize,
    columns: Range<usize>,
    rows: Range<usize>,
}

impl LayerMeasure {
    pub(crate) fn new(truth: PictureLayers) -> Self {
        let (width, height) = (truth.width, truth.height);
        let valid: Vec<bool> = (0..width * height).map(|i| truth.is_valid(i)).collect();
        let empty: Vec<bool> = valid.iter().map(|v| !v).collect();
        let not = |mask: Vec<bool>| (0..mask.len()).filter(|i| !mask[*i]).collect();
        let surface = || (0..valid.len()).filter(|i| valid[*i]);
        let range = |places: &mut dyn Iterator<Item = usize>, size: usize| {
            let (low, high) = places.fold((size, 0), |(l, h), v| (l.min(v), h.max(v)));
            low.saturating_sub(MARGIN)..(high + MARGIN + 1).min(size)
        };
        Self {
            interior: not(grown(&empty, width, EDGE)),
            outside: not(grown(&valid, width, EDGE)),
            surface_pixels: surface().count(),
            columns: range(&mut surface().map(|i| i % width), width),
            rows: range(&mut surface().map(|i| i / width), height),
            truth,
        }
    }

    /// Whether a picture is the reference, byte by byte.
    pub(crate) fn is(&self, shown: &PictureLayers) -> bool {
        let bits = |p: &PictureLayers| {
            let pixel = |i: usize| {
                (p.colour[i].map(f32::to_bits), p.depth[i].to_bits(), p.normal[i].map(f32::to_bits))
            };
            (0..p.depth.len()).map(pixel).collect::<Vec<_>>()
        };
        bits(&self.truth) == bits(shown)
    }

    /// # Panics
    /// Pictures of different sizes.
    pub(crate) fn of(&self, shown: &PictureLayers) -> LayerError {
        let size = (self.truth.width, self.truth.height);
        assert_eq!((shown.width, shown.height), size, "pictures of one size are compared");
        let both: Vec<usize> = self.interior.iter().copied().filter(|i| shown.is_valid(*i)).collect();
        let percent = |count: usize, of: usize| 100.0 * count as f64 / of.max(1) as f64;
        let spilt = self.outside.iter().filter(|i| shown.is_valid(**i)).count();
        let mut depths: Vec<f64> =
            both.iter().map(|&i| f64::from(shown.depth[i]) - f64::from(self.truth.depth[i])).collect();
        let mut angles: Vec<f64> = both.iter().filter_map(|&i| self.angle_deg(shown, i)).collect();
        let mean = |sum: f64, values: &[f64]| sum / values.len() as f64;
        let (psnr, ssim, largest) = self.colours(shown);
        LayerError {
            psnr,
            ssim,
            largest,
            holes: percent(self.interior.len() - both.len(), self.interior.len()),
            spill: percent(spilt, self.surface_pixels),
            depth_rmse: mean(depths.iter().map(|d| d * d).sum(), &depths).sqrt(),
            depth_bias: quantile(&mut depths, 0.5),
            normal_mean: mean(angles.iter().sum(), &angles),
            normal_median: quantile(&mut angles, 0.5),
        }
    }

    /// `None` where no normal is shown.
    fn angle_deg(&self, shown: &PictureLayers, i: usize) -> Option<f64> {
        let [wanted, n] = [&self.truth, shown].map(|p| Vec3::from_array(p.normal[i]).as_dvec3());
        let n = n.try_normalize()?;
        Some(n.dot(wanted).clamp(-1.0, 1.0).acos().to_degrees())
    }

    /// PSNR, mean structural similarity and the largest difference.
    fn colours(&self, shown: &PictureLayers) -> (f64, f64, f64) {
        let (mut squares, mut similarity, mut largest) = (0.0, 0.0, 0.0f64);
        for channel in 0..3 {
            let [wanted, found] = [&self.truth, shown].map(|p| self.plane(p, channel));
            for (a, b) in wanted.iter().zip(&found) {
                (squares, largest) = (squares + (a - b).powi(2), largest.max((a - b).abs()));
            }
            similarity += mean_similarity(&wanted, &found, self.columns.len()) / 3.0;
        }
        let mean = squares / (3 * self.columns.len() * self.rows.len()) as f64;
        (-10.0 * mean.log10(), similarity, largest)
    }

    /// A channel as it is displayed, in the box of the surface.
    fn plane(&self, picture: &PictureLayers, channel: usize) -> Vec<f64> {
        let row = |r: usize| self.columns.clone().map(move |c| r * self.truth.width + c);
        let places = self.rows.clone().flat_map(row);
        places.map(|i| srgb(f64::from(picture.colour[i][channel]))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of 20 pixels in the middle of 40 × 40, with a gradient.
    fn square() -> PictureLayers {
        let inside = |i: usize| (10..30).contains(&(i % 40)) && (10..30).contains(&(i / 40));
        let pick = |i: usize, yes: f32, no: f32| if inside(i) { yes } else { no };
        let grey = |i: usize| pick(i, (i % 40) as f32 / 40.0, 0.0);
        PictureLayers {
            width: 40,
            height: 40,
            colour: (0..1600).map(|i| [grey(i), grey(i), grey(i), pick(i, 1.0, 0.0)]).collect(),
            depth: (0..1600).map(|i| pick(i, 2.0, f32::INFINITY)).collect(),
            normal: (0..1600).map(|i| [0.0, 0.0, pick(i, 1.0, 0.0)]).collect(),
        }
    }

    #[test]
    fn the_reference_has_no_error() {
        let error = LayerMeasure::new(square()).of(&square());
        assert_eq!((error.holes, error.spill, error.depth_rmse, error.normal_mean), (0.0, 0.0, 0.0, 0.0));
        assert_eq!((error.psnr, error.largest), (f64::INFINITY, 0.0));
        assert!((error.ssim - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_hole_and_a_step_are_counted() {
        let mut shown = square();
        shown.depth.iter_mut().for_each(|d| *d += 0.5);
        shown.depth[20 * 40 + 20] = f32::INFINITY;
        shown.depth[0] = 1.0;
        let error = LayerMeasure::new(square()).of(&shown);
        // Two pixels off the edges leave 16 × 16.
        assert!((error.holes - 100.0 / 256.0).abs() < 1e-12);
        assert!((error.spill - 100.0 / 400.0).abs() < 1e-12);
        assert_eq!((error.depth_rmse, error.depth_bias), (0.5, 0.5));
    }
}
