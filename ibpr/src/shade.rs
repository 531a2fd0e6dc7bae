//! From surfaces to colours.

use crate::options::{Light, Options};
use crate::pixels::{Fragment, Nearest};
use crate::raster::Paint;
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
    fn normal(surface: &[f32; 4]) -> Vec3 {
        Vec3::new(surface[1], surface[2], surface[3]).normalize_or(Vec3::Z)
    }

    /// Colour × (A + (1 − A)·max(0, n·l)) at the centre of pixel (x, y).
    fn colour(&self, x: usize, y: usize, n: Vec3, colour: Option<Vec3>) -> Vec3 {
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

    #[inline]
    fn shaded(&self, surface: &[f32; 4], place: (usize, usize), paint: Option<&Paint>) -> (Vec3, Vec3) {
        let n = Self::normal(surface);
        (self.colour(place.0, place.1, n, paint.map(|p| Vec3::from_slice(&p[..3]))), n)
    }

    /// The nearest surface of a pixel, with a rim in front of it blended over what is behind.
    pub(crate) fn nearest(
        &self,
        pixels: &Nearest,
        i: usize,
        place: (usize, usize),
        coloured: bool,
    ) -> Shaded {
        let (solid, cover) = (&pixels.solid[i], pixels.rim_cover[i]);
        let has_solid = solid[0] < f32::INFINITY;
        let has_rim = cover > 0.0 && pixels.rim[i][0] < solid[0];
        let mut out = Shaded::NOTHING;
        let paint_of = |paints: &'_ [Paint]| paints.get(i).copied();
        if has_solid {
            let paint = paint_of(&pixels.solid_paint);
            let (c, n) = self.shaded(solid, place, paint.as_ref().filter(|_| coloured));
            out.blend(c, if has_rim { 1.0 - cover } else { 1.0 });
            out.show(self, solid[0], n, paint);
        }
        if has_rim {
            let paint = paint_of(&pixels.rim_paint);
            let (c, n) = self.shaded(&pixels.rim[i], place, paint.as_ref().filter(|_| coloured));
            out.blend(c, cover);
            // Depth and normal are those of the surface that covers more.
            if cover >= 0.5 {
                out.show(self, pixels.rim[i][0], n, paint);
            }
        }
        out
    }

    /// Surfaces over one another, each with opacity `alpha`: c = c_dst (1 − α) + c_src α, back to front.
    ///
    /// A surface within `together(depth)` of the one in front is the same one, folded.
    pub(crate) fn through(
        &self,
        fragments: &[Fragment],
        place: (usize, usize),
        alpha: f32,
        coloured: bool,
        together: impl Fn(f32) -> f32,
    ) -> Shaded {
        let mut out = Shaded::NOTHING;
        let mut left = 1.0;
        let mut last = f32::NEG_INFINITY;
        for f in fragments {
            if f.surface[0] < last + together(f.surface[0]) {
                continue;
            }
            last = f.surface[0];
            let (c, n) = self.shaded(&f.surface, place, Some(&f.paint).filter(|_| coloured));
            let share = alpha * f.cover;
            // Front to back, which is the same sum.
            out.blend(c, left * share);
            left *= 1.0 - share;
            if out.depth == f32::INFINITY && f.cover >= 0.5 {
                out.show(self, f.surface[0], n, Some(f.paint));
            }
        }
        out
    }

    fn world(&self, n: Vec3) -> Vec3 {
        n.x * self.axes[0] + n.y * self.axes[1] + n.z * self.axes[2]
    }

    /// Distance along the view axis in world units.
    fn depth(&self, q: f32) -> f32 {
        let d = f64::from(q / (1.0 - self.bend * q));
        ((d + self.reference) * self.unit) as f32
    }
}

/// Rows of the frame.
pub(crate) struct RowsOut<'a> {
    pub(crate) colour: &'a mut [[f32; 4]],
    pub(crate) depth: &'a mut [f32],
    /// Normals and counts, if asked for.
    pub(crate) surface: Option<(&'a mut [[f32; 3]], &'a mut [f32])>,
}

/// A pixel as it goes into the frame.
pub(crate) struct Shaded {
    colour: [f32; 4],
    depth: f32,
    normal: Vec3,
    count: f32,
}

impl Shaded {
    pub(crate) const NOTHING: Self = Self { colour: [0.0; 4], depth: f32::INFINITY, normal: Vec3::ZERO, count: 0.0 };

    fn blend(&mut self, c: Vec3, share: f32) {
        let c = c * share;
        for (sum, v) in self.colour.iter_mut().zip([c.x, c.y, c.z, share]) {
            *sum += v;
        }
    }

    fn show(&mut self, shader: &Shader, q: f32, n: Vec3, paint: Option<Paint>) {
        self.depth = shader.depth(q);
        self.normal = shader.world(n);
        self.count = paint.map_or(0.0, |p| p[3]);
    }

    #[inline]
    pub(crate) fn write(&self, out: &mut RowsOut<'_>, i: usize) {
        (out.colour[i], out.depth[i]) = (self.colour, self.depth);
        if let Some((normal, count)) = &mut out.surface {
            (normal[i], count[i]) = (self.normal.to_array(), self.count);
        }
    }
}
