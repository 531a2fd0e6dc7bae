//! The facts of `invariants`, and closed forms.

use glam::{DMat3, DVec3, dvec3};
use pointillist_surfel::invariants::{self, LEAST_DISTANCE};
use pointillist_surfel::{MAX_COUNT, Method, SampleOptions, SurfacePoint, SurfelError, sample};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2, TAU};
use testkit::holds;

const NOISE: SampleOptions = SampleOptions::DEFAULT;
const RAYS: SampleOptions = SampleOptions::DEFAULT.with_method(Method::Ldi);

type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

fn square(side: f64) -> Mesh {
    let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    (corners.map(|(x, y)| dvec3(x, y, 0.0) * side).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn cube(side: f64) -> Mesh {
    let bit = |i: u32, b: u32| f64::from(i >> b & 1) * side;
    let corners = (0..8).map(|i| dvec3(bit(i, 0), bit(i, 1), bit(i, 2))).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (corners, quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect())
}

/// A unit sphere of bands of triangles.
fn sphere(bands: u32) -> Mesh {
    let columns = 2 * bands;
    let mut positions = vec![];
    for r in 0..=bands {
        let (s, z) = (PI * f64::from(r) / f64::from(bands)).sin_cos();
        positions.extend((0..columns).map(|c| {
            let (y, x) = (TAU * f64::from(c) / f64::from(columns)).sin_cos();
            dvec3(s * x, s * y, z)
        }));
    }
    let at = |r: u32, c: u32| r * columns + c % columns;
    let quads = (0..bands).flat_map(|r| (0..columns).map(move |c| (r, c)));
    let triangles = quads.flat_map(|(r, c)| {
        let [a, b, d, e] = [at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)];
        // At the poles one of the two has no area.
        let kept = [(r + 1 < bands).then_some([a, b, d]), (r > 0).then_some([a, d, e])];
        kept.into_iter().flatten()
    });
    (positions, triangles.collect())
}

fn turned((positions, triangles): Mesh, angle: f64) -> Mesh {
    let turn = DMat3::from_axis_angle(dvec3(0.48, 0.6, 0.64), angle);
    (positions.into_iter().map(|p| turn * p).collect(), triangles)
}

fn sampled((positions, triangles): &Mesh, options: SampleOptions) -> Vec<SurfacePoint> {
    let points = sample(positions, triangles, &options).unwrap();
    invariants::points_lie_on_their_triangles(positions, triangles, &points).unwrap();
    points
}

fn area((positions, triangles): &Mesh) -> f64 {
    let of = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    triangles.iter().map(of).sum()
}

/// Any coordinate, with trouble: repeated, tiny, huge, far from 0.
fn coordinate() -> BoxedStrategy<f64> {
    prop_oneof![
        6 => -1.0..1.0,
        2 => (-4..=4).prop_map(|i| 0.25 * f64::from(i)),
        1 => (-1.0..1.0f64, -30..12).prop_map(|(x, e)| x * 10f64.powi(e)),
        1 => (-1.0..1.0f64).prop_map(|x| 1e6 + x),
    ]
    .boxed()
}

fn mesh() -> BoxedStrategy<Mesh> {
    let position = (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| dvec3(x, y, z));
    prop::collection::vec(position, 1..12)
        .prop_flat_map(|positions| {
            let n = positions.len() as u32;
            (Just(positions), prop::collection::vec([0..n, 0..n, 0..n], 0..16))
        })
        .boxed()
}

proptest! {
    #![proptest_config(testkit::config(48))]

    #[test]
    fn blue_noise_has_exactly_the_count(m in mesh(), count in 1..200usize, seed: u64) {
        holds!(invariants::counts_are_exact(&m.0, &m.1, count, seed));
    }

    #[test]
    fn rays_find_points_on_triangles(m in mesh(), count in 1..2000usize) {
        holds!(invariants::anything_is_sampled_or_refused(&m.0, &m.1, &RAYS.with_count(count)));
    }

    #[test]
    fn the_order_of_triangles_does_not_move_rays(m in mesh(), spacing in 0.02..1.0f64, turn: usize) {
        if area(&m) < 1e4 {
            holds!(invariants::triangle_order_does_not_matter(&m.0, &m.1, spacing, turn));
        }
    }

    #[test]
    fn a_patch_is_hit_once_by_every_ray(
        inner in prop::collection::vec((0.0..8.0f64, 0.0..8.0f64), 0..9), on_rays: bool, slope in -0.9..0.9f64,
    ) {
        // Split at each inner point that falls into a triangle: slivers, edges and corners on rays. Of 8 × 8 spacings.
        let mut m = square(8.0);
        for (x, y) in inner {
            let snap = |v: f64| if on_rays { v.floor() + 0.5 } else { v };
            let p = dvec3(snap(x), snap(y), 0.0);
            let inside = |t: &[u32; 3]| (0..3).all(|i| {
                let (a, b) = (m.0[t[i] as usize], m.0[t[(i + 1) % 3] as usize]);
                (b - a).cross(p - a).z > 1e-3
            });
            if let Some(k) = m.1.iter().position(inside) {
                let [a, b, c] = m.1.swap_remove(k);
                let n = m.0.len() as u32;
                m.0.push(p);
                m.1.extend([[a, b, n], [b, c, n], [c, a, n]]);
            }
        }
        m.0.iter_mut().for_each(|p| p.z = slope * p.x);
        let points = sampled(&m, RAYS.with_spacing(1.0));
        prop_assert_eq!(points.len(), 64);
        for (i, p) in points.iter().enumerate() {
            let ray = dvec3((i % 8) as f64 + 0.5, (i / 8) as f64 + 0.5, 0.0);
            prop_assert!((p.position.with_z(0.0) - ray).length() < 1e-5, "{} is not {}", p.position, ray);
        }
    }

    #[test]
    fn blue_noise_keeps_its_distance(count in 100..1500usize, seed: u64, angle in 0.0..6.0f64, which in 0..3usize) {
        let m = turned([square(2.0), cube(1.5), sphere(24)][which].clone(), angle);
        let points = sampled(&m, NOISE.with_count(count).with_seed(seed));
        let lattice = (area(&m) / (0.75f64.sqrt() * count as f64)).sqrt();
        holds!(invariants::points_keep_apart(&points, LEAST_DISTANCE * lattice));
    }

    #[test]
    fn discs_of_blue_noise_leave_no_gap(count in 200..1500usize, seed: u64, angle in 0.0..6.0f64, which in 0..3usize) {
        let m = turned([square(2.0), cube(1.5), sphere(24)][which].clone(), angle);
        let points = sampled(&m, NOISE.with_count(count).with_seed(seed));
        holds!(invariants::discs_leave_no_gap(&m.0, &m.1, &points, if which == 2 { 6 } else { 80 }, 1e-6));
    }

    #[test]
    fn discs_on_rays_leave_no_gap(count in 200..1500usize, angle in 0.0..6.0f64, which in 0..3usize) {
        let m = turned([square(2.0), cube(1.5), sphere(24)][which].clone(), angle);
        let points = sampled(&m, RAYS.with_count(count));
        holds!(invariants::discs_leave_no_gap(&m.0, &m.1, &points, if which == 2 { 6 } else { 80 }, 1e-6));
    }
}

#[test]
fn rays_find_the_closed_form_of_a_cube() {
    // Six faces of n × n rays each, whatever the place of the cube.
    for n in [1, 2, 7, 40] {
        for shift in [0.0, -3.0, 1e6] {
            let (mut positions, triangles) = cube(2.0);
            positions.iter_mut().for_each(|p| *p += shift);
            let points = sampled(&(positions, triangles), RAYS.with_spacing(2.0 / f64::from(n)));
            assert_eq!(points.len() as i32, 6 * n * n);
        }
    }
}

#[test]
fn rays_find_the_closed_form_of_a_sphere() {
    // ∫ |n|∞ over the unit sphere = 6 · 4 ∫₀^{π/4} dφ/(1 + cos² φ) = 12 √2 arctan(1/√2) ≈ 10.4449.
    let whole = 12.0 * SQRT_2 * FRAC_1_SQRT_2.atan();
    let spacing = 0.02;
    let count = sampled(&sphere(200), RAYS.with_spacing(spacing)).len() as f64;
    // The polyhedron is smaller by about (π/200)²/3, and rays on the lines where axes meet round either way.
    assert!((count * spacing * spacing / whole - 1.0).abs() < 2e-3, "{count}");
}

#[test]
fn rays_come_in_about_the_number_asked_for() {
    let points = sampled(&turned(sphere(64), 0.7), RAYS.with_count(20_000));
    assert!((points.len() as f64 / 20_000.0 - 1.0).abs() < 5e-3, "{}", points.len());
}

#[test]
fn points_are_as_dense_on_large_triangles_as_on_small_ones() {
    // A square of 2 × 16² triangles in one half and 2 in the other, by cells of 8 × 8: a χ² of 63 degrees of freedom is
    // below 93 in 99 % of random samples, and that of blue noise far below.
    let strip = |x0: f64, x1: f64, n: u32, mesh: &mut Mesh| {
        let first = mesh.0.len() as u32;
        let at = |i: u32| f64::from(i) / f64::from(n);
        let lattice = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
        mesh.0.extend(lattice.map(|(i, j)| dvec3(x0 + (x1 - x0) * at(i), at(j), 0.0)));
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let c = |di: u32, dj: u32| first + (j + dj) * (n + 1) + i + di;
            mesh.1.extend([[c(0, 0), c(1, 0), c(1, 1)], [c(0, 0), c(1, 1), c(0, 1)]]);
        }
    };
    let mut mesh = Mesh::default();
    strip(0.0, 0.5, 16, &mut mesh);
    strip(0.5, 1.0, 1, &mut mesh);
    let points = sampled(&mesh, NOISE.with_count(6400));
    let mut cells = [0.0; 64];
    points
        .iter()
        .for_each(|p| cells[(p.position.x * 8.0) as usize + 8 * (p.position.y * 8.0) as usize] += 1.0);
    let chi2: f64 = cells.iter().map(|n: &f64| (n - 100.0).powi(2) / 100.0).sum();
    assert!(chi2 < 20.0, "{chi2}: {cells:?}");
}

