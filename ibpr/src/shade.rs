//! From surfaces to colours.

use crate::options::{Light, Options};
use crate::view::BufferMap;
use glam::Vec3;

/// Shading and output of a frame: everything in the camera's frame (right, up, back).
pub(crate) struct Shader {
    light: Option<Vec3>,
    ambient: f32,
    base: Vec3,
    /// World axes of the camera's frame.
    axes: [Vec3; 3],
    /// Slopes of the rays: (px − centre) · slope.
    centre: (f32, f32),
    ray_slope: f32,
    bend: f32,
    reference: f64,
    unit: f64,
}

impl Shader {
    /// `map` is that of the picture itself or of any buffer of the frame.
    pub(crate) fn new(map: &BufferMap, options: &Options) -> Self {
        let v = &map.view;
        let light = match options.light {
            Light::Eye => None,
            Light::Towards(d) => {
                let d = d.normalize();
                Some(Vec3::new(d.dot(v.right) as f32, d.dot(v.up) as f32, -d.dot(v.forward) as f32))
            }
        };
        let (x, y) = map.centre();
        let ray_slope = if v.is_perspective() { 1.0 / v.focal_px() } else { 0.0 };
        Self {
            light,
            ambient: options.ambient,
            base: options.base,
            axes: [v.right.as_vec3(), v.up.as_vec3(), -v.forward.as_vec3()],
            centre: ((x * map.scale) as f32, (y * map.scale) as f32),
            ray_slope: ray_slope as f32,
            bend: map.bend(),
            reference: map.reference,
            unit: map.unit,
        }
    }

    /// Unit normal in the camera's frame.
    pub(crate) fn normal(surface: &[f32; 4]) -> Vec3 {
        Vec3::new(surface[1], surface[2], surface[3]).normalize_or(Vec3::Z)
    }

    /// Colour × (A + (1 − A)·max(0, n·l)) at the centre of pixel (x, y).
    pub(crate) fn colour(&self, x: usize, y: usize, n: Vec3, colour: Option<Vec3>) -> Vec3 {
        let facing = match self.light {
            Some(l) => n.dot(l),
            None => {
                let u = (x as f32 + 0.5 - self.centre.0) * self.ray_slope;
                let v = (y as f32 + 0.5 - self.centre.1) * self.ray_slope;
                n.dot(Vec3::new(-u, v, 1.0)) / (1.0 + u * u + v * v).sqrt()
            }
        };
        colour.unwrap_or(self.base) * (self.ambient + (1.0 - self.ambient) * facing.max(0.0))
    }

    pub(crate) fn world(&self, n: Vec3) -> Vec3 {
        n.x * self.axes[0] + n.y * self.axes[1] + n.z * self.axes[2]
    }

    /// Distance along the view axis in world units.
    pub(crate) fn depth(&self, q: f32) -> f32 {
        let d = f64::from(q / (1.0 - self.bend * q));
        ((d + self.reference) * self.unit) as f32
    }
}
