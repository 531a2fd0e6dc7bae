//! Normals, radii and areas of clouds that have none: the facts of `invariants`, and closed forms.

use glam::{DMat3, DVec3, Vec3, dvec3};
use pointillist_surfel::invariants::{self, Estimates, estimates};
use pointillist_surfel::{Method, SampleOptions, SurfacePoint, SurfelError, estimate_normals, sample};
use proptest::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

/// A unit sphere of bands of triangles.
fn sphere(bands: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let columns = 2 * bands;
    let ring = |r: u32| {
        let (s, z) = (PI * f64::from(r) / f64::from(bands)).sin_cos();
        (0..columns).map(move |c| {
            let (y, x) = (TAU * f64::from(c) / f64::from(columns)).sin_cos();
            dvec3(s * x, s * y, z)
        })
    };
    let at = |r: u32, c: u32| r * columns + c % columns;
    let quads = (0..bands).flat_map(|r| (0..columns).map(move |c| (r, c)));
    let triangles = quads.flat_map(|(r, c)| {
        let [a, b, d, e] = [at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)];
        // At the poles one of the two has no area.
        let kept = [(r + 1 < bands).then_some([a, b, d]), (r > 0).then_some([a, d, e])];
        kept.into_iter().flatten()
    });
    ((0..=bands).flat_map(ring).collect(), triangles.collect())
}

/// Points of a unit sphere that is turned by an angle, rad.
fn on_sphere(method: Method, count: usize, angle: f64) -> Vec<DVec3> {
    let turn = DMat3::from_axis_angle(dvec3(0.48, 0.6, 0.64), angle);
    let (positions, triangles) = sphere(64);
    let positions: Vec<DVec3> = positions.into_iter().map(|p| turn * p).collect();
    let options = SampleOptions::DEFAULT.with_method(method).with_count(count);
    sample(&positions, &triangles, &options).unwrap().iter().map(|p| p.position.normalize()).collect()
}

