//! Reference pictures with shadows: rays through a tree of boxes, many a pixel.

use glam::{DVec2, DVec3, dvec2};
use pointillist_render::Scene;
use pointillist_shade::Source;
use rayon::prelude::*;

use crate::common::opacities::Opacities;
use crate::common::picture::Picture;
use crate::common::point_sampling::Pinhole;
use crate::common::scenes::{SurfaceSample, corners, radiance};

/// A tree of boxes over triangles, split where a ray has least to test.
pub(crate) struct Tree {
    nodes: Vec<Node>,
    triangles: Vec<[DVec3; 3]>,
    ids: Vec<u32>,
    opacities: Opacities,
}

struct Node {
    low: DVec3,
    high: DVec3,
    /// First triangle of a leaf, or the second child; the first child follows its parent.
    first: u32,
    /// 0 for an inner node.
    count: u32,
    /// Along which an inner node's first child comes before the second.
    axis: usize,
}

/// From a point towards a direction, as far as `end` times its length.
#[derive(Clone, Copy)]
struct Ray {
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
    end: f64,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy)]
struct Hit {
    triangle: u32,
    /// In lengths of the ray's direction.
    t: f64,
    /// Barycentric coordinates of the second and the third corner.
    shares: [f64; 2],
}

/// Triangles in a leaf.
const LEAF: usize = 4;

/// Hits closer than this to a ray's start, relative to its length, are the surface it starts on.
const START: f64 = 1e-9;

impl Tree {
    pub(crate) fn new(scene: &Scene) -> Self {
        let count = scene.mesh.triangles.len();
        let mut items: Vec<Item> = (0..count).map(|t| (t as u32, corners(scene, t))).collect();
        let mut nodes = vec![];
        if count > 0 {
            build(&mut nodes, &mut items, 0, 0);
        }
        let (ids, triangles) = items.into_iter().unzip();
        Self { nodes, triangles, ids, opacities: Opacities::new(scene) }
    }

    /// All hits of a ray; `visit` says up to where to go on.
    fn hits(&self, mut ray: Ray, mut visit: impl FnMut(Hit) -> f64) {
        let mut stack = [0_u32; 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let node = &self.nodes[index as usize];
            let (a, b) = ((node.low - ray.origin) * ray.inverse, (node.high - ray.origin) * ray.inverse);
            let enter = a.min(b).max_element().max(0.0);
            let leave = a.max(b).min_element().min(ray.end);
            // A ray within a side's plane gives NaN there; it is kept.
            if enter > leave * (1.0 + 1e-12) {
                continue;
            }
            if node.count == 0 {
                // The nearer child is taken first: what it holds often hides the other.
                let children = [node.first, index + 1];
                let ahead = usize::from(ray.direction[node.axis] < 0.0);
                (stack[depth], stack[depth + 1]) = (children[ahead], children[1 - ahead]);
                depth += 2;
                continue;
            }
            for i in node.first as usize..(node.first + node.count) as usize {
                if let Some((t, shares)) = hit(&ray, &self.triangles[i]) {
                    ray.end = visit(Hit { triangle: self.ids[i], t, shares });
                }
            }
        }
    }

    /// The nearest triangle and how far it is, in lengths of `direction`.
    pub(crate) fn nearest(&self, origin: DVec3, direction: DVec3, beyond: f64) -> Option<(u32, f64)> {
        self.nearest_hit(origin, direction, beyond).map(|hit| (hit.triangle, hit.t))
    }

    /// How many triangles a ray meets between two distances, in lengths of `direction`.
    pub(crate) fn count(&self, origin: DVec3, direction: DVec3, [from, to]: [f64; 2]) -> usize {
        let mut count = 0;
        self.hits(Ray { origin, direction, inverse: direction.recip(), end: to }, |hit| {
            count += usize::from(hit.t > from);
            to
        });
        count
    }

    fn nearest_hit(&self, origin: DVec3, direction: DVec3, beyond: f64) -> Option<Hit> {
        let mut best = None;
        let ray = Ray { origin, direction, inverse: direction.recip(), end: f64::INFINITY };
        let mut end = f64::INFINITY;
        self.hits(ray, |hit| {
            if hit.t > beyond && hit.t < end {
                (best, end) = (Some(hit), hit.t);
            }
            end
        });
        best
    }

