//! Measured BRDFs in MERL's binary format \[12\].

use crate::{Incident, ShadeError, material::finite};
use glam::{Vec3, vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Bins along θ_half, θ_difference and φ_difference.
pub const MERL_DIMENSIONS: [usize; 3] = [90, 90, 180];

const BINS: usize = MERL_DIMENSIONS[0] * MERL_DIMENSIONS[1] * MERL_DIMENSIONS[2];

/// What stored red, green and blue are multiplied by, as in the database's own reader \[12\].
const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Bytes of the header: three counts.
const HEADER: usize = 12;

/// An isotropic BRDF as a table over half and difference angles \[13\].
///
/// Bins along θ_half are even in its square root (dense near the highlight), along the others even in the angle;
/// φ_difference runs over half a turn, the other half being the same by reciprocity. Values between the bins'
/// centres are interpolated in all three, and beyond the outermost centres stay as there.
#[derive(Clone, Debug, PartialEq)]
pub struct MerlTable {
    /// φ_difference fastest, θ_half slowest.
    bins: Vec<[f32; 3]>,
}

impl MerlTable {
    /// Reads a file's bytes: three little-endian `i32` (90, 90, 180), then all red, all green and all blue values as `f64`.
    ///
    /// Negative values mark what could not be measured and count as 0.
    ///
    /// # Errors
    ///
    /// Other dimensions, another length, a value that is not finite.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, ShadeError> {
        let Some((header, body)) = bytes.split_at_checked(HEADER) else {
            return Err(ShadeError::MerlSize { len: bytes.len(), wanted: HEADER + 24 * BINS });
        };
        let number = |i: usize| i32::from_le_bytes(std::array::from_fn(|k| header[4 * i + k]));
        let found = [number(0), number(1), number(2)];
        if found.map(i64::from) != MERL_DIMENSIONS.map(|n| n as i64) {
            return Err(ShadeError::MerlDimensions { found });
        }
        if body.len() != 24 * BINS {
            return Err(ShadeError::MerlSize { len: bytes.len(), wanted: HEADER + 24 * BINS });
        }
        let mut bins = vec![[0.0; 3]; BINS];
        let values = body.chunks_exact(8).map(|b| f64::from_le_bytes(std::array::from_fn(|k| b[k])));
        for (index, value) in values.enumerate() {
            let scaled = (value.max(0.0) * SCALES[index / BINS]) as f32;
            if !value.is_finite() || !scaled.is_finite() {
                return Err(ShadeError::MerlValue { index });
            }
            bins[index % BINS][index / BINS] = scaled;
        }
        Ok(Self { bins })
    }

    /// The table of a function of `(to_light, to_eye)`, unit vectors about the normal +Z, asked at every bin's centre.
    ///
    /// Directions may lie below the surface; negative and non-finite values are stored as 0.
    #[must_use]
    pub fn tabulate(brdf: impl Fn(Vec3, Vec3) -> Vec3) -> Self {
        let [halves, thetas, phis] = MERL_DIMENSIONS;
        let mut bins = Vec::with_capacity(BINS);
        for i in 0..BINS {
            let centre = |index: usize, count: usize| (index as f32 + 0.5) / count as f32;
            let half = centre(i / (thetas * phis), halves).powi(2) * FRAC_PI_2;
            let theta = centre(i / phis % thetas, thetas) * FRAC_PI_2;
            let phi = centre(i % phis, phis) * PI;
            let (to_light, to_eye) = directions(half, theta, phi);
            let value = brdf(to_light, to_eye);
            bins.push(value.to_array().map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 }));
        }
        Self { bins }
    }

    /// The file of this table; [`MerlTable::from_bytes`] reads it back to the rounding of `f32`.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + 24 * BINS);
        MERL_DIMENSIONS.iter().for_each(|&n| bytes.extend((n as i32).to_le_bytes()));
        for (channel, scale) in SCALES.iter().enumerate() {
            let values = self.bins.iter().map(|bin| f64::from(bin[channel]) / scale);
            values.for_each(|value| bytes.extend(value.to_le_bytes()));
        }
        bytes
    }

    /// The BRDF; 0 where light or eye is below the surface. All three are unit vectors away from the surface.
    #[must_use]
    pub fn brdf(&self, normal: Vec3, to_light: Vec3, to_eye: Vec3) -> Vec3 {
        if !(normal.dot(to_light) > 0.0 && normal.dot(to_eye) > 0.0) {
            return Vec3::ZERO;
        }
        let [half, theta, phi] = angles(normal, to_light, to_eye);
        let [halves, thetas, phis] = MERL_DIMENSIONS;
        let (h0, h1, fh) = inside((half / FRAC_PI_2).max(0.0).sqrt(), halves);
        let (t0, t1, ft) = inside(theta / FRAC_PI_2, thetas);
        let (p0, p1, fp) = around(phi / PI, phis);
        let bin = |h: usize, t: usize, p: usize| Vec3::from_array(self.bins[(h * thetas + t) * phis + p]);
        let row = |h: usize, t: usize| bin(h, t, p0).lerp(bin(h, t, p1), fp);
        let sheet = |h: usize| row(h, t0).lerp(row(h, t1), ft);
        sheet(h0).lerp(sheet(h1), fh)
    }

    /// Radiance towards `to_eye` of what arrives: BRDF · irradiance · cosine.
    #[must_use]
    pub fn reflect(&self, incident: &Incident, normal: Vec3, to_eye: Vec3) -> Vec3 {
        let cos_light = normal.dot(incident.to_light);
        if cos_light <= 0.0 || incident.is_dark() {
            return Vec3::ZERO;
        }
        finite(self.brdf(normal, incident.to_light, to_eye) * incident.irradiance * cos_light)
    }

    /// Directional albedo for an eye at normal incidence, by [`crate::directional_albedo`]: what stands for the whole table
    /// where one color is needed.
    #[must_use]
    pub fn albedo(&self) -> Vec3 {
        crate::directional_albedo(Vec3::Z, 64, |l, v| self.brdf(Vec3::Z, l, v)).min(Vec3::ONE)
    }
}

