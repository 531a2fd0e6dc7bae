//! Coordinates in which the predicates neither overflow nor round more than they must.
//!
//! Where all coordinates are multiples of one power of two, at most 2⁵³ of them apart, they become integers, counted
//! from the least of their axis. Otherwise they are multiplied by a power of two, so that the largest is about 1.
//! Neither rounds, but for inputs whose magnitudes span more than `f64` holds once the largest is 1.

use glam::DVec3;

/// A multiplication by 2^exponent, also where that is no `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PowerOfTwo(f64, f64);

impl PowerOfTwo {
    fn new(exponent: i32) -> Self {
        let power = |e: i32| f64::from_bits(((1023 + e.clamp(-1022, 1023)) as u64) << 52);
        let half = exponent.clamp(-1022, 1023);
        Self(power(half), power(exponent - half))
    }

    #[inline]
    fn times(self, v: DVec3) -> DVec3 {
        v * self.0 * self.1
    }
}

/// The map from given coordinates to those that are computed with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    origin: DVec3,
    /// What is divided by: 2^shift.
    shift: i32,
    factor: PowerOfTwo,
    /// Whether scaled coordinates are integers.
    pub(super) is_lattice: bool,
    /// Exponent of a unit of which all scaled coordinates are multiples.
    pub(super) unit: i32,
}

/// Exponent of the lowest bit set; `None` for 0.
fn lowest_bit(x: f64) -> Option<i32> {
    let bits = x.to_bits();
    let (field, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    let (mantissa, exponent) =
        if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    (mantissa != 0).then(|| exponent + mantissa.trailing_zeros() as i32)
}

/// Exponent e with |x| < 2^e, the least there is for normal numbers.
fn magnitude(x: f64) -> i32 {
    (x.to_bits() >> 52 & 0x7ff) as i32 - 1022
}

/// The integers that `f64` holds without gaps.
const MAX_INTEGER: f64 = (1u64 << 53) as f64;

/// Scaled coordinates may grow to this before products of five could overflow.
const MAX_SCALED: f64 = (1u128 << 100) as f64;

impl Scale {
    /// That fits these points, all finite.
    pub(super) fn new(points: impl Iterator<Item = DVec3>) -> Self {
        let (mut lo, mut hi, mut unit) = (DVec3::INFINITY, DVec3::NEG_INFINITY, i32::MAX);
        for p in points {
            (lo, hi) = (lo.min(p), hi.max(p));
            unit = unit.min(lowest_unit(p));
        }
        // Only zeros, or no points.
        let unit = if unit == i32::MAX { 0 } else { unit };
        let counting = PowerOfTwo::new(-unit);
        if counting.times(hi - lo).max_element() < MAX_INTEGER {
            return Self { origin: lo, shift: unit, factor: counting, is_lattice: true, unit: 0 };
        }
        let shift = magnitude(lo.abs().max(hi.abs()).max_element());
        let factor = PowerOfTwo::new(-shift);
        Self { origin: DVec3::ZERO, shift, factor, is_lattice: false, unit: unit - shift }
    }

    /// Scaled.
    #[inline]
    pub(super) fn apply(&self, p: DVec3) -> DVec3 {
        self.factor.times(p - self.origin)
    }

    /// A further point, scaled, unless that breaks what the scale promises: then a new one is needed.
    pub(super) fn apply_new(&mut self, p: DVec3) -> Option<DVec3> {
        let scaled = self.apply(p);
        if self.is_lattice {
            let vanishes = (p - self.origin).cmpne(DVec3::ZERO) & scaled.cmpeq(DVec3::ZERO);
            let is_integer = scaled.abs().max_element() < MAX_INTEGER && scaled == scaled.floor();
            return (is_integer && !vanishes.any() && difference_is_exact(p, self.origin)).then_some(scaled);
        }
        if scaled.abs().max_element() < MAX_SCALED {
            self.unit = self.unit.min(lowest_unit(p).saturating_sub(self.shift));
            return Some(scaled);
        }
        None
    }
}

/// Exponent of the largest power of two of which all three are multiples; the largest of all for zeros.
fn lowest_unit(p: DVec3) -> i32 {
    p.to_array().into_iter().filter_map(lowest_bit).fold(i32::MAX, i32::min)
}

/// Whether a − b does not round: the error of the difference is computed, itself without one (Knuth).
fn difference_is_exact(a: DVec3, b: DVec3) -> bool {
    let d = a - b;
    let b_seen = a - d;
    let a_seen = d + b_seen;
    (a - a_seen) + (b_seen - b) == DVec3::ZERO
}
