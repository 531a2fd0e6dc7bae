//! Targets behind several casters that hide them together, found without cutting.
//!
//! Triangles of a mesh that share an edge, on either side of it, leave no gap there. So if every edge of some opaque casters that crosses a target is an edge
//! of another of them on its other side, then the border of their union does not cross the target; and if they hide its middle, they hide all of it. Corners that triangles share are projected to the same place, bit for bit.
//!
//! 1. The edges that cross the target are collected.
//! 2. Casters with an edge that no other has on its other side are left out; their other edges then lack a partner, and so on.
//! 3. If a caster is left that covers the middle of the target, this is hidden. What is left does not depend on the order of casters.

use crate::overlap::Edges;
use glam::DVec2;
use pointillist_dice::{HalfPlane, convex};

/// More casters than this are not looked at: comparing their edges with each other would take longer than it saves.
const MOST: usize = 64;

/// A caster's outline and the half-planes of its edges.
pub(crate) type Shape<'c> = (&'c [DVec2], &'c [HalfPlane]);

/// An opaque caster in front of all of the target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cover {
    /// Its number.
    pub(crate) caster: u32,
    /// Its edges whose lines may cross the target.
    pub(crate) across: Edges,
}

/// Memory for one target.
#[derive(Debug, Default)]
pub(crate) struct Covering {
    /// The half-planes of the target's edges.
    sides: Vec<HalfPlane>,
    edges: Vec<Edge>,
    /// The last edge with each remainder of [`Edge::key`].
    last: Vec<Option<u16>>,
    /// Whether more than two casters share some edge.
    forks: bool,
    /// For each caster, whether it was left out.
    left_out: Vec<bool>,
}

/// Edges are looked up by one of so many keys.
const KEYS: usize = 64;

/// An edge that crosses the target.
#[derive(Clone, Copy, Debug)]
struct Edge {
    owner: usize,
    from: DVec2,
    to: DVec2,
    /// The edge before it with the same key.
    before: Option<u16>,
    /// An edge of another caster on the other side.
    partner: Option<u16>,
}

impl Edge {
    /// The same for an edge and its reverse.
    fn key(&self) -> usize {
        // Sums that differ mostly differ in their last bits, which the product carries to its first ones.
        const ODD: u64 = 0x9e37_79b9_7f4a_7c15;
        ((self.from.x + self.to.x).to_bits().wrapping_mul(ODD) >> (64 - KEYS.trailing_zeros())) as usize
    }

    fn is_reverse_of(&self, other: &Self) -> bool {
        self.from == other.to && self.to == other.from
    }
}

