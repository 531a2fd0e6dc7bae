//! Structural similarity of two pictures.
//!
//! Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, *Image quality assessment: from error visibility to structural
//! similarity*, 2004, with its Gaussian windows of 11 × 11 pixels. Windows that reach beyond the picture are left out.

/// Pixels from the middle of a window to its side.
const RADIUS: usize = 5;

/// Standard deviation of a window, in pixels.
const DEVIATION: f64 = 1.5;

/// What keeps the two quotients finite (C₁ and C₂), for values from 0 to 1.
const STEADY: [f64; 2] = [0.01 * 0.01, 0.03 * 0.03];

/// Mean over all windows of two planes of rows of `width`; 1 if there is none.
pub(crate) fn mean_similarity(a: &[f64], b: &[f64], width: usize) -> f64 {
    let [mean_a, mean_b] = [a, b].map(|plane| windows(plane, width));
    let of_products =
        |p: &[f64], q: &[f64]| windows(&p.iter().zip(q).map(|(p, q)| p * q).collect::<Vec<_>>(), width);
    let (aa, bb, ab) = (of_products(a, a), of_products(b, b), of_products(a, b));
    let at = |i: usize| {
        let (variances, covariance) =
            (aa[i] - mean_a[i].powi(2) + bb[i] - mean_b[i].powi(2), ab[i] - mean_a[i] * mean_b[i]);
        let means =
            (2.0 * mean_a[i] * mean_b[i] + STEADY[0]) / (mean_a[i].powi(2) + mean_b[i].powi(2) + STEADY[0]);
        means * (2.0 * covariance + STEADY[1]) / (variances + STEADY[1])
    };
    if ab.is_empty() { 1.0 } else { (0..ab.len()).map(at).sum::<f64>() / ab.len() as f64 }
}

/// Weighted means over all windows that fit.
fn windows(plane: &[f64], width: usize) -> Vec<f64> {
    let side = 2 * RADIUS + 1;
    if width < side || plane.len() < side * width {
        return vec![];
    }
    let bell = |k: usize| (-0.5 * ((k as f64 - RADIUS as f64) / DEVIATION).powi(2)).exp();
    let total: f64 = (0..side).map(bell).sum();
    let weights: Vec<f64> = (0..side).map(|k| bell(k) / total).collect();
    let across = |row: &[f64]| {
        let mean = |w: &[f64]| w.iter().zip(&weights).map(|(v, weight)| v * weight).sum::<f64>();
        row.windows(side).map(mean).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<f64>> = plane.chunks_exact(width).map(across).collect();
    let down = |rows: &[Vec<f64>], c: usize| rows.iter().zip(&weights).map(|(r, w)| r[c] * w).sum::<f64>();
    rows.windows(side).flat_map(|rows| (0..rows[0].len()).map(move |c| down(rows, c))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_constants_is_the_quotient_of_their_means() {
        let (a, b) = (vec![0.5; 400], vec![0.25; 400]);
        let wanted = (2.0 * 0.5 * 0.25 + STEADY[0]) / (0.25 + 0.0625 + STEADY[0]);
        assert!((mean_similarity(&a, &b, 20) - wanted).abs() < 1e-12);
        assert!((mean_similarity(&a, &a, 20) - 1.0).abs() < 1e-12);
    }
}
