//! Which triangles bound a solid: closed, consistently oriented, edge-manifold components.
//!
//! Of such a component an outside viewer never sees a back face, and every ray that enters it also
//! leaves it; so half of its triangles can be skipped, for the camera and for a light.

use crate::bounds::Bounds;
use glam::{DAffine3, DVec3};

/// A triangle's component is not closed.
pub(crate) const OPEN: u32 = u32::MAX;

/// One closed component of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid {
    /// +1 if its triangles wind counter-clockwise seen from outside, −1 if clockwise.
    pub(crate) orientation: i8,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// Which of the geometry's places its triangles stand in.
    pub(crate) place: u32,
}

impl Solid {
    /// The same solid of a shape in one of its places, in a box that may be larger than needed. A place that mirrors keeps fronts in front.
    pub(crate) fn moved(&self, world_from_shape: &DAffine3, place: u32) -> Self {
        let mut bounds = Bounds::EMPTY;
        for corner in 0..8 {
            let side = |axis: u32| if corner >> axis & 1 == 0 { self.low } else { self.high };
            bounds.include(world_from_shape.transform_point3(DVec3::new(side(0).x, side(1).y, side(2).z)));
        }
        Self { orientation: self.orientation, low: bounds.low, high: bounds.high, place }
    }
}

/// The closed components, and for each triangle the index of its own, or [`OPEN`].
///
/// `opaque(t)` says whether triangle `t` may hide what is behind it; a component with any other
/// triangle is left open.
pub(crate) fn find_solids(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    opaque: impl Fn(usize) -> bool,
) -> (Vec<Solid>, Vec<u32>) {
    let welded = weld(positions);
    let mut components = Components::new(triangles.len());
    let mut open = vec![false; triangles.len()];
    let edges = edges_by_vertex(positions.len(), triangles, &welded);
    pair_edges(&edges, &mut components, &mut open);
    for (t, tri) in triangles.iter().enumerate() {
        open[t] |= is_degenerate(tri.map(|c| welded[c as usize])) || !opaque(t);
    }
    collect_solids(positions, triangles, &mut components, &open)
}

/// Whether a triangle (of welded corners) has fewer than three.
fn is_degenerate(v: [u32; 3]) -> bool {
    v[0] == v[1] || v[1] == v[2] || v[2] == v[0]
}

