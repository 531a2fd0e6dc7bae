//! Points all over the part of a mesh that a picture shows.
//!
//! Points are about as far apart as pixels where they are, or as the points of the scans beside them if those are farther apart. A
//! triangle is halved across its longest edge (1) until it is out of view and left out, or (2) short, or all in view and at
//! about one depth, and gets a lattice. So a triangle that reaches far beyond the view costs no more than its visible part.

use crate::scene::{Camera, Projection};
use glam::DVec3;

/// Pieces with at most this many points along an edge are not cut further: a lattice costs less than cutting.
const SHORT: f64 = 16.0;
/// Depths within a piece whose pixels differ by at most this factor are one depth.
const ONE_DEPTH: f64 = 1.5;
/// Neighbours of a lattice are this many pixels apart, so that every pixel of a triangle that faces the eye has a point.
const PIXELS_APART: f64 = 0.8;
/// Pixels around the picture that get points, too: surfaces are averaged over neighbours.
const BORDER_PX: f64 = 16.0;
/// The nearest depth that is looked at, over the distance from the eye to its target.
const NEAREST: f64 = 1e-3;

/// Where points are needed, and how close together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needed {
    eye: DVec3,
    /// To the right, up, and along the view.
    axes: [DVec3; 3],
    projection: Projection,
    /// Half the width and height of what is seen, at depth 1 or at any depth.
    half: [f64; 2],
    /// World units between neighbours, at depth 1 or at any depth.
    apart: f64,
    nearest: f64,
    /// Points are at least this far apart.
    least: f64,
    /// Points are farther apart by this factor.
    coarser: f64,
}

impl Needed {
    /// For a picture with sides of `size` pixels, and points at least `least` apart.
    pub(super) fn new(camera: &Camera, size: [u32; 2], least: f64) -> Self {
        let [right, up, backward] = camera.axes();
        let [width, height] = size.map(f64::from);
        let half_height = match camera.projection {
            Projection::Perspective { fov_y_rad } => (0.5 * fov_y_rad).tan(),
            Projection::Orthographic { height } => 0.5 * height,
        };
        let pixel = 2.0 * half_height / height;
        Self {
            eye: camera.eye,
            axes: [right, up, -backward],
            projection: camera.projection,
            half: [width, height].map(|side| pixel * (0.5 * side + BORDER_PX)),
            apart: PIXELS_APART * pixel,
            nearest: NEAREST * camera.eye.distance(camera.target),
            least,
            coarser: 1.0,
        }
    }

    /// The same with points farther apart by a factor.
    pub(super) fn coarser(self, factor: f64) -> Self {
        Self { coarser: self.coarser * factor, ..self }
    }

    /// How far apart points are at a depth.
    fn spacing(&self, depth: f64) -> f64 {
        let apart = match self.projection {
            Projection::Perspective { .. } => self.apart * depth.max(self.nearest),
            Projection::Orthographic { .. } => self.apart,
        };
        self.coarser * apart.max(self.least)
    }

    /// Calls `piece` with everything of a triangle that gets a lattice.
    pub(super) fn pieces(&self, triangle: [DVec3; 3], piece: &mut impl FnMut(Piece)) {
        let mut todo = vec![triangle];
        while let Some(corners) = todo.pop() {
            let seen = corners.map(|corner| self.seen_from_eye(corner));
            if self.is_out_of_view(&seen) {
                continue;
            }
            let [least, most] = [f64::min, f64::max].map(|pick| seen.iter().map(|p| p.z).reduce(pick));
            let spacing = self.spacing(least.unwrap_or_default());
            let (edge, length) = longest_edge(&corners);
            let is_inside = seen.iter().all(|p| self.is_in_view(*p));
            let is_at_one_depth = self.spacing(most.unwrap_or_default()) <= ONE_DEPTH * spacing;
            let [a, b, c] = [corners[edge], corners[(edge + 1) % 3], corners[(edge + 2) % 3]];
            if length <= SHORT * spacing || (is_inside && is_at_one_depth) {
                piece(Piece { corners: [a, b, c], spacing });
                continue;
            }
            let middle = 0.5 * a + 0.5 * b;
            todo.extend([[middle, b, c], [a, middle, c]]);
        }
    }

    /// To the right, up, and depth.
    fn seen_from_eye(&self, p: DVec3) -> DVec3 {
        let [right, up, forward] = self.axes.map(|axis| (p - self.eye).dot(axis));
        DVec3::new(right, up, forward)
    }

    /// Half the width and height of the view at a depth.
    fn reach(&self, depth: f64) -> [f64; 2] {
        match self.projection {
            Projection::Perspective { .. } => self.half.map(|half| half * depth),
            Projection::Orthographic { .. } => self.half,
        }
    }

    fn is_in_view(&self, p: DVec3) -> bool {
        let [width, height] = self.reach(p.z);
        p.z >= self.nearest && p.x.abs() <= width && p.y.abs() <= height
    }

