//! `delaunay`, `sh` and `shprobe`: points without a general position, harmonics of extreme light, probes that are hardly apart.

use glam::{DQuat, DVec3, Vec3, dvec3};
use pointillist_delaunay::invariants::{queries, triangulation, weights};
use pointillist_delaunay::{Delaunay, DelaunayError};
use pointillist_sh::invariants as sh_facts;
use pointillist_shprobe::invariants as field_facts;
use pointillist_shprobe::sh::{Sh, coefficient_count};
use pointillist_shprobe::{Field, place};

use super::row;
use crate::stress::check::{Check, Verdict};

pub(super) fn add(rows: &mut Vec<Check>) {
    cells(rows);
    harmonics(rows);
    fields(rows);
}

/// A cube of 6³ points.
fn lattice() -> Vec<DVec3> {
    place::grid(DVec3::ZERO, DVec3::splat(5.0), [6, 6, 6])
}

/// Points on a unit sphere, rounded: nearly cospherical, as no five of them are exactly.
fn sphere(count: u32) -> Vec<DVec3> {
    let at = |i: u32| {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (2.399_963_229_728_653 * f64::from(i)).sin_cos();
        dvec3(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
    };
    (0..count).map(at).collect()
}

/// Corners of a regular polygon of `count` sides at two heights: exactly coplanar, and nearly cospherical.
fn prism(count: u32) -> Vec<DVec3> {
    let at = |i: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i / 2) / f64::from(count)).sin_cos();
        dvec3(cos, sin, f64::from(i % 2))
    };
    (0..2 * count).map(at).collect()
}

/// Positions to ask for: between the middle and points, and half-way between points, where these are often on sides of cells.
fn asked(points: &[DVec3]) -> Vec<DVec3> {
    let centre = points.iter().sum::<DVec3>() / points.len() as f64;
    let inner = points.iter().step_by(37).map(|p| centre.lerp(*p, 0.9));
    let halfway = points.windows(2).step_by(17).map(|pair| pair[0].midpoint(pair[1]));
    inner.chain(halfway).collect()
}

/// Points of one kind.
struct Set {
    name: String,
    points: Vec<DVec3>,
    /// Weights may change as fast as rounding: between the points of a pair, and across a turned square, which has one diagonal on one side
    /// and the other on the other.
    steep: bool,
}

fn sets() -> Vec<Set> {
    let mut sets = vec![];
    let mut add = |name: &str, points: Vec<DVec3>| {
        sets.push(Set { name: name.to_owned(), points, steep: false });
    };
    let scattered = place::random(DVec3::ZERO, DVec3::ONE, 300, 7);
    let changed = |by: &dyn Fn(DVec3) -> DVec3| scattered.iter().map(|&p| by(p)).collect();
    add("216 points of a cubic lattice", lattice());
    add("300 points of a sphere", sphere(300));
    add("120 corners of a prism", prism(60));
    add("200 points in one place", vec![dvec3(0.1, 0.2, 0.3); 200]);
    let (along, across) = (dvec3(0.1, 0.3, 0.7), dvec3(0.3, -0.1, 0.7));
    add("200 points of a line, rounded", (0..200).map(|i| along * f64::from(i)).collect());
    let in_plane = |i: u32| along * f64::from(i % 15) + across * f64::from(i / 15);
    add("225 points of a plane, rounded", (0..225).map(in_plane).collect());
    add("a slab of 1 : 1 : 1e-6", changed(&|p| p * dvec3(1.0, 1.0, 1e-6)));
    for far in [1e6, 1e9] {
        let shift = dvec3(far, -far, far);
        add(&format!("300 points, moved by {far:e}"), changed(&|p| p + shift));
        add(
            &format!("216 points of a lattice, moved by {far:e}"),
            lattice().iter().map(|p| *p + shift).collect(),
        );
    }
    for scale in [1e-310, 1e-100, 1e-6, 1e6, 1e100] {
        add(&format!("300 points, scaled by {scale:e}"), changed(&|p| p * scale));
    }
    let turn = DQuat::from_axis_angle(dvec3(0.48, -0.6, 0.64), 1.0);
    let turned = lattice().iter().map(|&p| turn * p).collect();
    let pair = |i: u32| scattered[i as usize / 2] + DVec3::X * (1e-9 * f64::from(i % 2));
    let steep = |name: &str, points| Set { name: name.to_owned(), points, steep: true };
    sets.push(steep("216 points of a lattice, turned", turned));
    sets.push(steep("300 points in pairs 1e-9 apart", (0..300).map(pair).collect()));
    sets
}

