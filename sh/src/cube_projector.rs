//! Projects cube maps to coefficients.

use crate::ShError;
use crate::basis::{MAX_ORDER, checked_order, coefficient_count};
use crate::cube_map::{texel_centre, texel_count};
use crate::kernel::{LANES, PARTS, Parts, Tables, total};
use crate::legendre::legendre;
use crate::moments::coefficients_from_moments;
use crate::{CubeMap, Sh, Weights};
use glam::DVec3;
use pulp::{Arch, Simd, WithSimd};

/// Sums per row of texels, of the highest order.
const MAX_SUMS: usize = 2 * MAX_ORDER + 1;

/// Projects cube maps of one size to coefficients. Its tables are computed once and serve for many cube maps.
///
/// For each face it sums texel · weight · polynomial in `f64`; a row of a face has five such sums for order 2. All
/// faces and colors share one table. The order of additions is fixed, so results have the same bits on any processor.
pub struct CubeProjector {
    size: usize,
    order: usize,
    weights: Weights,
    /// Weight over r^L and over r^(L−1), of the upper left quarter of a face.
    quarter: [Vec<f64>; 2],
    /// P_a of the columns' centres, for each a, padded to whole runs.
    legendre: Vec<f64>,
    /// P_b of the centre of each row of the upper half.
    of_rows: Vec<[f64; MAX_ORDER + 1]>,
    /// Per face, from moments to coefficients.
    matrices: Vec<f64>,
}

impl CubeProjector {
    /// Prepares the tables for faces of size × size texels and bands 0 to `order`.
    ///
    /// # Errors
    /// `CubeSize`, `OrderTooHigh`.
    pub fn new(size: usize, order: usize, weights: Weights) -> Result<Self, ShError> {
        texel_count(size)?;
        checked_order(order)?;
        let half = size.div_ceil(2);
        let inverse_r = |i: usize| {
            let (s, t) = (texel_centre(size, i % half), texel_centre(size, i / half));
            (1.0 + s * s + t * t).sqrt().recip()
        };
        let quarter = weights.of_quarter(size);
        let over =
            |degree: i32| quarter.iter().enumerate().map(|(i, w)| w * inverse_r(i).powi(degree)).collect();
        let width = size.next_multiple_of(LANES);
        let mut polynomials = vec![0.0; (order + 1) * width];
        let mut of_rows = vec![[0.0; MAX_ORDER + 1]; size];
        for (x, values) in of_rows.iter_mut().enumerate() {
            legendre(texel_centre(size, x), values);
            (0..=order).for_each(|a| polynomials[a * width + x] = values[a]);
        }
        of_rows.truncate(half);
        Ok(Self {
            size,
            order,
            weights,
            quarter: [over(order as i32), over(order as i32 - 1)],
            legendre: polynomials,
            of_rows,
            matrices: coefficients_from_moments(order),
        })
    }

    /// Texels along an edge of the faces that it projects.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// The highest band that it computes.
    #[must_use]
    pub const fn order(&self) -> usize {
        self.order
    }

    /// The rule by which it weights texels.
    #[must_use]
    pub const fn weights(&self) -> Weights {
        self.weights
    }

    /// The coefficients L_lm = ∫ L·Y_lm dω of a cube map's radiance.
    ///
    /// # Errors
    /// `WrongCubeSize`; `TexelNotFinite` with the first that is not.
    pub fn project(&self, map: &CubeMap) -> Result<Sh, ShError> {
        let (expected, size) = (self.size, map.size());
        if size != expected {
            return Err(ShError::WrongCubeSize { expected, size });
        }
        let planes = map.planes().each_ref().map(Vec::as_slice);
        let [r, g, b] = self.project_all(planes)?;
        Ok(Sh::from_parts((0..r.len()).map(|i| DVec3::new(r[i], g[i], b[i])).collect(), self.order))
    }

    /// The same of one number per texel: visibility of the sky, opacity.
    ///
    /// # Errors
    /// `CubeTexelCount` if there are not 6·size²; `TexelNotFinite`.
    pub fn project_plane(&self, plane: &[f32]) -> Result<Sh<f64>, ShError> {
        let (size, expected, count) = (self.size, 6 * self.size * self.size, plane.len());
        if count != expected {
            return Err(ShError::CubeTexelCount { size, expected, count });
        }
        let [coefficients] = self.project_all([plane])?;
        Ok(Sh::from_parts(coefficients, self.order))
    }

    fn project_all<const P: usize>(&self, planes: [&[f32]; P]) -> Result<[Vec<f64>; P], ShError> {
        let count = coefficient_count(self.order);
        let mut moments = vec![[0.0; PARTS]; P * 6 * count];
        // The vector instructions of the processor are detected once per image; everything inside is inlined into the
        // version for them.
        Arch::new().dispatch(Gather { projector: self, planes: &planes, moments: &mut moments });
        let mut of_planes = moments.chunks_exact(6 * count);
        let coefficients = planes.map(|_| self.coefficients(of_planes.next().unwrap_or_default()));
        // All weights are above 0 and finite texels have finite sums: texels are searched only if a sum is not finite.
        if coefficients.iter().flatten().all(|c| c.is_finite()) {
            return Ok(coefficients);
        }
        let first = planes.iter().filter_map(|plane| plane.iter().position(|v| !v.is_finite())).min();
        let index = first.expect("finite texels have finite sums");
        let (face, x, y) = (index / self.size.pow(2), index % self.size, index / self.size % self.size);
        Err(ShError::TexelNotFinite { face, x, y })
    }

