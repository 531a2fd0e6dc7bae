//! From the sums of a pixel to its colour.

use crate::camera::Camera;
use crate::options::{Light, Options};
use crate::tile::Sums;
use glam::Vec3;

/// A pixel while layers are laid under one another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pixel {
    /// Premultiplied colour and opacity.
    pub(crate) colour: [f32; 4],
    /// Bent depth and normal (in the picture's axes) of the layer that made it half opaque; the depth is +∞ before.
    pub(crate) depth: f32,
    pub(crate) normal: [f32; 3],
}

impl Pixel {
    pub(crate) const EMPTY: Self = Self { colour: [0.0; 4], depth: f32::INFINITY, normal: [0.0; 3] };
}

/// Light that passes all layers and is less than this is not followed: half a step of 8 bits.
const LEAST_LIGHT: f32 = 1.0 / 512.0;

/// How independent the edges of two layers are: between 1, where a layer covers its share of what those before leave open, and
/// 0, where it fills that first, as parts of one surface do. Found by experiment with a lens.
const INDEPENDENT: f32 = 0.4;

/// Shading and compositing of a frame.
#[derive(Clone, Debug)]
pub(crate) struct Shader {
    camera: Camera,
    /// Towards the light in the picture's axes; none if it comes from the eye.
    light: Option<Vec3>,
    ambient: f32,
    /// Colour of all points, if they have none of their own.
    base: Option<Vec3>,
}

impl Shader {
    pub(crate) fn new(camera: &Camera, options: &Options, coloured: bool) -> Self {
        let light = match options.light {
            Light::Eye => None,
            Light::Towards(d) => Some(camera.view.turned((d / d.abs().max_element()).normalize()).as_vec3()),
        };
        Self {
            camera: camera.clone(),
            light,
            ambient: options.ambient,
            base: (!coloured).then_some(options.base),
        }
    }

    /// Lays a surface with these sums and this opacity under what is in a pixel; whether nothing below can be seen.
    pub(crate) fn lay_under(&self, pixel: &mut Pixel, sums: &Sums, alpha: f32, at: (usize, usize)) -> bool {
        let inverse = 1.0 / sums[0];
        let normal = Vec3::new(sums[2], sums[3], sums[4]) * inverse;
        let paint = Vec3::new(sums[5], sums[6], sums[7]) * inverse;
        let shaded = self.lit(paint, normal, at);
        let before = pixel.colour[3];
        let share = (alpha * (1.0 - INDEPENDENT * before)).min(1.0 - before);
        for (c, s) in pixel.colour.iter_mut().zip([shaded.x, shaded.y, shaded.z, 1.0]) {
            *c += share * s;
        }
        if before < 0.5 && pixel.colour[3] >= 0.5 {
            pixel.depth = sums[1] * inverse;
            pixel.normal = normal.to_array();
        }
        1.0 - pixel.colour[3] <= LEAST_LIGHT
    }

    /// Cosine between the mean normal and the light, 0 if it faces away.
    fn facing(&self, normal: Vec3, at: (usize, usize)) -> f32 {
        let towards = self.light.unwrap_or_else(|| self.towards_eye(at));
        normal.dot(towards).clamp(0.0, 1.0)
    }

    /// Colour × (A + (1 − A)·max(0, n·l)); a mean of normals is shorter than 1, as is the mean of their cosines.
    pub(crate) fn lit(&self, paint: Vec3, normal: Vec3, at: (usize, usize)) -> Vec3 {
        let paint = self.base.unwrap_or(paint);
        paint * (self.ambient + (1.0 - self.ambient) * self.facing(normal, at))
    }

    fn towards_eye(&self, at: (usize, usize)) -> Vec3 {
        if !self.camera.is_perspective {
            return Vec3::NEG_Z;
        }
        let slope =
            |v: usize, axis: usize| (v as f32 + 0.5 - self.camera.centre[axis] as f32) / self.camera.focal;
        -Vec3::new(slope(at.0, 0), slope(at.1, 1), 1.0).normalize()
    }

    /// Distance of a pixel along the view axis.
    pub(crate) fn depth(&self, pixel: &Pixel) -> f32 {
        if pixel.depth == f32::INFINITY { f32::INFINITY } else { self.camera.world_depth(pixel.depth) }
    }

    /// Unit vector in the world along one in the picture's axes.
    pub(crate) fn in_world(&self, v: Vec3) -> [f32; 3] {
        let [right, down, forward] = self.camera.axes;
        (right * v.x + down * v.y + forward * v.z).normalize_or_zero().to_array()
    }
}

/// How much of a pixel a surface covers, from the sum of its weights and the sharpness of its edge.
///
/// Weights of discs add up to about 1 inside a surface and fall to 0 over its edge, as wide as the discs: where
/// discs are wider than pixels, the edge is made as steep as a pixel shows it, about the place where half is covered.
pub(crate) fn opacity(sum: f32, sharpness: f32) -> f32 {
    let covered = (0.5 + sharpness * (sum - 0.5)).clamp(0.0, 1.0);
    // Sums inside a surface vary by a few per cent: it must not let light through for that.
    (covered * (1.0 + CLOSING * covered * covered)).min(1.0)
}

/// A coverage of 0.9 and more is taken for all.
const CLOSING: f32 = 0.15;
