//! Coefficients of probes, fitted to the light between them by least squares.

use super::trial::{BALANCE, Bench, Candidates, check_amount};
use crate::sh::{Lobe, MAX_COUNT, Sh};
use crate::sight::Shares;
use crate::{ProbeError, parallel};
use glam::DVec3;

/// Weights of [`fit`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct FitOptions {
    /// As [`AdaptiveOptions::balance`](super::AdaptiveOptions::balance). Default: [`BALANCE`].
    pub balance: f64,
    /// Weight of what a probe saw itself against what the candidates that it lights saw; 0 ignores the former. Default:
    /// 0.02, found by experiment: with a larger weight the error falls less where candidates are dense, and without any
    /// weight probes that light few candidates hold what fits only these.
    pub hold: f64,
}

impl FitOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self = Self { balance: BALANCE, hold: 0.02 };

    /// Sets how much errors in the dark count.
    #[must_use]
    pub const fn with_balance(mut self, balance: f64) -> Self {
        self.balance = balance;
        self
    }

    /// Sets how strongly probes are held to what they saw.
    #[must_use]
    pub const fn with_hold(mut self, hold: f64) -> Self {
        self.hold = hold;
        self
    }
}

impl Default for FitOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The remainder at which the solver stops, over that at its start; and when it stops anyway.
const ENOUGH: f64 = 1e-8;
const MOST_STEPS: usize = 500;

/// What each of the `chosen` candidates should hold as a probe so that interpolation between them comes closest, in the
/// sense of least squares, to what all candidates saw.
///
/// A probe that holds what it saw is exact at its own position, but biased all around it where light has a peak or a
/// minimum there. A fitted probe has a small error everywhere and a much smaller one on the whole. \[6\] does the same
/// for vertices of meshes. The normal equations Σ wₛ aₛaₛᵀ X = Σ wₛ aₛ Tₛ, with a row aₛ of shares for each candidate,
/// are solved by conjugate gradients from what the probes saw. A candidate counts as far as probes see it, on a surface from in
/// front, and in free space as far as it sees them, too. On a surface the row is that of the irradiance for its normal, which ties all coefficients of its probes together; the error in free space is the mean over all normals.
///
/// # Errors
/// As [`adaptive`](super::adaptive), and [`ProbeError::NoSuchProbe`] for a number that is no candidate.
pub fn fit(candidates: Candidates<'_>, chosen: &[u32], options: &FitOptions) -> Result<Vec<Sh>, ProbeError> {
    let bench = Bench::new(candidates, options.balance)?;
    check_amount("hold", options.hold)?;
    if let Some(&index) = chosen.iter().find(|&&i| i as usize >= bench.count()) {
        return Err(ProbeError::NoSuchProbe { index });
    }
    let equations = Equations::new(&bench, chosen, options.hold)?;
    let scales = scales(candidates.radiance[0].order());
    let count = scales.len();
    let saw = |i: usize| candidates.radiance[i].coefficients().iter().zip(&scales).map(|(c, s)| *c * *s);
    let start: Vec<Vec<DVec3>> = chosen.iter().map(|&i| saw(i as usize).collect()).collect();
    // Solves for the correction of what the probes saw: the right side is the error at the candidates.
    let missing: Vec<Vec<DVec3>> = parallel::map(bench.count(), |s| {
        let mut rest: Vec<DVec3> = saw(s).collect();
        for (p, share) in equations.rows[s].iter() {
            rest.iter_mut().zip(&start[p as usize]).for_each(|(r, x)| *r -= *x * share);
        }
        equations.seen(s, rest)
    });
    let gain = solve(&equations, equations.gathered(&missing, count), count);
    let sum = |(x, dx): (Vec<DVec3>, Vec<DVec3>)| -> Result<Sh, ProbeError> {
        Ok(Sh::new(x.into_iter().zip(dx).zip(&scales).map(|((a, b), s)| (a + b) / *s).collect())?)
    };
    start.into_iter().zip(gain).map(sum).collect()
}

/// What coefficients of radiance are multiplied by so that sums of squares are means of squared irradiance over all
/// normals. Bands above 2, of which irradiance has little or nothing, count like band 2.
fn scales(order: usize) -> Vec<f64> {
    let norm = (4.0 * std::f64::consts::PI).sqrt();
    (0..=order).flat_map(|l| std::iter::repeat_n(Lobe::COSINE.bands()[l.min(2)] / norm, 2 * l + 1)).collect()
}

/// The normal equations as an operator: the matrix is never stored.
struct Equations {
    rows: Vec<Shares>,
    weights: Vec<f64>,
    /// For candidates on surfaces, what irradiance is of the scaled coefficients.
    bases: Vec<Option<[f64; MAX_COUNT]>>,
    /// Weight of each probe's own observation.
    held: Vec<f64>,
}