    /// Whether all corners are on the outer side of one of the planes around the view.
    fn is_out_of_view(&self, corners: &[DVec3; 3]) -> bool {
        let all = |outside: &dyn Fn(&DVec3) -> bool| corners.iter().all(outside);
        all(&|p| p.z < self.nearest)
            || all(&|p| p.x > self.reach(p.z)[0])
            || all(&|p| -p.x > self.reach(p.z)[0])
            || all(&|p| p.y > self.reach(p.z)[1])
            || all(&|p| -p.y > self.reach(p.z)[1])
    }
}

/// Which edge is the longest, from its corner to the next, and its length.
fn longest_edge(corners: &[DVec3; 3]) -> (usize, f64) {
    let length = |edge: usize| corners[edge].distance(corners[(edge + 1) % 3]);
    let lengths = [length(0), length(1), length(2)];
    let longest = (0..3).max_by(|&a, &b| lengths[a].total_cmp(&lengths[b])).unwrap_or_default();
    (longest, lengths[longest])
}

/// A part of a triangle, all in view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// The longest edge is from the first to the second.
    corners: [DVec3; 3],
    /// How far apart its points are.
    pub(super) spacing: f64,
}

impl Piece {
    /// Rows of points along the longest edge.
    fn rows(&self) -> f64 {
        let [a, b, c] = self.corners;
        let along = (b - a).normalize_or_zero();
        let height = (c - a).reject_from(along);
        (height.length() / self.spacing).ceil().max(1.0)
    }

    /// At most how many points there are.
    pub(super) fn most_points(&self) -> f64 {
        let [a, b, _] = self.corners;
        // Rows get shorter evenly; each is rounded up.
        self.rows() * (0.5 * a.distance(b) / self.spacing + 1.0)
    }

    /// Adds the points.
    pub(super) fn fill(&self, points: &mut Vec<DVec3>) {
        let [a, b, c] = self.corners;
        let rows = self.rows();
        for row in 0..rows as usize {
            let t = (row as f64 + 0.5) / rows;
            let (start, end) = (a.lerp(c, t), b.lerp(c, t));
            let count = (start.distance(end) / self.spacing).ceil().max(1.0);
            points.extend((0..count as usize).map(|i| start.lerp(end, (i as f64 + 0.5) / count)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From (0, 0, 4) towards the origin, 100 × 100 pixels.
    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(0.0, 0.0, 4.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Perspective { fov_y_rad: 0.5 },
        }
    }

    fn points(needed: &Needed, triangle: [DVec3; 3]) -> Vec<DVec3> {
        let mut points = vec![];
        needed.pieces(triangle, &mut |piece| piece.fill(&mut points));
        points
    }

    #[test]
    fn neighbours_are_as_close_as_pixels() {
        let needed = Needed::new(&camera(), [100, 100], 0.0);
        let spacing = needed.spacing(4.0);
        let triangle = [DVec3::ZERO, 0.5 * DVec3::X, DVec3::new(0.15, 0.4, 0.1)];
        let points = points(&needed, triangle);
        assert!(points.len() > 150, "{}", points.len());
        for p in &points {
            let nearest = points.iter().filter(|q| *q != p).map(|q| q.distance(*p)).fold(f64::MAX, f64::min);
            assert!(nearest <= spacing, "{p} has its nearest neighbour at {nearest}, not {spacing}");
        }
    }

    #[test]
    fn points_are_no_closer_than_those_of_the_scans() {
        let triangle = [DVec3::ZERO, 0.5 * DVec3::X, 0.5 * DVec3::Y];
        let [fine, coarse] = [0.0, 0.1].map(|least| Needed::new(&camera(), [100, 100], least));
        let count = points(&coarse, triangle).len();
        assert!((12..25).contains(&count), "{count} points for an area of 0.125");
        assert!(points(&fine, triangle).len() > 200);
    }

    #[test]
    fn a_triangle_far_beyond_the_view_costs_what_is_seen_of_it() {
        let needed = Needed::new(&camera(), [100, 100], 0.0);
        let filling = [DVec3::new(-3.0, -3.0, 0.0), DVec3::new(3.0, -3.0, 0.0), DVec3::new(0.0, 3.0, 0.0)];
        let usual = points(&needed, filling).len();
        for far in [1e3, 1e9, 1e15] {
            let [a, b, c] = filling;
            let count = points(&needed, [a, b, c * far]).len();
            assert!(count < 3 * usual, "{count} points, {usual} for a triangle that fills the picture");
        }
        // One that goes away from the eye has pixels at every depth: so many for each doubling of the depth.
        let away = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 0.0, -1e12)];
        let count = points(&needed, away).len();
        assert!((100..400_000).contains(&count), "{count}");
    }

    #[test]
    fn what_is_behind_the_eye_gets_no_points() {
        let needed = Needed::new(&camera(), [100, 100], 0.0);
        let behind = [DVec3::new(0.0, 0.0, 5.0), DVec3::new(1.0, 0.0, 5.0), DVec3::new(0.0, 1.0, 6.0)];
        assert!(points(&needed, behind).is_empty());
    }
}
