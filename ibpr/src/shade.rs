//! Lights surfaces and writes pixels.

use crate::buffer_map::BufferMap;
use crate::options::Options;
use crate::pixels::{Fragment, Nearest};
use crate::raster::Paint;
use crate::scan::unit;
use crate::solid_row::SolidRow;
use glam::{DVec3, Vec3};
use pointillist_view::Light;
use pulp::Arch;
use std::ops::Range;

/// Shading and output of a frame: everything in the camera's frame (right, up, back).
pub(crate) struct Shader {
    /// Towards the light; none if it is at the eye.
    pub(crate) light: Option<Vec3>,
    ambient: f32,
    pub(crate) base: Vec3,
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
                // Checked with the options.
                let d = unit(d).unwrap_or(DVec3::ZERO);
                Some(Vec3::new(d.dot(v.right()) as f32, d.dot(v.up()) as f32, -d.dot(v.forward()) as f32))
            }
        };
        let centre = v.centre_px().as_vec2();
        let ray_slope = if map.is_perspective() { 1.0 / v.focal_px() } else { 0.0 };
        Self {
            light,
            ambient: options.ambient,
            base: options.base,
            axes: [v.right().as_vec3(), v.up().as_vec3(), -v.forward().as_vec3()],
            centre: (centre.x, centre.y),
            ray_slope: ray_slope as f32,
            bend: map.bend(),
            reference: map.reference,
            unit: map.unit,
        }
    }

    /// Color × (A + (1 − A)·max(0, n·l)) at the centre of a pixel, for a normal of any length; A is the ambient share.
    #[inline]
    fn shaded(&self, surface: &[f32; 4], place: (usize, usize), paint: Option<&Paint>) -> Vec3 {
        let n = Vec3::new(surface[1], surface[2], surface[3]);
        let towards_light = self.light.unwrap_or_else(|| self.towards_eye(place));
        let color = paint.map_or(self.base, |p| Vec3::from_slice(&p.color[..3]));
        color * self.lit(n, towards_light)
    }

    /// From what a pixel shows to the eye.
    #[inline(always)]
    pub(crate) fn towards_eye(&self, place: (usize, usize)) -> Vec3 {
        let u = (place.0 as f32 + 0.5 - self.centre.0) * self.ray_slope;
        let v = (place.1 as f32 + 0.5 - self.centre.1) * self.ray_slope;
        Vec3::new(-u, v, 1.0)
    }

    /// A + (1 − A)·max(0, n·l), both of any length.
    #[inline(always)]
    pub(crate) fn lit(&self, n: Vec3, towards_light: Vec3) -> f32 {
        let lengths2 = n.length_squared() * towards_light.length_squared();
        let facing = n.dot(towards_light).max(0.0) / lengths2.sqrt();
        self.ambient + (1.0 - self.ambient) * if lengths2 > 0.0 { facing } else { 0.0 }
    }

    /// A row of pixels, `range` in the strip and in `out`, from `place` on: the nearest surface of each.
    pub(crate) fn nearest_row(
        &self,
        pixels: &Nearest,
        range: Range<usize>,
        place: (usize, usize),
        colored: bool,
        out: &mut RowsOut<'_>,
    ) {
        let plain = !colored && out.surface.is_none();
        if plain {
            let (surfaces, color) = (&pixels.solid[range.clone()], &mut out.color[range.clone()]);
            let depth = &mut out.depth[range.clone()];
            Arch::new().dispatch(SolidRow { shader: self, place, surfaces, color, depth });
        }
        for (column, i) in (place.0..).zip(range) {
            let has_rim = pixels.rim_cover[i] > 0.0;
            if !plain || has_rim {
                self.write(&self.nearest(pixels, i, (column, place.1), colored), out, i);
            }
            if has_rim && pixels.solid[i][0] == f32::INFINITY {
                out.lone_rims.push(i);
            }
        }
    }

    /// The nearest surface of a pixel, with a rim in front of it blended over what is behind.
    fn nearest(&self, pixels: &Nearest, i: usize, place: (usize, usize), colored: bool) -> Shaded {
        let (solid, cover) = (&pixels.solid[i], pixels.rim_cover[i]);
        let has_solid = solid[0] < f32::INFINITY;
        let has_rim = cover > 0.0 && pixels.rim[i][0] < solid[0];
        let mut out = Shaded::NOTHING;
        let paint_of = |paints: &'_ [Paint]| paints.get(i).copied();
        if has_solid {
            let paint = paint_of(&pixels.solid_paint);
            let c = self.shaded(solid, place, paint.as_ref().filter(|_| colored));
            out.blend(c, if has_rim { 1.0 - cover } else { 1.0 });
            out.show(solid, paint);
        }
        if has_rim {
            let paint = paint_of(&pixels.rim_paint);
            let c = self.shaded(&pixels.rim[i], place, paint.as_ref().filter(|_| colored));
            out.blend(c, cover);
            // Depth and normal are those of the surface that covers more.
            if cover >= 0.5 {
                out.show(&pixels.rim[i], paint);
            }
        }
        out
    }

    /// Surfaces over one another, each with opacity `alpha` times its own: c = c_dst (1 − α) + c_src α, back to front.
    ///
    /// A surface within `together(depth)` of the one in front is the same one, folded.
    pub(crate) fn through(
        &self,
        fragments: &[Fragment],
        place: (usize, usize),
        alpha: f32,
        colored: bool,
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
            let own = f.paint.color[3];
            let c = self.shaded(&f.surface, place, Some(&f.paint).filter(|_| colored));
            let premultiplied = if colored { c } else { c * own };
            let share = alpha * f.cover;
            // Front to back, which is the same sum.
            out.add(premultiplied * (left * share), left * share * own);
            left *= 1.0 - share * own;
            if out.surface[0] == f32::INFINITY && f.cover >= 0.5 && own > 0.0 {
                out.show(&f.surface, Some(f.paint));
            }
        }
        out
    }

    /// Unit normal in the world.
    fn normal(&self, surface: &[f32; 4]) -> Vec3 {
        let n = Vec3::new(surface[1], surface[2], surface[3]).normalize_or(Vec3::Z);
        n.x * self.axes[0] + n.y * self.axes[1] + n.z * self.axes[2]
    }

    /// Distance along the view axis in world units; +∞ stays +∞.
    fn depth(&self, q: f32) -> f32 {
        if q == f32::INFINITY { q } else { self.depth_of_shown(q) }
    }

    /// [`depth`](Self::depth) of a surface.
    #[inline(always)]
    pub(crate) fn depth_of_shown(&self, q: f32) -> f32 {
        let d = f64::from(q / (1.0 - self.bend * q));
        let depth = ((d + self.reference) * self.unit) as f32;
        // An outline may reach a little beyond the plane of the eye.
        if depth < 0.0 { 0.0 } else { depth }
    }

    /// Puts a pixel into the frame.
    #[inline]
    pub(crate) fn write(&self, shaded: &Shaded, out: &mut RowsOut<'_>, i: usize) {
        (out.color[i], out.depth[i]) = (shaded.color, self.depth(shaded.surface[0]));
        if let Some((normal, count)) = &mut out.surface {
            let shown = shaded.surface[0] < f32::INFINITY;
            normal[i] = if shown { self.normal(&shaded.surface).to_array() } else { [0.0; 3] };
            count[i] = shaded.count;
        }
    }
}