fn cells(rows: &mut Vec<Check>) {
    for Set { name, points, .. } in sets() {
        row(
            rows,
            format!("tetrahedra: {name}"),
            "Delaunay by exact arithmetic; weights and searches agree",
            move || {
                let asked = asked(&points);
                Verdict::facts([
                    Delaunay::new(&points).map(|_| ()).map_err(|error| error.to_string()),
                    triangulation::partition_is_delaunay(&points),
                    queries::neighbours_are_mutual(&points),
                    queries::nearest_is_that_of_a_search(&points, &asked),
                    weights::weights_find_the_nearest_point(&points, &asked, 1e-6),
                ])
            },
        );
    }
    row(rows, "tetrahedra: a point that is NaN", "a typed error", || {
        let found: Result<Delaunay, DelaunayError> = Delaunay::new(&[DVec3::ZERO, dvec3(0.0, f64::NAN, 0.0)]);
        Verdict::refused(found)
    });
}

/// Any function of this order, by a linear congruence.
fn any_sh(order: usize) -> Sh {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    Sh::new((0..coefficient_count(order)).map(|_| dvec3(next(), next(), next())).collect())
        .expect("all coefficients")
}

fn harmonics(rows: &mut Vec<Check>) {
    row(rows, "harmonics of every order up to 8", "orthonormal within 1e-12", || {
        Verdict::facts((0..=8).map(sh_facts::basis_is_orthonormal))
    });
    for (name, angle) in
        [("1e-300", 1e-300), ("1e-9", 1e-9), ("π − 1e-12", std::f64::consts::PI - 1e-12), ("1e6", 1e6)]
    {
        row(
            rows,
            format!("order 8 turned by {name} radians"),
            "turns, and composes, within 1e-12",
            move || {
                let turn = DQuat::from_axis_angle(dvec3(0.48, -0.6, 0.64), angle);
                let (sh, other) = (any_sh(8), DQuat::from_rotation_x(0.3));
                let directions = [DVec3::X, DVec3::NEG_Z, DVec3::ONE];
                let turned = directions.map(|d| sh_facts::rotation_turns(&sh, turn, d));
                Verdict::facts(turned.into_iter().chain([sh_facts::rotations_compose(&sh, turn, other)]))
            },
        );
    }
    for radiance in [1e-30, 1.0, 1e30] {
        row(
            rows,
            format!("a constant sky of {radiance:e}"),
            "irradiance π times that, by every weight",
            move || {
                let of_size = |size| {
                    sh_facts::constant_sky_gives_pi(DVec3::splat(radiance), size, dvec3(1.0, 2.0, -0.5))
                };
                Verdict::facts([1, 2, 3, 32].map(of_size))
            },
        );
    }
    row(rows, "cubes of 1 to 257 texels a side", "solid angles sum to 4π within 1e-13", || {
        Verdict::facts([1, 2, 3, 64, 257].map(sh_facts::solid_angles_fill_the_sphere))
    });
}

fn fields(rows: &mut Vec<Check>) {
    for Set { name, points: positions, steep } in sets() {
        row(
            rows,
            format!("probes: {name}"),
            match steep {
                true => "constant light stays; shares sum to 1",
                false => "constant light stays; shares sum to 1 and do not jump",
            },
            move || {
                let asked = asked(&positions);
                let radiance: Vec<Sh> =
                    (0..positions.len()).map(|i| any_sh(2).scaled(1.0 + (i % 5) as f64)).collect();
                let field = match Field::new(&positions, &radiance) {
                    Ok(field) => field,
                    Err(error) => return Verdict { happened: error.to_string(), passed: false },
                };
                let ways = asked.windows(2).filter(|_| !steep).map(|way| {
                    field_facts::shares_do_not_jump(&field, (way[0], Vec3::ZERO), (way[1], Vec3::ZERO))
                });
                let sums = [
                    field_facts::constant_light_stays_constant(&positions, None, 3.0, &asked),
                    field_facts::shares_sum_to_one(&field, &asked),
                    field_facts::hints_do_not_matter(&field, &asked, 1e-4),
                ];
                Verdict::facts(sums.into_iter().chain(ways))
            },
        );
    }
    row(rows, "probes: radiance that is NaN", "a typed error", || {
        let sh = Sh::constant(DVec3::splat(f64::NAN), 2);
        match sh {
            Ok(sh) => Verdict::refused(Field::new(&[DVec3::ZERO], &[sh])),
            refused => Verdict::refused(refused),
        }
    });
    row(rows, "probes: a position that is ∞", "a typed error", || {
        let sh = Sh::constant(DVec3::ONE, 2).expect("order 2");
        Verdict::refused(Field::new(&[DVec3::splat(f64::INFINITY)], &[sh]))
    });
}
