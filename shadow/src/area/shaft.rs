//! The shaft between a box of receivers and the bounding rectangle of a light, by five half-spaces of the light's frame.

use glam::{DVec2, DVec3};

/// Overlaps that are smaller than this, times the coordinates, are taken for possible: rounding must not decide.
const MARGIN: f64 = 1e-9;

/// Bits of [`Shaft::beyond`].
const LEFT: u32 = 2;
const ABOVE: u32 = 4;
const BELOW: u32 = 5;

/// What lies beyond one of its planes casts no shadow on the light as seen from any point of the box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shaft {
    /// Where the planes to the left and to the right meet the light: coordinate minus slope times height is below or above.
    least: DVec2,
    most: DVec2,
    /// Slopes of these planes.
    least_slope: DVec2,
    most_slope: DVec2,
    /// Greatest height of a receiver.
    top: f64,
    margin: f64,
}

impl Shaft {
    /// Between the box `[low, high]` of the light's frame (z is the height over the light) and the rectangle `[least, most]` of its plane.
    ///
    /// In a plane that contains the height axis, f = x − most − slope · h is at most 0 in the box and 0 on the rectangle's side. Where
    /// f > 0 at a caster, f > 0 where the line from the receiver through the caster meets the light's plane, too.
    pub(crate) fn new((low, high): (DVec3, DVec3), (least, most): (DVec2, DVec2)) -> Self {
        let (b0, b1) = (low.truncate(), high.truncate());
        let size =
            [least, most, b0, b1].map(|v| v.abs().max_element()).into_iter().fold(high.z.abs(), f64::max);
        // A box that reaches to the light's plane has no slopes: its shaft has no sides. Upright sides would not do: the shafts of boxes
        // within it, which widen above their boxes' lower sides, would reach out of it.
        let steep = low.z <= MARGIN * size;
        let slope = |to_box: DVec2, widens: DVec2| {
            // The steepest line from the rectangle's side to a corner of the box.
            let by_height = |d: f64, sign: f64| if (d * sign) > 0.0 { d / low.z } else { d / high.z };
            DVec2::new(by_height(to_box.x, widens.x), by_height(to_box.y, widens.y))
        };
        let (least, most, least_slope, most_slope) = if steep {
            (DVec2::NEG_INFINITY, DVec2::INFINITY, DVec2::ZERO, DVec2::ZERO)
        } else {
            (least, most, slope(b0 - least, DVec2::NEG_ONE), slope(b1 - most, DVec2::ONE))
        };
        Self { least, most, least_slope, most_slope, top: high.z, margin: MARGIN * size }
    }

    /// The same shaft, exactly: what it does not miss, the shaft of no larger box misses.
    pub(crate) fn without_margin(&self) -> Self {
        Self { margin: 0.0, ..*self }
    }

    /// Which of its planes a point lies beyond, as bits; and whether it lies above all receivers, or not in front of the light.
    #[inline]
    pub(crate) fn beyond(&self, p: DVec3) -> u8 {
        let most = p.truncate() - self.most - self.most_slope * p.z;
        let least = p.truncate() - self.least - self.least_slope * p.z;
        let margin = self.margin;
        u8::from(most.x > margin)
            | u8::from(most.y > margin) << 1
            | u8::from(least.x < -margin) << LEFT
            | u8::from(least.y < -margin) << 3
            | u8::from(p.z >= self.top) << ABOVE
            | u8::from(p.z <= 0.0) << BELOW
    }

    /// Whether convex things with these corners are beyond one plane.
    #[inline]
    pub(crate) fn misses(&self, corners: impl Iterator<Item = DVec3>) -> bool {
        corners.fold(!0, |all, p| all & self.beyond(p)) != 0
    }

    /// Whether every point of the box sees an edge to the right of the rectangle (greater x), or above or below it (y): there it does not
    /// change winding numbers within the rectangle.
    pub(crate) fn is_right_or_beside(&self, [a, b]: [DVec3; 2]) -> bool {
        self.beyond(a) & self.beyond(b) & !(1 << LEFT | 1 << ABOVE | 1 << BELOW) != 0
    }

    /// The greatest height of the part of an edge that is within the planes; `None` if there is none. Without the margin: what is within a
    /// shaft is within that of every larger box.
    pub(crate) fn highest_within(&self, a: DVec3, b: DVec3) -> Option<f64> {
        let most = |p: DVec3| p.truncate() - self.most - self.most_slope * p.z;
        let least = |p: DVec3| self.least + self.least_slope * p.z - p.truncate();
        let ((ma, mb), (la, lb)) = ((most(a), most(b)), (least(a), least(b)));
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (fa, fb) in [(ma.x, mb.x), (ma.y, mb.y), (la.x, lb.x), (la.y, lb.y)] {
            match (fa > 0.0, fb > 0.0) {
                (true, true) => return None,
                (true, false) => from = from.max(fa / (fa - fb)),
                (false, true) => to = to.min(fa / (fa - fb)),
                (false, false) => {}
            }
        }
        (from <= to).then(|| (a.z + (b.z - a.z) * from).max(a.z + (b.z - a.z) * to))
    }
}
