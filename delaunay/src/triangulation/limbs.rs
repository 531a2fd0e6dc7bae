//! Signs of determinants of differences cut to integers of 61 bits: with 64-bit products, an order of magnitude faster
//! than expansions.
//!
//! Differences of coordinates of similar magnitude are such integers, in a common unit, and the sign is exact.
//! Otherwise the sign is right where the determinant exceeds what the cuts can change, about 2⁻⁵⁰ of the largest
//! possible determinant. Points that would lie on a common sphere without the rounding of their coordinates have larger
//! determinants than that.

use glam::DVec3;

/// Differences are less than 2 to this power.
const BITS: i32 = 61;

/// Differences, and whether nothing was cut off.
struct Cut<const N: usize> {
    x: [i64; N],
    y: [i64; N],
    z: [i64; N],
    is_exact: bool,
}

/// 2 to a power for which that is a normal number.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

impl<const N: usize> Cut<N> {
    /// Of these points to p, if that is not all of them. Coordinates of magnitudes from 2⁻²⁰⁰ to 2¹⁰⁰ or 0.
    fn new(points: [DVec3; N], p: DVec3) -> Option<Self> {
        let reach = points.iter().fold(DVec3::ZERO, |r, q| r.max((q - p).abs())).max_element();
        let exponent = (reach.to_bits() >> 52) as i32 - 1022;
        // Less than 2⁶¹ after scaling, as is what rounding has taken off it.
        let scale = power_of_two(BITS - exponent);
        let mut is_exact = true;
        let mut cut = |a: f64, b: f64| {
            let rounded = a - b;
            let b_seen = a - rounded;
            let rest = (a - (rounded + b_seen)) + (b_seen - b);
            let (rounded, rest) = (rounded * scale, rest * scale);
            let (whole, part) = (rounded as i64, rest as i64);
            is_exact &= whole as f64 == rounded && part as f64 == rest;
            whole + part
        };
        let x = points.map(|q| cut(q.x, p.x));
        let y = points.map(|q| cut(q.y, p.y));
        let z = points.map(|q| cut(q.z, p.z));
        (reach > 0.0).then_some(Self { x, y, z, is_exact })
    }

    /// Of the shadow of i and j.
    fn area(&self, i: usize, j: usize) -> i128 {
        product(self.x[i], self.y[j]) - product(self.x[j], self.y[i])
    }
}

fn product(a: i64, b: i64) -> i128 {
    i128::from(a) * i128::from(b)
}

/// high · 2⁶⁴ + low.
#[derive(Clone, Copy)]
struct Triple {
    high: i128,
    low: u64,
}

impl Triple {
    /// Of factors below 2⁶² and 2¹²⁴.
    fn product(a: i64, b: i128) -> Self {
        let low = i128::from(a) * i128::from(b as u64);
        Self { high: product(a, (b >> 64) as i64) + (low >> 64), low: low as u64 }
    }

    fn plus(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Self { high: self.high + other.high + i128::from(carry), low }
    }
}

/// A sum of products, in six digits of 64 bits whose carries are not yet propagated.
#[derive(Clone, Copy, Default)]
struct Sum([i128; 6]);

impl Sum {
    fn add(&mut self, place: usize, product: i128) {
        self.0[place] += i128::from(product as u64);
        self.0[place + 1] += product >> 64;
    }

    fn add_unsigned(&mut self, place: usize, product: u128) {
        self.0[place] += i128::from(product as u64);
        self.0[place + 1] += i128::from((product >> 64) as u64);
    }

    /// Adds a product of factors of which the first is positive.
    fn add_product(&mut self, a: u128, b: Triple) {
        let wide = |a: u64, b: u64| u128::from(a) * u128::from(b);
        let (middle, high) = (b.high as u64, (b.high >> 64) as i64);
        for (place, a) in [(0, a as u64), (1, (a >> 64) as u64)] {
            self.add_unsigned(place, wide(a, b.low));
            self.add_unsigned(place + 1, wide(a, middle));
            self.add(place + 2, i128::from(a) * i128::from(high));
        }
    }

    /// Propagates carries. Returns the quotient by 2²⁵⁶, rounded down, and whether the sum is 0.
    fn carried(mut self) -> (i128, bool) {
        let mut is_zero = true;
        for place in 0..5 {
            let carry = self.0[place] >> 64;
            is_zero &= self.0[place] as u64 == 0;
            self.0[place + 1] += carry;
            self.0[place] &= i128::from(u64::MAX);
        }
        is_zero &= self.0[5] == 0;
        ((self.0[5] << 64) + self.0[4], is_zero)
    }
}

