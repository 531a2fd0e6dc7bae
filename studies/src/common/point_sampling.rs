//! The comparator for pictures: plain N × N point samples a pixel through a z-buffer.

use glam::{DVec2, DVec3, dvec2};
use pointillist_render::{Projection, Scene};

use crate::common::picture::Picture;
use crate::common::scenes::{SurfaceSample, Visibility, corners, opacity, radiance};

/// The camera of a scene as a projection onto its pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pinhole {
    pub(crate) eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Pixels per unit of x/depth.
    scale: f64,
    centre: DVec2,
}

impl Pinhole {
    pub(crate) fn new(scene: &Scene) -> Self {
        let Projection::Perspective { fov_y_rad } = scene.camera.projection else {
            panic!("the studies draw perspective scenes");
        };
        let [right, up, backward] = scene.camera.axes();
        let size = dvec2(scene.image.width.into(), scene.image.height.into());
        let scale = 0.5 * size.y / (0.5 * fov_y_rad).tan();
        Self { eye: scene.camera.eye, right, up, forward: -backward, scale, centre: 0.5 * size }
    }

    /// Right, down and forward, of unit length.
    pub(crate) fn axes(&self) -> [DVec3; 3] {
        [self.right, -self.up, self.forward]
    }

    /// Pixels per unit of x/depth.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Pixel position and nearness (1/depth) of a point in front of the eye.
    fn project(&self, local: DVec3) -> DVec3 {
        (dvec2(local.x, -local.y) / local.z * self.scale + self.centre).extend(1.0 / local.z)
    }

    /// Pixel position of a point in front of the eye.
    pub(crate) fn pixel(&self, p: DVec3) -> DVec2 {
        self.project(self.local(p)).truncate()
    }

    fn local(&self, p: DVec3) -> DVec3 {
        let v = p - self.eye;
        DVec3::new(v.dot(self.right), v.dot(self.up), v.dot(self.forward))
    }

    /// Direction through a pixel position, with length 1 along the view axis.
    pub(crate) fn direction(&self, pixel: DVec2) -> DVec3 {
        let p = (pixel - self.centre) / self.scale;
        self.forward + self.right * p.x - self.up * p.y
    }
}

/// A triangle on the screen, or what the near plane left of it.
#[derive(Clone, Debug)]
pub(crate) struct Projected {
    pub(crate) triangle: u32,
    /// Corners in pixels; z is the nearness.
    pub(crate) corners: [DVec3; 3],
    /// Nearness at a pixel position p is x·p.x + y·p.y + z.
    pub(crate) plane: DVec3,
    pub(crate) opacity: f64,
}

/// All triangles of a scene that are in front of the eye.
pub(crate) fn project(scene: &Scene, camera: &Pinhole) -> Vec<Projected> {
    let mut list = Vec::with_capacity(scene.mesh.triangles.len());
    for t in 0..scene.mesh.triangles.len() {
        let local = corners(scene, t).map(|p| camera.local(p));
        let ring = in_front(&local);
        let opacity = opacity(scene, t);
        for i in 1..ring.len().saturating_sub(1) {
            let corners = [ring[0], ring[i], ring[i + 1]].map(|p| camera.project(p));
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if normal.z != 0.0 {
                let slope = -normal.truncate() / normal.z;
                let plane = slope.extend(corners[0].z - slope.dot(corners[0].truncate()));
                list.push(Projected { triangle: t as u32, corners, plane, opacity });
            }
        }
    }
    list
}

/// What of a triangle lies beyond a near plane that is close to the eye.
fn in_front(local: &[DVec3; 3]) -> Vec<DVec3> {
    let near = 1e-3 * local.iter().map(|p| p.length()).fold(f64::INFINITY, f64::min).max(1e-3);
    let mut ring = Vec::with_capacity(4);
    for (i, &a) in local.iter().enumerate() {
        let b = local[(i + 1) % 3];
        if a.z >= near {
            ring.push(a);
        }
        if (a.z >= near) != (b.z >= near) {
            ring.push(a + (b - a) * ((near - a.z) / (b.z - a.z)));
        }
    }
    ring
}

/// For each row of pixels the triangles that it may meet.
pub(crate) fn by_rows(triangles: &[Projected], height: u32) -> Vec<Vec<u32>> {
    let mut rows = vec![vec![]; height as usize];
    for (i, t) in triangles.iter().enumerate() {
        let ys = t.corners.map(|c| c.y);
        let (low, high) = (ys[0].min(ys[1]).min(ys[2]), ys[0].max(ys[1]).max(ys[2]));
        if high >= 0.0 && low < f64::from(height) {
            let last = (high as usize).min(rows.len() - 1);
            rows[low.max(0.0) as usize..=last].iter_mut().for_each(|row| row.push(i as u32));
        }
    }
    rows
}