    /// What is left of light from `source` at a point.
    pub(crate) fn transmittance(&self, at: &SurfaceSample, source: Source) -> f64 {
        let (direction, end) = match source {
            Source::Direction(d) => (-d, f64::INFINITY),
            Source::Position(p) => (p - at.position, 1.0),
            _ => unreachable!("light comes from a point or a direction"),
        };
        let start = match source {
            Source::Direction(_) => START * at.position.length().max(at.to_eye.length()) / direction.length(),
            _ => START,
        };
        let mut left = 1.0;
        let ray = Ray { origin: at.position, direction, inverse: direction.recip(), end };
        self.hits(ray, |hit| {
            if hit.triangle != at.triangle && hit.t > start && hit.t < end {
                left *= 1.0 - self.opacities.at(hit.triangle, hit.shares);
            }
            if left > 0.0 { end } else { -1.0 }
        });
        left
    }
}

/// A triangle with its number.
type Item = (u32, [DVec3; 3]);

/// Levels below which nodes are halved, so that the stack of a walk is deep enough.
const MOST_SPLITS: u32 = 40;

fn build(nodes: &mut Vec<Node>, items: &mut [Item], base: u32, level: u32) {
    let (low, high) = items.iter().flat_map(|(_, c)| *c).fold(NOWHERE, with_point);
    let index = nodes.len();
    let leaf = items.len() <= LEAF;
    nodes.push(Node { low, high, first: base, count: if leaf { items.len() as u32 } else { 0 }, axis: 0 });
    if leaf {
        return;
    }
    let (low, high) = items.iter().map(|(_, c)| centre(c)).fold(NOWHERE, with_point);
    let axis = (high - low).max_position();
    let cheapest = if level < MOST_SPLITS { cheapest(items, axis, low[axis], high[axis]) } else { None };
    let middle = match cheapest {
        Some(plane) => halves(items, |c| centre(c)[axis] < plane),
        None => {
            let middle = items.len() / 2;
            items.select_nth_unstable_by(middle, |a, b| centre(&a.1)[axis].total_cmp(&centre(&b.1)[axis]));
            middle
        }
    };
    let (left, right) = items.split_at_mut(middle);
    build(nodes, left, base, level + 1);
    (nodes[index].first, nodes[index].axis) = (nodes.len() as u32, axis);
    build(nodes, right, base + middle as u32, level + 1);
}

/// The box of nothing.
const NOWHERE: (DVec3, DVec3) = (DVec3::INFINITY, DVec3::NEG_INFINITY);

fn with_point((low, high): (DVec3, DVec3), p: DVec3) -> (DVec3, DVec3) {
    (low.min(p), high.max(p))
}

/// Three times the middle of its corners.
fn centre([a, b, c]: &[DVec3; 3]) -> DVec3 {
    *a + *b + *c
}

/// Slices in which the cheapest plane is looked for.
const SLICES: usize = 16;

/// The plane between centres that makes the expected number of tests least, of those between slices: areas of boxes times what is in them
/// (Wald, *On fast construction of SAH-based bounding volume hierarchies*, 2007). `None` where all centres are in one place.
fn cheapest(items: &[Item], axis: usize, low: f64, high: f64) -> Option<f64> {
    let width = (high - low) / SLICES as f64;
    let mut slices = [(NOWHERE, 0_usize); SLICES];
    for (_, corners) in items {
        let slice = &mut slices[(((centre(corners)[axis] - low) / width) as usize).min(SLICES - 1)];
        *slice = (corners.iter().copied().fold(slice.0, with_point), slice.1 + 1);
    }
    let cost = |part: &[((DVec3, DVec3), usize)]| {
        let count: usize = part.iter().map(|slice| slice.1).sum();
        let (low, high) = part.iter().fold(NOWHERE, |(l, h), ((low, high), _)| (l.min(*low), h.max(*high)));
        let size = high - low;
        (count > 0).then_some(count as f64 * (size.x * size.y + size.y * size.z + size.z * size.x))
    };
    let sum = |k: &usize| Some(cost(&slices[..*k])? + cost(&slices[*k..])?);
    let costs = (1..SLICES).filter_map(|k| Some((k, sum(&k)?)));
    let (k, _) = costs.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(low + k as f64 * width)
}