impl Covering {
    /// Whether some of these casters hide a target with this outline.
    pub(crate) fn hides<'c>(
        &mut self,
        casters: &[Cover],
        shape: impl Fn(u32) -> Shape<'c>,
        outline: &[DVec2],
    ) -> bool {
        if !(2..=MOST).contains(&casters.len()) || !covers_samples(casters, &shape, outline) {
            return false;
        }
        self.collect_edges(casters, &shape, outline);
        self.find_partners();
        while self.leave_out_incomplete() {}
        // One that only touches the target within rounding has no edge that crosses it.
        let stay = casters.iter().zip(&self.left_out).filter(|(_, left_out)| !**left_out);
        covers_middle(stay.map(|(cover, _)| cover), shape, outline)
    }

    /// Calls `visit` with the edges of these casters that cross a target and have none of another on their other side. Returns false, and visits
    /// none, if there are too many casters to look at.
    pub(crate) fn for_each_unpaired<'c>(
        &mut self,
        casters: &[Cover],
        shape: impl Fn(u32) -> Shape<'c>,
        outline: &[DVec2],
        mut visit: impl FnMut([DVec2; 2]),
    ) -> bool {
        if casters.len() > MOST {
            return false;
        }
        self.collect_edges(casters, &shape, outline);
        self.find_partners();
        self.edges.iter().filter(|edge| edge.partner.is_none()).for_each(|edge| visit([edge.from, edge.to]));
        true
    }

    fn collect_edges<'c>(&mut self, casters: &[Cover], shape: &impl Fn(u32) -> Shape<'c>, outline: &[DVec2]) {
        self.left_out.clear();
        self.left_out.resize(casters.len(), false);
        self.sides.clear();
        self.sides.extend(convex::half_planes(outline));
        self.edges.clear();
        self.last.clear();
        self.last.resize(KEYS, None);
        for (owner, &Cover { caster, across }) in casters.iter().enumerate() {
            let ring = shape(caster).0;
            let (mut from, mut number) = (ring[ring.len() - 1], 0);
            for &to in ring {
                // Corners that coincide have no half-plane between them.
                if from != to {
                    if across.has(number) && !self.is_beyond_a_side(from, to) {
                        self.push(Edge { owner, from, to, before: None, partner: None });
                    }
                    number += 1;
                }
                from = to;
            }
        }
    }

    /// Whether an edge, whose line crosses the target, lies outside of it.
    fn is_beyond_a_side(&self, from: DVec2, to: DVec2) -> bool {
        self.sides.iter().any(|half| half.value(from).max(half.value(to)) <= 0.0)
    }

    fn push(&mut self, mut edge: Edge) {
        let number = Some(self.edges.len() as u16);
        edge.before = std::mem::replace(&mut self.last[edge.key()], number);
        self.edges.push(edge);
    }

    /// Gives every edge that has one a partner.
    fn find_partners(&mut self) {
        self.forks = false;
        for i in 0..self.edges.len() {
            if self.edges[i].partner.is_none() {
                let partner = self.partner(i, |_| true);
                self.edges[i].partner = partner;
                if let Some(j) = partner {
                    self.forks |= *self.edges[usize::from(j)].partner.get_or_insert(i as u16) != i as u16;
                }
            }
        }
    }

    /// An edge on the other side of an edge whose owner is wanted.
    fn partner(&self, edge: usize, wanted: impl Fn(usize) -> bool) -> Option<u16> {
        let edge = &self.edges[edge];
        let mut next = self.last[edge.key()];
        while let Some(number) = next {
            let other = &self.edges[usize::from(number)];
            if other.is_reverse_of(edge) && wanted(other.owner) {
                break;
            }
            next = other.before;
        }
        next
    }

    /// Leaves out casters that have an edge without a partner. Returns whether there were any.
    fn leave_out_incomplete(&mut self) -> bool {
        let mut changed = false;
        for i in 0..self.edges.len() {
            let Edge { owner, partner, .. } = self.edges[i];
            let stays = |owner: usize| !self.left_out[owner];
            // Where triangles fork, another one may take the place of a partner that was left out.
            let another = || self.forks && self.partner(i, stays).is_some();
            let complete = || partner.is_some_and(|j| stays(self.edges[usize::from(j)].owner) || another());
            if stays(owner) && !complete() {
                self.left_out[owner] = true;
                changed = true;
            }
        }
        changed
    }
}

/// Whether casters cover some points of a target. Most targets that are lit in part are told by them.
fn covers_samples<'c>(casters: &[Cover], shape: &impl Fn(u32) -> Shape<'c>, outline: &[DVec2]) -> bool {
    let middle = middle(outline);
    outline.iter().all(|&v| casters.iter().any(|c| covers(shape(c.caster), 0.5 * (middle + v))))
}

/// Whether some of these casters cover the middle of an outline.
pub(crate) fn covers_middle<'c, 'l>(
    casters: impl IntoIterator<Item = &'l Cover>,
    shape: impl Fn(u32) -> Shape<'c>,
    outline: &[DVec2],
) -> bool {
    let middle = middle(outline);
    casters.into_iter().any(|c| covers(shape(c.caster), middle))
}

