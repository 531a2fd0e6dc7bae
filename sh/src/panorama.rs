//! Equirectangular images.

use crate::ShError;
use glam::{DVec3, Vec3, dvec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Radiance in all directions as an equirectangular image: row 0 is at the zenith (+Y), the centre column looks along
/// −Z, and columns run towards +X.
#[derive(Clone, Debug, PartialEq)]
pub struct Panorama {
    width: usize,
    height: usize,
    planes: [Vec<f32>; 3],
}

impl Panorama {
    /// The largest number of pixels along a side.
    pub const MAX_SIDE: usize = 1 << 16;

    /// From colors in rows from the top.
    ///
    /// # Errors
    /// `PanoramaSize` if there is not one color per pixel, or a side is 0 or above [`Panorama::MAX_SIDE`];
    /// `PixelNotFinite`.
    pub fn new(width: usize, height: usize, pixels: &[[f32; 3]]) -> Result<Self, ShError> {
        Self::from_planes(width, height, std::array::from_fn(|c| pixels.iter().map(|p| p[c]).collect()))
    }

    /// From red, green and blue, each in rows from the top.
    ///
    /// # Errors
    /// As [`Panorama::new`].
    pub fn from_planes(width: usize, height: usize, planes: [Vec<f32>; 3]) -> Result<Self, ShError> {
        let expected = pixel_count(width, height)?;
        let is_right = |plane: &Vec<f32>| plane.len() == expected;
        if let Some(wrong) = planes.iter().find(|plane| !is_right(plane)) {
            return Err(ShError::PanoramaSize { width, height, count: wrong.len() });
        }
        let first = planes.iter().filter_map(|plane| plane.iter().position(|v| !v.is_finite())).min();
        match first {
            Some(i) => Err(ShError::PixelNotFinite { x: i % width, y: i / width }),
            None => Ok(Self { width, height, planes }),
        }
    }

    /// The radiance that `f` returns for the direction of each pixel's centre.
    ///
    /// # Errors
    /// As [`Panorama::new`].
    pub fn from_fn(width: usize, height: usize, f: impl Fn(DVec3) -> DVec3) -> Result<Self, ShError> {
        let count = pixel_count(width, height)?;
        let pixel = |i: usize| {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
            f(direction(x / width as f64, y / height as f64)).as_vec3().to_array()
        };
        Self::new(width, height, &(0..count).map(pixel).collect::<Vec<_>>())
    }

    /// Pixels in a row.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Red, green and blue.
    #[must_use]
    pub const fn planes(&self) -> &[Vec<f32>; 3] {
        &self.planes
    }

    /// The unit direction of a pixel's centre.
    #[must_use]
    pub fn pixel_direction(&self, x: usize, y: usize) -> DVec3 {
        direction((x as f64 + 0.5) / self.width as f64, (y as f64 + 0.5) / self.height as f64)
    }

    /// The solid angle of each pixel of a row, Δφ·(cos θ₀ − cos θ₁); 0 outside.
    #[must_use]
    pub fn solid_angle(&self, y: usize) -> f64 {
        if y >= self.height { 0.0 } else { solid_angle(self.width, self.height, y) }
    }

    /// Radiance from a direction of any length but 0, bilinear between the centres of pixels, around the seam and over
    /// the poles.
    #[must_use]
    pub fn at(&self, direction: DVec3) -> Vec3 {
        let DVec3 { x, y, z } = direction;
        let u = x.atan2(-z) / TAU + 0.5;
        let v = (x.hypot(z)).atan2(y) * FRAC_1_PI;
        let (u, v) = (u * self.width as f64 - 0.5, v * self.height as f64 - 0.5);
        let (column, row) = (u.floor(), v.floor());
        let (fu, fv) = ((u - column) as f32, (v - row) as f32);
        let pixel = |i, j| self.pixel(column as isize + i, row as isize + j);
        pixel(0, 0).lerp(pixel(1, 0), fu).lerp(pixel(0, 1).lerp(pixel(1, 1), fu), fv)
    }

    /// A pixel at most one row beyond a pole, where the other side begins.
    fn pixel(&self, x: isize, y: isize) -> Vec3 {
        let (width, height) = (self.width as isize, self.height as isize);
        let inside = y.clamp(0, height - 1);
        let x = if inside == y { x } else { x + width / 2 };
        let index = (inside * width + x.rem_euclid(width)) as usize;
        self.planes.each_ref().map(|plane| plane[index]).into()
    }
}

/// Width times height, or an error if a side is 0 or above [`Panorama::MAX_SIDE`].
pub(crate) fn pixel_count(width: usize, height: usize) -> Result<usize, ShError> {
    let range = 1..=Panorama::MAX_SIDE;
    if range.contains(&width) && range.contains(&height) {
        Ok(width * height)
    } else {
        Err(ShError::PanoramaSize { width, height, count: 0 })
    }
}

pub(crate) fn solid_angle(width: usize, height: usize, y: usize) -> f64 {
    let step = PI / height as f64;
    // cos a − cos b = 2·sin((a + b)/2)·sin((b − a)/2), without the cancellation.
    TAU / width as f64 * 2.0 * ((y as f64 + 0.5) * step).sin() * (0.5 * step).sin()
}

/// The direction of a position in the image, from 0 at the left and top to 1.
fn direction(u: f64, v: f64) -> DVec3 {
    let (sin_phi, cos_phi) = (TAU * (u - 0.5)).sin_cos();
    let (sin_theta, cos_theta) = (PI * v).sin_cos();
    dvec3(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
}
