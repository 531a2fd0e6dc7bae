//! The nearest triangle along a ray: boxes in a tree with four children a node, split where surface area is saved most.
//!
//! Boxes are in single precision, a little too large; triangles are met in double precision. Coordinates are those of a scene: about −½ to ½.

use glam::{DVec3, Vec3, Vec4};

/// Triangles in a leaf, at most.
const LEAF: usize = 2;
/// Places along each axis where a split is tried.
const BINS: usize = 16;
/// By this boxes are larger than what they hold: more than single precision rounds coordinates of up to 1.
const PAD: f32 = 4e-7;
/// A hit may be this much outside a triangle, in barycentric coordinates: rays do not pass between neighbours.
const SEAM: f64 = 1e-9;
/// No triangles, as a child.
const EMPTY: u32 = u32::MAX;
/// Bit of children that are triangles; 3 bits below the first one's number say how many.
const TRIANGLES: u32 = 1 << 31;
/// Levels that are split where surface area is saved most; below, halves keep the tree from being deeper than the stack.
const LEVELS: usize = 12;
/// Nodes on the way from the root that wait for their turn: three for every level, of which there are fewer than this for 2³⁰ triangles.
const STACK: usize = 96;

/// What a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// What was given with the triangle.
    pub(crate) tag: u32,
    /// Whether it is the side from which the corners run counter-clockwise.
    pub(crate) front: bool,
    /// In lengths of the direction.
    pub(crate) distance: f64,
}

/// A triangle to be found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Corners {
    pub(crate) corners: [DVec3; 3],
    /// Given back with a hit.
    pub(crate) tag: u32,
    /// Whether rays pass through it from behind.
    pub(crate) from_front: bool,
}

#[derive(Clone, Copy, Debug)]
struct Triangle {
    corner: DVec3,
    edges: [DVec3; 2],
    tag: u32,
    from_front: bool,
}

#[derive(Clone, Debug)]
struct Node {
    low: [Vec4; 3],
    high: [Vec4; 3],
    children: [u32; 4],
}

/// Triangles, found by rays.
#[derive(Clone, Debug, Default)]
pub(crate) struct RayTree {
    nodes: Vec<Node>,
    triangles: Vec<Triangle>,
}

#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3,
    high: Vec3,
}

impl Bounds {
    const NONE: Self = Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY };

    fn with(self, o: Self) -> Self {
        Self { low: self.low.min(o.low), high: self.high.max(o.high) }
    }

    fn half_area(self) -> f32 {
        let size = (self.high - self.low).max(Vec3::ZERO);
        size.x * size.y + size.y * size.z + size.z * size.x
    }
}

/// A triangle while the tree is built.
#[derive(Clone, Copy)]
struct Item {
    bounds: Bounds,
    centre: Vec3,
    number: u32,
}

impl RayTree {
    /// Of triangles with a tag each.
    pub(crate) fn new(list: &[Corners]) -> Self {
        let mut items: Vec<Item> = list.iter().enumerate().map(|(i, t)| item(i, &t.corners)).collect();
        let mut tree = Self::default();
        if !items.is_empty() {
            tree.build(&mut items, 0, 0);
        }
        let triangle = |item: &Item| {
            let Corners { corners: [a, b, c], tag, from_front } = list[item.number as usize];
            Triangle { corner: a, edges: [b - a, c - a], tag, from_front }
        };
        tree.triangles = items.iter().map(triangle).collect();
        tree
    }