/// Puts those first that are meant; how many they are. Where that is none or all, which rounding may do, half of them.
fn halves(items: &mut [Item], is_first: impl Fn(&[DVec3; 3]) -> bool) -> usize {
    let mut count = 0;
    for i in 0..items.len() {
        if is_first(&items[i].1) {
            items.swap(i, count);
            count += 1;
        }
    }
    if count == 0 || count == items.len() { items.len() / 2 } else { count }
}

/// Möller and Trumbore's test.
fn hit(ray: &Ray, [a, b, c]: &[DVec3; 3]) -> Option<(f64, [f64; 2])> {
    let (u, v) = (*b - *a, *c - *a);
    let p = ray.direction.cross(v);
    let det = u.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = ray.origin - *a;
    let x = s.dot(p) / det;
    if !(0.0..=1.0).contains(&x) {
        return None;
    }
    let q = s.cross(u);
    let y = ray.direction.dot(q) / det;
    if y < 0.0 || x + y > 1.0 {
        return None;
    }
    let t = v.dot(q) / det;
    (t > 0.0 && t < ray.end).then_some((t, [x, y]))
}

/// What a sample of the picture shows.
pub(crate) type Show<'a> = dyn Fn(&SurfaceSample) -> DVec3 + Sync + 'a;

/// Radiance with shadow rays to every light.
pub(crate) fn with_shadows<'a>(
    scene: &'a Scene,
    tree: &'a Tree,
) -> impl Fn(&SurfaceSample) -> DVec3 + Sync + 'a {
    move |at| {
        let visible = |at: &SurfaceSample, light: usize, sample: u32| {
            tree.transmittance(at, scene.lights[light].light.source(sample))
        };
        radiance(scene, at, &visible)
    }
}

/// Stratified samples a side: everywhere, and where these differ.
const COARSE: u32 = 10;

/// A picture by rays; `fine` × `fine` stratified samples in pixels at edges. `seed` moves the samples.
pub(crate) fn render(scene: &Scene, tree: &Tree, show: &Show<'_>, fine: u32, seed: u64) -> Picture {
    let camera = Pinhole::new(scene);
    let width = scene.image.width as usize;
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    let sample = |pixel: DVec2| color(scene, tree, &camera, pixel, show);
    let coarse: Vec<(DVec3, bool)> = (0..picture.pixels.len())
        .into_par_iter()
        .map(|i| {
            let colors = stratified(i, width, COARSE, seed).map(&sample).collect::<Vec<_>>();
            let mean = colors.iter().sum::<DVec3>() / colors.len() as f64;
            let spread = colors.iter().map(|c| (*c - mean).abs().max_element()).fold(0.0, f64::max);
            (mean, spread > 0.02 * mean.max_element() + 1e-9)
        })
        .collect();
    let near_edge = |i: usize| {
        let (x, y) = ((i % width) as i64, (i / width) as i64);
        let rough = |dx: i64, dy: i64| {
            let (x, y) = (x + dx, y + dy);
            let inside = x >= 0 && y >= 0 && x < width as i64 && (y as usize) < coarse.len() / width;
            inside && coarse[y as usize * width + x as usize].1
        };
        (-1..=1).any(|dy| (-1..=1).any(|dx| rough(dx, dy)))
    };
    picture.pixels.par_iter_mut().enumerate().for_each(|(i, pixel)| {
        *pixel = if near_edge(i) {
            stratified(i, width, fine, seed ^ 0x5bd1).map(&sample).sum::<DVec3>() / f64::from(fine * fine)
        } else {
            coarse[i].0
        };
    });
    picture
}

