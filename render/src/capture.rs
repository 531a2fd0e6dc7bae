//! What a probe sees: six views along the axes.

use crate::ambient::Ambient;
use crate::draw::DrawOptions;
use crate::error::RenderError;
use crate::frame::{Frame, LayerKind};
use crate::monitor::{Monitor, Part};
use crate::prepared::Prepared;
use crate::shader::{Economy, Glow, Style};
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Bounds, DepthRange, MicropointError};
use pointillist_sh::{CubePoint, cube_direction, texel_solid_angle};
use pointillist_view::{Projection, View, ViewError};
use std::f64::consts::{FRAC_PI_2, PI};

/// How the six pictures are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureOptions {
    /// Pixels on a side of each of the six pictures. Default: 32.
    pub resolution: u32,
    /// Whether surfaces show the light that they emit, except those that light others directly ([`Details::emits`]): they are
    /// lights, which captures do not show. Default: no.
    ///
    /// [`Details::emits`]: crate::Details::emits
    pub emission: bool,
    /// Whether surfaces show what they reflect of the scene's lights. Default: yes.
    pub lights: bool,
    /// Whether every shadow and texel within a pixel is computed. Default: no, only enough of them for sums over all pixels.
    pub thorough: bool,
    /// Surfaces outside of these distances are cut away, and what is behind them is seen, in the end the background. Distances are along
    /// the axis of each picture: a cube around the position is left out, and what is beyond another one. What is cut away still casts
    /// shadows. Default: all are seen.
    pub depths: DepthRange,
}

impl CaptureOptions {
    /// The defaults, as a constant.
    pub const DEFAULT: Self =
        Self { resolution: 32, emission: false, lights: true, thorough: false, depths: DepthRange::ALL };
}

impl Default for CaptureOptions {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Six pictures in the order +X −X +Y −Y +Z −Z, each row by row, laid out within a face as in [`pointillist_sh::CubeMap`].
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// Pixels on a side.
    pub size: usize,
    /// Linear radiance: one plane of `6 · size²` for each of red, green and blue.
    pub radiance: [Vec<f32>; 3],
    /// What of it the lights make by themselves.
    pub direct: [Vec<f32>; 3],
    /// The share of each pixel in which nothing is.
    pub sky: Vec<f32>,
    /// The share of each pixel that shows backs of surfaces.
    pub back: Vec<f32>,
    /// How far what fills most of a pixel is; +∞ where nothing is.
    pub distance: Vec<f32>,
    /// Faces in whose view nothing lies, and which were not drawn.
    pub empty_faces: u32,
}

/// Shadows for each light and pixel that are enough for sums over a face: at 32² pixels the irradiance differs by 1e-3 from that of
/// thorough pictures (Sponza).
const SHADOWS_PER_PIXEL: usize = 4;

/// Triangles of a scene from which lights with an area are taken as points. What is seen of a light as a whole takes longer the more
/// triangles may be in its way: two rooms of 800 take a third of the time of sixteen points, Sponza's 66 000 take 20 times as long.
const CROWDED: usize = 4096;

/// What is enough for sums over the faces of a capture.
fn economy(triangles: usize) -> Economy {
    Economy {
        shadows_per_pixel: SHADOWS_PER_PIXEL,
        textures_per_micropoint: 1,
        samples_areas: triangles > CROWDED,
    }
}