fn sign(high: i128, is_zero: bool) -> f64 {
    if is_zero {
        0.0
    } else if high < 0 {
        -1.0
    } else {
        1.0
    }
}

/// The sign of (b−a)×(c−a)·(d−a); `None` if it is not certain.
pub(super) fn orient([a, b, c, d]: [DVec3; 4]) -> Option<f64> {
    let cut = Cut::new([b, c, d], a)?;
    let terms = [(0, 1, 2), (1, 2, 0), (2, 0, 1)].map(|(i, j, k)| Triple::product(cut.z[k], cut.area(i, j)));
    let Triple { high, low } = terms[0].plus(terms[1]).plus(terms[2]);
    // Six products of three, each of which cuts change by 3 · 2 · 2¹²² at most: less than 2¹²⁸.
    let is_sure = cut.is_exact || !(-(1 << 64)..1 << 64).contains(&high);
    is_sure.then(|| sign(high, high == 0 && low == 0))
}

/// Positive inside the sphere through the corners of a positive tetrahedron; `None` if the sign is not certain.
pub(super) fn sphere(corners: [DVec3; 4], p: DVec3) -> Option<f64> {
    let cut = Cut::new(corners, p)?;
    let near = [0, 1, 2, 3].map(|i| cut.area(i, (i + 1) & 3));
    let far = [cut.area(0, 2), cut.area(1, 3)];
    let mut sum = Sum::default();
    for i in 0..4 {
        // The volume without corner i, as in `lifts_and_volumes`.
        let (j, k, l) = ((i + 1) & 3, (i + 2) & 3, (i + 3) & 3);
        let across = if j < 2 { far[j] } else { -far[j - 2] };
        let turn = |z: i64| if i % 2 == 0 { z } else { -z };
        let volume = Triple::product(turn(cut.z[j]), near[k])
            .plus(Triple::product(turn(-cut.z[k]), across))
            .plus(Triple::product(turn(cut.z[l]), near[j]));
        let square = |v: i64| product(v, v) as u128;
        sum.add_product(square(cut.x[i]) + square(cut.y[i]) + square(cut.z[i]), volume);
    }
    let (high, is_zero) = sum.carried();
    // 72 products of five, each of which cuts change by 5 · 2 · 2²⁴⁴ at most: less than 2²⁵⁶.
    let is_sure = cut.is_exact || !(-1..1).contains(&high);
    is_sure.then(|| sign(high, is_zero))
}

#[cfg(test)]
mod tests {
    use super::super::exact;
    use super::*;
    use crate::wide;

    /// Numbers of one kind: with few bits or many, near and far from each other.
    fn coordinate(kind: u64, seed: &mut u64) -> f64 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (*seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        match (kind, *seed >> 40 & 3) {
            (0, _) => (x * 4.0).round(),
            (1, _) => (x * 4.0).round() * 0.1 + 7.0,
            (2, _) => 1.0 + x * 1e-14,
            (3, 0) => x * 1e-3,
            (3, _) => x,
            (_, 0) => x * 1e-30,
            _ => (x * 4.0).round(),
        }
    }

    #[test]
    fn signs_are_those_of_other_arithmetic() {
        let mut seed = 1;
        let (mut told, mut zeros) = ([0; 5], [0; 5]);
        for kind in (0..5).cycle().take(20_000) {
            let mut point = || DVec3::from_array([0; 3].map(|_| coordinate(kind, &mut seed)));
            let (corners, p) = ([0; 4].map(|_| point()), point());
            if let Some(sign) = orient(corners) {
                assert_eq!(sign, wide::orient(corners), "{corners:?}");
            }
            let expected = wide::sphere(corners, p);
            assert_eq!(exact::expansion_sphere(corners, p).partial_cmp(&0.0), expected.partial_cmp(&0.0));
            if let Some(sign) = sphere(corners, p) {
                assert_eq!(sign, expected, "{corners:?} {p:?}");
                told[kind as usize] += 1;
                zeros[kind as usize] += u32::from(sign == 0.0);
            }
        }
        assert!(told[..4].iter().all(|&t| t > 3_900) && told[4] > 2_000, "{told:?} of 4000 each told");
        assert!(zeros[0] > 500 && zeros[1] > 300, "{zeros:?} are 0");
    }
}
