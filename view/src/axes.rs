//! Orthonormal axes from two directions of any length.

use glam::DVec3;

/// Sine of the angle between `up` and the view direction below which the roll of the picture would be rounding: an ulp
/// of either direction turns it by more than a hundredth of a radian.
const SMALLEST_UP_SINE: f64 = 64.0 * f64::EPSILON;

/// A cross product of unit vectors this short is off orthogonal by 16 times the rounding of its terms: it gets a second
/// pass of Gram–Schmidt.
const SHORT_CROSS: f64 = 1.0 / 16.0;

/// Lengths outside these powers of two have squares that lose digits or overflow.
const TINY: f64 = f64::from_bits((1023 - 340) << 52);
const HUGE: f64 = f64::from_bits((1023 + 340) << 52);
/// 2⁶⁰⁰: takes any such length, subnormal ones included, into the range where its square is a normal number.
const UNDO: f64 = f64::from_bits((1023 + 600) << 52);

/// The unit vector along `v`, also for vectors whose squared length is no number of `f64`; `None` for zero and for what
/// is not finite. Multiplying by a power of two rounds nothing.
pub(crate) fn unit_vector(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if largest < TINY {
        (v * UNDO).try_normalize()
    } else if largest > HUGE {
        (v / UNDO).try_normalize()
    } else {
        v.try_normalize()
    }
}

/// Right and up of a camera that looks along the unit vector `forward`; `None` if `up` is zero, not finite or parallel
/// to it.
pub(crate) fn right_and_up(forward: DVec3, up: DVec3) -> Option<(DVec3, DVec3)> {
    let across = forward.cross(unit_vector(up)?);
    let sine = across.length();
    if sine < SMALLEST_UP_SINE {
        return None;
    }
    let mut right = across.try_normalize()?;
    if sine < SHORT_CROSS {
        right = (right - forward * right.dot(forward)).try_normalize()?;
    }
    Some((right, right.cross(forward)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    #[test]
    fn unit_vectors_of_any_length_are_those_of_ordinary_length() {
        let v = dvec3(0.3, -0.7, 0.2);
        let unit = v.normalize();
        let power = |n: i32| 2f64.powi(n);
        for exponent in [-1000, -700, -341, -339, -1, 0, 1, 339, 341, 700, 1000] {
            assert_eq!(unit_vector(v * power(exponent)), Some(unit), "2^{exponent}");
        }
        let least = f64::from_bits(1);
        assert_eq!(unit_vector(dvec3(0.0, -least, 0.0)), Some(DVec3::NEG_Y));
        assert_eq!(unit_vector(DVec3::X * f64::MAX), Some(DVec3::X));
        for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, dvec3(f64::NAN, 1.0, 0.0)] {
            assert_eq!(unit_vector(bad), None);
        }
    }

    #[test]
    fn axes_are_orthogonal_however_close_up_is_to_the_view() {
        let forward = dvec3(0.3, -0.8, 0.5).normalize();
        for tilt in [1e-1, 1e-2, 1e-5, 1e-9, 1e-13] {
            let (right, up) = right_and_up(forward, forward + dvec3(0.1, 0.2, 0.7) * tilt).unwrap();
            let errors = [right.dot(forward), up.dot(forward), right.dot(up)];
            assert!(errors.iter().all(|e| e.abs() < 8.0 * f64::EPSILON), "{tilt}: {errors:?}");
        }
        assert_eq!(right_and_up(forward, forward * 7.0), None);
        assert_eq!(right_and_up(forward, forward * -1e-290), None);
    }
}
