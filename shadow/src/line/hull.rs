//! Whether something may be between a group of receivers and a line, by directions that separate it from their hull.

use glam::DVec3;

/// Gaps smaller than this, times the coordinates, are none: rounding must not decide.
const MARGIN: f64 = 1e-9;

/// Directions, and how far the hull of a box and a line reaches along each.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hull {
    reach: [(DVec3, f64); DIRECTIONS],
    margin: f64,
}

const DIRECTIONS: usize = 11;

impl Hull {
    /// Of a box and the line between two points.
    ///
    /// The directions are those of the axes, both normals of the plane through the line and the middle of the box, and the outward normals, in
    /// that plane, of the triangle that they form.
    pub(crate) fn new((low, high): (DVec3, DVec3), [a, b]: [DVec3; 2]) -> Self {
        let middle = 0.5 * (low + high);
        let across = (a - middle).cross(b - middle).normalize_or_zero();
        let outward = |from: DVec3, to: DVec3, other: DVec3| {
            let side = (to - from).cross(across).normalize_or_zero();
            if side.dot(other - from) > 0.0 { -side } else { side }
        };
        let directions = [
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::NEG_X,
            DVec3::NEG_Y,
            DVec3::NEG_Z,
            across,
            -across,
            outward(a, b, middle),
            outward(middle, a, b),
            outward(middle, b, a),
        ];
        let reach = |d: DVec3| {
            let of_box = d.dot(DVec3::select(d.cmpgt(DVec3::ZERO), high, low));
            (d, of_box.max(d.dot(a)).max(d.dot(b)))
        };
        let size = [low, high, a, b].map(|p| p.abs().max_element()).into_iter().fold(0.0, f64::max);
        Self { reach: directions.map(reach), margin: MARGIN * size }
    }

    /// Whether convex things with these corners are beyond it in one direction.
    pub(crate) fn misses(&self, corners: &[DVec3]) -> bool {
        self.reach.iter().any(|&(d, reach)| corners.iter().all(|c| d.dot(*c) > reach + self.margin))
    }
}
