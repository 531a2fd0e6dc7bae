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

    /// Whether an edge has all of an outline on or beyond it: [`convex::has_separating_edge`].
    #[inline]
    pub(crate) fn have_edge_before(&self, outline: &[DVec2]) -> bool {
        self.groups.iter().any(|four| {
            let mut most = [f64::NEG_INFINITY; 4];
            for v in outline {
                for i in 0..4 {
                    let value = four.along_x[i] * (v.y - four.y[i]) - four.along_y[i] * (v.x - four.x[i]);
                    most[i] = more(most[i], value);
                }
            }
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
