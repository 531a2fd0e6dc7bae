//! Light on surfaces, for as many pixels at a time as the processor computes together.

use crate::camera::Camera;
use crate::options::{Light, Options};
use glam::Vec3;
use pulp::Simd;

/// Light that passes all layers and is less than this is not followed: half a step of 8 bits.
pub(crate) const LEAST_LIGHT: f32 = 1.0 / 512.0;

/// How independent the edges of two layers are: between 1, where a layer covers its share of what those before leave open, and
/// 0, where it fills that first, as parts of one surface do. Found by experiment with a lens.
pub(crate) const INDEPENDENT: f32 = 0.4;

/// Shading of a frame.
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

    /// Cosine between the mean normal and the light, 0 if it faces away.
    #[inline(always)]
    fn facing<S: Simd>(&self, simd: S, normal: [S::f32s; 3], at: (S::f32s, S::f32s)) -> S::f32s {
        let cosine = match self.light {
            Some(light) => dot(simd, normal, light.to_array().map(|v| simd.splat_f32s(v))),
            None => self.facing_eye(simd, normal, at),
        };
        simd.min_f32s(simd.max_f32s(cosine, simd.splat_f32s(0.0)), simd.splat_f32s(1.0))
    }

    /// Cosine between the mean normal and the way to the eye.
    #[inline(always)]
    fn facing_eye<S: Simd>(&self, simd: S, normal: [S::f32s; 3], (x, y): (S::f32s, S::f32s)) -> S::f32s {
        if !self.camera.is_perspective {
            return simd.neg_f32s(normal[2]);
        }
        let centre = self.camera.centre.map(|c| simd.splat_f32s(c as f32 - 0.5));
        let inverse = simd.splat_f32s(-1.0 / self.camera.focal);
        let towards = [
            simd.mul_f32s(simd.sub_f32s(x, centre[0]), inverse),
            simd.mul_f32s(simd.sub_f32s(y, centre[1]), inverse),
            simd.splat_f32s(-1.0),
        ];
        simd.div_f32s(dot(simd, normal, towards), simd.sqrt_f32s(dot(simd, towards, towards)))
    }

    /// Colour × (A + (1 − A)·max(0, n·l)) in the pixels (x, y); a mean of normals is shorter than 1, as is the mean of their
    /// cosines.
    #[inline(always)]
    pub(crate) fn lit<S: Simd>(
        &self,
        simd: S,
        paint: [S::f32s; 3],
        normal: [S::f32s; 3],
        at: (S::f32s, S::f32s),
    ) -> [S::f32s; 3] {
        let sun = simd.splat_f32s(1.0 - self.ambient);
        let sun = simd.mul_f32s(sun, self.facing(simd, normal, at));
        let light = simd.add_f32s(simd.splat_f32s(self.ambient), sun);
        let paint = match self.base {
            Some(base) => base.to_array().map(|v| simd.splat_f32s(v)),
            None => paint,
        };
        [simd.mul_f32s(paint[0], light), simd.mul_f32s(paint[1], light), simd.mul_f32s(paint[2], light)]
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

#[inline(always)]
fn dot<S: Simd>(simd: S, a: [S::f32s; 3], b: [S::f32s; 3]) -> S::f32s {
    let sum = simd.add_f32s(simd.mul_f32s(a[0], b[0]), simd.mul_f32s(a[1], b[1]));
    simd.add_f32s(sum, simd.mul_f32s(a[2], b[2]))
}

/// How much of a pixel a surface covers, from the sum of its weights and the sharpness of its edge.
///
/// Weights of discs add up to about 1 inside a surface and fall to 0 over its edge, as wide as the discs: where
/// discs are wider than pixels, the edge is made as steep as a pixel shows it, about the place where half is covered.
#[inline(always)]
pub(crate) fn opacity<S: Simd>(simd: S, sum: S::f32s, sharpness: S::f32s) -> S::f32s {
    let (none, half, one) = (simd.splat_f32s(0.0), simd.splat_f32s(0.5), simd.splat_f32s(1.0));
    let covered = simd.add_f32s(half, simd.mul_f32s(sharpness, simd.sub_f32s(sum, half)));
    let covered = simd.min_f32s(simd.max_f32s(covered, none), one);
    // Sums inside a surface vary by a few per cent: it must not let light through for that.
    let closing = simd.mul_f32s(simd.splat_f32s(CLOSING), simd.mul_f32s(covered, covered));
    simd.min_f32s(simd.mul_f32s(covered, simd.add_f32s(one, closing)), one)
}

/// A coverage of 0.9 and more is taken for all.
const CLOSING: f32 = 0.15;
