//! Metrics of the difference of two pictures.

mod flip;
mod flip_colors;
mod lab;
mod page;
mod worst;

pub use flip::{PIXELS_PER_DEGREE, flip_map};
pub use page::Page;

use crate::image_io::Picture;
use serde::Serialize;

/// Differences of two pictures of the same size, over linear red, green and blue.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Differences {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Root of the mean square.
    pub rmse: f64,
    /// Mean of the absolute difference.
    pub mae: f64,
    /// Mean of the difference, A − B.
    pub bias: f64,
    /// Largest absolute difference of any channel.
    pub max: f64,
    /// Column and row where it is.
    pub max_pixel: [u32; 2],
    /// 20·log10(1 / rmse), in decibels; `null` if the pictures are equal.
    pub psnr: Option<f64>,
    /// Mean LDR-FLIP, 0 to 1.
    pub flip: f64,
    /// Numbers that are not finite, in either picture; they count as 0.
    pub nonfinite: u64,
}

/// Two pictures of the same size, compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The numbers.
    pub differences: Differences,
    /// FLIP at every pixel, 0 to 1.
    pub flip: Vec<f32>,
}

/// Compares two pictures of the same size.
///
/// # Panics
///
/// The sizes differ.
pub fn compare(a: &Picture, b: &Picture) -> Comparison {
    assert_eq!(a.size, b.size, "the caller compares sizes first");
    let [width, height] = a.size;
    let mut nonfinite = 0;
    let mut clean = |n: f32| {
        if n.is_finite() {
            n
        } else {
            nonfinite += 1;
            0.0
        }
    };
    let mut rgb = |picture: &Picture| -> Vec<[f32; 3]> {
        picture.color.iter().map(|&[r, g, b, _]| [r, g, b].map(&mut clean)).collect()
    };
    let (a, b) = (rgb(a), rgb(b));
    let (mut squares, mut sizes, mut sum) = (0.0, 0.0, 0.0);
    let (mut max, mut worst) = (0.0, 0);
    for (index, (a, b)) in a.iter().zip(&b).enumerate() {
        for (&a, &b) in a.iter().zip(b) {
            let difference = f64::from(a) - f64::from(b);
            squares += difference * difference;
            sizes += difference.abs();
            sum += difference;
            if difference.abs() > max {
                (max, worst) = (difference.abs(), index);
            }
        }
    }
    let n = (3 * a.len()) as f64;
    let rmse = (squares / n).sqrt();
    let map = flip_map(&a, &b, width as usize, PIXELS_PER_DEGREE);
    let flip = map.iter().map(|&e| f64::from(e)).sum::<f64>() / map.len() as f64;
    let differences = Differences {
        width,
        height,
        rmse,
        mae: sizes / n,
        bias: sum / n,
        max,
        max_pixel: [(worst % width as usize) as u32, (worst / width as usize) as u32],
        psnr: (rmse > 0.0).then(|| -20.0 * rmse.log10()),
        flip,
        nonfinite,
    };
    Comparison { differences, flip: map }
}

/// The absolute difference as RGB bytes, brightened so that the largest is white.
pub fn difference_bytes(a: &Picture, b: &Picture) -> Vec<u8> {
    let difference = |a: f32, b: f32| {
        let d = (a - b).abs();
        if d.is_finite() { d } else { 0.0 }
    };
    let pixels: Vec<[f32; 3]> =
        a.color.iter().zip(&b.color).map(|(a, b)| [0, 1, 2].map(|i| difference(a[i], b[i]))).collect();
    let largest = pixels.iter().flatten().copied().fold(0.0, f32::max);
    let gain = if largest > 0.0 { 255.0 / largest } else { 0.0 };
    pixels.into_iter().flatten().map(|d| (d * gain + 0.5) as u8).collect()
}
