//! How the outline of a caster lies to a target, by the half-planes of its edges.

use glam::DVec2;
use pointillist_dice::{HalfPlane, convex};

/// A target's corners and edges in groups of four, coordinate by coordinate: what is computed of each then takes few instructions, and no branches.
#[derive(Debug, Default)]
pub(crate) struct Corners {
    groups: Vec<Four>,
}

/// Four corners, and the edges from each to the next. Where there are fewer, the last one counts several times.
#[derive(Clone, Copy, Debug)]
struct Four {
    x: [f64; 4],
    y: [f64; 4],
    along_x: [f64; 4],
    along_y: [f64; 4],
    /// As in [`convex::has_separating_edge`]; −∞ for an edge that separates nothing.
    slack: [f64; 4],
}

impl Corners {
    /// Becomes those of an outline.
    pub(crate) fn set(&mut self, outline: &[DVec2]) {
        self.groups.clear();
        for first in (0..outline.len()).step_by(4) {
            let corner = |i: usize| {
                let at = (first + i).min(outline.len() - 1);
                (outline[at], outline[(at + 1) % outline.len()] - outline[at])
            };
            let corners = [corner(0), corner(1), corner(2), corner(3)];
            self.groups.push(Four {
                x: corners.map(|(p, _)| p.x),
                y: corners.map(|(p, _)| p.y),
                along_x: corners.map(|(_, along)| along.x),
                along_y: corners.map(|(_, along)| along.y),
                slack: corners.map(|(p, along)| {
                    let slack = convex::separation_slack(along);
                    // The line through two vertices that nearly coincide may run through the outline itself.
                    let holds = outline.iter().all(|&v| along.perp_dot(v - p) >= -slack);
                    if holds && along != DVec2::ZERO { slack } else { f64::NEG_INFINITY }
                }),
            });
        }
    }

    /// The least and the largest value of a half-plane.
    #[inline]
    pub(crate) fn range(&self, half: &HalfPlane) -> (f64, f64) {
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for Four { x, y, .. } in &self.groups {
            let HalfPlane { anchor, normal, offset } = *half;
            let value = |i: usize| normal.x * (x[i] - anchor.x) + normal.y * (y[i] - anchor.y) + offset;
            let values = [value(0), value(1), value(2), value(3)];
            least = less(least, less(less(values[0], values[2]), less(values[1], values[3])));
            most = more(most, more(more(values[0], values[2]), more(values[1], values[3])));
        }
        (least, most)
    }

    /// Whether one of the edges has all of an outline on or beyond it, as [`convex::has_separating_edge`] tells.
    #[inline]
    pub(crate) fn has_separating_edge(&self, outline: &[DVec2]) -> bool {
        self.groups.iter().any(|four| {
            let Four { x, y, along_x, along_y, .. } = four;
            let value = |v: &DVec2, i: usize| along_x[i] * (v.y - y[i]) - along_y[i] * (v.x - x[i]);
            let start = [f64::NEG_INFINITY; 4];
            let most = outline.iter().fold(start, |most, v| [0, 1, 2, 3].map(|i| more(most[i], value(v, i))));
            let separates = |i: usize| most[i] <= four.slack[i];
            separates(0) | separates(1) | separates(2) | separates(3)
        })
    }
}

// One instruction each; those of `f64` look for NaN.
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
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
        let (mut across, mut over, mut apart) = (0, true, false);
        for (number, half) in sides.iter().enumerate() {
            let (least, most) = target.range(half);
            apart |= most <= 0.0;
            let outside = least < 0.0;
            over &= !outside;
            // The half-plane of a short edge was moved outward from its line.
            across |= u32::from(outside | (half.offset != 0.0)) << number;
        }
        if apart {
            Self::Apart
        } else if over {
            Self::Over
        } else {
            Self::Across(Edges(across))
        }
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