fn covers((_, sides): Shape<'_>, p: DVec2) -> bool {
    sides.iter().all(|half| half.value(p) >= 0.0)
}

fn middle(outline: &[DVec2]) -> DVec2 {
    outline.iter().fold(DVec2::ZERO, |sum, &v| sum + v) / outline.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlap::{Corners, Overlap};
    use glam::dvec2;

    const TARGET: [DVec2; 3] = [dvec2(-1.0, -1.0), dvec2(1.0, -1.0), dvec2(0.0, 1.0)];

    /// Whether triangles hide the target, in every order.
    fn hidden_by(triangles: &[[DVec2; 3]]) -> bool {
        let sides: Vec<Vec<HalfPlane>> = triangles.iter().map(|t| convex::half_planes(t).collect()).collect();
        let shape = |i: u32| (&triangles[i as usize][..], &sides[i as usize][..]);
        let mut corners = Corners::default();
        corners.set(&TARGET);
        let across = |sides: &[HalfPlane]| match Overlap::of(sides, &corners) {
            Overlap::Across(edges) => edges,
            Overlap::Apart | Overlap::Over => Edges::default(),
        };
        let cover = |(i, sides): (usize, &Vec<HalfPlane>)| Cover { caster: i as u32, across: across(sides) };
        let mut order: Vec<Cover> = sides.iter().enumerate().map(cover).collect();
        let mut covering = Covering::default();
        let first = covering.hides(&order, shape, &TARGET);
        for _ in 0..triangles.len() {
            order.rotate_left(1);
            assert_eq!(covering.hides(&order, shape, &TARGET), first, "{order:?}");
        }
        first
    }

    #[test]
    fn neighbours_hide_what_lies_across_their_edge_and_a_slit_does_not() {
        let [a, b] = [dvec2(0.1, -9.0), dvec2(0.2, 9.0)];
        let (left, right) = (dvec2(-9.0, 0.0), dvec2(9.0, 0.0));
        assert!(hidden_by(&[[a, b, left], [b, a, right]]));
        assert!(!hidden_by(&[[a, b, left], [b, a + 1e-12, right]]));
    }

    #[test]
    fn a_fold_hides_one_side_only() {
        let [a, b] = [dvec2(0.1, -9.0), dvec2(0.2, 9.0)];
        assert!(!hidden_by(&[[a, b, dvec2(-9.0, 0.0)], [a, b, dvec2(-8.0, 1.0)]]));
        // Even where the points that are looked at first are covered.
        let [a, b] = [dvec2(0.9, -9.0), dvec2(0.9, 9.0)];
        assert!(!hidden_by(&[[a, b, dvec2(-9.0, 0.0)], [a, b, dvec2(-8.0, 1.0)]]));
    }

    #[test]
    fn a_fan_hides_what_lies_around_its_centre_unless_a_sector_is_missing() {
        let centre = dvec2(0.1, -0.2);
        let ray = |k: u32| centre + 9.0 * DVec2::from_angle(f64::from(k % 7));
        let fan: Vec<_> = (0..7).map(|k| [centre, ray(k), if k < 6 { ray(k + 1) } else { ray(0) }]).collect();
        assert!(hidden_by(&fan[..]));
        assert!((0..7).all(|k| {
            let others: Vec<_> = (0..7).filter(|&i| i != k).map(|i| fan[i]).collect();
            !hidden_by(&others)
        }));
    }

    #[test]
    fn where_three_triangles_share_an_edge_any_partner_will_do() {
        let [a, b] = [dvec2(0.1, -9.0), dvec2(0.2, 9.0)];
        let (left, right) = (dvec2(-9.0, 0.0), dvec2(9.0, 0.0));
        // The first on the right is cut short, so that the target reaches beyond it.
        let short = dvec2(0.6, 0.0);
        assert!(hidden_by(&[[a, b, left], [b, a, short], [b, a, right]]));
        assert!(!hidden_by(&[[a, b, left], [b, a, short]]));
    }
}
