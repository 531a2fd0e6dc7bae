//! The background: what a pixel shows where no surface covers it.

use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use pointillist_micropoint::{MicropointError, TexelCorner, TexelSums, TexelWrap};
use pointillist_view::View;
use std::f64::consts::{PI, TAU};

/// A constant colour or an equirectangular environment.
pub(crate) struct Background<'a> {
    color: Vec3,
    environment: Option<&'a TexelSums<3>>,
    view: View,
}

/// The scene's environment, ready for means over any part of it.
pub(crate) fn sum_up_environment(scene: &Scene) -> Result<Option<TexelSums<3>>, MicropointError> {
    let Some(i) = scene.image.environment else { return Ok(None) };
    let t = &scene.textures[i];
    let texel = |x, y| t.texel(x, y).truncate().to_array();
    TexelSums::new(t.width, t.height, TexelWrap::Repeat, texel).map(Some)
}

impl<'a> Background<'a> {
    pub(crate) fn new(scene: &Scene, environment: Option<&'a TexelSums<3>>, view: &View) -> Self {
        Self { color: scene.image.background, environment, view: *view }
    }

    /// Mean radiance behind a pixel.
    pub(crate) fn behind(&self, x: u32, y: u32) -> Vec3 {
        let Some(map) = &self.environment else { return self.color };
        let size = DVec2::new(f64::from(map.width()), f64::from(map.height()));
        let at = |dx: f64, dy: f64| {
            let pixel = DVec2::new(f64::from(x) + dx, f64::from(y) + dy);
            equirectangular(self.view.ray(pixel).direction) * size
        };
        let middle = at(0.5, 0.5);
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(dx, dy)| {
            let mut texel = at(dx, dy);
            // The map's left and right border are one meridian.
            texel.x -= ((texel.x - middle.x) / size.x).round() * size.x;
            TexelCorner { grid: DVec2::new(dx, dy), rational: 1.0, texel }
        });
        let mean = map.mean(&corners);
        Vec3::new(mean[0] as f32, mean[1] as f32, mean[2] as f32)
    }
}

/// Where a direction lies on the map, 0..=1: row 0 is +Y, the centre looks along −Z, columns run to +X.
fn equirectangular(d: DVec3) -> DVec2 {
    let u = 0.5 + d.x.atan2(-d.z) / TAU;
    let v = d.y.atan2(d.x.hypot(d.z));
    DVec2::new(u, 0.5 - v / PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_map_is_laid_out_as_documented() {
        let close = |a: DVec2, x, y| (a - DVec2::new(x, y)).length() < 1e-12;
        assert!(close(equirectangular(DVec3::NEG_Z), 0.5, 0.5));
        assert!(close(equirectangular(DVec3::X), 0.75, 0.5));
        assert!(equirectangular(DVec3::Y).y == 0.0);
    }
}