#[test]
fn both_sides_of_a_thin_sheet_are_sampled_alike() {
    let (mut positions, mut triangles) = square(1.0);
    positions.extend(positions.clone().iter().map(|p| p - DVec3::Z * 1e-4));
    triangles.extend([[4, 6, 5], [4, 7, 6]]);
    let points = sampled(&(positions, triangles), NOISE.with_count(1000));
    let above = points.iter().filter(|p| p.normal.z > 0.0).count();
    assert!(above.abs_diff(500) < 15, "{above}");
    for side in [1.0, -1.0] {
        let side: Vec<_> = points.iter().filter(|p| p.normal.z == side).copied().collect();
        invariants::points_keep_apart(&side, LEAST_DISTANCE * (2.0 / (0.75f64.sqrt() * 1000.0)).sqrt())
            .unwrap();
    }
}

#[test]
fn a_lattice_of_rays_has_discs_of_half_its_diagonal() {
    // The Voronoi cells of a square lattice are squares.
    let points = sampled(&square(1.0), RAYS.with_spacing(1.0 / 16.0));
    let inner = points.iter().filter(|p| (p.position - 0.5).with_z(0.0).abs().max_element() < 0.4);
    for p in inner {
        assert!((f64::from(p.radius) - SQRT_2 / 32.0).abs() < 1e-8, "{p:?}");
    }
}