    /// Appends the node of some triangles, the first of which will be at `base`; returns its number.
    fn build(&mut self, items: &mut [Item], base: usize, level: usize) -> u32 {
        let number = self.nodes.len();
        let nothing = Node { low: [Vec4::INFINITY; 3], high: [Vec4::NEG_INFINITY; 3], children: [EMPTY; 4] };
        self.nodes.push(nothing);
        // The largest part is split until there are four.
        let mut parts = vec![(0, items.len())];
        while parts.len() < 4 {
            let large = parts.iter().enumerate().filter(|(_, (from, to))| to - from > LEAF);
            let area = |(from, to): (usize, usize)| bounds_of(&items[from..to]).half_area();
            let Some((which, &(from, to))) = large.max_by(|a, b| area(*a.1).total_cmp(&area(*b.1))) else {
                break;
            };
            let middle =
                from + if level < LEVELS { split(&mut items[from..to]) } else { halve(&mut items[from..to]) };
            parts[which] = (from, middle);
            parts.insert(which + 1, (middle, to));
        }
        for (slot, (from, to)) in parts.into_iter().enumerate() {
            let bounds = bounds_of(&items[from..to]);
            let child = if to - from <= LEAF {
                TRIANGLES | ((base + from) as u32) << 3 | (to - from) as u32
            } else {
                self.build(&mut items[from..to], base + from, level + 1)
            };
            let node = &mut self.nodes[number];
            node.children[slot] = child;
            for axis in 0..3 {
                node.low[axis][slot] = bounds.low[axis];
                node.high[axis][slot] = bounds.high[axis];
            }
        }
        number as u32
    }

    /// The nearest triangle nearer than `end`, in lengths of `direction`.
    pub(crate) fn nearest(&self, origin: DVec3, direction: DVec3, end: f64) -> Option<Hit> {
        let mut best = None;
        self.visit(origin, direction, end, |hit| {
            best = Some(hit);
            hit.distance
        });
        best
    }

    /// Whether anything is nearer than `end`, in lengths of `direction`.
    pub(crate) fn is_blocked(&self, origin: DVec3, direction: DVec3, end: f64) -> bool {
        let mut any = false;
        self.visit(origin, direction, end, |_| {
            any = true;
            -1.0
        });
        any
    }

    /// Hits nearer than `end`; `visit` says up to where to go on.
    fn visit(&self, origin: DVec3, direction: DVec3, mut end: f64, mut visit: impl FnMut(Hit) -> f64) {
        let from = origin.as_vec3();
        // A direction within a box's side would give a product that is not a number.
        let apart = |d: f64| if d.abs() < 1e-20 { 1e-20_f64.copysign(d) } else { d };
        let inverse =
            DVec3::new(apart(direction.x), apart(direction.y), apart(direction.z)).recip().as_vec3();
        // Along an axis that the ray goes down, boxes are entered at their upper side.
        let falls = inverse.cmplt(Vec3::ZERO);
        let falls = [falls.test(0), falls.test(1), falls.test(2)];
        let mut stack = [(0_u32, 0.0_f32); STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (child, near) = stack[depth];
            if f64::from(near) > end {
                continue;
            }
            if child & TRIANGLES != 0 {
                let first = ((child & !TRIANGLES) >> 3) as usize;
                for triangle in &self.triangles[first..first + (child & 7) as usize] {
                    if let Some(hit) = triangle.hit(origin, direction, end) {
                        end = visit(hit);
                    }
                }
                continue;
            }
            let node = &self.nodes[child as usize];
            let (mut enter, mut leave) = (Vec4::ZERO, Vec4::splat(end.min(1e30) as f32 * 1.000_001));
            for axis in 0..3 {
                let (low, high) = (&node.low[axis], &node.high[axis]);
                let (first, last) = if falls[axis] { (high, low) } else { (low, high) };
                enter = enter.max((*first - from[axis]) * inverse[axis]);
                leave = leave.min((*last - from[axis]) * inverse[axis]);
            }
            let (enter, meets) = (enter.to_array(), enter.cmple(leave).bitmask());
            let start = depth;
            for (slot, (&child, near)) in node.children.iter().zip(enter).enumerate() {
                if meets >> slot & 1 == 1 && child != EMPTY && depth < STACK {
                    // The nearest comes last, and is taken first.
                    let mut at = depth;
                    while at > start && stack[at - 1].1 < near {
                        stack[at] = stack[at - 1];
                        at -= 1;
                    }
                    stack[at] = (child, near);
                    depth += 1;
                }
            }
        }
    }
}

