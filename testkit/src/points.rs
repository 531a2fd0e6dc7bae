//! Sets of points that geometry finds hard, and places to ask about.

use glam::{DVec3, dvec3};
use proptest::prelude::*;

/// Any coordinate, with trouble: on a grid, repeated, tiny, huge, far from 0, an ulp apart.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -1.0..1.0,
        4 => (-3..=3).prop_map(|i| 0.5 * f64::from(i)),
        1 => (-3..=3).prop_map(|i| 0.1 * f64::from(i)),
        1 => (0..4u32).prop_map(|i| 1.0 + f64::from(i) * f64::EPSILON),
        1 => Just(-0.0),
    ]
}

/// A point of any coordinates about the origin, which are often the same as those of others.
pub fn point() -> impl Strategy<Value = DVec3> {
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| dvec3(x, y, z))
}

fn lattice_point(side: i32) -> impl Strategy<Value = DVec3> {
    [0..side, 0..side, 0..side].prop_map(|c| DVec3::from_array(c.map(f64::from)))
}

/// A point of a line or plane, up to rounding: nearly degenerate.
fn flat_point() -> impl Strategy<Value = DVec3> {
    (-4..=4, -4..=4)
        .prop_map(|(u, v)| dvec3(0.1, 0.2, 0.3) * f64::from(u) + dvec3(0.3, -0.1, 0.7) * f64::from(v))
}

/// A point near a unit sphere.
fn sphere_point() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..6.3f64).prop_map(|(z, a)| {
        let r = (1.0 - z * z).sqrt();
        dvec3(r * a.cos(), r * a.sin(), z)
    })
}

/// Exponents of two that a whole set is multiplied by.
fn scale() -> impl Strategy<Value = i32> {
    prop_oneof![4 => Just(0), 1 => -900..900]
}

/// Points times a power of two.
#[must_use]
pub fn scaled(points: Vec<DVec3>, exponent: i32) -> Vec<DVec3> {
    points.into_iter().map(|p| p * 2f64.powi(exponent)).collect()
}

/// Fewer than `max` finite points: anywhere, on lattices, lines, planes and spheres, repeated, huge beside tiny.
pub fn points(max: usize) -> impl Strategy<Value = Vec<DVec3>> {
    let of = prop_oneof![
        prop::collection::vec(point(), 1..max),
        prop::collection::vec(lattice_point(3), 1..max),
        prop::collection::vec(lattice_point(1 << 20), 1..max),
        prop::collection::vec(flat_point(), 1..max),
        prop::collection::vec(sphere_point(), 1..max),
        // Huge beside tiny.
        prop::collection::vec((point(), -300..300).prop_map(|(p, e)| p * 10f64.powi(e)), 1..max.min(24)),
        // A few places off a plane, each point several times.
        prop::collection::vec(
            prop_oneof![8 => lattice_point(4).prop_map(|p| p * dvec3(1.0, 1.0, 0.0)), 1 => point()],
            1..max
        ),
    ];
    (of, scale())
        .prop_map(|(points, e)| scaled(points, e))
        .prop_filter("finite", |p| p.iter().all(|p| p.is_finite()))
}

/// Points of a small lattice: grids, planes, lines and repeats come often, and no cell is thinner than a thousandth.
pub fn lattice_points() -> impl Strategy<Value = Vec<DVec3>> {
    let coordinate = -4..=4_i8;
    let axis = prop_oneof![
        coordinate.clone().prop_map(|c| [c, c]),
        (coordinate.clone(), coordinate).prop_map(|(a, b)| [a, b])
    ];
    // Both numbers of an axis equal: all points lie in one plane.
    let point = |x: [i8; 2], y: [i8; 2], z: [i8; 2]| {
        prop::collection::vec((x[0]..=x[0].max(x[1]), y[0]..=y[0].max(y[1]), z[0]..=z[0].max(z[1])), 1..24)
    };
    (axis.clone(), axis.clone(), axis)
        .prop_flat_map(move |(x, y, z)| point(x, y, z))
        .prop_map(|list| list.into_iter().map(|(x, y, z)| dvec3(x.into(), y.into(), z.into())).collect())
}

/// A place in and about [`lattice_points`], often on the lattice.
pub fn query() -> impl Strategy<Value = DVec3> {
    let near = prop::array::uniform3(-6.0..6.0_f64);
    let on_lattice = prop::array::uniform3((-12..=12_i8).prop_map(|c| f64::from(c) * 0.5));
    prop_oneof![near, on_lattice].prop_map(DVec3::from_array)
}
