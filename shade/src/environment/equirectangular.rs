//! Maps with longitude along the rows and latitude along the columns.

use crate::ShadeError;
use glam::{DVec2, DVec3, Vec3, dvec2};
use std::f64::consts::{PI, TAU};

/// Where a direction lies on the map, as shares of width and height: row 0 is +Y, the centre column looks along −Z,
/// columns run to +X. Any length but zero will do.
#[must_use]
pub fn equirectangular_uv(direction: DVec3) -> DVec2 {
    let d = direction;
    let u = 0.5 + d.x.atan2(-d.z) / TAU;
    let latitude = d.y.atan2(d.x.hypot(d.z));
    dvec2(u, 0.5 - latitude / PI)
}

/// The unit vector of a place on the map; the inverse of [`equirectangular_uv`].
#[must_use]
pub fn equirectangular_direction(uv: DVec2) -> DVec3 {
    let longitude = (uv.x - 0.5) * TAU;
    let latitude = (0.5 - uv.y) * PI;
    let (r, y) = (latitude.cos(), latitude.sin());
    DVec3::new(r * longitude.sin(), y, -r * longitude.cos())
}

/// An equirectangular map's texels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equirectangular<'a> {
    texels: &'a [Vec3],
    width: usize,
    height: usize,
    /// Means of the first and the last row.
    poles: [Vec3; 2],
}

impl<'a> Equirectangular<'a> {
    /// A map of `width` · `height` texels, row by row from the zenith.
    ///
    /// # Errors
    ///
    /// No texels, or another number of them.
    pub fn new(texels: &'a [Vec3], width: u32, height: u32) -> Result<Self, ShadeError> {
        if width == 0 || height == 0 || texels.len() as u64 != u64::from(width) * u64::from(height) {
            return Err(ShadeError::TextureSize { len: texels.len(), width, height });
        }
        let (width, height) = (width as usize, height as usize);
        let mean = |row: &[Vec3]| row.iter().sum::<Vec3>() / width as f32;
        let poles = [mean(&texels[..width]), mean(&texels[texels.len() - width..])];
        Ok(Self { texels, width, height, poles })
    }

    /// Radiance from a direction, interpolated between four texels: continuous everywhere, over the ±180° column and the poles,
    /// too.
    #[must_use]
    pub fn sample(&self, direction: DVec3) -> Vec3 {
        let uv = equirectangular_uv(direction);
        let x = uv.x * self.width as f64 - 0.5;
        let y = uv.y * self.height as f64 - 0.5;
        let (fx, fy) = ((x - x.floor()) as f32, (y - y.floor()) as f32);
        let (x, y) = (x.floor() as i64, y.floor() as i64);
        let row = |y: i64| self.texel(x, y).lerp(self.texel(x + 1, y), fx);
        row(y).lerp(row(y + 1), fy)
    }

    /// Beyond a pole the value is mirrored about the row's mean, so that the pole itself has that mean from every side. (The
    /// opposite meridian would do, too, where the width is even.)
    fn texel(&self, x: i64, y: i64) -> Vec3 {
        let column = |x: i64| x.rem_euclid(self.width as i64) as usize;
        let inside = y.clamp(0, self.height as i64 - 1);
        let row = &self.texels[inside as usize * self.width..][..self.width];
        if y == inside { row[column(x)] } else { 2.0 * self.poles[usize::from(y > inside)] - row[column(x)] }
    }
}