impl Triangle {
    /// Möller's and Trumbore's test.
    #[inline]
    fn hit(&self, origin: DVec3, direction: DVec3, end: f64) -> Option<Hit> {
        let [u, v] = self.edges;
        let p = direction.cross(v);
        let determinant = u.dot(p);
        if determinant == 0.0 || (self.from_front && determinant < 0.0) {
            return None;
        }
        let inverse = 1.0 / determinant;
        let s = origin - self.corner;
        let x = s.dot(p) * inverse;
        if !(-SEAM..=1.0 + SEAM).contains(&x) {
            return None;
        }
        let q = s.cross(u);
        let y = direction.dot(q) * inverse;
        if y < -SEAM || x + y > 1.0 + SEAM {
            return None;
        }
        let distance = v.dot(q) * inverse;
        let hit = Hit { tag: self.tag, front: determinant > 0.0, distance };
        (distance > 0.0 && distance < end).then_some(hit)
    }
}

fn item(number: usize, corners: &[DVec3; 3]) -> Item {
    let low = corners[0].min(corners[1]).min(corners[2]).as_vec3() - PAD;
    let high = corners[0].max(corners[1]).max(corners[2]).as_vec3() + PAD;
    Item { bounds: Bounds { low, high }, centre: 0.5 * (low + high), number: number as u32 }
}

fn bounds_of(items: &[Item]) -> Bounds {
    items.iter().fold(Bounds::NONE, |b, i| b.with(i.bounds))
}

/// Parts items in two; returns how many come first. Where no split is better than another, halves.
fn split(items: &mut [Item]) -> usize {
    let low = items.iter().fold(Vec3::INFINITY, |m, i| m.min(i.centre));
    let high = items.iter().fold(Vec3::NEG_INFINITY, |m, i| m.max(i.centre));
    let mut best = (f32::INFINITY, 0, 0);
    let bin_of = |axis: usize, item: &Item| {
        (((item.centre[axis] - low[axis]) / (high[axis] - low[axis]) * BINS as f32) as usize).min(BINS - 1)
    };
    for axis in (0..3).filter(|&axis| high[axis] > low[axis]) {
        let mut bins = [(Bounds::NONE, 0_usize); BINS];
        for item in items.iter() {
            let bin = &mut bins[bin_of(axis, item)];
            *bin = (bin.0.with(item.bounds), bin.1 + 1);
        }
        let mut after = [(0.0, 0); BINS];
        let mut sum = (Bounds::NONE, 0);
        for i in (1..BINS).rev() {
            sum = (sum.0.with(bins[i].0), sum.1 + bins[i].1);
            after[i] = (sum.0.half_area(), sum.1);
        }
        let mut sum = (Bounds::NONE, 0);
        for i in 1..BINS {
            sum = (sum.0.with(bins[i - 1].0), sum.1 + bins[i - 1].1);
            let cost = sum.0.half_area() * sum.1 as f32 + after[i].0 * after[i].1 as f32;
            if sum.1 > 0 && after[i].1 > 0 && cost < best.0 {
                best = (cost, axis, i);
            }
        }
    }
    let (cost, axis, bin) = best;
    if !cost.is_finite() {
        return halve(items);
    }
    // Stable: the order of triangles within a part is that of the input.
    items.sort_by_key(|item| bin_of(axis, item) >= bin);
    items.partition_point(|item| bin_of(axis, item) < bin)
}

/// Parts items at the median along the longest axis.
fn halve(items: &mut [Item]) -> usize {
    let low = items.iter().fold(Vec3::INFINITY, |m, i| m.min(i.centre));
    let high = items.iter().fold(Vec3::NEG_INFINITY, |m, i| m.max(i.centre));
    let axis = (high - low).max_position();
    items.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    items.len() / 2
}
