//! Where the shadow of opaque casters ends on a face: receivers that no end crosses are lit or dark all over, and one end is one cut.
//!
//! What some casters hide of a face is bounded by edges of theirs. An edge that two of them share, on either side of it, bounds nothing. The others,
//! the ends, are found once for the face, and each of its receivers is compared with them:
//!
//! 1. If none crosses it, the receiver is dark if a caster covers its middle, else lit.
//! 2. If one crosses it from side to side, the receiver is dark on the left of that edge, where its caster is. On the right it is lit or dark, too.
//! 3. Else it must be cut by all casters.

use crate::covered::{Cover, Covering, Shape, covers_middle};
use glam::DVec2;
use pointillist_dice::{ConvexPolygon, HalfPlane, convex};

/// A shadow on a receiver.
#[derive(Debug, PartialEq)]
pub(crate) enum Shadow<'l> {
    /// It lets the same fraction of light through everywhere.
    Even(f64),
    /// All but this part of the receiver is dark.
    AllBut(&'l ConvexPolygon),
    Unknown,
}

/// The edges at which the shadow of some casters ends on a face. Memory is reused from face to face.
#[derive(Debug, Default)]
pub(crate) struct ShadowEnds {
    edges: Vec<[DVec2; 2]>,
    /// Whether `edges` are all there are.
    are_known: bool,
}

impl ShadowEnds {
    /// Forgets the last face.
    pub(crate) fn clear(&mut self) {
        self.edges.clear();
        self.are_known = false;
    }

    /// Finds those on a face with this outline.
    pub(crate) fn find<'c>(
        &mut self,
        covering: &mut Covering,
        casters: &[Cover],
        shape: impl Fn(u32) -> Shape<'c>,
        outline: &[DVec2],
    ) {
        self.edges.clear();
        self.are_known = covering.for_each_unpaired(casters, shape, outline, |edge| {
            // Where a surface turns away from the light, the triangles on both sides of an edge lie on the same side of it.
            if !self.edges.contains(&edge) {
                self.edges.push(edge);
            }
        });
    }

    /// The shadow of the same casters on a receiver with this outline, which is part of the face. `lit` is memory for what is lit.
    pub(crate) fn shadow_on<'c, 'l>(
        &self,
        casters: &[Cover],
        shape: impl Fn(u32) -> Shape<'c>,
        outline: &[DVec2],
        lit: &'l mut ConvexPolygon,
    ) -> Shadow<'l> {
        if !self.are_known {
            return Shadow::Unknown;
        }
        let mut crossing = self.edges.iter().filter_map(|edge| Some((edge, Crossing::of(edge, outline)?)));
        let Some((&[from, to], how)) = crossing.next() else {
            let is_dark = covers_middle(casters, shape, outline);
            return Shadow::Even(if is_dark { 0.0 } else { 1.0 });
        };
        if how == Crossing::Partly || crossing.next().is_some() {
            return Shadow::Unknown;
        }
        ConvexPolygon::from_vertices(outline).clip_into(&HalfPlane::left_of(to, from), lit);
        match covers_middle(casters, shape, lit.vertices()) {
            true => Shadow::Even(0.0),
            false => Shadow::AllBut(lit),
        }
    }
}

/// How an edge crosses the interior of a convex outline.
#[derive(Debug, PartialEq)]
enum Crossing {
    /// From side to side.
    Through,
    /// It may have an end inside.
    Partly,
}

