//! The comparator for shadows: a depth map seen from the light, looked up through a small kernel.

use glam::{DVec2, DVec3, dvec2};
use pointillist_render::Scene;
use pointillist_shade::Source;

use crate::common::scenes::{SurfaceSample, corners, normal_towards};

/// Nearest depths as the light sees them.
pub(crate) struct ShadowMap {
    frame: LightFrame,
    side: usize,
    /// Nearness: larger is nearer.
    nearest: Vec<f64>,
    kernel: usize,
}

/// How the light sees the scene: a square of 0..side texels that holds all of it.
#[derive(Clone, Copy)]
struct LightFrame {
    origin: DVec3,
    axes: [DVec3; 3],
    perspective: bool,
    low: DVec2,
    scale: f64,
}

impl LightFrame {
    fn new(scene: &Scene, source: Source, side: usize) -> Self {
        let (low, high) = scene
            .mesh
            .positions
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        let middle = 0.5 * (low + high);
        let (origin, forward, perspective) = match source {
            Source::Direction(d) => (middle - d.normalize() * (high - low).length(), d.normalize(), false),
            Source::Position(p) => (p, (middle - p).normalize(), true),
            _ => unreachable!("light comes from a point or a direction"),
        };
        let (right, down) = forward.any_orthonormal_pair();
        let mut frame =
            Self { origin, axes: [right, down, forward], perspective, low: DVec2::ZERO, scale: 1.0 };
        let seen = scene.mesh.positions.iter().map(|&p| frame.place(p).truncate());
        let (low, high) = seen.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        frame.scale = side as f64 / (high - low).max_element();
        frame.low = low;
        frame
    }

    /// Texel position and nearness.
    fn place(&self, p: DVec3) -> DVec3 {
        let v = p - self.origin;
        let [x, y, z] = self.axes.map(|a| v.dot(a));
        let (at, nearness) = if self.perspective { (dvec2(x, y) / z, 1.0 / z) } else { (dvec2(x, y), -z) };
        ((at - self.low) * self.scale).extend(nearness)
    }

    /// World size of a texel at a point.
    fn texel_size(&self, p: DVec3) -> f64 {
        let depth = if self.perspective { (p - self.origin).dot(self.axes[2]) } else { 1.0 };
        depth / self.scale
    }
}

impl ShadowMap {
    /// Draws the map. The whole scene must lie in front of a point light.
    pub(crate) fn new(scene: &Scene, source: Source, side: usize, kernel: usize) -> Self {
        let frame = LightFrame::new(scene, source, side);
        let mut map = Self { frame, side, nearest: vec![f64::NEG_INFINITY; side * side], kernel };
        for t in 0..scene.mesh.triangles.len() {
            map.draw(corners(scene, t).map(|p| frame.place(p)));
        }
        map
    }

    fn draw(&mut self, c: [DVec3; 3]) {
        let normal = (c[1] - c[0]).cross(c[2] - c[0]);
        if normal.z == 0.0 || !normal.is_finite() {
            return;
        }
        let slope = -normal.truncate() / normal.z;
        let (low, high) = (c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2]));
        let last = self.side as f64 - 1.0;
        let texels =
            |low: f64, high: f64| (low - 0.5).ceil().max(0.0) as usize..=(high - 0.5).min(last) as usize;
        for y in texels(low.y, high.y) {
            for x in texels(low.x, high.x) {
                let p = dvec2(x as f64 + 0.5, y as f64 + 0.5);
                let side = |i: usize| {
                    let (a, b) = (c[i].truncate(), c[(i + 1) % 3].truncate());
                    (b - a).perp_dot(p - a) * normal.z.signum()
                };
                if side(0) >= 0.0 && side(1) >= 0.0 && side(2) >= 0.0 {
                    let nearness = c[0].z + slope.dot(p - c[0].truncate());
                    let texel = &mut self.nearest[y * self.side + x];
                    *texel = texel.max(nearness);
                }
            }
        }
    }

    /// How much of the light arrives. Biased as usual: the point is moved along its normal by texels
    /// of the kernel's reach, as much more as it is inclined to the light.
    pub(crate) fn lit(&self, scene: &Scene, at: &SurfaceSample, to_light: DVec3) -> f64 {
        let normal = normal_towards(scene, at.triangle as usize, at.to_eye);
        let cos = normal.dot(to_light.normalize()).clamp(0.0, 1.0);
        let sin = (1.0 - cos * cos).sqrt();
        let texel = self.frame.texel_size(at.position);
        let reach = 0.5 * self.kernel as f64 + 0.5;
        let moved = at.position + normal * texel * reach * (0.1 + 1.5 * sin);
        let place = self.frame.place(moved);
        let half = self.kernel as i64 / 2;
        let (x0, y0) = (place.x.floor() as i64, place.y.floor() as i64);
        let mut lit = 0;
        for y in y0 - half..=y0 + half {
            for x in x0 - half..=x0 + half {
                let inside = (0..self.side as i64).contains(&x) && (0..self.side as i64).contains(&y);
                lit += u32::from(!inside || self.nearest[y as usize * self.side + x as usize] <= place.z);
            }
        }
        f64::from(lit) / (self.kernel * self.kernel) as f64
    }
}