/// θ_half, θ_difference and φ_difference in [0, π) \[13\].
///
/// Angles come from sines and cosines together, so that none loses its digits near 0.
fn angles(n: Vec3, l: Vec3, v: Vec3) -> [f32; 3] {
    let h = (l + v).normalize_or(n);
    let half = n.cross(h).length().atan2(n.dot(h));
    let theta = h.cross(l).length().atan2(h.dot(l));
    // The axes about h: y at right angles to the plane of n and h; anything where they coincide.
    let y = n.cross(h).normalize_or(n.any_orthonormal_vector());
    let x = y.cross(h);
    let phi = l.dot(y).atan2(l.dot(x));
    [half, theta.min(FRAC_PI_2), if phi < 0.0 { phi + PI } else { phi }]
}

/// The inverse of [`angles`], about the normal +Z.
fn directions(half: f32, theta: f32, phi: f32) -> (Vec3, Vec3) {
    let h = vec3(half.sin(), 0.0, half.cos());
    let (x, y) = (vec3(half.cos(), 0.0, -half.sin()), Vec3::Y);
    let l = theta.sin() * phi.cos() * x + theta.sin() * phi.sin() * y + theta.cos() * h;
    (l, 2.0 * l.dot(h) * h - l)
}

/// The bins whose centres lie about a coordinate in [0, 1], and the weight of the second; no more than the outermost.
fn inside(x: f32, count: usize) -> (usize, usize, f32) {
    let place = (x * count as f32 - 0.5).clamp(0.0, (count - 1) as f32);
    let low = (place as usize).min(count - 2);
    (low, low + 1, place - low as f32)
}

/// The same where the last bin is next to the first.
fn around(x: f32, count: usize) -> (usize, usize, f32) {
    let place = x * count as f32 - 0.5;
    let low = place.floor();
    let bin = |i: f32| (i as i64).rem_euclid(count as i64) as usize;
    (bin(low), bin(low + 1.0), place - low)
}