/// Gives equal positions one number. OBJ files often repeat a vertex along texture seams.
fn weld(positions: &[DVec3]) -> Vec<u32> {
    let slots = (positions.len() * 2).next_power_of_two().max(16);
    let mut table = vec![u32::MAX; slots];
    let bits = |p: DVec3| [p.x, p.y, p.z].map(|c| (c + 0.0).to_bits());
    let mut welded = Vec::with_capacity(positions.len());
    for (i, &p) in positions.iter().enumerate() {
        let key = bits(p);
        let hash = key.iter().fold(0u64, |h, &k| (h.rotate_left(21) ^ k).wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let mut slot = (hash >> 32) as usize & (slots - 1);
        while table[slot] != u32::MAX && bits(positions[table[slot] as usize]) != key {
            slot = (slot + 1) & (slots - 1);
        }
        if table[slot] == u32::MAX {
            table[slot] = i as u32;
        }
        welded.push(table[slot]);
    }
    welded
}

/// A directed edge as seen from its lower vertex.
#[derive(Clone, Copy)]
struct HalfEdge {
    other: u32,
    /// Triangle index × 2 + (1 if the edge runs from the lower vertex to the higher). There are fewer than 2³⁰ triangles.
    code: u32,
}

struct EdgesByVertex {
    first: Vec<u32>,
    edges: Vec<HalfEdge>,
}

impl EdgesByVertex {
    fn vertex_count(&self) -> usize {
        self.first.len() - 1
    }

    fn of_vertex(&self, v: usize) -> &[HalfEdge] {
        &self.edges[self.first[v] as usize..self.first[v + 1] as usize]
    }
}

/// Counting sort of all half-edges by their lower vertex.
fn edges_by_vertex(vertices: usize, triangles: &[[u32; 3]], welded: &[u32]) -> EdgesByVertex {
    let mut first = vec![0u32; vertices + 2];
    for_each_edge(triangles, welded, |v, _| first[v as usize + 2] += 1);
    for i in 1..first.len() {
        first[i] += first[i - 1];
    }
    let mut edges = vec![HalfEdge { other: 0, code: 0 }; first[first.len() - 1] as usize];
    for_each_edge(triangles, welded, |v, edge| {
        let slot = &mut first[v as usize + 1];
        edges[*slot as usize] = edge;
        *slot += 1;
    });
    first.pop();
    EdgesByVertex { first, edges }
}

/// Hands over every half-edge with its lower vertex.
#[inline]
fn for_each_edge(triangles: &[[u32; 3]], welded: &[u32], mut visit: impl FnMut(u32, HalfEdge)) {
    for (t, tri) in triangles.iter().enumerate() {
        let v = tri.map(|c| welded[c as usize]);
        // Without area, and nobody's neighbour: its other two edges pair up as if it were not there.
        if is_degenerate(v) {
            continue;
        }
        for (a, b) in [(v[0], v[1]), (v[1], v[2]), (v[2], v[0])] {
            let code = t as u32 * 2 + u32::from(a < b);
            visit(a.min(b), HalfEdge { other: a.max(b), code });
        }
    }
}

/// The half-edges between a vertex and its lower neighbour that was looked at last.
#[derive(Clone, Copy)]
struct Between {
    lower: u32,
    count: u32,
    /// Sum of their codes: of two, it tells the other by the one.
    codes: u32,
}

/// Joins triangles across manifold edges; marks those with any other kind of edge as open.
fn pair_edges(edges: &EdgesByVertex, components: &mut Components, open: &mut [bool]) {
    let none = Between { lower: u32::MAX, count: 0, codes: 0 };
    let mut between = vec![none; edges.vertex_count()];
    for lower in 0..edges.vertex_count() as u32 {
        for e in edges.of_vertex(lower as usize) {
            let found = &mut between[e.other as usize];
            if found.lower != lower {
                *found = Between { lower, ..none };
            }
            found.count += 1;
            found.codes = found.codes.wrapping_add(e.code);
        }
        for e in edges.of_vertex(lower as usize) {
            let Between { count, codes, .. } = between[e.other as usize];
            let partner = codes.wrapping_sub(e.code);
            if count != 2 || (e.code ^ partner) & 1 == 0 {
                open[triangle_of(e.code)] = true;
            } else if e.code < partner {
                components.join(triangle_of(e.code) as u32, triangle_of(partner) as u32);
            }
        }
    }
}

/// The triangle of a half-edge's code.
fn triangle_of(code: u32) -> usize {
    (code / 2) as usize
}

fn collect_solids(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    components: &mut Components,
    open: &[bool],
) -> (Vec<Solid>, Vec<u32>) {
    let mut root_open = vec![false; triangles.len()];
    for (t, &is_open) in open.iter().enumerate() {
        if is_open {
            root_open[components.root(t as u32) as usize] = true;
        }
    }
    let mut solid_of_root = vec![OPEN; triangles.len()];
    let mut sums: Vec<(DVec3, f64, Solid)> = Vec::new();
    let mut solid_of = Vec::with_capacity(triangles.len());
    for (t, tri) in triangles.iter().enumerate() {
        let root = components.root(t as u32) as usize;
        if root_open[root] {
            solid_of.push(OPEN);
            continue;
        }
        let v = tri.map(|c| positions[c as usize]);
        if solid_of_root[root] == OPEN {
            solid_of_root[root] = sums.len() as u32;
            sums.push((v[0], 0.0, Solid { orientation: 1, low: v[0], high: v[0], place: 0 }));
        }
        let (anchor, volume, solid) = &mut sums[solid_of_root[root] as usize];
        // Six times the signed volume, about a vertex of the component so that distance does not matter.
        *volume += (v[0] - *anchor).dot((v[1] - *anchor).cross(v[2] - *anchor));
        for p in v {
            solid.low = solid.low.min(p);
            solid.high = solid.high.max(p);
        }
        solid_of.push(solid_of_root[root]);
    }
    let solids = sums
        .into_iter()
        .map(|(_, volume, solid)| Solid { orientation: if volume < 0.0 { -1 } else { 1 }, ..solid })
        .collect();
    (solids, solid_of)
}

/// Disjoint sets of triangles.
struct Components {
    parent: Vec<u32>,
}

impl Components {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = (a.min(b), a.max(b));
        self.parent[high as usize] = low;
    }
}

/// Solid angle of a triangle seen from the origin, signed by its winding (Van Oosterom and Strackee
/// 1983, eq. 8). Summed over a closed surface it is ±4π inside and 0 outside.
pub(crate) fn solid_angle(v: [DVec3; 3]) -> f64 {
    let [a, b, c] = v;
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let divisor = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * volume.atan2(divisor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    fn tetrahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let p = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        (p, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    }

    #[test]
    fn a_tetrahedron_is_a_solid_and_loses_it_with_a_face() {
        let (p, t) = tetrahedron();
        let (solids, of) = find_solids(&p, &t, |_| true);
        assert_eq!((solids.len(), solids[0].orientation), (1, 1));
        assert!(of.iter().all(|&s| s == 0));
        let (solids, of) = find_solids(&p, &t[..3], |_| true);
        assert!(solids.is_empty() && of.iter().all(|&s| s == OPEN));
        assert!(find_solids(&p, &t, |i| i != 1).0.is_empty());
    }

    #[test]
    fn repeated_vertices_are_welded_and_a_reversed_solid_is_recognised() {
        let (p, t) = tetrahedron();
        let split: Vec<DVec3> = t.iter().flat_map(|t| t.map(|c| p[c as usize])).collect();
        let reversed: Vec<[u32; 3]> = (0..4).map(|i| [3 * i, 3 * i + 2, 3 * i + 1]).collect();
        let (solids, _) = find_solids(&split, &reversed, |_| true);
        assert_eq!((solids.len(), solids[0].orientation), (1, -1));
    }

    #[test]
    fn solid_angles_tell_inside_from_outside() {
        let (p, t) = tetrahedron();
        let total = |o: DVec3| t.iter().map(|t| solid_angle(t.map(|c| p[c as usize] - o))).sum::<f64>();
        assert!((total(dvec3(0.1, 0.1, 0.1)).abs() - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        assert!(total(dvec3(1.0, 1.0, 1.0)).abs() < 1e-12);
    }
}
