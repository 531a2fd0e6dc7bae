//! Projects panoramas to coefficients.

use crate::ShError;
use crate::basis::{MAX_ORDER, checked_order, coefficient_count, coefficient_index, fill_basis};
use crate::kernel::{LANES, PARTS, Parts, Tables, total};
use crate::panorama::pixel_count;
use crate::{Panorama, Rotation, Sh, Weights};
use glam::{DMat3, DVec3, dvec3};
use pointillist_parallel as parallel;
use pulp::{Arch, Simd, WithSimd};
use std::f64::consts::{PI, TAU};

const MAX_SUMS: usize = 2 * MAX_ORDER + 1;

/// Projects panoramas of one size to coefficients. Its tables are computed once and serve for many panoramas.
///
/// Rows are summed with cos mφ and sin mφ of their pixels' centres, and those sums with the functions of θ; with
/// [`Weights::Gregory`] this is exact for any sky of order up to the smaller of width and height less the order, and
/// second order with the others. (To integrate the basis over each pixel, as if radiance were constant there, would
/// damp band m by the factor sin(mΔ/2)/(mΔ/2), Δ = 2π/width; also of pixels that are means, which it would damp again.)
pub struct PanoramaProjector {
    width: usize,
    height: usize,
    order: usize,
    /// cos mφ for m up to the order, then sin mφ from m = 1.
    tables: Tables,
    /// Per row of the image, weight times Y_lm(θ, φ = 0), m ≥ 0, as coefficients are ordered.
    rows: Vec<f64>,
    world_from_zenith: Rotation,
}

impl PanoramaProjector {
    /// For width × height pixels, to bands 0 to `order`.
    ///
    /// # Errors
    /// `PanoramaSize` if a side is 0 or above [`Panorama::MAX_SIDE`], `OrderTooHigh`.
    pub fn new(width: usize, height: usize, order: usize, weights: Weights) -> Result<Self, ShError> {
        let count = coefficient_count(checked_order(order)?);
        pixel_count(width, height)?;
        let mut rows = vec![0.0; height * count];
        for (y, (row, weight)) in rows.chunks_exact_mut(count).zip(weights.of_rows(height)).enumerate() {
            let (sin, cos) = (PI * (y as f64 + 0.5) / height as f64).sin_cos();
            fill_basis(order, dvec3(sin, 0.0, cos), row);
            row.iter_mut().for_each(|value| *value *= weight * TAU / width as f64);
        }
        // The basis functions have the zenith as z axis. For a right-handed frame, angles increase against the
        // direction of columns.
        let world_from_zenith = DMat3::from_cols(DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y);
        Ok(Self {
            width,
            height,
            order,
            tables: waves(width, order),
            rows,
            world_from_zenith: Rotation::new(order, world_from_zenith)?,
        })
    }

    /// The coefficients L_lm = ∫ L·Y_lm dω of a panorama's radiance; on all cores, with the same result on any number.
    ///
    /// # Errors
    /// `WrongPanoramaSize`.
    pub fn project(&self, map: &Panorama) -> Result<Sh, ShError> {
        let (width, height) = (map.width(), map.height());
        if (width, height) != (self.width, self.height) {
            return Err(ShError::WrongPanoramaSize { width, height });
        }
        let of_row = |y: usize| {
            let row = map.planes().each_ref().map(|plane| &plane[y * width..(y + 1) * width]);
            Arch::new().dispatch(RowSums { tables: &self.tables, row })
        };
        let mut coefficients = vec![DVec3::ZERO; coefficient_count(self.order)];
        for (y, sums) in parallel::map(height, of_row).iter().enumerate() {
            self.add_row(y, sums, &mut coefficients);
        }
        self.world_from_zenith.of(&Sh::from_parts(coefficients, self.order))
    }

    fn add_row(&self, y: usize, sums: &[[Parts; 3]; MAX_SUMS], coefficients: &mut [DVec3]) {
        let row = &self.rows[y * coefficients.len()..];
        let sums = sums.map(|parts| DVec3::from(parts.map(total)));
        for l in 0..=self.order {
            coefficients[coefficient_index(l, 0)] += sums[0] * row[coefficient_index(l, 0)];
            for m in 1..=l {
                let (plus, minus) = (coefficient_index(l, m as isize), coefficient_index(l, -(m as isize)));
                coefficients[plus] += sums[m] * row[plus];
                coefficients[minus] += sums[self.order + m] * row[plus];
            }
        }
    }
}

fn waves(width: usize, order: usize) -> Tables {
    let mut tables = Tables::new(2 * order + 1, width);
    let phi = |x: usize| PI - TAU * (x as f64 + 0.5) / width as f64;
    tables.fill(|k, x, run: &mut [f64; LANES]| {
        let inside = run.iter_mut().zip(x..width);
        if k <= order {
            inside.for_each(|(value, x)| *value = (k as f64 * phi(x)).cos());
        } else {
            inside.for_each(|(value, x)| *value = ((k - order) as f64 * phi(x)).sin());
        }
    });
    tables
}

/// One row of each color.
struct RowSums<'a> {
    tables: &'a Tables,
    row: [&'a [f32]; 3],
}

impl WithSimd for RowSums<'_> {
    type Output = [[Parts; 3]; MAX_SUMS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut sums = [[[0.0; PARTS]; MAX_SUMS]; 3];
        for (row, sums) in self.row.iter().zip(&mut sums) {
            self.tables.sums(row, sums);
        }
        std::array::from_fn(|k| [sums[0][k], sums[1][k], sums[2][k]])
    }
}
