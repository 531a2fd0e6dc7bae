//! How far a frame is from the surface that its points were measured on.

use crate::common::contour::Contour;
use crate::common::layers::Layers;
use crate::common::true_surface::Truth;

/// Pixels from an outline or a depth step that do not count as interior.
pub(crate) const EDGE: usize = 2;

/// Neighbouring pixels whose depths differ by more spacings have a step between them.
const STEP: f64 = 5.0;

/// Distances in spacings, angles in degrees, shares in percent.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FrameError {
    pub(crate) normal_mean: f64,
    pub(crate) normal_median: f64,
    /// Away from depth steps, where half a pixel decides between two surfaces.
    pub(crate) depth_rmse: f64,
    /// The same with the pixels at steps.
    pub(crate) depth_rmse_all: f64,
    /// Median of depth − true depth.
    pub(crate) bias: f64,
    pub(crate) depth_p95: f64,
    /// Interior pixels without a surface.
    pub(crate) holes: f64,
    /// dB, sRGB, over the box of the surface and 8 pixels around.
    pub(crate) psnr: f64,
    /// Pixels more than [`EDGE`] outside the outline, per pixel of the surface.
    pub(crate) spill: f64,
    /// Distance between the outline that is drawn, where coverage is 1/2, and the true one: root mean square, in pixels.
    pub(crate) outline: f64,
}

/// A truth with the masks that errors are measured in.
pub(crate) struct Measure {
    truth: Truth,
    spacing: f64,
    interior: Vec<bool>,
    smooth: Vec<bool>,
    outside: Vec<bool>,
    contour: Contour,
    surface_pixels: usize,
    /// Columns and rows of the box of the picture in which colours are compared.
    columns: std::ops::Range<usize>,
    rows: std::ops::Range<usize>,
}

impl Measure {
    pub(crate) fn new(truth: Truth, spacing: f64) -> Self {
        let size = truth.size;
        let valid: Vec<bool> = truth.depth.iter().map(|d| *d < f64::INFINITY).collect();
        let empty: Vec<bool> = valid.iter().map(|v| !v).collect();
        let interior = grown(&empty, size, EDGE).iter().map(|v| !v).collect();
        let outside = grown(&valid, size, EDGE).iter().map(|v| !v).collect();
        let step: Vec<bool> = (0..valid.len()).map(|i| is_step(&truth, i, spacing)).collect();
        let near_step = grown(&step, size, EDGE);
        let smooth = near_step.iter().map(|v| !v).collect();
        let places = |coordinate: &dyn Fn(usize) -> usize| {
            const MARGIN: usize = 8;
            let used = (0..valid.len()).filter(|i| valid[*i]).map(coordinate);
            let (low, high) = used.fold((size, 0), |(l, h), v| (l.min(v), h.max(v)));
            low.saturating_sub(MARGIN)..(high + MARGIN + 1).min(size)
        };
        let (columns, rows) = (places(&|i| i % size), places(&|i| i / size));
        let surface_pixels = valid.iter().filter(|v| **v).count();
        let contour = Contour::new(&truth.coverage, size);
        Self { truth, spacing, interior, smooth, outside, contour, surface_pixels, columns, rows }
    }

    pub(crate) fn truth(&self) -> &Truth {
        &self.truth
    }

    pub(crate) fn interior_pixels(&self) -> usize {
        self.interior.iter().filter(|v| **v).count()
    }

    /// Percent of the interior for which `fact` holds.
    pub(crate) fn interior_share(&self, fact: impl Fn(usize) -> bool) -> f64 {
        let count = (0..self.interior.len()).filter(|i| self.interior[*i] && fact(*i)).count();
        100.0 * count as f64 / self.interior_pixels().max(1) as f64
    }

    pub(crate) fn of(&self, frame: &Layers) -> FrameError {
        let drawn = |i: usize| frame.depth[i] < f32::INFINITY;
        let interior: Vec<usize> =
            (0..frame.depth.len()).filter(|i| self.interior[*i] && drawn(*i)).collect();
        let depth = |&i: &usize| (f64::from(frame.depth[i]) - self.truth.depth[i]) / self.spacing;
        let angle = |&i: &usize| {
            let n = glam::Vec3::from_array(frame.normal[i]).as_dvec3().normalize_or_zero();
            n.dot(self.truth.normal[i]).clamp(-1.0, 1.0).acos().to_degrees()
        };
        let mut angles: Vec<f64> = interior.iter().map(angle).collect();
        let mut depths: Vec<f64> = interior.iter().map(depth).collect();
        let rmse = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt();
        let smooth: Vec<f64> = interior.iter().filter(|i| self.smooth[**i]).map(depth).collect();
        let mut distances: Vec<f64> = depths.iter().map(|d| d.abs()).collect();
        let spilt = (0..frame.depth.len()).filter(|i| self.outside[*i] && drawn(*i)).count();
        FrameError {
            normal_mean: angles.iter().sum::<f64>() / angles.len() as f64,
            normal_median: quantile(&mut angles, 0.5),
            depth_rmse: rmse(&smooth),
            depth_rmse_all: rmse(&depths),
            bias: quantile(&mut depths, 0.5),
            depth_p95: quantile(&mut distances, 0.95),
            holes: self.interior_share(|i| !drawn(i)),
            psnr: self.psnr(frame),
            spill: 100.0 * spilt as f64 / self.surface_pixels as f64,
            outline: self.outline(frame),
        }
    }

    fn outline(&self, frame: &Layers) -> f64 {
        let coverage: Vec<f64> = frame.color.iter().map(|c| f64::from(c[3])).collect();
        Contour::new(&coverage, self.truth.size).rms_distance(&self.contour)
    }

    fn psnr(&self, frame: &Layers) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (row, column) in self.rows.clone().flat_map(|r| self.columns.clone().map(move |c| (r, c))) {
            let i = row * self.truth.size + column;
            let wanted = srgb(self.truth.grey[i]);
            for c in &frame.color[i][..3] {
                sum += (srgb(f64::from(*c)) - wanted).powi(2);
                count += 1.0;
            }
        }
        -10.0 * (sum / count).log10()
    }
}

pub(crate) fn srgb(linear: f64) -> f64 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

pub(crate) fn quantile(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let place = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(place, f64::total_cmp).1
}

/// Whether the surface jumps between a pixel and the one to the right or below.
fn is_step(truth: &Truth, i: usize, spacing: f64) -> bool {
    let next = |offset: usize| truth.depth.get(i + offset).copied().unwrap_or(f64::INFINITY);
    [next(1), next(truth.size)].into_iter().any(|d| (d - truth.depth[i]).abs() > STEP * spacing)
}

/// A mask with the pixels that are at most `steps` steps to the side, up or down away.
pub(crate) fn grown(mask: &[bool], size: usize, steps: usize) -> Vec<bool> {
    let mut mask = mask.to_vec();
    for _ in 0..steps {
        let before = mask.clone();
        let at = |i: Option<usize>| i.is_some_and(|i| before.get(i) == Some(&true));
        for (i, grown) in mask.iter_mut().enumerate() {
            let column = i % size;
            *grown |= column > 0 && at(i.checked_sub(1));
            *grown |= column + 1 < size && at(Some(i + 1));
            *grown |= at(i.checked_sub(size)) || at(Some(i + size));
        }
    }
    mask
}
