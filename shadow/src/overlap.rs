//! How the outline of a caster lies to a target, by the half-planes of its edges.

use glam::DVec2;
use pointillist_dice::{HalfPlane, convex};

/// A target's corners and edges in groups of four: what is computed of each then takes few instructions, and no branches.
#[derive(Debug, Default)]
pub(crate) struct Corners {
    groups: Vec<Four>,
}

/// Four corners, and the edges from each to the next. Where there are fewer, the last one counts several times.
#[derive(Clone, Copy, Debug)]
struct Four {
    corners: [DVec2; 4],
    along: [DVec2; 4],
    /// Up to this an edge separates, as in [`convex::has_separating_edge`].
    slack: [f64; 4],
}

impl Corners {
    /// Becomes those of an outline.
    pub(crate) fn set(&mut self, outline: &[DVec2]) {
        let last = outline.len() - 1;
        self.groups.clear();
        self.groups.extend((0..=last).step_by(4).map(|first| {
            let numbers = [first, first + 1, first + 2, first + 3].map(|i| i.min(last));
            let corners = numbers.map(|i| outline[i]);
            let along = numbers.map(|i| outline[if i == last { 0 } else { i + 1 }] - outline[i]);
            Four { corners, along, slack: along.map(convex::separation_slack) }
        }));
    }

    /// The least and the largest value of a half-plane.
    #[inline]
    pub(crate) fn range(&self, half: &HalfPlane) -> (f64, f64) {
        // One instruction each; those of `f64` look for NaN.
        let less = |a: f64, b: f64| if a < b { a } else { b };
        let more = |a: f64, b: f64| if a > b { a } else { b };
        self.groups.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), four| {
            let [a, b, c, d] = four.corners.map(|p| half.value(p));
            (less(least, less(less(a, c), less(b, d))), more(most, more(more(a, c), more(b, d))))
        })
    }

    /// Whether one of the edges has all of an outline on or beyond it, as [`convex::has_separating_edge`] tells.
    #[inline]
    pub(crate) fn has_separating_edge(&self, outline: &[DVec2]) -> bool {
        self.groups.iter().any(|Four { corners, along, slack }| {
            let mut separates = [true; 4];
            for &v in outline {
                let is_beyond = |i: usize| along[i].perp_dot(v - corners[i]) <= slack[i];
                separates = [0, 1, 2, 3].map(|i| separates[i] & is_beyond(i));
            }
            separates != [false; 4]
                && (0..4).any(|i| separates[i] && self.has_before(corners[i], along[i], slack[i]))
        })
    }

    /// Whether all corners are before an edge: the line through two that nearly coincide may run through the target itself.
    fn has_before(&self, from: DVec2, along: DVec2, slack: f64) -> bool {
        let mut corners = self.groups.iter().flat_map(|four| &four.corners);
        along != DVec2::ZERO && corners.all(|&v| along.perp_dot(v - from) >= -slack)
    }
}

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
    /// Takes the caster by the half-planes of its edges, at most 32.
    pub(crate) fn of(sides: &[HalfPlane], target: &Corners) -> Self {
        let (mut across, mut over) = (0, true);
        for (number, half) in sides.iter().enumerate() {
            let (least, most) = target.range(half);
            if most <= 0.0 {
                return Self::Apart;
            }
            let outside = least < 0.0;
            over &= !outside;
            // The half-plane of a short edge was moved outward from its line.
            across |= u32::from(outside | (half.offset != 0.0)) << number;
        }
        if over { Self::Over } else { Self::Across(Edges(across)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;

    /// Convex outlines of three to seven corners; some corners coincide, and some lie on corners or edges of others.
    fn outlines() -> Vec<Vec<DVec2>> {
        let corner = |k: u32, count: u32, turn: f64| {
            DVec2::from_angle(turn + f64::from(k) * std::f64::consts::TAU / f64::from(count))
        };
        let mut outlines = vec![];
        for i in 0..60_u32 {
            let (count, turn) = (3 + i % 5, f64::from(i / 10));
            let middle = 0.5 * dvec2(f64::from(i % 7), f64::from(i % 4));
            let size = dvec2(1.0, if i % 9 == 0 { 1e-9 } else { 0.7 });
            let mut outline: Vec<DVec2> =
                (0..count).map(|k| middle + size * corner(k, count, turn)).collect();
            if i % 6 == 0 {
                outline.insert(1, outline[1] + if i % 12 == 0 { DVec2::ZERO } else { dvec2(1e-13, -1e-13) });
            }
            outlines.push(outline);
        }
        // Neighbours across an edge.
        let mirrored = |o: &Vec<DVec2>| vec![o[1], o[0], o[0] + o[1] - o[2]];
        outlines.extend(outlines.iter().map(mirrored).collect::<Vec<_>>());
        outlines
    }

    #[test]
    fn four_at_a_time_tell_what_single_corners_tell() {
        let (outlines, mut corners) = (outlines(), Corners::default());
        let mut found = [0; 4];
        for (target, caster) in outlines.iter().flat_map(|t| outlines.iter().map(move |c| (t, c))) {
            corners.set(target);
            let separated = convex::has_separating_edge(target, caster);
            assert_eq!(corners.has_separating_edge(caster), separated, "{target:?} {caster:?}");
            let sides: Vec<HalfPlane> = convex::half_planes(caster).collect();
            let any = |half: &HalfPlane, is: fn(f64) -> bool| target.iter().any(|&p| is(half.value(p)));
            let apart = sides.iter().any(|half| !any(half, |value| value > 0.0));
            let crossed = |half: &HalfPlane| any(half, |value| value < 0.0) || half.offset != 0.0;
            let kind = match Overlap::of(&sides, &corners) {
                Overlap::Apart => 0,
                Overlap::Over => 1,
                Overlap::Across(edges) => {
                    let is_told = |(i, half)| edges.has(i) == crossed(half);
                    assert!(sides.iter().enumerate().all(is_told), "{target:?} {caster:?}");
                    2
                }
            };
            let is_over = !apart && !sides.iter().any(|half| any(half, |value| value < 0.0));
            assert_eq!([apart, is_over], [kind == 0, kind == 1], "{target:?} {caster:?}");
            found[kind] += 1;
            found[3] += usize::from(separated);
        }
        assert!(found.iter().all(|&count| count > 100), "{found:?}");
    }
}
