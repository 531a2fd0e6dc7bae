//! Positions of the vertices and the two predicates on them: the side of a plane, and inside or outside of a sphere.
//!
//! Both are answered exactly. A determinant in `f64` decides whenever it is larger than its error can be, for which one
//! bound serves all points: it follows from the longest side of their box. On small integers there is no error, so the
//! bound is 0. [`Exact`] decides the rest.

use super::cell::{Vertex, replaced};
use super::exact::{self, Exact};
use super::limbs;
use super::scale::Scale;
use crate::wide;
use glam::DVec3;
use std::cmp::Ordering;

/// A position, scaled; padded so that it never lies in two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
struct Site {
    p: DVec3,
}

/// The positions of all vertices, and how exact signs are had of them.
#[derive(Clone, Debug)]
pub(crate) struct Sites {
    /// Scaled. The first is a placeholder for the vertex at infinity; results computed from it are never used.
    at: Vec<Site>,
    /// As given, and only where scaling rounds or products of scaled coordinates may underflow.
    given: Vec<DVec3>,
    scale: Scale,
    exact: Exact,
    /// The box, scaled.
    lo: DVec3,
    hi: DVec3,
    /// A determinant larger than this has the right sign.
    orient_bound: f64,
    sphere_bound: f64,
}

/// Bounds the error of [`orient_det`] for differences of at most 1: the sum of the absolute values of its products, 6,
/// times Shewchuk's factor (7 + 56ε)ε, rounded up.
const ORIENT_ERROR: f64 = 6.0 * 8.0 * (f64::EPSILON / 2.0);

/// As [`ORIENT_ERROR`] for [`sphere_det`]: 4 · 3 · 6 times (16 + 224ε)ε, rounded up.
const SPHERE_ERROR: f64 = LARGEST_SPHERE_DET * 17.0 * (f64::EPSILON / 2.0);

/// Differences shorter than this are too near to underflow for a bound that follows from them.
const LEAST_LENGTH: f64 = 1e-50;

/// Smallest error bound other than 0: products that underflow add less error than this.
const LEAST_BOUND: f64 = 1e-200;

/// The sum of the absolute values of the products in [`sphere_det`], for differences of at most 1: no partial sum is
/// larger.
const LARGEST_SPHERE_DET: f64 = 72.0;

/// 2⁵³: determinants of integers that cannot reach it are exact in `f64`.
const EXACT_BELOW: f64 = (1u64 << 53) as f64;

/// (b−a)×(c−a)·(d−a), computed from differences to d.
#[inline]
fn orient_det(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let (a, b, c) = (a - d, b - d, c - d);
    let bc = b.x * c.y - c.x * b.y;
    let ca = c.x * a.y - a.x * c.y;
    let ab = a.x * b.y - b.x * a.y;
    -(a.z * bc + b.z * ca + c.z * ab)
}

/// One number for each corner of a tetrahedron.
type Lanes = [f64; 4];

#[inline(always)]
fn lanes(f: impl Fn(usize) -> f64) -> Lanes {
    [f(0), f(1), f(2), f(3)]
}

/// How far each corner is lifted above p's, and six times the signed volume of p and the other three corners: positive
/// where p lies on the corner's side of them.
///
/// The terms are those of Shewchuk's `insphere`, so that his bound holds; the four of a kind stand side by side, for
/// the compiler to compute them at once.
#[inline(always)]
fn lifts_and_volumes(corners: [DVec3; 4], p: DVec3) -> (Lanes, Lanes) {
    let x = lanes(|i| corners[i].x - p.x);
    let y = lanes(|i| corners[i].y - p.y);
    let z = lanes(|i| corners[i].z - p.z);
    let lift = lanes(|i| x[i] * x[i] + y[i] * y[i] + z[i] * z[i]);
    // With j and k after i in a circle of four: areas of ij and ik seen along z, then volumes of ijk.
    let near = lanes(|i| x[i] * y[(i + 1) & 3] - x[(i + 1) & 3] * y[i]);
    let far = lanes(|i| x[i] * y[(i + 2) & 3] - x[(i + 2) & 3] * y[i]);
    let volume = lanes(|i| {
        let (j, k) = ((i + 1) & 3, (i + 2) & 3);
        z[i] * near[j] - z[j] * far[i] + z[k] * near[i]
    });
    (lift, [volume[1], -volume[2], volume[3], -volume[0]])
}

/// Positive where p lies inside the sphere through the corners of a positive tetrahedron.
#[inline(always)]
fn sphere_det(corners: [DVec3; 4], p: DVec3) -> f64 {
    let (lift, volume) = lifts_and_volumes(corners, p);
    let term = lanes(|i| lift[i] * volume[i]);
    (term[0] + term[1]) + (term[2] + term[3])
}

