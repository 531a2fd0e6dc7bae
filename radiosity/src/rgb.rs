//! Light in three bands.

use crate::error::RadiosityError;

/// Red, green, blue, or any other three bands.
pub type Rgb = [f64; 3];

/// Largest emission, irradiance or importance: with areas of up to 1e140, sums of powers stay finite, and a residual that
/// overflowed would be bounded by nothing.
const MOST_LIGHT: f64 = 1e100;

/// Whether a value can be light: not NaN, not negative, not so large that sums overflow.
pub(crate) fn is_light(value: f64) -> bool {
    (0.0..=MOST_LIGHT).contains(&value)
}

/// a + f · b in each band.
#[inline]
pub(crate) fn add(a: Rgb, f: f64, b: Rgb) -> Rgb {
    [a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]]
}

/// Product of the bands.
#[inline]
pub(crate) fn times(a: Rgb, b: Rgb) -> Rgb {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// Checks what a caller says of the direct irradiance of patches: none, or one light for each.
pub(crate) fn check_direct(patches: usize, direct: &[Rgb]) -> Result<(), RadiosityError> {
    if !direct.is_empty() && direct.len() != patches {
        return Err(RadiosityError::CountMismatch { patches, given: direct.len() });
    }
    for (patch, light) in direct.iter().enumerate() {
        if let Some(&value) = light.iter().find(|&&l| !is_light(l)) {
            return Err(RadiosityError::DirectIrradiance { patch, value });
        }
    }
    Ok(())
}

/// Replaces the direct irradiance of patches by one light for each, or by none.
pub(crate) fn replace_direct(all: &mut [Rgb], direct: &[Rgb]) -> Result<(), RadiosityError> {
    check_direct(all.len(), direct)?;
    all.fill([0.0; 3]);
    all[..direct.len()].copy_from_slice(direct);
    Ok(())
}