impl Crossing {
    /// `None` if it does not cross it.
    fn of(&[from, to]: &[DVec2; 2], outline: &[DVec2]) -> Option<Self> {
        let along = to - from;
        let (mut left, mut right) = (false, false);
        for &p in outline {
            let side = along.perp_dot(p - from);
            left |= side > 0.0;
            right |= side < 0.0;
        }
        if !(left && right) {
            return None;
        }
        let (mut from_outside, mut to_outside) = (false, false);
        for half in convex::half_planes(outline) {
            let (from, to) = (half.value(from) <= 0.0, half.value(to) <= 0.0);
            if from && to {
                return None;
            }
            from_outside |= from;
            to_outside |= to;
        }
        // Its line crosses the interior, and no side has both ends beyond it: if both are outside, the interior is between them.
        Some(if from_outside && to_outside { Self::Through } else { Self::Partly })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overlap::{Corners, Overlap};
    use glam::dvec2;

    const FACE: [DVec2; 3] = [dvec2(-4.0, -4.0), dvec2(4.0, -4.0), dvec2(0.0, 4.0)];
    const RECEIVER: [DVec2; 3] = [dvec2(-1.0, -1.0), dvec2(1.0, -1.0), dvec2(0.0, 1.0)];

    /// The shadow of triangles on [`RECEIVER`], a part of [`FACE`].
    fn shadow_of<'l>(triangles: &[[DVec2; 3]], lit: &'l mut ConvexPolygon) -> Shadow<'l> {
        let sides: Vec<Vec<HalfPlane>> = triangles.iter().map(|t| convex::half_planes(t).collect()).collect();
        let mut corners = Corners::default();
        corners.set(&FACE);
        let across = |sides: &[HalfPlane]| match Overlap::of(sides, &corners) {
            Overlap::Across(edges) => Some(edges),
            other => panic!("{other:?}"),
        };
        let cover = |(i, s): (usize, &Vec<HalfPlane>)| Some(Cover { caster: i as u32, across: across(s)? });
        let casters: Vec<Cover> = sides.iter().enumerate().filter_map(cover).collect();
        let shape = |i: u32| (&triangles[i as usize][..], &sides[i as usize][..]);
        let mut ends = ShadowEnds::default();
        ends.find(&mut Covering::default(), &casters, shape, &FACE);
        ends.shadow_on(&casters, shape, &RECEIVER, lit)
    }

    #[test]
    fn one_end_is_one_cut() {
        let lit = &mut ConvexPolygon::default();
        let [a, b] = [dvec2(0.0, -9.0), dvec2(0.0, 9.0)];
        let Shadow::AllBut(right) = shadow_of(&[[a, b, dvec2(-9.0, 0.0)]], lit) else { panic!("one end") };
        assert_eq!(right.area(), 1.0);
        assert!(right.vertices().iter().all(|p| p.x >= 0.0));
        // What another caster hides, too, is dark.
        let [c, d] = [dvec2(-3.5, -9.0), dvec2(-3.5, 9.0)];
        let both = [[a, b, dvec2(-9.0, 0.0)], [d, c, dvec2(90.0, 0.0)]];
        assert_eq!(shadow_of(&both, lit), Shadow::Even(0.0));
    }

    #[test]
    fn an_edge_with_casters_on_either_side_is_no_end_and_one_with_two_on_one_side_is_one() {
        let lit = &mut ConvexPolygon::default();
        let [a, b] = [dvec2(0.0, -9.0), dvec2(0.0, 9.0)];
        let (left, other, right) = (dvec2(-9.0, 0.0), dvec2(-8.0, 1.0), dvec2(9.0, 0.0));
        assert_eq!(shadow_of(&[[a, b, left], [b, a, right]], lit), Shadow::Even(0.0));
        assert!(matches!(shadow_of(&[[a, b, left], [a, b, other]], lit), Shadow::AllBut(_)));
    }

    #[test]
    fn casters_beside_a_receiver_leave_it_lit_and_corners_within_it_are_not_known() {
        let lit = &mut ConvexPolygon::default();
        let far = [dvec2(-3.0, -9.0), dvec2(-3.0, 9.0), dvec2(-9.0, 0.0)];
        assert_eq!(shadow_of(&[far], lit), Shadow::Even(1.0));
        let corner = [dvec2(0.0, -0.5), dvec2(-5.0, 9.0), dvec2(-9.0, 0.0)];
        assert_eq!(shadow_of(&[corner], lit), Shadow::Unknown);
        // A slit is two ends.
        let [a, b] = [dvec2(0.0, -9.0), dvec2(0.0, 9.0)];
        let slit = [[a, b, dvec2(-9.0, 0.0)], [b, a + 1e-6, dvec2(9.0, 0.0)]];
        assert_eq!(shadow_of(&slit, lit), Shadow::Unknown);
    }

    #[test]
    fn an_edge_whose_line_crosses_need_not_cross() {
        let of = |from: DVec2, to: DVec2| Crossing::of(&[from, to], &RECEIVER);
        assert_eq!(of(dvec2(-3.0, 0.0), dvec2(3.0, 0.1)), Some(Crossing::Through));
        assert_eq!(of(dvec2(-3.0, 0.0), dvec2(0.0, 0.1)), Some(Crossing::Partly));
        assert_eq!(of(dvec2(0.1, -0.2), dvec2(0.0, 0.1)), Some(Crossing::Partly));
        assert_eq!(of(dvec2(-3.0, 0.0), dvec2(-2.0, 0.0)), None);
        assert_eq!(of(dvec2(-3.0, -1.0), dvec2(3.0, -1.0)), None);
        assert_eq!(of(dvec2(-3.0, 2.0), dvec2(3.0, 2.0)), None);
    }
}
