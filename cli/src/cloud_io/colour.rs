//! Colours of points: sRGB codes to linear values.

use pointillist_render::linear_from_srgb;
use std::sync::LazyLock;

/// 8-bit codes; a power per channel would cost more than the rest of the reading.
static OF_BYTE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| linear_from_srgb(code as f32 / 255.0)));

/// 16-bit codes, 256 KiB, made when the first file with such colours comes.
static OF_SHORT: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(|code| linear_from_srgb(f32::from(code) / 65_535.0)).collect());

/// How far above 1 a float colour may be by rounding; it is taken as 1. Beyond, it is not a colour from 0 to 1.
const ROUNDING: f64 = 1e-3;

/// The range that colours are stored in. All are sRGB-encoded, floats too: no format here says otherwise, and writers
/// pass on what came out of a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ColourCode {
    /// 0 to 255.
    Byte,
    /// 0 to 65,535.
    Short,
    /// 0 to 1.
    Unit,
}

impl ColourCode {
    /// Linear value of a stored one; NaN for NaN, nothing for a number out of range. Fractions of 8- and 16-bit codes are
    /// rounded to the nearest.
    pub(super) fn linear(self, stored: f64) -> Option<f32> {
        if stored.is_nan() {
            return Some(f32::NAN);
        }
        match self {
            Self::Byte if (0.0..=255.0).contains(&stored) => Some(OF_BYTE[(stored + 0.5) as usize]),
            Self::Short if (0.0..=65_535.0).contains(&stored) => Some(OF_SHORT[(stored + 0.5) as usize]),
            Self::Unit if (0.0..=1.0 + ROUNDING).contains(&stored) => {
                Some(linear_from_srgb(stored.min(1.0) as f32))
            }
            _ => None,
        }
    }

    /// A stored opacity as a share of the highest code; NaN for NaN, nothing for a number out of range.
    pub(super) fn share(self, stored: f64) -> Option<f32> {
        let share = stored / f64::from(self.highest());
        let is_valid = share.is_nan() || (0.0..=1.0 + ROUNDING).contains(&share);
        is_valid.then_some(if share > 1.0 { 1.0 } else { share as f32 })
    }

    /// The largest code.
    pub(super) const fn highest(self) -> u32 {
        match self {
            Self::Byte => 255,
            Self::Short => 65_535,
            Self::Unit => 1,
        }
    }
}
