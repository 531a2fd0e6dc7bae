//! The space between two boxes, by the planes that touch both: what lies beyond one of them is not between them.

use glam::{DVec2, DVec3};

/// Lowest and highest corner.
pub(crate) type Box3 = (DVec3, DVec3);

/// Boxes beyond a plane by less than this, times the coordinates, count as between: rounding must not decide.
const MARGIN: f64 = 1e-9;

/// Pairs of axes, one for each direction in which the boxes are looked at.
const AXES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];

/// The convex hull of two boxes, from outside: its bounds, and the lines that touch both boxes as seen along each axis.
#[derive(Clone, Debug)]
pub(crate) struct Shaft {
    around: Box3,
    margin: f64,
    /// The axes, a normal outwards, and its product with a point of the line.
    lines: Vec<((usize, usize), DVec2, f64)>,
}

impl Shaft {
    pub(crate) fn new(a: Box3, b: Box3) -> Self {
        let around = (a.0.min(b.0), a.1.max(b.1));
        let margin = MARGIN * around.0.abs().max(around.1.abs()).max_element();
        let lines = AXES.into_iter().flat_map(|axes| tangents(axes, a, b, margin)).collect();
        Self { around, margin, lines }
    }

    /// Whether a box may have a part between the two.
    pub(crate) fn may_hold(&self, (low, high): Box3) -> bool {
        let (least, most) = self.around;
        let beside = low.cmpgt(most + self.margin).any() || high.cmplt(least - self.margin).any();
        let beyond = |&((x, y), normal, offset): &((usize, usize), DVec2, f64)| {
            // The corner that is least far out.
            let inmost = DVec2::select(
                normal.cmpgt(DVec2::ZERO),
                DVec2::new(low[x], low[y]),
                DVec2::new(high[x], high[y]),
            );
            normal.dot(inmost) > offset + self.margin
        };
        !beside && !self.lines.iter().any(beyond)
    }
}

/// The lines through the same corner of two rectangles that have both on one side, as unit normals outwards and offsets.
fn tangents(
    axes: (usize, usize),
    a: Box3,
    b: Box3,
    margin: f64,
) -> impl Iterator<Item = ((usize, usize), DVec2, f64)> {
    let corner = move |of: Box3, k: usize| {
        let pick = |axis: usize, high: bool| if high { of.1[axis] } else { of.0[axis] };
        DVec2::new(pick(axes.0, k & 1 > 0), pick(axes.1, k & 2 > 0))
    };
    (0..4).flat_map(move |k| {
        let (from, to) = (corner(a, k), corner(b, k));
        let normal = (to - from).perp().normalize_or_zero();
        [normal, -normal].into_iter().filter_map(move |normal| {
            let offset = normal.dot(from);
            let within = |of: Box3| (0..4).all(|c| normal.dot(corner(of, c)) <= offset + margin);
            (normal != DVec2::ZERO && within(a) && within(b)).then_some((axes, normal, offset))
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Vec3Swizzles as _, dvec3};

    fn cube(centre: DVec3, half: f64) -> Box3 {
        (centre - half, centre + half)
    }

    #[test]
    fn what_is_on_the_way_is_held_and_what_is_beside_is_not() {
        let shaft = Shaft::new(cube(DVec3::ZERO, 1.0), cube(dvec3(10.0, 10.0, 0.0), 1.0));
        assert!(shaft.may_hold(cube(dvec3(5.0, 5.0, 0.0), 0.1)));
        assert!(shaft.may_hold(cube(DVec3::ZERO, 100.0)));
        // Within the bounds of both, but off the diagonal.
        assert!(!shaft.may_hold(cube(dvec3(8.0, 2.0, 0.0), 1.0)));
        assert!(!shaft.may_hold(cube(dvec3(5.0, 5.0, 3.0), 1.0)));
    }

    #[test]
    fn every_box_around_a_point_between_two_boxes_is_held() {
        let golden = |i: u32, k: f64| (f64::from(i) * k).fract();
        for i in 0..2000_u32 {
            let place = |o: f64| {
                dvec3(golden(i, 0.618_034 + o), golden(i, 0.754_877 + o), golden(i, 0.569_840 + o)) * 8.0
            };
            let size = |o: f64| 2.0 * golden(i, 0.445_041 + o);
            let (a, b) = (cube(place(0.0), size(0.0)), cube(place(0.113), size(0.271)));
            let share = dvec3(golden(i, 0.31), golden(i, 0.47), golden(i, 0.83));
            let (p, q) = (a.0 + (a.1 - a.0) * share, b.0 + (b.1 - b.0) * share.zxy());
            let between = p.lerp(q, golden(i, 0.91));
            assert!(Shaft::new(a, b).may_hold(cube(between, 1e-12)), "case {i}");
        }
    }
}
