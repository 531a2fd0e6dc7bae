//! The background: what a pixel shows where no surface covers it.

use crate::scene::Scene;
use glam::{DVec2, DVec3, Vec3};
use pointillist_micropoint::{MicropointError, TexelCorner, TexelSums, TexelWrap};
use pointillist_shade::{cube_direction, cube_place};
use pointillist_view::View;
use std::f64::consts::{PI, TAU};

/// A picture of all directions, ready for means over any part of it.
pub(crate) enum Panorama {
    Equirectangular(TexelSums<3>),
    /// The faces of a cube, in the order of [`cube_direction`].
    Cube(Vec<TexelSums<3>>),
}

/// A constant colour or a picture of all directions.
pub(crate) struct Background<'a> {
    color: Vec3,
    environment: Option<&'a Panorama>,
    view: View,
}

/// The scene's environment, summed up.
pub(crate) fn sum_up_environment(scene: &Scene) -> Result<Option<Panorama>, MicropointError> {
    let Some(i) = scene.image.environment else { return Ok(None) };
    let t = &scene.textures[i];
    let texel = |x, y| t.texel(x, y).truncate().to_array();
    if !t.is_cube() {
        let sums = TexelSums::new(t.width, t.height, TexelWrap::Repeat, texel)?;
        return Ok(Some(Panorama::Equirectangular(sums)));
    }
    let n = t.width;
    let face = |face: u32| TexelSums::new(n, n, TexelWrap::Clamp, |x, y| texel(x, face * n + y));
    (0..6).map(face).collect::<Result<_, _>>().map(|faces| Some(Panorama::Cube(faces)))
}

/// The middle and the corners of a pixel, from its upper left one.
const MIDDLE: DVec2 = DVec2::splat(0.5);
const CORNERS: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];

impl<'a> Background<'a> {
    pub(crate) fn new(scene: &Scene, environment: Option<&'a Panorama>, view: &View) -> Self {
        Self { color: scene.image.background, environment, view: *view }
    }

    /// Mean radiance behind a pixel.
    pub(crate) fn behind(&self, x: u32, y: u32) -> Vec3 {
        let towards = |at: DVec2| self.view.ray(DVec2::new(f64::from(x), f64::from(y)) + at).direction;
        match self.environment {
            None => self.color,
            Some(Panorama::Equirectangular(map)) => mean_of_panorama(map, towards),
            Some(Panorama::Cube(faces)) => mean_of_cube(faces, towards),
        }
    }
}

fn mean_of_panorama(map: &TexelSums<3>, towards: impl Fn(DVec2) -> DVec3) -> Vec3 {
    let size = DVec2::new(f64::from(map.width()), f64::from(map.height()));
    let at = |place: DVec2| equirectangular(towards(place)) * size;
    let middle = at(MIDDLE);
    mean(map, |corner| {
        let mut texel = at(corner);
        // The map's left and right border are one meridian.
        texel.x -= ((texel.x - middle.x) / size.x).round() * size.x;
        texel
    })
}

/// The mean over the face that the pixel's middle sees. What of a pixel lies beyond that face has the colour of the face's rim.
fn mean_of_cube(faces: &[TexelSums<3>], towards: impl Fn(DVec2) -> DVec3) -> Vec3 {
    let (face, ..) = cube_place(towards(MIDDLE));
    let map = &faces[face];
    let outward = cube_direction(face, 0.0, 0.0);
    let (right, down) = (cube_direction(face, 1.0, 0.0) - outward, cube_direction(face, 0.0, 1.0) - outward);
    let half = 0.5 * f64::from(map.width());
    mean(map, |corner| {
        let d = towards(corner);
        // A corner of a very wide pixel may be behind the face.
        let depth = d.dot(outward).max(LEAST_DEPTH * d.length());
        (DVec2::new(d.dot(right), d.dot(down)) / depth + 1.0) * half
    })
}

/// The cosine at which a direction is as good as parallel to a face: 89.4° from its middle.
const LEAST_DEPTH: f64 = 0.01;

/// Mean over a pixel from where its corners lie on a map.
fn mean(map: &TexelSums<3>, texel: impl Fn(DVec2) -> DVec2) -> Vec3 {
    let corners = CORNERS.map(|grid| TexelCorner { grid, rational: 1.0, texel: texel(grid) });
    let mean = map.mean(&corners);
    Vec3::new(mean[0] as f32, mean[1] as f32, mean[2] as f32)
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
