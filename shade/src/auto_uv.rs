//! Texture coordinates for meshes that have none.

use glam::{DVec2, DVec3, dvec2};
use std::f64::consts::{PI, TAU};

/// How texture coordinates are made from positions. The object's box becomes the unit square, v runs upward (+Y).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum AutoUv {
    /// Along the shortest side of the box, so that the texture lies on its largest face: u along x (z if the box is
    /// thinnest in x), v along y (−z if it is thinnest in y).
    Planar,
    /// Around the box's vertical axis: u is the angle, 0.5 at the front (+Z) and growing to the right as seen from
    /// outside, v the height.
    Cylindrical,
    /// As seen from the box's centre: u as for a cylinder, v the elevation from the lower to the upper pole.
    Polar,
    /// Each triangle on the side of the box that it faces most, all upright as seen from outside.
    Box,
}

impl AutoUv {
    /// Coordinates of a triangle's corners in a box from `low` to `high`.
    ///
    /// `normal` says which side a triangle of [`AutoUv::Box`] faces. Where a triangle crosses the seam at the back (−Z), its u runs
    /// on beyond 0 or 1, so that the texture, repeated, has no jump in it; a corner on the axis gets the u of the others' middle.
    /// A box without extent in a direction maps to 0.5.
    #[must_use]
    pub fn corners(self, low: DVec3, high: DVec3, corners: [DVec3; 3], normal: DVec3) -> [DVec2; 3] {
        let size = high - low;
        let unit = corners.map(|p| {
            let share = |p: f64, low: f64, size: f64| if size > 0.0 { (p - low) / size } else { 0.5 };
            DVec3::new(share(p.x, low.x, size.x), share(p.y, low.y, size.y), share(p.z, low.z, size.z))
        });
        match self {
            Self::Planar => planar(size, unit),
            Self::Box => side(normal, unit),
            Self::Cylindrical => round(low + 0.5 * size, corners, |i, _| unit[i].y),
            Self::Polar => round(low + 0.5 * size, corners, |_, p| 0.5 + p.y.atan2(p.x.hypot(p.z)) / PI),
        }
    }
}

fn planar(size: DVec3, unit: [DVec3; 3]) -> [DVec2; 3] {
    let thinnest = size.min_element();
    if size.z == thinnest {
        unit.map(|p| dvec2(p.x, p.y))
    } else if size.y == thinnest {
        unit.map(|p| dvec2(p.x, 1.0 - p.z))
    } else {
        unit.map(|p| dvec2(p.z, p.y))
    }
}

fn side(normal: DVec3, unit: [DVec3; 3]) -> [DVec2; 3] {
    let a = normal.abs();
    let flip = |u: f64, positive: bool| if positive { u } else { 1.0 - u };
    if a.y >= a.x && a.y >= a.z {
        unit.map(|p| dvec2(p.x, flip(p.z, normal.y < 0.0)))
    } else if a.x >= a.z {
        unit.map(|p| dvec2(flip(p.z, normal.x < 0.0), p.y))
    } else {
        unit.map(|p| dvec2(flip(p.x, normal.z > 0.0), p.y))
    }
}

/// u from the angle about the vertical axis, continuous over the triangle; v as given.
fn round(centre: DVec3, corners: [DVec3; 3], v: impl Fn(usize, DVec3) -> f64) -> [DVec2; 3] {
    let around = corners.map(|p| p - centre);
    let turn = around.map(|p| (p.x != 0.0 || p.z != 0.0).then(|| 0.5 + p.x.atan2(p.z) / TAU));
    let first = turn.iter().flatten().next().copied().unwrap_or(0.5);
    // No two corners of a triangle beside the axis are half a turn or more apart, so the nearest is the right one.
    let near = turn.map(|u| u.map(|u| u - (u - first).round()));
    let known: Vec<f64> = near.iter().flatten().copied().collect();
    let middle = if known.is_empty() { 0.5 } else { known.iter().sum::<f64>() / known.len() as f64 };
    std::array::from_fn(|i| dvec2(near[i].unwrap_or(middle), v(i, around[i])))
}
