//! Directions and colors in 32 bits and shares in 16, for links.

use glam::Vec3;

/// Steps of an octahedral coordinate on either side of 0.
const STEPS: f32 = 32767.0;

/// A unit vector as a point of the octahedron, 16 bits a coordinate; off by less than 0.005°.
pub(crate) fn pack_direction(n: Vec3) -> u32 {
    let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
    let (mut x, mut y) = (n.x, n.y);
    if n.z < 0.0 {
        (x, y) = ((1.0 - n.y.abs()).copysign(n.x), (1.0 - n.x.abs()).copysign(n.y));
    }
    let step = |v: f32| (v * STEPS).round() as i32 as u16;
    u32::from(step(x)) | u32::from(step(y)) << 16
}

/// The unit vector again, but for its length.
#[inline(always)]
pub(crate) fn unpack_way(packed: u32) -> Vec3 {
    let coordinate = |bits: u32| f32::from(bits as u16 as i16);
    let (x, y) = (coordinate(packed), coordinate(packed >> 16));
    let z = STEPS - x.abs() - y.abs();
    let folded = (-z).max(0.0);
    Vec3::new(x - folded.copysign(x), y - folded.copysign(y), z)
}

/// Bits of a mantissa, and the bias of the common exponent.
const MANTISSA: i32 = 9;
const BIAS: i32 = 15;

/// A color with a common exponent, 9 bits a channel; channels up to 65,408, off by at most 1/512 of the largest.
pub(crate) fn pack_color(c: [f32; 3]) -> u32 {
    let largest = (1.0 - f32::exp2(-MANTISSA as f32)) * f32::exp2((31 - BIAS) as f32);
    let c = c.map(|v| v.clamp(0.0, largest));
    let brightest = c[0].max(c[1]).max(c[2]);
    if brightest < f32::exp2((-BIAS - MANTISSA) as f32) {
        return 0;
    }
    let mut exponent = (brightest.log2().floor() as i32).max(-BIAS - 1) + 1 + BIAS;
    let scale = |exponent: i32| f32::exp2((MANTISSA + BIAS - exponent) as f32);
    if (brightest * scale(exponent)).round() as u32 >= 1 << MANTISSA {
        exponent += 1;
    }
    let m = c.map(|v| ((v * scale(exponent)).round() as u32).min((1 << MANTISSA) - 1));
    m[0] | m[1] << 9 | m[2] << 18 | (exponent as u32) << 27
}

/// The color again.
#[inline(always)]
pub(crate) fn unpack_color(packed: u32) -> [f32; 3] {
    // 2 to the power of the exponent, without a call: it is a normal number.
    let exponent = (packed >> 27) as i32 - BIAS - MANTISSA;
    let scale = f32::from_bits(((exponent + F32_BIAS) as u32) << (f32::MANTISSA_DIGITS - 1));
    [0, 9, 18].map(|shift| (packed >> shift & 0x1ff) as f32 * scale)
}

/// Steps of a share.
const SHARES: f32 = 65535.0;

/// A share, 0 to 1, in 16 bits; 0 and 1 are exact.
pub(crate) fn pack_share(share: f32) -> u16 {
    (share * SHARES).round() as u16
}

/// The share again.
#[inline(always)]
pub(crate) fn unpack_share(packed: u16) -> f32 {
    f32::from(packed) / SHARES
}

/// The bias of the exponent of an `f32`.
const F32_BIAS: i32 = f32::MAX_EXP - 1;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_survive() {
        let mut n = Vec3::new(0.3, -0.2, 0.9);
        let turn = glam::Mat3::from_axis_angle(Vec3::new(1.0, 2.0, -0.5).normalize(), 0.7)
            * glam::Mat3::from_rotation_z(1.3);
        for _ in 0..2000 {
            n = (turn * n).normalize();
            assert!(unpack_way(pack_direction(n)).normalize().distance(n) < 9e-5, "{n}");
        }
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            assert_eq!(unpack_way(pack_direction(axis)).normalize(), axis);
            assert_eq!(unpack_way(pack_direction(-axis)).normalize(), -axis);
        }
    }

    #[test]
    fn shares_survive() {
        for share in [0.0, 1.0, 0.5, 1e-9, 0.999_999, 1.0 / 3.0] {
            assert!((unpack_share(pack_share(share)) - share).abs() <= 0.5 / SHARES, "{share}");
        }
        assert_eq!([0.0, 1.0].map(|share| unpack_share(pack_share(share))), [0.0, 1.0]);
    }

    #[test]
    fn colors_survive() {
        for c in
            [[0.0; 3], [1.0; 3], [0.999; 3], [0.2, 0.5, 1e-4], [3e4, 0.1, 7.0], [1e-5; 3], [0.25, 0.5, 0.75]]
        {
            let back = unpack_color(pack_color(c));
            let brightest = c[0].max(c[1]).max(c[2]);
            for (a, b) in c.iter().zip(back) {
                assert!((a - b).abs() <= brightest / 512.0 + 1e-7, "{c:?} became {back:?}");
            }
        }
    }
}
