//! The places where two pictures differ most.

use super::Comparison;
use crate::image_io::PixelRect;

/// Width and height of a place in pixels, where the picture is as large.
const SIDE: u32 = 24;
/// How many places are shown.
const COUNT: usize = 5;
/// A place whose mean FLIP is less is not worth showing; rounding of sums is far less.
const LEAST_MEAN: f64 = 1e-5;

/// Up to [`COUNT`] places that do not overlap: the one about the largest difference first, then those with most FLIP.
pub(super) fn worst_places(comparison: &Comparison) -> Vec<PixelRect> {
    let differences = &comparison.differences;
    let size = [differences.width, differences.height];
    if differences.max == 0.0 {
        return vec![];
    }
    let side = size.map(|length| length.min(SIDE));
    let about = [0, 1].map(|i| differences.max_pixel[i].saturating_sub(side[i] / 2).min(size[i] - side[i]));
    let mut places = vec![place_at(about, side)];
    let sums = Sums::new(&comparison.flip, size);
    while places.len() < COUNT {
        match next_place(&sums, size, side, &places) {
            Some(place) => places.push(place),
            None => break,
        }
    }
    places
}

fn place_at([x, y]: [u32; 2], [width, height]: [u32; 2]) -> PixelRect {
    PixelRect { x0: x, y0: y, x1: x + width, y1: y + height }
}

/// The place with most FLIP beside those that are taken; of several, the first row by row.
fn next_place(sums: &Sums, size: [u32; 2], side: [u32; 2], taken: &[PixelRect]) -> Option<PixelRect> {
    let mut best = (LEAST_MEAN * f64::from(side[0]) * f64::from(side[1]), None);
    for y in 0..=size[1] - side[1] {
        for x in 0..=size[0] - side[0] {
            let place = place_at([x, y], side);
            let sum = sums.of(place);
            if sum > best.0 && !taken.iter().any(|other| overlap(place, *other)) {
                best = (sum, Some(place));
            }
        }
    }
    best.1
}

fn overlap(a: PixelRect, b: PixelRect) -> bool {
    a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1
}

/// Sums over rectangles, from those of all rectangles at the corner.
struct Sums {
    row: usize,
    sums: Vec<f64>,
}

impl Sums {
    fn new(values: &[f32], [width, height]: [u32; 2]) -> Self {
        let row = width as usize + 1;
        let mut sums = vec![0.0; row * (height as usize + 1)];
        for (y, line) in values.chunks_exact(width as usize).enumerate() {
            let mut along = 0.0;
            for (x, &value) in line.iter().enumerate() {
                along += f64::from(value);
                sums[(y + 1) * row + x + 1] = sums[y * row + x + 1] + along;
            }
        }
        Self { row, sums }
    }

    fn of(&self, place: PixelRect) -> f64 {
        let at = |x: u32, y: u32| self.sums[y as usize * self.row + x as usize];
        at(place.x1, place.y1) - at(place.x0, place.y1) - at(place.x1, place.y0) + at(place.x0, place.y0)
    }
}