/// Rows of the frame.
pub(crate) struct RowsOut<'a> {
    pub(crate) color: &'a mut [[f32; 4]],
    pub(crate) depth: &'a mut [f32],
    /// Normals and counts, if asked for.
    pub(crate) surface: Option<(&'a mut [[f32; 3]], &'a mut [f32])>,
    /// Gets the numbers of pixels that a surface covers in part, and nothing behind it.
    pub(crate) lone_rims: &'a mut Vec<usize>,
}

impl RowsOut<'_> {
    /// Says that there is nothing at these pixels.
    pub(crate) fn clear(&mut self, pixels: Range<usize>) {
        self.color[pixels.clone()].fill([0.0; 4]);
        self.depth[pixels.clone()].fill(f32::INFINITY);
        if let Some((normal, count)) = &mut self.surface {
            normal[pixels.clone()].fill([0.0; 3]);
            count[pixels].fill(0.0);
        }
    }
}

/// A pixel: its color, and the surface that is shown there.
pub(crate) struct Shaded {
    color: [f32; 4],
    surface: [f32; 4],
    count: f32,
}

impl Shaded {
    pub(crate) const NOTHING: Self =
        Self { color: [0.0; 4], surface: [f32::INFINITY, 0.0, 0.0, 0.0], count: 0.0 };

    fn blend(&mut self, c: Vec3, share: f32) {
        self.add(c * share, share);
    }

    /// Adds a premultiplied color.
    fn add(&mut self, c: Vec3, opacity: f32) {
        for (sum, v) in self.color.iter_mut().zip([c.x, c.y, c.z, opacity]) {
            *sum += v;
        }
    }

    fn show(&mut self, surface: &[f32; 4], paint: Option<Paint>) {
        self.surface = *surface;
        self.count = paint.map_or(0.0, |p| p.count);
    }
}