impl Equations {
    fn new(bench: &Bench<'_>, chosen: &[u32], hold: f64) -> Result<Self, ProbeError> {
        let spacing = bench.tree(chosen)?.1;
        let shares = bench.shares(chosen)?;
        let counted = parallel::map(shares.len(), |i| {
            // Close behind a thin wall probes seem to see the place, which does not see them.
            let (row, kept) = shares[i].parts(|p| bench.sees_of(i, chosen[p as usize]));
            // What no probe sees is lit by probes that do not see it. To bend these to it, as to the dark outside of a room that is open on one
            // side, takes light from all that they do see.
            let spot = bench.spot(i, spacing);
            let seen = row.iter().map(|(p, _)| bench.seen(&spot, chosen[p as usize])).fold(0.0, f64::max);
            (row, seen * kept)
        });
        let (rows, seen): (Vec<Shares>, Vec<f64>) = counted.into_iter().unzip();
        let weights: Vec<f64> = bench.weights().iter().zip(seen).map(|(w, seen)| w * seen).collect();
        let mut lit = vec![0.0; chosen.len()];
        for (row, w) in rows.iter().zip(&weights) {
            row.iter().for_each(|(p, share)| lit[p as usize] += w * share);
        }
        // A probe that lights no candidate keeps what it saw, whatever the weight.
        let held = lit.into_iter().map(|lit| if lit > 0.0 { hold * lit } else { 1.0 }).collect();
        let scales = scales(bench.order());
        let in_scale = |basis: &[f64; MAX_COUNT]| {
            let mut scaled = [0.0; MAX_COUNT];
            let bands = bench.cosine();
            for (k, scale) in scales.iter().enumerate() {
                scaled[k] = basis[k] * bands[k] / scale;
            }
            scaled
        };
        let bases = (0..bench.count()).map(|i| bench.basis(i).map(in_scale)).collect();
        Ok(Self { rows, weights, bases, held })
    }

    /// Coefficients as a candidate counts them: themselves, or on a surface their part in its irradiance.
    fn seen(&self, s: usize, mut coefficients: Vec<DVec3>) -> Vec<DVec3> {
        if let Some(basis) = &self.bases[s] {
            let light: DVec3 = coefficients.iter().zip(basis).map(|(c, y)| *c * *y).sum();
            coefficients.iter_mut().zip(basis).for_each(|(c, y)| *c = light * *y);
        }
        coefficients
    }

    /// Σ wₛ aₛ rₛ: residuals of candidates, gathered at their probes.
    fn gathered(&self, rest: &[Vec<DVec3>], count: usize) -> Vec<Vec<DVec3>> {
        let mut sums = vec![vec![DVec3::ZERO; count]; self.held.len()];
        for ((row, w), rest) in self.rows.iter().zip(&self.weights).zip(rest) {
            for (p, share) in row.iter() {
                add(&mut sums[p as usize], rest, w * share);
            }
        }
        sums
    }

    /// The matrix times coefficients of each probe.
    fn times(&self, x: &[Vec<DVec3>], count: usize) -> Vec<Vec<DVec3>> {
        let lit: Vec<Vec<DVec3>> = parallel::map(self.rows.len(), |s| {
            let mut sum = vec![DVec3::ZERO; count];
            self.rows[s].iter().for_each(|(p, share)| add(&mut sum, &x[p as usize], share));
            self.seen(s, sum)
        });
        let mut product = self.gathered(&lit, count);
        product.iter_mut().zip(x).zip(&self.held).for_each(|((sum, x), held)| add(sum, x, *held));
        product
    }
}

/// Conjugate gradients from 0, all coefficients at once: they share a matrix.
fn solve(equations: &Equations, mut rest: Vec<Vec<DVec3>>, count: usize) -> Vec<Vec<DVec3>> {
    let mut x = vec![vec![DVec3::ZERO; count]; rest.len()];
    let mut direction = rest.clone();
    let mut square = dot(&rest, &rest);
    let enough = square * ENOUGH * ENOUGH;
    for _ in 0..MOST_STEPS {
        if square <= enough {
            break;
        }
        let product = equations.times(&direction, count);
        let step = square / dot(&direction, &product);
        for i in 0..x.len() {
            add(&mut x[i], &direction[i], step);
            add(&mut rest[i], &product[i], -step);
        }
        let next = dot(&rest, &rest);
        let turn = next / square;
        for (d, r) in direction.iter_mut().flatten().zip(rest.iter().flatten()) {
            *d = *r + *d * turn;
        }
        square = next;
    }
    x
}

fn add(sum: &mut [DVec3], x: &[DVec3], factor: f64) {
    sum.iter_mut().zip(x).for_each(|(s, x)| *s += *x * factor);
}

fn dot(a: &[Vec<DVec3>], b: &[Vec<DVec3>]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.dot(*b)).sum()
}