    fn coefficients(&self, moments: &[Parts]) -> Vec<f64> {
        let count = coefficient_count(self.order);
        let mut coefficients = vec![0.0; count];
        for (moments, matrix) in moments.chunks_exact(count).zip(self.matrices.chunks_exact(count * count)) {
            for (&moment, column) in moments.iter().zip(matrix.chunks_exact(count)) {
                let moment = total(moment);
                coefficients.iter_mut().zip(column).for_each(|(sum, a)| *sum += a * moment);
            }
        }
        coefficients
    }

    /// P_a of a run of columns.
    #[inline(always)]
    fn polynomial(&self, a: usize, x: usize) -> &[f64] {
        let width = self.size.next_multiple_of(LANES);
        &self.legendre[a * width + x..a * width + x + LANES]
    }
}

/// The moments of all faces of all planes.
struct Gather<'a> {
    projector: &'a CubeProjector,
    planes: &'a [&'a [f32]],
    moments: &'a mut [Parts],
}

impl WithSimd for Gather<'_> {
    type Output = ();

    // No explicit vector types: the compiler vectorises the loops over lanes. Everything must be inlined, because a
    // function that is not would be compiled without the wide instructions.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        // With the usual order as a constant the loops over moments are unrolled: a third less time with small faces.
        match self.projector.order {
            2 => self.run(2),
            order => self.run(order),
        }
    }
}

impl Gather<'_> {
    #[inline(always)]
    fn run(self, order: usize) {
        let Self { projector, planes, moments } = self;
        let (size, count) = (projector.size, coefficient_count(order));
        let mut row = Row::new(projector);
        for y in 0..size.div_ceil(2) {
            row.fill(projector, order, y);
            let polynomials = &projector.of_rows[y];
            for (plane, moments) in planes.iter().zip(moments.chunks_exact_mut(6 * count)) {
                let faces = plane.chunks_exact(size * size);
                for (face, moments) in faces.zip(moments.chunks_exact_mut(count)) {
                    row.sum(face, size, y);
                    row.add_to(moments, order, polynomials);
                }
            }
        }
    }
}

/// Tables and sums of one row of a face and of its mirror image.
struct Row {
    /// Weight·P_a(s) over r^L for a up to L, then over r^(L−1) for a up to L − 1.
    tables: Tables,
    /// The weights of the row over r^L and r^(L−1), with both halves, padded to whole runs.
    weights: [Vec<f64>; 2],
    /// Of the row and of its mirror image.
    sums: [[Parts; MAX_SUMS]; 2],
}

impl Row {
    fn new(projector: &CubeProjector) -> Self {
        let padded = vec![0.0; projector.size.next_multiple_of(LANES)];
        let tables = Tables::new(2 * projector.order + 1, projector.size);
        Self { tables, weights: [padded.clone(), padded], sums: [[[0.0; PARTS]; MAX_SUMS]; 2] }
    }

    /// Tables of row y and its mirror image: they are the same.
    #[inline(always)]
    fn fill(&mut self, projector: &CubeProjector, order: usize, y: usize) {
        let half = projector.size.div_ceil(2);
        for (weights, quarter) in self.weights.iter_mut().zip(&projector.quarter) {
            let left = &quarter[y * half..(y + 1) * half];
            weights[..half].copy_from_slice(left);
            let right = weights[half..projector.size].iter_mut().rev();
            right.zip(left).for_each(|(weight, &mirrored)| *weight = mirrored);
        }
        let weights = &self.weights;
        self.tables.fill(|k, x, run| {
            let (weights, a) = if k > order { (&weights[1], k - order - 1) } else { (&weights[0], k) };
            let factors = weights[x..x + LANES].iter().zip(projector.polynomial(a, x));
            run.iter_mut().zip(factors).for_each(|(value, (w, p))| *value = w * p);
        });
    }

    /// Sums up row y of a face and its mirror image; the middle row has none.
    #[inline(always)]
    fn sum(&mut self, face: &[f32], size: usize, y: usize) {
        let [sums, mirrored] = &mut self.sums;
        self.tables.sums(&face[y * size..(y + 1) * size], sums);
        let across = size - 1 - y;
        if across == y {
            mirrored.fill([0.0; PARTS]);
        } else {
            self.tables.sums(&face[across * size..(across + 1) * size], mirrored);
        }
    }

    /// Adds both rows to the face's moments, ordered by degree, a and b: P_b of the mirror image is ±P_b.
    #[inline(always)]
    fn add_to(&self, moments: &mut [Parts], order: usize, polynomials: &[f64; MAX_ORDER + 1]) {
        let mut moments = moments.iter_mut();
        for (first, degree) in [(0, order), (order + 1, order.wrapping_sub(1))] {
            for a in 0..degree.wrapping_add(1) {
                let [sum, mirrored] = [self.sums[0][first + a], self.sums[1][first + a]];
                let mut even_odd = [[0.0; PARTS]; 2];
                for part in 0..PARTS {
                    even_odd[0][part] = sum[part] + mirrored[part];
                    even_odd[1][part] = sum[part] - mirrored[part];
                }
                for (b, moment) in (0..=degree - a).zip(moments.by_ref()) {
                    for part in 0..PARTS {
                        moment[part] += even_odd[b % 2][part] * polynomials[b];
                    }
                }
            }
        }
    }
}