/// Numbers from 0 to 1.
fn random(mut state: u64) -> impl FnMut() -> f64 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Random places on the unit sphere.
fn anywhere(count: usize, seed: u64) -> Vec<DVec3> {
    let mut next = random(seed);
    let mut place = || {
        let z = 2.0 * next() - 1.0;
        let (sin, cos) = (TAU * next()).sin_cos();
        dvec3(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
    };
    (0..count).map(|_| place()).collect()
}

/// Two scans: one all over, one from another direction and coarser over a half.
fn two_scans(count: usize) -> Vec<DVec3> {
    let mut points = on_sphere(Method::Ldi, count, 0.3);
    points.extend(on_sphere(Method::Ldi, count * 3 / 4, 1.3).into_iter().filter(|p| p.x > 0.0));
    points
}

fn sheet(side: u32) -> Vec<DVec3> {
    (0..side * side).map(|i| dvec3(f64::from(i % side), f64::from(i / side), 0.0)).collect()
}

fn total(areas: &[f32]) -> f64 {
    areas.iter().map(|&area| f64::from(area)).sum()
}

/// Coordinates with trouble: equal, on lines, 1e-30 apart, far from 0.
fn cloud() -> BoxedStrategy<Vec<DVec3>> {
    let coordinate = prop_oneof![
        6 => -1.0..1.0,
        4 => (-2..=2).prop_map(|i| 0.5 * f64::from(i)),
        1 => (-4..=4).prop_map(|i| 1e-30 * f64::from(i)),
        1 => (-1.0..1.0f64).prop_map(|x| 1e6 + x),
        1 => (-1.0..1.0f64, -320..300).prop_map(|(x, e)| x * 10f64.powi(e)),
    ]
    .boxed();
    let any = [coordinate.clone(), coordinate.clone(), coordinate.clone()].prop_map(DVec3::from_array);
    let line = (any.clone(), any.clone(), prop::collection::vec(-9..9i32, 1..40)).prop_map(|(a, b, at)| {
        at.into_iter().map(|t| a + b * (0.125 * f64::from(t))).filter(|p| p.is_finite()).collect()
    });
    let plane = (any.clone(), -30..12i32, prop::collection::vec((-9..9i32, -9..9i32), 1..90));
    let plane = plane.prop_map(|(a, e, at)| {
        let place =
            |(x, y): (i32, i32)| a + dvec3(f64::from(x), f64::from(y), f64::from(x - y)) * 10f64.powi(e);
        at.into_iter().map(place).filter(|p| p.is_finite()).collect()
    });
    prop_oneof![2 => prop::collection::vec(any, 0..60), 1 => line, 1 => plane].boxed()
}

fn normal() -> BoxedStrategy<Vec3> {
    let component = || prop_oneof![-1.0..1.0f32, Just(0.0), Just(1.0)];
    [component(), component(), component()].prop_map(|n| Vec3::from_array(n).normalize_or(Vec3::Z)).boxed()
}

fn radius() -> BoxedStrategy<f32> {
    prop_oneof![3 => 0.01..2.0f32, 1 => (1.0..9.0f32, -37..38).prop_map(|(r, e)| r * 10f32.powi(e))].boxed()
}

proptest! {
    #![proptest_config(testkit::config(128))]

    #[test]
    fn any_cloud_has_estimates(cloud in cloud()) {
        invariants::estimates_are_sound(&cloud).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn any_normals_and_radii_have_areas(
        cloud in cloud(), normals in prop::collection::vec(normal(), 90), radii in prop::collection::vec(radius(), 90),
    ) {
        let n = cloud.len();
        invariants::areas_are_sound(&cloud, &normals[..n], &radii[..n]).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn normals_of_a_sphere_point_to_its_centre() {
    for points in [on_sphere(Method::Poisson, 2000, 0.3), on_sphere(Method::Ldi, 2000, 0.3), two_scans(2000)]
    {
        let angle = |(n, p): (&Vec3, &DVec3)| n.as_dvec3().dot(*p).abs().min(1.0).acos();
        let mean =
            estimates(&points).normals.iter().zip(&points).map(angle).sum::<f64>() / points.len() as f64;
        assert!(mean.to_degrees() < 1.0, "{}°", mean.to_degrees());
    }
}

#[test]
fn estimated_normals_come_in_the_order_of_the_points_and_not_from_bad_ones() {
    let far = DVec3::splat(1e4);
    let points = on_sphere(Method::Poisson, 2000, 0.3);
    let moved: Vec<DVec3> = points.iter().map(|p| *p * 3.0 + far).collect();
    let normals = estimate_normals(&moved).unwrap();
    let worst = normals.iter().zip(&points).map(|(n, p)| n.as_dvec3().dot(*p).abs()).fold(1.0, f64::min);
    assert!(normals.len() == points.len() && worst > 0.99, "{worst}");
    assert_eq!(estimate_normals(&[]), Err(SurfelError::NoPoints));
    let bad = [DVec3::ZERO, DVec3::NAN];
    assert!(matches!(estimate_normals(&bad), Err(SurfelError::PointNotFinite { index: 1, .. })));
}

/// Points of a torus about Z with this thickness, whose other radius is 1, and the vectors out of it.
fn torus(count: u32, thickness: f64) -> (Vec<DVec3>, Vec<DVec3>) {
    // As many rounds as make the lattice about square.
    let rounds = (f64::from(count) * thickness).sqrt();
    let at = |i: u32| {
        let (around, through) = (TAU * f64::from(i) / rounds, TAU * f64::from(i) / f64::from(count));
        let (axis, out) = (dvec3(through.cos(), through.sin(), 0.0), around.cos());
        let out = axis * out + DVec3::Z * around.sin();
        (axis + out * thickness, out)
    };
    (0..count).map(at).unzip()
}

#[test]
fn normals_stand_outside_of_closed_surfaces() {
    for points in [on_sphere(Method::Poisson, 2000, 0.3), two_scans(800), anywhere(2000, 4), anywhere(100, 4)]
    {
        invariants::sides_are_found(&points, &points, true).unwrap();
    }
    for (count, thickness) in [(4000, 0.4), (4000, 0.1)] {
        let (points, out) = torus(count, thickness);
        invariants::sides_are_found(&points, &out, true).unwrap();
    }
    // One in the other, and one beside them that is small and dense.
    let sphere = on_sphere(Method::Poisson, 2000, 0.3);
    let moved = |factor: f64, by: DVec3| sphere.iter().map(move |p| *p * factor + by);
    let three = moved(1.0, DVec3::ZERO).chain(moved(0.8, DVec3::ZERO)).chain(moved(0.1, DVec3::X * 1.5));
    invariants::sides_are_found(&three.collect::<Vec<_>>(), &sphere.repeat(3), true).unwrap();
}

#[test]
fn normals_stand_outside_of_sharp_and_thin_things() {
    // A box of 40 × 40 × 3 lattice steps: edges, and two sheets three steps apart.
    let (wide, thick) = (40, 3);
    let (mut points, mut out) = (vec![], vec![]);
    for (x, y, z) in
        (0..=wide).flat_map(|x| (0..=wide).flat_map(move |y| (0..=thick).map(move |z| (x, y, z))))
    {
        let side = |at: i32, size: i32| f64::from(i32::from(at == size) - i32::from(at == 0));
        let way = dvec3(side(x, wide), side(y, wide), side(z, thick));
        if way != DVec3::ZERO {
            points.push(dvec3(x.into(), y.into(), z.into()));
            out.push(way);
        }
    }
    invariants::sides_are_found(&points, &out, true).unwrap();
}

#[test]
fn normals_of_open_surfaces_stand_on_one_side_and_not_outside() {
    let wavy: Vec<DVec3> =
        sheet(50).iter().map(|p| *p + DVec3::Z * 3.0 * (0.3 * p.x).sin() * (0.2 * p.y).cos()).collect();
    invariants::sides_are_found(&wavy, &[DVec3::Z; 2500], false).unwrap();
    // Up, because most of it faces so.
    assert!(estimates(&wavy).normals.iter().all(|n| n.z > 0.0));
    let half: Vec<DVec3> = on_sphere(Method::Poisson, 3000, 0.3).into_iter().filter(|p| p.x < 0.0).collect();
    invariants::sides_are_found(&half, &half, false).unwrap();
    // A tube without ends.
    let tube: Vec<DVec3> = sheet(60)
        .iter()
        .map(|p| dvec3((TAU * p.x / 60.0).cos(), (TAU * p.x / 60.0).sin(), 0.1 * p.y))
        .collect();
    let out: Vec<DVec3> = tube.iter().map(|p| dvec3(p.x, p.y, 0.0)).collect();
    invariants::sides_are_found(&tube, &out, false).unwrap();
}

#[test]
fn noise_does_not_turn_normals() {
    // A fifth of a spacing (0.08) on either side.
    let mut next = random(9);
    let points = on_sphere(Method::Poisson, 2000, 0.3);
    let noisy: Vec<DVec3> = points.iter().map(|p| *p * (1.0 + 0.032 * (next() - 0.5))).collect();
    invariants::sides_are_found(&noisy, &points, true).unwrap();
}

#[test]
fn normals_follow_a_bend() {
    // A plane through 14 unevenly spread neighbours is off by 0.50°.
    let points = on_sphere(Method::Poisson, 4000, 0.3);
    let angle = |(n, p): (&Vec3, &DVec3)| n.as_dvec3().angle_between(*p);
    let mean = estimates(&points).normals.iter().zip(&points).map(angle).sum::<f64>() / points.len() as f64;
    assert!(mean.to_degrees() < 0.05, "{}°", mean.to_degrees());
}

/// The mean angle between estimated and given normals, in degrees, of points that are shifted along these by up to so much.
fn off_by_noise(points: &[DVec3], out: &[DVec3], most: f64) -> f64 {
    let mut next = random(5);
    let noisy: Vec<DVec3> =
        points.iter().zip(out).map(|(p, n)| p + n * (most * (2.0 * next() - 1.0))).collect();
    let angle = |(n, out): (&Vec3, &DVec3)| n.as_dvec3().angle_between(*out);
    let sum: f64 = estimate_normals(&noisy).unwrap().iter().zip(out).map(angle).sum();
    (sum / points.len() as f64).to_degrees()
}

#[test]
fn normals_of_noisy_points_are_means_of_those_around() {
    // Paraboloids alone are off by 0.05°, 3.7° and 7.2°; means by 0.05°, 1.7° and 2.4°.
    let (points, out) = torus(8000, 0.4);
    let spacing = (TAU * TAU * 0.4 / 8000.0).sqrt();
    for (noise, most) in [(0.0, 0.06), (0.25, 2.2), (0.5, 3.2)] {
        let off = off_by_noise(&points, &out, noise * spacing);
        assert!(off < most, "{off}° with noise of {noise} spacings");
    }
}

#[test]
fn normals_of_a_plane_are_exact_far_away() {
    // At 1e6, coordinates of the plane are rounded to 1e-10.
    let normal = dvec3(0.36, 0.48, 0.8);
    let (right, up) = normal.any_orthonormal_pair();
    let points: Vec<DVec3> =
        sheet(20).iter().map(|p| 1e6 + right * (p.x + 0.3 * p.y * p.y) + up * p.y).collect();
    for n in estimates(&points).normals {
        assert!((n - normal.as_vec3()).length() < 1e-6, "{n}");
    }
}

#[test]
fn normals_of_a_line_are_across_it_and_of_a_point_up() {
    let along = dvec3(0.6, -0.64, 0.48);
    let line: Vec<DVec3> = (0..50).map(|i| along * f64::from(i)).collect();
    assert!(estimates(&line).normals.iter().all(|n| n.as_dvec3().dot(along).abs() < 1e-6));
    assert!(estimates(&line[..2]).normals.iter().all(|n| n.as_dvec3().dot(along).abs() < 1e-6));
    assert_eq!(estimates(&[along; 7]).normals, [Vec3::Z; 7]);
}

#[test]
fn discs_of_a_sphere_leave_no_gap() {
    let (positions, triangles) = sphere(32);
    let clouds = [
        on_sphere(Method::Ldi, 1500, 0.3),
        on_sphere(Method::Poisson, 1500, 0.3),
        two_scans(1500),
        anywhere(1500, 8),
    ];
    for points in clouds {
        let Estimates { normals, radii, .. } = estimates(&points);
        let disc = |i: usize| SurfacePoint {
            position: points[i],
            normal: normals[i].as_dvec3() * normals[i].as_dvec3().dot(points[i]).signum(),
            triangle: 0,
            barycentric: DVec3::X,
            radius: radii[i],
        };
        let discs: Vec<SurfacePoint> = (0..points.len()).map(disc).collect();
        // Discs lie in tangent planes, cells on the sphere: of a spacing s, s² / 12 ≈ 0.1 % longer.
        invariants::discs_leave_no_gap(&positions, &triangles, &discs, 3, 1e-2).unwrap();
    }
}

#[test]
fn a_lattice_has_discs_of_half_its_diagonal_up_to_the_border() {
    for scale in [1e-30, 1.0, 1e12] {
        let points: Vec<DVec3> = sheet(20).iter().map(|&p| p * scale).collect();
        for radius in estimates(&points).radii {
            assert!((f64::from(radius) / scale - FRAC_1_SQRT_2).abs() < 1e-6, "{radius:e}");
        }
    }
}

#[test]
fn points_in_a_row_have_discs_that_touch() {
    let row: Vec<DVec3> = (0..20).map(|i| DVec3::X * f64::from(i)).collect();
    assert_eq!(estimates(&row).radii, [0.5; 20]);
    assert_eq!(estimates(&row[..1]).radii, [1.0]);
    assert_eq!(estimates(&[DVec3::ONE; 9]).radii, [1.0; 9]);
}

#[test]
fn a_lone_point_far_away_has_no_giant_disc() {
    for place in [dvec3(10.0, 10.0, 60.0), dvec3(-60.0, 10.0, 0.0)] {
        let mut points = sheet(20);
        points.push(place);
        let radius = estimates(&points).radii[400];
        // Twice the spacing of its neighbours, √2 to 2 on a border.
        assert!(radius <= 4.0, "{radius}");
    }
}

#[test]
fn areas_of_a_sphere_add_up_to_it() {
    for points in [on_sphere(Method::Poisson, 2000, 0.3), on_sphere(Method::Ldi, 2000, 0.3), two_scans(2000)]
    {
        let share = total(&estimates(&points).areas) / (4.0 * PI);
        assert!((share - 1.0).abs() < 0.02, "{share}");
    }
}

#[test]
fn kernels_of_a_sphere_add_up_to_one_anywhere() {
    // The table at `SWEEPS` in `areas.rs`, and some of the deviation that 300 places have.
    let probes = anywhere(300, 5);
    let clouds = [
        (on_sphere(Method::Ldi, 2000, 0.3), 0.09),
        (on_sphere(Method::Poisson, 2000, 0.3), 0.15),
        (two_scans(2000), 0.13),
    ];
    for (points, ripple) in clouds {
        invariants::areas_reproduce_constants(&points, &probes, 0.025, ripple).unwrap();
    }
}

#[test]
fn areas_of_a_lattice_are_one_inside_and_bounded_on_the_border() {
    let areas = estimates(&sheet(20)).areas;
    assert!((areas[210] - 1.0).abs() < 0.02, "{}", areas[210]);
    assert!(areas.iter().all(|&area| area < 1.6));
}

#[test]
fn a_point_stands_for_no_more_than_its_disc() {
    for points in [anywhere(500, 3), vec![DVec3::ONE], vec![DVec3::ZERO, DVec3::X]] {
        let Estimates { radii, areas, .. } = estimates(&points);
        for (radius, area) in radii.iter().zip(areas) {
            let disc = PI * f64::from(*radius).powi(2);
            assert!(f64::from(area) <= disc * (1.0 + 1e-6), "{area} and {disc}");
        }
    }
}

#[test]
fn points_that_coincide_share_their_area() {
    let points = sheet(12);
    let alone = estimates(&points);
    let thrice: Vec<DVec3> = points.iter().flat_map(|&p| [p; 3]).collect();
    let shared = estimates(&thrice);
    for (i, area) in shared.areas.iter().enumerate() {
        assert!((area * 3.0 / alone.areas[i / 3] - 1.0).abs() < 1e-6);
        assert_eq!((shared.radii[i], shared.normals[i]), (alone.radii[i / 3], alone.normals[i / 3]));
    }
}

#[test]
fn very_many_points_in_one_place_take_no_longer() {
    // Pair by pair this would be 1e10 distances.
    let mut points = vec![dvec3(3.0, 3.0, 0.0); 100_000];
    points.extend(sheet(8));
    let areas = estimates(&points).areas;
    assert!((total(&areas) / 64.0 - 1.0).abs() < 0.15, "{}", total(&areas));
}

#[test]
fn the_two_sides_of_a_sheet_have_areas_of_their_own() {
    // Points that coincide, one facing each way.
    let points: Vec<DVec3> = sheet(12).into_iter().flat_map(|p| [p; 2]).collect();
    let normals: Vec<Vec3> = (0..points.len()).map(|i| if i % 2 == 0 { Vec3::Z } else { -Vec3::Z }).collect();
    let (one, two) = invariants::areas_by_sides(&points, &normals, &vec![0.75; points.len()]);
    for (one, two) in one.iter().zip(two) {
        assert!((two * 2.0 / one - 1.0).abs() < 1e-6, "{one} and {two}");
    }
}

#[test]
#[cfg_attr(target_family = "wasm", ignore = "one thread is all there is")]
fn threads_do_not_change_a_bit() {
    let points = two_scans(1500);
    let by = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| estimates(&points))
    };
    assert_eq!(by(1), by(2));
    assert_eq!(by(1), by(8));
}
