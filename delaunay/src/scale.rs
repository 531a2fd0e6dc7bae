//! Powers of two that bring numbers near 1 without rounding.

/// The power of two that brings `size` into [½, 1), as far as doubles hold it; 1 for 0.
pub(crate) fn power_of_two_to_one(size: f64) -> f64 {
    if size == 0.0 {
        return 1.0;
    }
    // Subnormal sizes have no exponent field of their own; 2⁵⁴ lifts them.
    let (lifted, bits) = if size < f64::MIN_POSITIVE { (size * 2.0_f64.powi(54), 54) } else { (size, 0) };
    let exponent = ((lifted.to_bits() >> 52) & 0x7ff) as i32 - 1022 - bits;
    2.0_f64.powi((-exponent).clamp(-1022, 1023))
}

#[cfg(test)]
mod tests {
    use super::power_of_two_to_one;

    #[test]
    fn sizes_end_between_a_half_and_one() {
        for size in [1.0, 0.75, 3.0, 1e-300, 1e300, 1e70, f64::MIN_POSITIVE] {
            let scaled = size * power_of_two_to_one(size);
            assert!((0.5..1.0).contains(&scaled), "{size} became {scaled}");
        }
        assert_eq!(power_of_two_to_one(0.0), 1.0);
        assert!(power_of_two_to_one(5e-324).is_finite());
    }
}
