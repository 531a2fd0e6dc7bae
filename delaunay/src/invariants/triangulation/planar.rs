//! Triangles.

use super::{across, check, check_links};
use crate::invariants::exact::{Points, dot, zero};
use crate::{OUTSIDE, Triangles};
use num_bigint::BigInt;
use std::collections::BTreeMap;

/// A direction along which the plane is not seen edge on, and how to compute areas in its shadow.
struct Shadow<'a> {
    points: &'a Points,
    axis: usize,
}

impl Shadow<'_> {
    /// Twice the signed area.
    fn area(&self, triangle: [u32; 3]) -> BigInt {
        self.points.normal(triangle)[self.axis].clone()
    }

    /// (b−a)·(c−a): over twice the area of the triangle, the cotangent of its angle at a. Areas of shadows do for
    /// areas: in one plane all are shortened alike.
    fn cosine(&self, [a, b, c]: [u32; 3]) -> BigInt {
        dot(&self.points.difference(b, a), &self.points.difference(c, a))
    }
}

/// All turn alike, none is flat, angles opposite an inner edge add up to π at most, and the outline is convex and
/// filled once.
pub(super) fn check_triangles(points: &Points, t: &Triangles, distinct: &[u32]) -> Result<(), String> {
    check_links(&t.corners, &t.neighbours, distinct)?;
    let normal = points.normal(t.corners[0]);
    let axis = (0..3).find(|&k| normal[k] != zero()).ok_or("the first triangle is flat")?;
    let shadow = Shadow { points, axis };
    let sense = shadow.area(t.corners[0]);
    for corners in &t.corners {
        check(shadow.area(*corners) * &sense > zero(), || {
            format!("{corners:?} is flat or turns the wrong way")
        })?;
    }
    for (cell, k, d) in across(&t.corners, &t.neighbours) {
        let corners = t.corners[cell];
        let [c, a, b] = [0, 1, 2].map(|j| corners[(k + j) % 3]);
        let at_c = shadow.cosine([c, a, b]) * shadow.area([d, b, a]);
        let at_d = shadow.cosine([d, a, b]) * shadow.area([c, a, b]);
        check((at_c + at_d) * &sense >= zero(), || format!("{d} lies in the circle of {corners:?}"))?;
    }
    outline_is_convex(&shadow, t, &sense)
}

fn outline_is_convex(shadow: &Shadow<'_>, t: &Triangles, sense: &BigInt) -> Result<(), String> {
    let open = t.corners.iter().zip(&t.neighbours).flat_map(|(corners, neighbours)| {
        let sides = (0..3).filter(|k| neighbours[*k] == OUTSIDE);
        sides.map(|k| (corners[(k + 1) % 3], corners[(k + 2) % 3]))
    });
    let next: BTreeMap<u32, u32> = open.collect();
    let (&start, _) = next.first_key_value().ok_or("there is no outline")?;
    let mut enclosed = BigInt::ZERO;
    let (mut at, mut steps) = (start, 0);
    while steps == 0 || at != start {
        let to = *next.get(&at).ok_or("the outline is open")?;
        let after = *next.get(&to).ok_or("the outline is open")?;
        check(shadow.area([at, to, after]) * sense >= zero(), || {
            format!("the outline bends inward at {to}")
        })?;
        enclosed += shadow.area([start, at, to]);
        (at, steps) = (to, steps + 1);
    }
    check(steps == next.len(), || "the outline is more than one".into())?;
    let filled: BigInt = t.corners.iter().map(|c| shadow.area(*c)).sum();
    check(filled == enclosed, || "the triangles do not fill the outline once".into())
}