/// As [`Sites::breaks_tie`], of integers for which none of this rounds: their differences are below 1024, so that one
/// number tells their lexicographic order.
fn breaks_small_tie(corners: [DVec3; 4], p: DVec3) -> bool {
    let (_, volume) = lifts_and_volumes(corners, p);
    // Corners in the plane of the others and p do not decide; p itself has 0.
    let lateness = lanes(|i| {
        let d = corners[i] - p;
        if volume[i] == 0.0 { -1.0 } else { (d.x * 1024.0 + d.y) * 1024.0 + d.z }
    });
    let last = (1..4).fold(0, |last, i| if lateness[i] > lateness[last] { i } else { last });
    lateness[last] > 0.0 && volume[last] > 0.0
}

impl Sites {
    /// These points, from vertex 1 on.
    pub(crate) fn new(points: impl ExactSizeIterator<Item = DVec3> + Clone) -> Self {
        let scale = Scale::new(points.clone());
        let mut at = Vec::with_capacity(points.len() + 1);
        at.push(Site::default());
        at.extend(points.clone().map(|p| Site { p: scale.apply(p) }));
        let (lo, hi) = at[1..]
            .iter()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), s| (lo.min(s.p), hi.max(s.p)));
        let mut sites = Self {
            at,
            given: vec![],
            scale,
            exact: Exact::Wide,
            lo,
            hi,
            orient_bound: 0.0,
            sphere_bound: 0.0,
        };
        sites.choose_arithmetic();
        if sites.exact == Exact::Wide {
            sites.given.push(DVec3::ZERO);
            sites.given.extend(points);
        }
        sites
    }

    /// The cheapest arithmetic that is exact for all differences within the box.
    fn choose_arithmetic(&mut self) {
        let side = (self.hi - self.lo).max_element() * (1.0 + f64::EPSILON);
        let largest_det = LARGEST_SPHERE_DET * side.powi(5);
        self.exact = if self.scale.is_lattice && largest_det < EXACT_BELOW {
            Exact::Small
        } else if self.scale.is_lattice && largest_det < exact::INTEGER_BELOW {
            Exact::Integer
        } else if self.scale.unit >= exact::LEAST_UNIT {
            Exact::Expansion
        } else {
            Exact::Wide
        };
        let bound = |b: f64| if self.exact == Exact::Small { 0.0 } else { b.max(LEAST_BOUND) };
        self.orient_bound = bound(ORIENT_ERROR * side.powi(3));
        self.sphere_bound = bound(SPHERE_ERROR * side.powi(5));
    }

    /// Adds a vertex; `None` if the scale does not fit it, so that all have to be scaled anew.
    pub(super) fn push(&mut self, p: DVec3) -> Option<Vertex> {
        let (scale, lo, hi, exact) = (self.scale, self.lo, self.hi, self.exact);
        let scaled = self.scale.apply_new(p)?;
        (self.lo, self.hi) = (self.lo.min(scaled), self.hi.max(scaled));
        self.choose_arithmetic();
        if self.exact == Exact::Wide && exact != Exact::Wide {
            // The positions as given were not kept.
            (self.scale, self.lo, self.hi) = (scale, lo, hi);
            self.choose_arithmetic();
            return None;
        }
        if self.exact == Exact::Wide {
            self.given.push(p);
        }
        self.at.push(Site { p: scaled });
        Some(Vertex(self.at.len() as u32 - 1))
    }

    /// One more vertex in the box, off the plane in which all others lie: they and it span tetrahedra whose bases are
    /// the Delaunay triangles of that plane.
    pub(crate) fn push_apex(&mut self, plane: [Vertex; 3]) -> Vertex {
        let from = plane[0];
        let apex = Vertex(self.at.len() as u32);
        self.at.push(self.at[from.slot()]);
        if self.exact == Exact::Wide {
            self.given.push(self.given[from.slot()]);
        }
        let [a, b, c] = plane;
        for axis in 0..3 {
            self.move_far(apex, axis);
            if self.orient([a, b, c, apex]) != 0.0 {
                return apex;
            }
            self.at[apex.slot()] = self.at[from.slot()];
            if self.exact == Exact::Wide {
                self.given[apex.slot()] = self.given[from.slot()];
            }
        }
        unreachable!("no plane holds three directions")
    }

    /// Moves a vertex along an axis, about as far as the box is wide, to where all arithmetic stays exact.
    fn move_far(&mut self, v: Vertex, axis: usize) {
        let p = &mut self.at[v.slot()].p;
        if self.scale.is_lattice {
            let side = (self.hi - self.lo).max_element();
            let middle = 0.5 * (self.lo + self.hi)[axis];
            p[axis] = if p[axis] > middle { self.hi[axis] - side } else { self.lo[axis] + side };
        } else if self.exact == Exact::Wide {
            let largest = self.given.iter().map(|g| g.abs().max_element()).fold(0.0, f64::max);
            let given = &mut self.given[v.slot()];
            given[axis] = if given[axis] > 0.0 { -largest } else { largest };
            *p = self.scale.apply(*given);
        } else {
            let largest = self.lo.abs().max(self.hi.abs()).max_element();
            p[axis] = if p[axis] > 0.0 { -largest } else { largest };
        }
        (self.lo, self.hi) = (self.lo.min(*p), self.hi.max(*p));
        self.choose_arithmetic();
    }

    /// Where a vertex is, scaled.
    #[inline]
    pub(super) fn position(&self, v: Vertex) -> DVec3 {
        self.at[v.slot()].p
    }

    /// The same without what scaling may lose: as given where it does, else scaled.
    #[inline]
    pub(super) fn exact_position(&self, v: Vertex) -> DVec3 {
        if self.exact == Exact::Wide { self.given[v.slot()] } else { self.position(v) }
    }

    /// Whether positions are those given, up to the scale.
    pub(super) fn are_positions_exact(&self) -> bool {
        self.exact != Exact::Wide
    }

    /// The largest of (b−a)×(c−a)·(p−a) over the corners p of a box within that of all, and a bound for its error.
    pub(super) fn reach_beyond(&self, face: [Vertex; 3], lo: DVec3, hi: DVec3) -> (f64, f64) {
        let [a, b, c] = face.map(|v| self.position(v));
        let corner = |k: u32| DVec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), hi, lo);
        let largest = (0..8).map(|k| orient_det(a, b, c, corner(k))).fold(f64::NEG_INFINITY, f64::max);
        (largest, self.orient_bound)
    }

    /// How many there are, the one at infinity included.
    pub(super) fn len(&self) -> usize {
        self.at.len()
    }

    /// Lexicographic order of positions: the same for scaled ones as for those given.
    pub(crate) fn compare(&self, v: Vertex, w: Vertex) -> Ordering {
        let (a, b) = (self.exact_position(v), self.exact_position(w));
        a.to_array().partial_cmp(&b.to_array()).expect("positions are finite")
    }

    /// A number with the sign of (b−a)×(c−a)·(d−a).
    #[inline]
    pub(crate) fn orient(&self, corners: [Vertex; 4]) -> f64 {
        let [a, b, c, d] = corners.map(|v| self.at[v.slot()].p);
        let det = orient_det(a, b, c, d);
        if det.abs() > self.orient_bound { det } else { self.orient_exactly(corners, det) }
    }

    /// Whether `f64` does not round determinants of differences up to this.
    fn is_small(&self, reach: f64) -> bool {
        self.scale.is_lattice && LARGEST_SPHERE_DET * reach.powi(5) < EXACT_BELOW
    }

    #[cold]
    #[inline(never)]
    fn orient_exactly(&self, corners: [Vertex; 4], det: f64) -> f64 {
        let points = corners.map(|v| self.at[v.slot()].p);
        let [a, b, c, d] = points;
        let reach = (a - d).abs().max((b - d).abs()).max((c - d).abs()).max_element();
        if self.is_small(reach) {
            return det;
        }
        if reach > LEAST_LENGTH && det.abs() > ORIENT_ERROR * reach.powi(3) {
            return det;
        }
        match self.exact {
            Exact::Small => 0.0,
            Exact::Integer => exact::integer_orient(points),
            Exact::Expansion => limbs::orient(points).unwrap_or_else(|| exact::expansion_orient(points)),
            Exact::Wide => wide::orient(corners.map(|v| self.given[v.slot()])),
        }
    }

    /// Whether p lies inside the sphere through the corners of a positive tetrahedron, where a point on the sphere
    /// counts as moved as [`Sites::breaks_tie`] says.
    #[inline]
    pub(super) fn in_sphere(&self, corners: [Vertex; 4], p: Vertex) -> bool {
        let det = sphere_det(corners.map(|v| self.at[v.slot()].p), self.at[p.slot()].p);
        if det.abs() > self.sphere_bound { det > 0.0 } else { self.in_sphere_exactly(corners, p, det) }
    }

    #[cold]
    #[inline(never)]
    fn in_sphere_exactly(&self, corners: [Vertex; 4], v: Vertex, det: f64) -> bool {
        let points = corners.map(|v| self.at[v.slot()].p);
        let p = self.at[v.slot()].p;
        let reach = points.into_iter().fold(DVec3::ZERO, |r, q| r.max((q - p).abs())).max_element();
        if self.is_small(reach) {
            return if det == 0.0 { breaks_small_tie(points, p) } else { det > 0.0 };
        }
        if reach > LEAST_LENGTH && det.abs() > SPHERE_ERROR * reach.powi(5) {
            return det > 0.0;
        }
        let sign = self.exact_sphere(corners, v);
        if sign == 0.0 { self.breaks_tie(corners, v) } else { sign > 0.0 }
    }

    /// A number with the sign of the sphere's determinant, by exact arithmetic.
    fn exact_sphere(&self, corners: [Vertex; 4], v: Vertex) -> f64 {
        let points = corners.map(|v| self.at[v.slot()].p);
        let p = self.at[v.slot()].p;
        match self.exact {
            Exact::Small => 0.0,
            Exact::Integer => exact::integer_sphere(points, p),
            Exact::Expansion => {
                limbs::sphere(points, p).unwrap_or_else(|| exact::expansion_sphere(points, p))
            }
            Exact::Wide => wide::sphere(corners.map(|v| self.given[v.slot()]), self.given[v.slot()]),
        }
    }

    /// Positive where p lies inside the sphere through the corners of a positive tetrahedron, 0 on it, negative
    /// outside.
    pub(crate) fn sphere_sign(&self, corners: [Vertex; 4], p: Vertex) -> f64 {
        let det = sphere_det(corners.map(|v| self.at[v.slot()].p), self.at[p.slot()].p);
        if det.abs() > self.sphere_bound || self.exact == Exact::Small {
            det
        } else {
            self.exact_sphere(corners, p)
        }
    }

    /// Whether p, on the sphere through the corners, counts as inside.
    ///
    /// Delaunay triangulations are the lower hulls of points lifted to the paraboloid. Each point counts as lifted
    /// higher by an infinitesimal amount of its own, the larger the later it comes in lexicographic order, and by
    /// incomparably more than all before it: so the answer is that of the last point whose lifting changes it. That of
    /// p takes it out of the sphere. That of a corner takes p in if p lies on the corner's side of the other three, and
    /// out on the other side; in their plane it does nothing.
    fn breaks_tie(&self, corners: [Vertex; 4], p: Vertex) -> bool {
        let mut order = [0, 1, 2, 3, 4];
        let of = |k: usize| if k == 4 { p } else { corners[k] };
        order.sort_unstable_by(|&i, &j| self.compare(of(j), of(i)));
        for k in order {
            if k == 4 {
                return false;
            }
            let side = self.orient(replaced(corners, k, p));
            if side != 0.0 {
                return side > 0.0;
            }
        }
        unreachable!("p itself decides at the latest")
    }

    /// Signs of the components of (b−a)×(c−a).
    pub(super) fn normal_signs(&self, corners: [Vertex; 3]) -> [f64; 3] {
        if self.exact == Exact::Wide {
            wide::normal_signs(corners.map(|v| self.given[v.slot()]))
        } else {
            exact::normal_signs(corners.map(|v| self.at[v.slot()].p))
        }
    }

    /// Whether three vertices lie on a line.
    pub(crate) fn are_collinear(&self, corners: [Vertex; 3]) -> bool {
        self.normal_signs(corners) == [0.0; 3]
    }

    /// Forgets the last vertex.
    pub(super) fn pop(&mut self) {
        self.at.pop();
        if self.exact == Exact::Wide {
            self.given.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;

    /// Two short edges along one line, and a long edge to the opposite corner of the box, in any order: the volume is 0, and its terms round.
    #[test]
    fn corners_of_a_plane_are_so_where_sides_differ_much() {
        let mut seed = 11_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 34) as f64 * 0.5_f64.powi(52)
        };
        for _ in 0..2000 {
            let mut short = || dvec3(random(), random(), random());
            let (near, far) = (DVec3::splat(-1.0), DVec3::ONE - 0.5 * short());
            let along = short();
            let corners = [near, near + 3.0 * along, near + 8.0 * along, far];
            let sites = Sites::new(corners.into_iter());
            for turned in 0..4 {
                let order = [0, 1, 2, 3].map(|k| Vertex(1 + (k + turned) % 4));
                assert_eq!(sites.orient(order), 0.0, "{corners:?}, {turned}");
            }
        }
    }
}
