//! Coordinates of LAS: whole numbers with a scale and an offset.

/// One axis. A file says `0.001` and means a thousandth, which no double is: n · 0.001 + offset is rounded three times, and the
/// coordinate 5 391 234.567 comes out a few units of the last digit off. Where scale and offset are decimals of the same step, the
/// sum is of whole numbers and the quotient is rounded once: the double next to the decimal number that was stored.
#[derive(Clone, Copy, Debug)]
pub(super) enum Axis {
    /// (n + `offset`) / `per_unit`, both whole.
    Exact { offset: f64, per_unit: f64 },
    /// n · `scale` + `offset`, rounded once.
    Rounded { scale: f64, offset: f64 },
}

/// Whole numbers up to here are doubles.
const WHOLE: f64 = 9_007_199_254_740_992.0;

impl Axis {
    pub(super) fn new(scale: f64, offset: f64) -> Self {
        let per_unit = (1.0 / scale).round();
        let steps = (offset * per_unit).round();
        let is_exact = per_unit >= 1.0
            && 1.0 / per_unit == scale
            && steps.abs() + f64::from(i32::MAX) < WHOLE
            && steps / per_unit == offset;
        if is_exact { Self::Exact { offset: steps, per_unit } } else { Self::Rounded { scale, offset } }
    }

    /// Of a stored number.
    pub(super) fn coordinate(self, stored: i32) -> f64 {
        let stored = f64::from(stored);
        match self {
            Self::Exact { offset, per_unit } => (stored + offset) / per_unit,
            Self::Rounded { scale, offset } => stored.mul_add(scale, offset),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(testkit::config(256))]
        #[test]
        fn coordinates_are_the_doubles_next_to_their_decimals(
            stored: i32,
            digits in 0_usize..6,
            offset in -9_999_999_999_i64..=9_999_999_999,
        ) {
            let scale: f64 = format!("1e-{digits}").parse().unwrap();
            // An offset of up to four decimals more or less than the scale has, as a file would have it.
            let decimals = digits.min(4);
            let steps = 10_i64.pow((digits - decimals) as u32);
            let offset_value: f64 = format!("{offset}e-{decimals}").parse().unwrap();
            let axis = Axis::new(scale, offset_value);
            let exact: f64 = format!("{}e-{digits}", i64::from(stored) + offset * steps).parse().unwrap();
            prop_assert_eq!(axis.coordinate(stored), exact);
        }

        #[test]
        fn any_scale_and_offset_is_within_two_roundings(
            stored: i32,
            scale in 1e-9_f64..1e3,
            offset in -1e9_f64..1e9,
        ) {
            let axis = Axis::new(scale, offset);
            let plain = f64::from(stored) * scale + offset;
            let size = (f64::from(stored) * scale).abs() + offset.abs();
            prop_assert!((axis.coordinate(stored) - plain).abs() <= 2.0 * f64::EPSILON * size);
        }
    }

    #[test]
    fn odd_scales_are_taken_as_they_are() {
        for (scale, offset) in
            [(0.0, 1.0), (f64::NAN, 0.0), (-0.01, 5.0), (f64::INFINITY, 0.0), (1e-300, 0.5)]
        {
            assert!(matches!(Axis::new(scale, offset), Axis::Rounded { .. }), "{scale} {offset}");
        }
        assert_eq!(Axis::new(-0.5, 5.0).coordinate(4), 3.0);
    }
}
