//! Light on surfaces, and how much of a pixel they cover.

use crate::camera::{Camera, turned};
use crate::options::Options;
use crate::vector::{Real, Vector};
use glam::Vec3;
use pointillist_view::Light;
use pulp::Simd;

/// Transmittance of all layers so far below which further layers are not drawn: half a step of an 8-bit picture.
pub(crate) const LEAST_LIGHT: f32 = 1.0 / 512.0;

/// How independent the edges of two layers are: between 1, where a layer covers its share of what those before leave
/// open, and 0, where it fills that first, as parts of one surface do. Found by experiment with a lens.
pub(crate) const INDEPENDENT: f32 = 0.4;

/// Shading of a frame.
#[derive(Clone, Debug)]
pub(crate) struct Shader {
    camera: Camera,
    /// Towards the light in the picture's axes; none if it comes from the eye.
    light: Option<Vec3>,
    ambient: f32,
    /// Color of all points, if they have none of their own.
    base: Option<Vec3>,
}

impl Shader {
    pub(crate) fn new(camera: &Camera, options: &Options, colored: bool) -> Self {
        let light = match options.light {
            Light::Eye => None,
            Light::Towards(d) => {
                Some(turned(&camera.view, (d / d.abs().max_element()).normalize()).as_vec3())
            }
        };
        Self {
            camera: camera.clone(),
            light,
            ambient: options.ambient,
            base: (!colored).then_some(options.base),
        }
    }

    /// Cosine between normal and light, 0 if it faces away.
    #[inline(always)]
    fn facing<S: Simd>(&self, normal: [Vector<S>; 3], at: (Vector<S>, Vector<S>)) -> Vector<S> {
        let cosine = match self.light {
            Some(light) => normal[0] * light.x + normal[1] * light.y + normal[2] * light.z,
            None => self.facing_eye(normal, at),
        };
        cosine.at_least(0.0).at_most(1.0)
    }

    /// Cosine between the normal and the direction to the eye.
    #[inline(always)]
    fn facing_eye<S: Simd>(&self, normal: [Vector<S>; 3], (x, y): (Vector<S>, Vector<S>)) -> Vector<S> {
        if !self.camera.is_perspective {
            return -normal[2];
        }
        let inverse = 1.0 / self.camera.focal;
        let x = (x - self.camera.centre[0] as f32) * inverse;
        let y = (y - self.camera.centre[1] as f32) * inverse;
        -(normal[0] * x + normal[1] * y + normal[2]) / (x * x + y * y + 1.0).sqrt()
    }

    /// Color × (A + (1 − A)·max(0, n·l)) of surfaces at places (x, y) of the picture, premultiplied as `paint` is.
    #[inline(always)]
    pub(crate) fn lit<S: Simd>(
        &self,
        (paint, opacity): ([Vector<S>; 3], Vector<S>),
        normal: [Vector<S>; 3],
        at: (Vector<S>, Vector<S>),
    ) -> [Vector<S>; 3] {
        let light = self.facing(normal, at) * (1.0 - self.ambient) + self.ambient;
        let [red, green, blue] = match self.base {
            Some(base) => base.to_array().map(|v| opacity * v),
            None => paint,
        };
        [red * light, green * light, blue * light]
    }

    /// Distance along the view axis of a bent depth.
    #[inline(always)]
    pub(crate) fn depth(&self, bent: f32) -> f32 {
        let depth = self.camera.world_depth(bent);
        if bent == f32::INFINITY { f32::INFINITY } else { depth }
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
#[inline(always)]
pub(crate) fn opacity<S: Simd>(sum: Vector<S>, sharpness: Vector<S>) -> Vector<S> {
    let covered = (sharpness * (sum - 0.5) + 0.5).at_least(0.0).at_most(1.0);
    // Sums inside a surface vary by a few per cent, which must not make it translucent.
    let squared = covered * covered;
    let to_fourth = squared * squared;
    (covered * (to_fourth * to_fourth * CLOSING + 1.0)).at_most(1.0)
}

/// Coefficient of the power that closes surfaces: with it, a coverage of 0.87 and more counts as 1. So high a power because
/// what it adds to lesser coverage makes outlines fat and blurred edges steep.
const CLOSING: f32 = 0.47;