/// A picture of `n` × `n` stratified samples in every pixel; `seed` moves the samples.
pub(crate) fn sampled(scene: &Scene, tree: &Tree, show: &Show<'_>, n: u32, seed: u64) -> Picture {
    let camera = Pinhole::new(scene);
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    let width = picture.width;
    picture.pixels.par_iter_mut().enumerate().for_each(|(i, pixel)| {
        let colors = stratified(i, width, n, seed).map(|at| color(scene, tree, &camera, at, show));
        *pixel = colors.sum::<DVec3>() / f64::from(n * n);
    });
    picture
}

/// A scene with shadows by `n` × `n` samples in every pixel, its tree included.
pub(crate) fn sampled_with_shadows(scene: &Scene, n: u32, seed: u64) -> Picture {
    let tree = Tree::new(scene);
    sampled(scene, &tree, &with_shadows(scene, &tree), n, seed)
}

/// `n` × `n` positions in a pixel, one in each stratum.
fn stratified(i: usize, width: usize, n: u32, seed: u64) -> impl Iterator<Item = DVec2> {
    let corner = dvec2((i % width) as f64, (i / width) as f64);
    let mut state = seed.wrapping_add(i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    (0..n * n).map(move |k| {
        let jitter = dvec2(random(&mut state), random(&mut state));
        corner + (dvec2(f64::from(k % n), f64::from(k / n)) + jitter) / f64::from(n)
    })
}

/// The next number of 0..1 (xorshift64*).
pub(crate) fn random(state: &mut u64) -> f64 {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1_u64 << 53) as f64
}

fn color(scene: &Scene, tree: &Tree, camera: &Pinhole, pixel: DVec2, show: &Show<'_>) -> DVec3 {
    let ray = camera.direction(pixel);
    let (mut sum, mut left, mut beyond) = (DVec3::ZERO, 1.0, 0.0);
    while left > 0.0 {
        let Some(Hit { triangle, t, shares }) = tree.nearest_hit(camera.eye, ray, beyond) else {
            return sum + left * scene.image.background.as_dvec3();
        };
        let opacity = tree.opacities.at(triangle, shares);
        let at = SurfaceSample { triangle, position: camera.eye + ray * t, to_eye: -ray };
        // What shows through a hole needs no light.
        if opacity > 0.0 {
            sum += left * opacity * show(&at);
        }
        left *= if tree.opacities.all_opaque { 0.0 } else { 1.0 - opacity };
        beyond = t * (1.0 + 1e-12);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::scenes::Sketch;
    use glam::dvec3;

    /// The nearest hit of all, one triangle after the other.
    fn by_trying_all(scene: &Scene, origin: DVec3, direction: DVec3) -> Option<(u32, f64)> {
        let ray = Ray { origin, direction, inverse: direction.recip(), end: f64::INFINITY };
        let hits = (0..scene.mesh.triangles.len())
            .filter_map(|i| Some((i as u32, hit(&ray, &corners(scene, i))?.0)));
        hits.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    #[test]
    fn the_tree_finds_what_trying_all_finds() {
        let mut sketch = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, 16);
        let white = sketch.matt(0.8, 1.0);
        sketch.sphere(DVec3::ZERO, 1.0, 4, white);
        sketch.cuboid(dvec3(-9.0, -1.0, -9.0), dvec3(9.0, -0.99, 9.0), white);
        // Nothing divides triangles whose middles are in one place.
        for i in 1..=100 {
            let size = 0.01 * f64::from(i);
            let corners =
                [dvec3(-size, 2.0, -size), dvec3(2.0 * size, 2.0, -size), dvec3(-size, 2.0, 2.0 * size)];
            sketch.polygon(&corners, white);
        }
        let tree = Tree::new(&sketch.scene);
        let mut state = 1;
        let mut found = 0;
        for _ in 0..2000 {
            let mut any = || dvec3(random(&mut state), random(&mut state), random(&mut state)) * 2.0 - 1.0;
            let (origin, direction) = (any() * 4.0, any());
            let [by_tree, wanted] = [
                tree.nearest(origin, direction, 0.0).map(|hit| hit.1),
                by_trying_all(&sketch.scene, origin, direction).map(|hit| hit.1),
            ];
            assert_eq!(by_tree, wanted, "from {origin} along {direction}");
            found += usize::from(wanted.is_some());
        }
        assert!(found > 500, "{found} rays met something");
    }
}
