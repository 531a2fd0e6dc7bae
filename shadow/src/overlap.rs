//! How the outline of a caster lies to a target, by the half-planes of its edges.

use glam::DVec2;
use pointillist_dice::HalfPlane;

/// Edges of a caster, by the numbers of their half-planes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Edges(u32);

impl Edges {
    pub(crate) fn has(self, number: usize) -> bool {
        self.0 >> number & 1 == 1
    }
}

/// How a caster's outline lies to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Overlap {
    /// One of its edges separates them.
    Apart,
    /// It contains the target.
    Over,
    /// It has these edges whose lines may cross the target; the target is on the inner side of the others.
    Across(Edges),
}

impl Overlap {
    pub(crate) fn of(sides: &[HalfPlane], target: &[DVec2]) -> Self {
        // Most targets are triangles: loops of known length have no branches.
        match <&[DVec2; 3]>::try_from(target) {
            Ok(triangle) => Self::of_points(sides, triangle),
            Err(_) => Self::of_points(sides, target),
        }
    }

    #[inline]
    fn of_points<'p, P: Copy + IntoIterator<Item = &'p DVec2>>(sides: &[HalfPlane], target: P) -> Self {
        let (mut across, mut over) = (0, true);
        for (number, half) in sides.iter().enumerate() {
            let (mut inside, mut outside) = (false, false);
            for &p in target {
                let value = half.value(p);
                inside |= value > 0.0;
                outside |= value < 0.0;
            }
            if !inside {
                return Self::Apart;
            }
            over &= !outside;
            // The half-plane of a short edge was moved outward from its line.
            across |= u32::from(outside | (half.offset != 0.0)) << number;
        }
        if over { Self::Over } else { Self::Across(Edges(across)) }
    }
}
