//! Panoramas to cube maps.

use crate::ShError;
use crate::{CubeMap, CubePoint, Panorama, cube_direction};
use glam::{DVec3, dvec3};

impl Panorama {
    /// A cube map of this panorama. Each texel is the mean of k×k bilinear samples, weighted by their solid angles,
    /// with k such that no pixel is missed: samples are at most a pixel's width at the horizon apart.
    ///
    /// # Errors
    /// `CubeSize`.
    pub fn to_cube(&self, size: usize) -> Result<CubeMap, ShError> {
        // In the middle of a face a texel is 2/size wide, and a pixel 2π/width or π/height.
        let pixels = self.width().max(2 * self.height()) as f64;
        let samples = (pixels / (std::f64::consts::PI * size.max(1) as f64)).ceil() as usize;
        let half_texel = 1.0 / size.max(1) as f64;
        CubeMap::from_fn(size, |centre| self.mean_around(centre, half_texel, samples.max(1)))
    }

    /// The mean over a texel about a direction.
    fn mean_around(&self, centre: DVec3, half_texel: f64, samples: usize) -> DVec3 {
        let Some(middle) = crate::cube_point(centre) else { return DVec3::ZERO };
        let offset = |i: usize| half_texel * ((2 * i + 1) as f64 / samples as f64 - 1.0);
        let (mut sum, mut total) = (DVec3::ZERO, 0.0);
        for i in 0..samples * samples {
            let (s, t) = (middle.s + offset(i % samples), middle.t + offset(i / samples));
            let way = cube_direction(CubePoint { s, t, ..middle });
            let weight = way.length_squared().powf(-1.5);
            let [r, g, b] = self.at(way).to_array().map(f64::from);
            sum += weight * dvec3(r, g, b);
            total += weight;
        }
        sum / total
    }
}