#[test]
fn attributes_are_interpolated() {
    let mesh = turned(sphere(8), 0.3);
    for p in sampled(&mesh, NOISE.with_count(300)) {
        // A linear function of the place has the value of the place.
        let f = |v: DVec3| 3.0 * v.x - v.y + 0.5 * v.z;
        let corners = mesh.1[p.triangle as usize].map(|v| f(mesh.0[v as usize]));
        assert!((p.interpolate(corners) - f(p.position)).abs() < 1e-14);
    }
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn threads_do_not_change_a_bit_and_seeds_do() {
    let mesh = sphere(20);
    for options in [NOISE.with_count(3000), RAYS.with_count(3000)] {
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sampled(&mesh, options))
        };
        assert_eq!(by(1), by(2));
        assert_eq!(by(1), by(8));
    }
    assert_ne!(sampled(&mesh, NOISE.with_count(99)), sampled(&mesh, NOISE.with_count(99).with_seed(1)));
}

#[test]
fn what_cannot_be_sampled_is_refused() {
    let (positions, triangles) = square(1.0);
    let refused = |p: &[DVec3], t: &[[u32; 3]], o: SampleOptions| sample(p, t, &o).unwrap_err();
    let ok = |o| refused(&positions, &triangles, o);
    assert_eq!(ok(NOISE.with_count(0)), SurfelError::ZeroCount);
    assert!(matches!(ok(NOISE.with_count(MAX_COUNT + 1)), SurfelError::TooManyPoints { .. }));
    assert!(matches!(ok(RAYS.with_spacing(1e-6)), SurfelError::TooManyPoints { .. }));
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(ok(NOISE.with_spacing(spacing)), SurfelError::BadSpacing { .. }));
    }
    let mut broken = positions.clone();
    broken[2].y = f64::NAN;
    let error = refused(&broken, &triangles, NOISE);
    assert!(matches!(error, SurfelError::VertexNotFinite { index: 2, .. }), "{error:?}");
    let error = SurfelError::VertexOutOfRange { triangle: 1, vertex: 4, count: 4 };
    assert_eq!(refused(&positions, &[[0, 1, 2], [0, 4, 1]], NOISE), error);
    assert!(matches!(refused(&positions, &[], NOISE), SurfelError::NoArea { .. }));
    assert!(matches!(refused(&positions, &[[0, 1, 1]], RAYS), SurfelError::NoArea { .. }));
    // A thread of a billion spacings: few points, but too many rays.
    let thread = [DVec3::ZERO, dvec3(1e9, 0.0, 0.0), dvec3(1e9, 1e-8, 0.0)];
    assert!(matches!(refused(&thread, &[[0, 1, 2]], RAYS.with_spacing(1.0)), SurfelError::TooFine { .. }));
}
