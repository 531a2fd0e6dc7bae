//! Irradiance of order 2, to be evaluated often.

use crate::Sh;
use glam::{DMat4, DVec3, DVec4, Vec3, Vec4};

/// A₂·¼√(15/π) = √(15π)/16, of x² − y², and half of that of xy.
const C1: f64 = 0.429_042_765_404_891_7;
/// A₁·√(3/4π)/2 = √(3π)/6.
const C2: f64 = 0.511_663_353_973_244_2;
/// 3·C5.
const C3: f64 = 0.743_123_868_301_127_1;
/// A₀·√(1/4π) = √π/2.
const C4: f64 = 0.886_226_925_452_758;
/// A₂·¼√(5/π) = √(5π)/16.
const C5: f64 = 0.247_707_956_100_375_7;

/// E(n) = nᵀMn with n = (x, y, z, 1) (\[1\], eq. 11 and 12): a symmetric matrix per color.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IrradianceMatrix {
    /// Of x², y², z², 1, yz, xz, xy, x, y, z.
    terms: [DVec3; 10],
}

impl IrradianceMatrix {
    /// Makes it from bands 0 to 2. Missing bands count as 0, higher ones are ignored.
    #[must_use]
    pub fn new(sh: &Sh) -> Self {
        let c = |l, m| sh.coefficient(l, m);
        let terms = [
            c(2, 2) * C1,
            c(2, 2) * -C1,
            c(2, 0) * C3,
            c(0, 0) * C4 - c(2, 0) * C5,
            c(2, -1) * (2.0 * C1),
            c(2, 1) * (2.0 * C1),
            c(2, -2) * (2.0 * C1),
            c(1, 1) * (2.0 * C2),
            c(1, -1) * (2.0 * C2),
            c(1, 0) * (2.0 * C2),
        ];
        Self { terms }
    }

    /// M of red (0), green (1) or blue (2, and above).
    #[must_use]
    pub fn matrix(&self, channel: usize) -> DMat4 {
        let [xx, yy, zz, one, yz, xz, xy, x, y, z] = self.terms.map(|term| term[channel.min(2)]);
        DMat4::from_cols(
            DVec4::new(xx, 0.5 * xy, 0.5 * xz, 0.5 * x),
            DVec4::new(0.5 * xy, yy, 0.5 * yz, 0.5 * y),
            DVec4::new(0.5 * xz, 0.5 * yz, zz, 0.5 * z),
            DVec4::new(0.5 * x, 0.5 * y, 0.5 * z, one),
        )
    }

    /// E(n) for a normal of unit length.
    #[must_use]
    #[inline]
    pub fn at(&self, normal: DVec3) -> DVec3 {
        let [xx, yy, zz, one, yz, xz, xy, x, y, z] = self.terms;
        let DVec3 { x: nx, y: ny, z: nz } = normal;
        // Two independent chains of additions, which the processor computes in parallel.
        let squares = xx * (nx * nx) + yy * (ny * ny) + zz * (nz * nz) + one + yz * (ny * nz);
        let others = xz * (nx * nz) + xy * (nx * ny) + x * nx + y * ny + z * nz;
        squares + others
    }

    /// The same in single precision.
    #[must_use]
    pub fn to_irradiance(&self) -> Irradiance {
        let [xx, yy, zz, one, yz, xz, xy, x, y, z] = self.terms;
        // Of a unit normal z² = 1 − x² − y²: one term less, and no cancellation of large ones.
        let terms = [xx - zz, yy - zz, one + zz, yz, xz, xy, x, y, z];
        Irradiance { terms: terms.map(|term| term.as_vec3().extend(0.0)) }
    }
}

/// [`IrradianceMatrix`] in single precision, as renderers use it: about 1e-7 of the largest irradiance; infinite for
/// coefficients beyond the range of `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Irradiance {
    /// Of x² − z², y² − z², 1 + z², yz, xz, xy, x, y, z; four numbers each, as vector registers have them.
    terms: [Vec4; 9],
}

impl Irradiance {
    /// As [`IrradianceMatrix::new`].
    #[must_use]
    pub fn new(sh: &Sh) -> Self {
        IrradianceMatrix::new(sh).to_irradiance()
    }

    /// No light.
    pub const DARK: Self = Self { terms: [Vec4::ZERO; 9] };

    /// Adds a share of another's light.
    #[inline]
    pub fn add_scaled(&mut self, other: &Self, weight: f32) {
        self.terms.iter_mut().zip(&other.terms).for_each(|(sum, term)| *sum += *term * weight);
    }

    /// E(n) for a normal of unit length.
    #[must_use]
    #[inline]
    pub fn at(&self, normal: Vec3) -> Vec3 {
        let [xx, yy, one, yz, xz, xy, x, y, z] = self.terms;
        let Vec3 { x: nx, y: ny, z: nz } = normal;
        let along_x = (x + xx * nx + xy * ny) * nx;
        let along_y = (y + yy * ny + yz * nz) * ny;
        let along_z = (z + xz * nx) * nz;
        (along_x + along_y + (along_z + one)).truncate()
    }
}
