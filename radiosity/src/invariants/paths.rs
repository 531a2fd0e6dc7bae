//! Light between surfaces by brute force: paths that are reflected at random until they are absorbed. It shares no code with the solvers, and knows neither
//! patches nor clusters.

use glam::DVec3;

use crate::lamp::Lamp;
use crate::polygon::Polygon;
use crate::rgb::Rgb;
use crate::surface::Surface;

/// Triangles in a box that is divided no further.
const LEAF: usize = 4;
/// Rays start this far off their surface, as a share of the scene's size.
const OFF: f64 = 1e-7;
/// Reflections of a path, at most: 0.7^48 is 4e-8.
const MOST: usize = 48;
/// Reflections after which a path may end by chance.
const SURE: usize = 3;

struct Node {
    low: DVec3,
    high: DVec3,
    first: usize,
    /// Triangles; 0 for a node with children, the first of which comes next, the second at `first`.
    count: usize,
}

/// Surfaces and lamps to be looked at along paths.
pub struct Paths<'l> {
    surfaces: Vec<Surface>,
    lamps: &'l [Lamp<'l>],
    nodes: Vec<Node>,
    triangles: Vec<([DVec3; 3], usize)>,
    size: f64,
}

impl<'l> Paths<'l> {
    /// Surfaces that are no polygons, or have no area, are left out.
    #[must_use]
    pub fn new(surfaces: &[Surface], lamps: &'l [Lamp<'l>]) -> Self {
        let mut triangles = vec![];
        for (i, surface) in surfaces.iter().enumerate() {
            let Ok(polygon) = Polygon::new(&surface.vertices) else { continue };
            let ring = polygon.vertices();
            triangles.extend((1..ring.len() - 1).map(|k| ([ring[0], ring[k], ring[k + 1]], i)));
        }
        let (low, high) = bounds(&triangles);
        let mut paths = Self {
            surfaces: surfaces.to_vec(),
            lamps,
            nodes: vec![],
            size: (high - low).max_element(),
            triangles,
        };
        let count = paths.triangles.len();
        if count > 0 {
            paths.build(0, count);
        }
        paths
    }

    fn build(&mut self, from: usize, to: usize) {
        let (low, high) = bounds(&self.triangles[from..to]);
        let node = self.nodes.len();
        let count = if to - from <= LEAF { to - from } else { 0 };
        self.nodes.push(Node { low, high, first: from, count });
        if count > 0 {
            return;
        }
        let axis = (high - low).max_position();
        let middle = (to - from) / 2;
        let at = |t: &([DVec3; 3], usize)| t.0[0][axis] + t.0[1][axis] + t.0[2][axis];
        self.triangles[from..to].select_nth_unstable_by(middle, |a, b| at(a).total_cmp(&at(b)));
        self.build(from, from + middle);
        self.nodes[node].first = self.nodes.len();
        self.build(from + middle, to);
    }

    /// The nearest surface before `end`, in lengths of the direction, and where. `any`: whichever is found first.
    fn meet(&self, origin: DVec3, direction: DVec3, end: f64, any: bool) -> Option<(usize, f64)> {
        let mut best = None;
        let mut end = end;
        let inverse = direction.recip();
        let mut stack = vec![0];
        while let Some(node) = stack.pop().and_then(|n: usize| self.nodes.get(n).map(|node| (n, node))) {
            let (number, node) = node;
            let (a, b) = ((node.low - origin) * inverse, (node.high - origin) * inverse);
            let enter = a.min(b).max_element().max(0.0);
            if enter > a.max(b).min_element().min(end) * (1.0 + 1e-12) {
                continue;
            }
            if node.count == 0 {
                stack.extend([node.first, number + 1]);
                continue;
            }
            for (corners, surface) in &self.triangles[node.first..node.first + node.count] {
                if let Some(t) = distance(origin, direction, corners).filter(|&t| t < end) {
                    (best, end) = (Some((*surface, t)), t);
                    if any {
                        return best;
                    }
                }
            }
        }
        best
    }

    /// Irradiance from surfaces at a point in front of its own surface, the mean of so many paths, with its standard error. Light of lamps is in it only after
    /// a reflection. The same seed gives the same paths.
    #[must_use]
    pub fn irradiance(&self, point: DVec3, normal: DVec3, paths: usize, seed: u64) -> (Rgb, Rgb) {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
        // First directions are stratified.
        let side = (paths as f64).sqrt().ceil().max(1.0) as usize;
        let count = side * side;
        for k in 0..count {
            let (x, y) = ((k % side) as f64 + random.next(), (k / side) as f64 + random.next());
            let light = self.along(point, normal, [x / side as f64, y / side as f64], &mut random);
            for band in 0..3 {
                sum[band] += light[band];
                squares[band] += light[band] * light[band];
            }
        }
        let n = count as f64;
        let mean = sum.map(|s| s / n);
        let error = [0, 1, 2].map(|b| ((squares[b] / n - mean[b] * mean[b]).max(0.0) / n).sqrt());
        (mean, error)
    }

    /// How far it is from a point along its normal to the next surface, as a share of the scene's size: next to nothing where surfaces lie on one another, and it
    /// is left to rounding which of them is lit.
    #[must_use]
    pub fn clearance(&self, point: DVec3, normal: DVec3) -> f64 {
        let met = self.meet(point + normal * (OFF * self.size), normal, f64::INFINITY, false);
        met.map_or(f64::INFINITY, |(_, distance)| distance / self.size)
    }

    /// Irradiance by lamps at a point in front of its own surface; areas at one random point each.
    #[must_use]
    pub fn direct(&self, point: DVec3, normal: DVec3, seed: u64) -> Rgb {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        self.lit(point + normal * (OFF * self.size), normal, &mut random)
    }

    fn along(&self, point: DVec3, normal: DVec3, first: [f64; 2], random: &mut Random) -> Rgb {
        let (mut light, mut weight) = ([0.0; 3], [1.0; 3]);
        let (mut origin, mut up, mut pair) = (point + normal * (OFF * self.size), normal, first);
        for reflections in 0..MOST {
            let direction = by_cosine(up, pair);
            let Some((number, t)) = self.meet(origin, direction, f64::INFINITY, false) else { break };
            let surface = &self.surfaces[number];
            let Ok(polygon) = Polygon::new(&surface.vertices) else { break };
            let back = polygon.normal().dot(direction) > 0.0;
            if back && !surface.two_sided {
                break;
            }
            up = if back { -polygon.normal() } else { polygon.normal() };
            origin += direction * t + up * (OFF * self.size);
            let lit = self.lit(origin, up, random);
            for band in 0..3 {
                light[band] +=
                    weight[band] * (surface.emission[band] + surface.reflectance[band] * lit[band]);
                weight[band] *= surface.reflectance[band];
            }
            let most = weight.into_iter().fold(0.0, f64::max);
            if reflections >= SURE {
                if random.next() >= most {
                    break;
                }
                weight = weight.map(|w| w / most);
            }
            pair = [random.next(), random.next()];
        }
        light
    }

    /// Irradiance by lamps.
    fn lit(&self, point: DVec3, normal: DVec3, random: &mut Random) -> Rgb {
        let mut sum = [0.0; 3];
        for lamp in self.lamps {
            let (way, light, shadow, end) = match *lamp {
                Lamp::Point { position, irradiance, shadow } => {
                    (position - point, irradiance(point, normal), shadow, 1.0)
                }
                Lamp::Directional { direction, irradiance, shadow } => {
                    (-direction, irradiance(point, normal), shadow, f64::INFINITY)
                }
                Lamp::Area { polygon, exitance, shadow } => {
                    let at =
                        crate::rays::sequence::point_of(polygon.vertices(), [random.next(), random.next()]);
                    let way = at - point;
                    let length2 = way.length_squared();
                    let cosines = normal.dot(way).max(0.0) * polygon.normal().dot(-way).max(0.0);
                    let factor = cosines / (length2 * length2) * polygon.area() / std::f64::consts::PI;
                    (way, exitance.map(|e| e * factor), shadow, 1.0 - 1e-9)
                }
            };
            if normal.dot(way) > 0.0 && !(shadow && self.meet(point, way, end, true).is_some()) {
                sum = crate::rgb::add(sum, 1.0, light);
            }
        }
        sum
    }
}

/// xorshift64*.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

fn by_cosine(normal: DVec3, [x, y]: [f64; 2]) -> DVec3 {
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let (sine, cosine) = (std::f64::consts::TAU * y).sin_cos();
    (u * cosine + v * sine) * x.sqrt() + normal * (1.0 - x).max(1e-12).sqrt()
}

fn bounds(triangles: &[([DVec3; 3], usize)]) -> (DVec3, DVec3) {
    let all = triangles.iter().flat_map(|t| t.0);
    all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)))
}

/// Where a ray meets a triangle, from either side.
fn distance(origin: DVec3, direction: DVec3, [a, b, c]: &[DVec3; 3]) -> Option<f64> {
    let normal = (*b - *a).cross(*c - *a);
    let t = normal.dot(*a - origin) / normal.dot(direction);
    if !(t > 0.0 && t.is_finite()) {
        return None;
    }
    let p = origin + direction * t;
    let inside = |from: DVec3, to: DVec3| normal.dot((to - from).cross(p - from)) >= 0.0;
    (inside(*a, *b) && inside(*b, *c) && inside(*c, *a)).then_some(t)
}
