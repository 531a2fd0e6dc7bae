//! LDR-FLIP: how different two pictures look when one flips between them.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, *FLIP: A Difference
//! Evaluator for Alternating Images*, HPG 2020. Constants and steps are the paper's; every filter in it is separable
//! or a sum of two that are, and is applied so.

use super::lab::{hunt_lab_from_rgb, hyab, rgb_from_ycxcz, ycxcz_from_rgb};
use std::f64::consts::PI;

/// What the paper assumes: 0.7 m from a screen 0.7 m wide with 3840 pixels.
pub const PIXELS_PER_DEGREE: f64 = 0.7 * 3840.0 / 0.7 * PI / 180.0;

/// Exponent of the colour difference (q_c).
const COLOR_EXPONENT: f64 = 0.7;
/// Below this share of the largest difference (p_c)…
const COLOR_KNEE: f64 = 0.4;
/// …lies this share of the scale (p_t).
const COLOR_AT_KNEE: f64 = 0.95;
/// Width of edges and points that are looked for, in degrees (w).
const FEATURE_WIDTH: f64 = 0.082;
/// Exponent of the feature difference (q_f).
const FEATURE_EXPONENT: f64 = 0.5;

/// Contrast sensitivity as sums of Gaussians: `a · √(π/b) · exp(−π² d² / b)` for each `[a, b]`, with d in degrees.
const SENSITIVITY: [&[[f64; 2]]; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];
/// The widest b above, from which the filter's radius follows.
const WIDEST: f64 = 0.04;

/// FLIP at every pixel, 0 to 1, of two rows-of-`width` pictures in linear colours, which are clamped to [0, 1].
pub fn flip_map(a: &[[f32; 3]], b: &[[f32; 3]], width: usize, pixels_per_degree: f64) -> Vec<f32> {
    let opponent = |pixels: &[[f32; 3]]| -> Vec<[f64; 3]> {
        pixels.iter().map(|p| ycxcz_from_rgb(p.map(|c| f64::from(c.clamp(0.0, 1.0))))).collect()
    };
    let (a, b) = (opponent(a), opponent(b));
    let [seen_a, seen_b] = [&a, &b].map(|pixels| perceived(pixels, width, pixels_per_degree));
    let [edges_a, edges_b] = [&a, &b].map(|pixels| features(pixels, width, pixels_per_degree));
    let largest =
        hyab(hunt_lab_from_rgb([0.0, 1.0, 0.0]), hunt_lab_from_rgb([0.0, 0.0, 1.0])).powf(COLOR_EXPONENT);
    (0..a.len())
        .map(|i| {
            let color = spread(hyab(seen_a[i], seen_b[i]).powf(COLOR_EXPONENT), largest);
            let edge = (edges_a[i][0] - edges_b[i][0]).abs();
            let point = (edges_a[i][1] - edges_b[i][1]).abs();
            let feature = (edge.max(point) / 2f64.sqrt()).powf(FEATURE_EXPONENT).clamp(0.0, 1.0);
            color.powf(1.0 - feature) as f32
        })
        .collect()
}

/// Spreads small differences over most of the scale.
fn spread(difference: f64, largest: f64) -> f64 {
    let knee = COLOR_KNEE * largest;
    if difference < knee {
        difference * COLOR_AT_KNEE / knee
    } else {
        COLOR_AT_KNEE + (difference - knee) / (largest - knee) * (1.0 - COLOR_AT_KNEE)
    }
}

/// What the eye makes of a picture at that distance, in the space where differences are measured.
fn perceived(pixels: &[[f64; 3]], width: usize, pixels_per_degree: f64) -> Vec<[f64; 3]> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as isize;
    let mut filtered = vec![[0.0; 3]; pixels.len()];
    for channel in 0..3 {
        let plane: Vec<f64> = pixels.iter().map(|pixel| pixel[channel]).collect();
        let mut total = 0.0;
        for &[a, b] in SENSITIVITY[channel] {
            let gaussian: Vec<f64> = (-radius..=radius)
                .map(|x| (-PI * PI * (x as f64 / pixels_per_degree).powi(2) / b).exp())
                .collect();
            let weight = a * (PI / b).sqrt();
            total += weight * gaussian.iter().sum::<f64>().powi(2);
            let blurred = separable(&plane, width, &gaussian, &gaussian);
            filtered.iter_mut().zip(blurred).for_each(|(pixel, value)| pixel[channel] += weight * value);
        }
        filtered.iter_mut().for_each(|pixel| pixel[channel] /= total);
    }
    let seen = |pixel: [f64; 3]| hunt_lab_from_rgb(rgb_from_ycxcz(pixel).map(|c| c.clamp(0.0, 1.0)));
    filtered.into_iter().map(seen).collect()
}

/// Strength of edges and of points at every pixel.
fn features(pixels: &[[f64; 3]], width: usize, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as isize;
    let kernel = |f: &dyn Fn(f64) -> f64| -> Vec<f64> { (-radius..=radius).map(|x| f(x as f64)).collect() };
    let bell = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let gaussian = kernel(&bell);
    let first = kernel(&|x| -x * bell(x));
    let second = kernel(&|x| (x * x / (deviation * deviation) - 1.0) * bell(x));
    let across = scaled(&gaussian);
    let luminance: Vec<f64> = pixels.iter().map(|pixel| (pixel[0] + 16.0) / 116.0).collect();
    let gradient = |kernel: &[f64]| -> Vec<f64> {
        let kernel = scaled(kernel);
        let x = separable(&luminance, width, &kernel, &across);
        let y = separable(&luminance, width, &across, &kernel);
        x.into_iter().zip(y).map(|(x, y)| x.hypot(y)).collect()
    };
    gradient(&first).into_iter().zip(gradient(&second)).map(|(edge, point)| [edge, point]).collect()
}

/// The kernel with its positive part scaled to sum to 1 and its negative part to −1.
fn scaled(kernel: &[f64]) -> Vec<f64> {
    let positive: f64 = kernel.iter().filter(|&&k| k > 0.0).sum();
    let negative: f64 = -kernel.iter().filter(|&&k| k < 0.0).sum::<f64>();
    kernel
        .iter()
        .map(|&k| {
            if k > 0.0 {
                k / positive
            } else if k < 0.0 {
                k / negative
            } else {
                0.0
            }
        })
        .collect()
}

/// A plane filtered along rows, then along columns; beyond the border its values go on.
fn separable(plane: &[f64], width: usize, along_x: &[f64], along_y: &[f64]) -> Vec<f64> {
    let height = plane.len() / width;
    let tap = |at: usize, offset: usize, radius: usize, size: usize| {
        (at + offset).saturating_sub(radius).min(size - 1)
    };
    let radius = along_x.len() / 2;
    let mut rows = vec![0.0; plane.len()];
    for (row, out) in plane.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        for (x, value) in out.iter_mut().enumerate() {
            *value =
                along_x.iter().enumerate().map(|(k, weight)| weight * row[tap(x, k, radius, width)]).sum();
        }
    }
    let radius = along_y.len() / 2;
    let mut result = vec![0.0; plane.len()];
    for (y, out) in result.chunks_exact_mut(width).enumerate() {
        for (k, weight) in along_y.iter().enumerate() {
            let from = tap(y, k, radius, height) * width;
            out.iter_mut().zip(&rows[from..from + width]).for_each(|(value, row)| *value += weight * row);
        }
    }
    result
}