/// A surface that a translucent one lets through at a sample.
struct Layer {
    sample: u32,
    nearness: f64,
    index: u32,
}

/// Draws a scene with `n` × `n` samples a pixel on a regular grid.
pub(crate) fn render(scene: &Scene, n: u32, visible: &Visibility<'_>) -> Picture {
    let camera = Pinhole::new(scene);
    let triangles = project(scene, &camera);
    let rows = by_rows(&triangles, scene.image.height);
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    let mut band = Band::default();
    for (y, indices) in rows.iter().enumerate() {
        band.draw(scene, &triangles, indices, y, n);
        let row = &mut picture.pixels[y * scene.image.width as usize..][..scene.image.width as usize];
        band.shade(&Shading { scene, camera: &camera, triangles: &triangles, visible }, y, n, row);
    }
    picture
}

/// What samples are shaded with.
#[derive(Clone, Copy)]
struct Shading<'a> {
    scene: &'a Scene,
    camera: &'a Pinhole,
    triangles: &'a [Projected],
    visible: &'a Visibility<'a>,
}

/// Samples of one row of pixels.
#[derive(Default)]
struct Band {
    /// Nearness and number of the nearest opaque surface; number `u32::MAX` where none is.
    nearest: Vec<(f64, u32)>,
    layers: Vec<Layer>,
}

impl Band {
    fn draw(&mut self, scene: &Scene, triangles: &[Projected], indices: &[u32], y: usize, n: u32) {
        let columns = scene.image.width * n;
        self.nearest.clear();
        self.nearest.resize((columns * n) as usize, (0.0, u32::MAX));
        self.layers.clear();
        let step = 1.0 / f64::from(n);
        for &index in indices {
            let t = &triangles[index as usize];
            for line in 0..n {
                let py = y as f64 + (f64::from(line) + 0.5) * step;
                let Some((low, high)) = span(t, py) else { continue };
                let first = (low / step - 0.5).ceil().max(0.0) as u32;
                let end = (high / step - 0.5).floor().min(f64::from(columns) - 1.0);
                if end < 0.0 {
                    continue;
                }
                for column in first..=end as u32 {
                    let px = (f64::from(column) + 0.5) * step;
                    let nearness = t.plane.x * px + t.plane.y * py + t.plane.z;
                    let sample = line * columns + column;
                    if t.opacity < 1.0 {
                        self.layers.push(Layer { sample, nearness, index });
                    } else if nearness > self.nearest[sample as usize].0 {
                        self.nearest[sample as usize] = (nearness, index);
                    }
                }
            }
        }
        self.layers
            .sort_by(|a, b| (a.sample, b.nearness).partial_cmp(&(b.sample, a.nearness)).expect("finite"));
    }

    fn shade(&self, with: &Shading<'_>, y: usize, n: u32, row: &mut [DVec3]) {
        let Shading { scene, camera, triangles, visible } = *with;
        let columns = scene.image.width * n;
        let step = 1.0 / f64::from(n);
        let mut next = 0;
        for (sample, &(nearest, index)) in self.nearest.iter().enumerate() {
            let (line, column) = (sample as u32 / columns, sample as u32 % columns);
            let pixel = dvec2((f64::from(column) + 0.5) * step, y as f64 + (f64::from(line) + 0.5) * step);
            let color = |index: u32, nearness: f64| {
                let ray = camera.direction(pixel);
                let at = SurfaceSample {
                    triangle: triangles[index as usize].triangle,
                    position: camera.eye + ray / nearness,
                    to_eye: -ray,
                };
                radiance(scene, &at, visible)
            };
            let (mut sum, mut open) = (DVec3::ZERO, 1.0);
            while next < self.layers.len() && self.layers[next].sample as usize == sample {
                let layer = &self.layers[next];
                next += 1;
                if layer.nearness > nearest {
                    let opacity = triangles[layer.index as usize].opacity;
                    sum += open * opacity * color(layer.index, layer.nearness);
                    open *= 1.0 - opacity;
                }
            }
            let behind =
                if index == u32::MAX { scene.image.background.as_dvec3() } else { color(index, nearest) };
            row[(column / n) as usize] += (sum + open * behind) * step * step;
        }
    }
}

/// Where a horizontal line crosses a triangle.
pub(crate) fn span(t: &Projected, y: f64) -> Option<(f64, f64)> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for i in 0..3 {
        // From the upper corner, so that both neighbours of an edge find the same point.
        let (mut a, mut b) = (t.corners[i], t.corners[(i + 1) % 3]);
        if a.y > b.y {
            std::mem::swap(&mut a, &mut b);
        }
        if a.y <= y && y < b.y {
            let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
            low = low.min(x);
            high = high.max(x);
        }
    }
    (low < high).then_some((low, high))
}
