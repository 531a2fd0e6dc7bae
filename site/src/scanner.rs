//! A range scanner: parallel rays that meet a model, and what it measures of them.

use crate::model::Model;
use glam::{DVec2, DVec3};

/// Cosine of the largest incidence that gives a depth: 75°, as of real scanners.
const LEAST_FACING: f64 = 0.259;

/// Directions towards the scanner, of any length: eight around a model, and one from above.
pub(crate) const STATIONS: [DVec3; 9] = [
    DVec3::new(0.0, 0.2, 1.0),
    DVec3::new(0.7, 0.2, 0.7),
    DVec3::new(1.0, 0.2, 0.0),
    DVec3::new(0.7, 0.2, -0.7),
    DVec3::new(0.0, 0.2, -1.0),
    DVec3::new(-0.7, 0.2, -0.7),
    DVec3::new(-1.0, 0.2, 0.0),
    DVec3::new(-0.7, 0.2, 0.7),
    DVec3::new(0.1, 1.0, 0.1),
];

/// How a model is scanned.
pub(crate) struct Scanner {
    /// Unit vector towards the scanner.
    towards: DVec3,
    right: DVec3,
    up: DVec3,
    /// Distance of rays, world units.
    spacing: f64,
}

impl Scanner {
    pub(crate) fn new(towards: DVec3, spacing: f64) -> Self {
        let towards = towards.normalize();
        let right = DVec3::Y.cross(towards).normalize();
        Self { towards, right, up: towards.cross(right), spacing }
    }

    /// The points that the rays meet first, each wrong by a random distance along its ray: at most `noise` in units of the spacing, small
    /// errors more often than large ones.
    pub(crate) fn scan(&self, model: &Model, noise: f64, random: &mut Random) -> Vec<DVec3> {
        let [low, high] = model.bounds();
        let centre = 0.5 * (low + high);
        let half = (0.5 * (high - low).length() / self.spacing).ceil() as usize + 1;
        let side = 2 * half + 1;
        let mut hits = vec![NO_HIT; side * side];
        for corners in &model.triangles {
            let corners = corners.map(|corner| self.in_rays(model.positions[corner as usize] - centre));
            meet(corners, half, self.spacing, &mut hits);
        }
        let point = |(ray, hit): (usize, &Hit)| {
            let [x, y] = [ray % side, ray / side].map(|i| (i as f64 - half as f64) * self.spacing);
            let error = noise * self.spacing * random.triangular();
            centre + x * self.right + y * self.up + (hit.height + error) * self.towards
        };
        hits.iter().enumerate().filter(|(_, hit)| hit.has_depth).map(point).collect()
    }

    /// Right, up and towards the scanner; the first two count rays.
    fn in_rays(&self, offset: DVec3) -> DVec3 {
        let flat = DVec2::new(offset.dot(self.right), offset.dot(self.up)) / self.spacing;
        flat.extend(offset.dot(self.towards))
    }
}

/// What a ray meets first.
#[derive(Clone, Copy)]
struct Hit {
    /// Towards the scanner, world units.
    height: f64,
    /// Whether the surface faces the scanner enough.
    has_depth: bool,
}

const NO_HIT: Hit = Hit { height: f64::NEG_INFINITY, has_depth: false };

/// Enters a triangle into the rays that meet it before what they met so far.
fn meet([a, b, c]: [DVec3; 3], half: usize, spacing: f64, hits: &mut [Hit]) {
    let (to_b, to_c) = (b - a, c - a);
    let twice_area = to_b.truncate().perp_dot(to_c.truncate());
    if twice_area == 0.0 {
        return;
    }
    let in_world = DVec3::new(spacing, spacing, 1.0);
    let normal = (to_b * in_world).cross(to_c * in_world);
    let has_depth = normal.z > LEAST_FACING * normal.length();
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let (limit, side) = (half as f64, 2 * half + 1);
    let rays = |low: f64, high: f64| (low.ceil().max(-limit) as i64)..=(high.floor().min(limit) as i64);
    for (y, x) in rays(low.y, high.y).flat_map(|y| rays(low.x, high.x).map(move |x| (y, x))) {
        let p = DVec2::new(x as f64, y as f64) - a.truncate();
        // Barycentric weights of b and c.
        let v = p.perp_dot(to_c.truncate()) / twice_area;
        let w = to_b.truncate().perp_dot(p) / twice_area;
        let height = a.z + v * to_b.z + w * to_c.z;
        let hit = &mut hits[(y + half as i64) as usize * side + (x + half as i64) as usize];
        if v >= 0.0 && w >= 0.0 && v + w <= 1.0 && height > hit.height {
            *hit = Hit { height, has_depth };
        }
    }
}

/// Random numbers that are the same everywhere (a linear congruential generator, its upper bits).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From −1 to 1, around 0 the most often.
    fn triangular(&mut self) -> f64 {
        self.uniform() - self.uniform()
    }
}
