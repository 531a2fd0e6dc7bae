//! Triangles that may stand in the light, and the groups of targets that each may darken.

use crate::grid::{Group, LightGrid};
use crate::target::Target;
use glam::DVec2;
use pointillist_dice::{HalfPlane, convex};
use pointillist_micropoint::Face;
use std::ops::Range;

/// A triangle that may stand in the light.
#[derive(Clone, Debug)]
pub(crate) struct Caster {
    pub(crate) face: Face,
    pub(crate) bounds: (DVec2, DVec2),
    /// Those of [`Casters::vertices`] that are its corners, in positive order.
    pub(crate) outline: Range<usize>,
    /// The sum of its corners.
    pub(crate) corner_sum: DVec2,
    /// Those of [`Casters::sides`] that are the half-planes of its edges.
    pub(crate) sides: Range<usize>,
    /// `None`: textured.
    pub(crate) opacity: Option<f64>,
}

/// What decides about most casters of a group, side by side in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearby {
    pub(crate) bounds: (DVec2, DVec2),
    /// Largest nearness.
    pub(crate) nearest: f64,
    /// The caster's triangle.
    pub(crate) id: u32,
    /// Index into [`Casters::list`].
    pub(crate) index: u32,
}

impl Nearby {
    /// Whether a caster that is not the target's own face may stand before the target, by its bounds. One condition: which of them fails first varies.
    #[inline]
    pub(crate) fn may_darken(&self, target: &Target, face: &Face) -> bool {
        let ((low, high), (target_low, target_high)) = (self.bounds, target.bounds);
        (low.x < target_high.x)
            & (low.y < target_high.y)
            & (high.x > target_low.x)
            & (high.y > target_low.y)
            & (self.nearest >= target.nearness.least)
            & (self.id != face.id)
    }

    /// Finds those that may stand before a target by their bounds, by their places in the list.
    pub(crate) fn find(list: &[Self], target: &Target, face: &Face, found: &mut Vec<u32>) {
        // Without branches: which of them do is hard to predict.
        found.clear();
        found.resize(list.len(), 0);
        let mut count = 0;
        for (at, near) in list.iter().enumerate() {
            found[count] = at as u32;
            count += usize::from(near.may_darken(target, face));
        }
        found.truncate(count);
    }
}

/// An element of the list of casters of a group.
#[derive(Clone, Copy, Debug)]
struct Link {
    caster: u32,
    next: Option<u32>,
}

/// The casters of one screen.
#[derive(Debug, Default)]
pub(crate) struct Casters {
    pub(crate) list: Vec<Caster>,
    pub(crate) sides: Vec<HalfPlane>,
    pub(crate) vertices: Vec<DVec2>,
    links: Vec<Link>,
}

impl Casters {
    /// Removes all casters and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.sides.clear();
        self.vertices.clear();
        self.links.clear();
    }

    /// Links a face with this outline to the groups that it may darken, and keeps it as a caster if there are any. Returns whether it was kept.
    pub(crate) fn link(
        &mut self,
        face: &Face,
        outline: &[DVec2],
        opacity: Option<f32>,
        grid: &mut LightGrid,
    ) -> bool {
        let index = self.list.len() as u32;
        let Self { links, sides, .. } = self;
        let first_side = sides.len();
        sides.extend(convex::half_planes(outline));
        let own = &sides[first_side..];
        let (bounds, opacity) = (convex::bounds(outline), opacity.map(f64::from));
        let first = links.len();
        grid.darken_near(bounds, face.nearness.most, |group| match covers((face, opacity), own, group) {
            Cover::Nothing => false,
            Cover::All => true,
            Cover::Some => {
                links.push(Link { caster: index, next: group.first_link });
                group.first_link = Some(links.len() as u32 - 1);
                false
            }
        });
        let used = self.links.len() > first;
        if used {
            let first_vertex = self.vertices.len();
            self.vertices.extend_from_slice(outline);
            let corner_sum = outline.iter().fold(DVec2::ZERO, |sum, &v| sum + v);
            let (outline, sides) = (first_vertex..self.vertices.len(), first_side..self.sides.len());
            self.list.push(Caster { face: *face, bounds, outline, corner_sum, sides, opacity });
        } else {
            self.sides.truncate(first_side);
        }
        used
    }

    /// The casters of a group.
    pub(crate) fn of_group(&self, group: &Group, nearby: &mut Vec<Nearby>) {
        nearby.clear();
        let mut link = group.first_link;
        while let Some(at) = link {
            let Link { caster: index, next } = self.links[at as usize];
            let caster = &self.list[index as usize];
            link = next;
            // Merged into a copy of itself.
            if caster.opacity == Some(0.0) {
                continue;
            }
            let (bounds, nearest, id) = (caster.bounds, caster.face.nearness.most, caster.face.id);
            nearby.push(Nearby { bounds, nearest, id, index });
        }
    }
}

/// What a caster does to a group.
enum Cover {
    /// Its outline misses the group's rectangle.
    Nothing,
    Some,
    /// It is opaque and covers the rectangle, in front of all its targets. Then it also covers each
    /// target alone, and cutting would leave exactly nothing.
    All,
}

fn covers((face, opacity): (&Face, Option<f64>), sides: &[HalfPlane], group: &Group) -> Cover {
    let mut all_inside = true;
    for half in sides {
        // The corners of the rectangle farthest along the normal, and farthest against it.
        let along = DVec2::select(half.normal.cmpgt(DVec2::ZERO), group.high, group.low);
        let against = group.low + group.high - along;
        if half.value(along) < 0.0 {
            return Cover::Nothing;
        }
        all_inside &= half.value(against) >= 0.0;
    }
    let clearly_before = face.nearness.least > group.nearness.most + 1e-6 * group.nearness.most.abs();
    if all_inside && clearly_before && opacity == Some(1.0) { Cover::All } else { Cover::Some }
}