impl Prepared<'_> {
    /// Looks around from a position. Does not depend on threads.
    ///
    /// # Errors
    /// [`RenderError`] if the position is not finite, the resolution is 0 or beyond [`View::LARGEST_SIDE`], the depths are no range, or
    /// the monitor cancels.
    pub fn capture(
        &self,
        position: DVec3,
        options: CaptureOptions,
        ambient: Ambient<'_>,
        monitor: &dyn Monitor,
    ) -> Result<Capture, RenderError> {
        let glow = if options.emission { Glow::OtherThanLights } else { Glow::Nothing };
        self.look_around(position, options, ambient, glow, monitor)
    }

    /// As [`Prepared::capture`], with the emission of some surfaces.
    pub(crate) fn look_around(
        &self,
        position: DVec3,
        options: CaptureOptions,
        ambient: Ambient<'_>,
        glow: Glow,
        monitor: &dyn Monitor,
    ) -> Result<Capture, RenderError> {
        let mut views = Vec::with_capacity(6);
        for face in 0..6 {
            views.push(view_of_face(position, face, options.resolution)?);
        }
        if !options.depths.is_valid() {
            let DepthRange { near, far } = options.depths;
            return Err(MicropointError::BadDepths { near, far }.into());
        }
        let economy = (!options.thorough).then(|| economy(self.geometry.triangle_count()));
        let CaptureOptions { lights, depths, .. } = options;
        let style = Style { ambient, glow, lights, economy, depths, hides_environment: false };
        let layers = DrawOptions::DEFAULT.with_layers(vec![LayerKind::Back, LayerKind::Direct]);
        let mut capture = Capture::new(options.resolution as usize);
        for (face, view) in views.into_iter().enumerate() {
            if self.has_constant_background() && !may_see(&self.geometry.bounds(), position, face) {
                capture.add_empty_face(self.scene.image.background);
                continue;
            }
            let frame = self.draw_styled(view, &style, &layers, &Part(monitor))?;
            capture.add_face(face, &frame);
        }
        Ok(capture)
    }
}

/// The view from a position through one face of the cube around it.
fn view_of_face(position: DVec3, face: usize, resolution: u32) -> Result<View, ViewError> {
    let axis = |s, t| cube_direction(CubePoint { face, s, t });
    let forward = axis(0.0, 0.0);
    let up = axis(0.0, -1.0) - forward;
    let projection = Projection::Perspective { fov_y_rad: FRAC_PI_2 };
    let target = position + forward * position.abs().max_element().max(1.0);
    View::look_at(position, target, up, projection, resolution, resolution)
}

impl Capture {
    /// Without any face yet.
    fn new(size: usize) -> Self {
        let [radiance, direct] = Default::default();
        Self { size, radiance, direct, sky: vec![], back: vec![], distance: vec![], empty_faces: 0 }
    }

    /// Adds a picture. Cube faces are pictures seen from outside: columns run the other way.
    fn add_face(&mut self, face: usize, frame: &Frame) {
        let n = self.size;
        let to_unit = |i: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
        for (y, x) in (0..n).flat_map(|y| (0..n).map(move |x| (y, x))) {
            let from = y * n + (n - 1 - x);
            let [r, g, b, alpha] = frame.color[from];
            self.radiance.iter_mut().zip([r, g, b]).for_each(|(plane, v)| plane.push(v));
            let direct = frame.layers[1].planes.iter().map(|plane| plane[from]);
            self.direct.iter_mut().zip(direct).for_each(|(plane, v)| plane.push(v));
            self.sky.push(1.0 - alpha);
            self.back.push(frame.layers[0].planes[0][from]);
            let along = cube_direction(CubePoint { face, s: to_unit(x), t: to_unit(y) }).length() as f32;
            self.distance.push(frame.depth[from] * along);
        }
    }

    /// The share of all directions in which the back of a surface is seen: near 1 inside of walls.
    pub fn back_share(&self) -> f64 {
        let n = self.size;
        let weight = |i: usize| texel_solid_angle(n, i % n, i / n % n);
        let sum: f64 = self.back.iter().enumerate().map(|(i, &b)| weight(i) * f64::from(b)).sum();
        sum / (4.0 * PI)
    }

    fn add_empty_face(&mut self, background: Vec3) {
        let texels = self.size * self.size;
        let fill = |list: &mut Vec<f32>, value| list.extend(std::iter::repeat_n(value, texels));
        self.radiance.iter_mut().zip(background.to_array()).for_each(|(plane, v)| fill(plane, v));
        self.direct.iter_mut().for_each(|plane| fill(plane, 0.0));
        fill(&mut self.sky, 1.0);
        fill(&mut self.back, 0.0);
        fill(&mut self.distance, f32::INFINITY);
        self.empty_faces += 1;
    }
}

/// Whether any of a box may be in the view of a face: not all of it is beyond one of the face's five planes.
fn may_see(bounds: &Bounds, position: DVec3, face: usize) -> bool {
    let axis = |s, t| cube_direction(CubePoint { face, s, t });
    let forward = axis(0.0, 0.0);
    let (right, down) = (axis(1.0, 0.0) - forward, axis(0.0, 1.0) - forward);
    let inward = [forward, forward + right, forward - right, forward + down, forward - down];
    inward.iter().all(|&n| bounds.extent_along(position, n).most > 0.0)
}
