//! Spherical harmonics: the facts of `invariants`, closed forms, and what went wrong once.

use glam::{DMat3, DQuat, DVec3, EulerRot, dvec3};
use pointillist_sh::invariants as facts;
use pointillist_sh::{
    Clipping, CubeMap, CubePoint, CubeProjector, DominantLight, IrradianceMatrix, Lobe, MAX_ORDER, Panorama,
    PanoramaProjector, Product, Response, Rotation, Sh, ShError, SphereQuadrature, Weights, Window, basis,
    basis_l2, coefficient_count, cube_direction, cube_point, gauss_legendre, texel_solid_angle,
};
use proptest::collection::vec;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn color() -> impl Strategy<Value = DVec3> {
    [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from)
}

/// Of unit length; often along an axis or a diagonal.
fn direction() -> impl Strategy<Value = DVec3> {
    let corner =
        (-1..=1_i32, -1..=1_i32, -1..=1_i32).prop_map(|(x, y, z)| dvec3(x.into(), y.into(), z.into()));
    let any = color();
    prop_oneof![1 => corner, 3 => any].prop_filter_map("no direction", DVec3::try_normalize)
}

fn rotation() -> impl Strategy<Value = DQuat> {
    let quarter = (0..4_i32, 0..4_i32, 0..4_i32).prop_map(|(x, y, z)| {
        let [x, y, z] = [x, y, z].map(|turns| f64::from(turns) * FRAC_PI_2);
        DQuat::from_euler(EulerRot::XYZ, x, y, z)
    });
    let any = (direction(), -PI..PI).prop_map(|(axis, angle)| DQuat::from_axis_angle(axis, angle));
    prop_oneof![1 => quarter, 3 => any]
}

fn of_order(order: usize) -> impl Strategy<Value = Sh> {
    vec(color(), coefficient_count(order)).prop_map(|c| Sh::new(c).unwrap())
}

fn sh() -> impl Strategy<Value = Sh> {
    (0..=MAX_ORDER).prop_flat_map(of_order)
}

/// Light that is bright on average: of lamps, a sky, and noise that makes it ring.
fn lit() -> impl Strategy<Value = Sh> {
    let lamp = (direction(), 0.0..20.0_f64);
    (vec(lamp, 0..3), of_order(2), 0.0..0.5_f64, 0.01..2.0_f64).prop_map(|(lamps, noise, amount, sky)| {
        let mut sum = Sh::constant(DVec3::splat(sky), 2).unwrap();
        sum.add_scaled(&noise, amount * sky).unwrap();
        for (direction, power) in lamps {
            let lamp = DominantLight { direction, irradiance: dvec3(1.0, 0.8, 0.5) * power };
            sum.add_scaled(&lamp.to_sh(2).unwrap(), 1.0).unwrap();
        }
        sum
    })
}

fn hold(result: Result<(), String>) -> Result<(), TestCaseError> {
    result.map_err(TestCaseError::fail)
}

proptest! {
    #![proptest_config(testkit::config(64))]

    #[test]
    fn rotation_keeps_band_power_and_turns_the_function(sh in sh(), q in rotation(), d in direction()) {
        hold(facts::rotation_turns(&sh, q, d))?;
    }

    #[test]
    fn rotations_compose(sh in sh(), first in rotation(), second in rotation()) {
        hold(facts::rotations_compose(&sh, first, second))?;
    }

    #[test]
    fn irradiance_is_the_integral_over_the_hemisphere(sh in sh(), n in direction()) {
        hold(facts::irradiance_is_the_integral(&sh, n))?;
    }

    #[test]
    fn matrix_and_bands_give_the_same_irradiance(sh in of_order(2), n in direction()) {
        hold(facts::irradiance_agrees(&sh, n))?;
    }

    #[test]
    fn a_constant_sky_gives_pi_times_itself(radiance in color(), size in 1..40_usize, n in direction()) {
        hold(facts::constant_sky_gives_pi(radiance, size, n))?;
    }

    #[test]
    fn deringed_light_is_nowhere_negative(sh in lit(), n in direction()) {
        hold(facts::deringed_is_not_negative(&sh, n))?;
    }

    #[test]
    fn minimum_of_order_2_is_least(sh in of_order(2), d in direction()) {
        hold(facts::minimum_is_least(&sh.channel(0), d))?;
    }

    #[test]
    fn products_multiply(left in (0..=4_usize).prop_flat_map(of_order), right in (0..=4_usize).prop_flat_map(of_order), d in direction()) {
        hold(facts::product_multiplies(&left, &right.channel(1), d))?;
    }

    #[test]
    fn points_of_the_cube_come_back(face in 0..6_usize, s in -1.5..1.5_f64, t in -1.5..1.5_f64) {
        hold(facts::cube_points_come_back(CubePoint { face, s, t }))?;
        // On edges and corners.
        hold(facts::cube_points_come_back(CubePoint { face, s: s.signum(), t }))?;
        hold(facts::cube_points_come_back(CubePoint { face, s: s.signum(), t: t.signum() }))?;
    }

    #[test]
    fn quadrature_reproduces_band_limited_functions(sh in sh()) {
        let rule = SphereQuadrature::new(2 * sh.order());
        let back = rule.project(sh.order(), |direction| sh.at(direction)).unwrap();
        prop_assert!(facts::difference(&sh, &back) < 1e-12);
    }

    #[test]
    fn panoramas_reproduce_band_limited_functions(sh in sh()) {
        let map = Panorama::from_fn(40, 20, |direction| sh.at(direction)).unwrap();
        let back = PanoramaProjector::new(40, 20, sh.order(), Weights::Gregory).unwrap().project(&map).unwrap();
        // Pixels are in single precision.
        prop_assert!(facts::difference(&sh, &back) < 3e-7);
    }

    #[test]
    fn blending_is_linear(a in of_order(2), b in of_order(2), t in 0.0..1.0_f64, d in direction()) {
        let blend = Sh::blend([(&a, 1.0 - t), (&b, t)]).unwrap();
        prop_assert!((blend.at(d) - a.at(d).lerp(b.at(d), t)).length() < 1e-13);
        let mut into = a.clone();
        into.set_to_blend([(&a, 1.0 - t), (&b, t)]).unwrap();
        prop_assert_eq!(into, blend);
    }

    #[test]
    fn projection_is_the_plain_sum(size in 1..24_usize, order in 0..=MAX_ORDER, seed in any::<u32>()) {
        let mut state = seed | 1;
        let mut random = || { state ^= state << 13; state ^= state >> 17; state ^= state << 5; state as f32 / u32::MAX as f32 };
        let texels: Vec<_> = (0..6 * size * size).map(|_| [random(), random(), 8.0 * random()]).collect();
        let map = CubeMap::from_texels(size, &texels).unwrap();
        for weights in facts::WEIGHTS {
            let projector = CubeProjector::new(size, order, weights).unwrap();
            assert_eq!((projector.order(), projector.weights()), (order, weights));
            let fast = projector.project(&map).unwrap();
            let plain = plain_projection(&map, order, weights);
            prop_assert!(facts::difference(&plain, &fast) < 1e-12, "{:?}", facts::difference(&plain, &fast));
            let red = projector.project_plane(&map.planes()[0]).unwrap();
            prop_assert_eq!(fast.channel(0), red);
        }
    }

    #[test]
    fn no_plane_makes_it_panic(size in 1..9_usize, value in any::<f32>(), place in any::<prop::sample::Index>()) {
        let mut plane = vec![1.0; 6 * size * size];
        let i = place.index(plane.len());
        plane[i] = value;
        let result = CubeProjector::new(size, 2, Weights::Gregory).unwrap().project_plane(&plane);
        let wrong = ShError::TexelNotFinite { face: i / (size * size), x: i % size, y: i / size % size };
        prop_assert_eq!(result.err(), (!value.is_finite()).then_some(wrong));
    }
}

proptest! {
    // A search in debug builds takes its time.
    #![proptest_config(testkit::config(12))]

    #[test]
    fn minimum_of_any_order_is_least(sh in sh(), d in direction()) {
        hold(facts::minimum_is_least(&sh.channel(0), d))?;
    }
}

/// Texel by texel, as the paper has it.
fn plain_projection(map: &CubeMap, order: usize, weights: Weights) -> Sh {
    let size = map.size();
    let mut sums = vec![DVec3::ZERO; coefficient_count(order)];
    let weights = weights.of_face(size).unwrap();
    for i in 0..6 * size * size {
        let (face, y, x) = (i / (size * size), i / size % size, i % size);
        let texel = DVec3::from(map.texel(face, x, y).unwrap().map(f64::from)) * weights[i % (size * size)];
        let values = basis(order, map.texel_direction(face, x, y));
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += texel * value);
    }
    Sh::new(sums).unwrap()
}

#[test]
fn basis_is_orthonormal_up_to_the_highest_order() {
    for order in 0..=MAX_ORDER {
        facts::basis_is_orthonormal(order).unwrap();
    }
}

#[test]
fn basis_of_order_2_is_that_of_all_orders() {
    for direction in [DVec3::Y, dvec3(0.48, -0.6, 0.64), dvec3(-0.8, 0.36, -0.48)] {
        let (all, nine) = (basis(3, direction), basis_l2(direction));
        assert!(all.iter().zip(nine).all(|(a, b)| (a - b).abs() < 1e-15), "{all:?} {nine:?}");
    }
    // Signs and order as `cli.md` has them.
    let [x, y, z] = [0.48, 0.6, 0.64];
    let wanted = [1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y];
    let values = basis_l2(dvec3(x, y, z));
    assert!(values.iter().zip(wanted).all(|(a, b)| a * b > 0.0));
}

#[test]
fn solid_angles_fill_the_sphere_at_any_size() {
    for size in [1, 2, 3, 5, 8, 17, 32, 64, 100, 128, 256] {
        facts::solid_angles_fill_the_sphere(size).unwrap();
    }
    assert_eq!(texel_solid_angle(4, 4, 0), 0.0);
    // A large texel by four arctangents.
    let corner = |s: f64, t: f64| (s * t / (s * s + t * t + 1.0).sqrt()).atan();
    let wanted = corner(1.0, 1.0) - corner(0.5, 1.0) - corner(1.0, 0.5) + corner(0.5, 0.5);
    assert!((texel_solid_angle(4, 3, 3) - wanted).abs() < 1e-15);
}

#[test]
fn weights_of_a_face_are_a_sixth_of_the_sphere() {
    for (weights, size) in facts::WEIGHTS.into_iter().flat_map(|w| [1, 2, 5, 16, 33].map(|size| (w, size))) {
        let sum: f64 = weights.of_face(size).unwrap().iter().sum();
        assert!((sum * 6.0 / (4.0 * PI) - 1.0).abs() < 1e-13, "{weights:?} {size}");
    }
}

/// Known from measurement: 7.8e-9, 3.6e-6 and 1.7e-6 of L00, for a sky that is quadratic in the direction.
#[test]
fn end_corrections_make_smooth_skies_exact_to_1e_8() {
    let sky = |d: DVec3| dvec3(1.0 + 0.5 * d.x + 0.3 * d.y * d.z, 2.0 + d.y, 1.5 + d.z * d.z);
    let exact = SphereQuadrature::new(4).project(2, sky).unwrap();
    let map = CubeMap::from_fn(128, sky).unwrap();
    let error = |weights| {
        let sh = CubeProjector::new(128, 2, weights).unwrap().project(&map).unwrap();
        facts::difference(&exact, &sh)
    };
    let [gregory, exact, paper] = facts::WEIGHTS.map(error);
    assert!(gregory < 1e-8 && (1e-6..5e-6).contains(&exact) && (1e-6..2e-6).contains(&paper));
    // Constant only: too few texels for end corrections, and those of the normalised rule.
    assert_eq!(Weights::Gregory.of_face(15), Weights::Paper.of_face(15));
}

#[test]
fn cubes_reproduce_band_limited_functions_better_and_better() {
    let c = |i: usize| DVec3::new((i as f64).sin(), (2.0 * i as f64).cos(), (3.0 * i as f64).sin());
    let sh = Sh::new((0..25).map(c).collect()).unwrap();
    let error = |size| facts::reconstruction_error(&sh, size, Weights::Gregory).unwrap();
    let errors = [16, 32, 64, 128].map(error);
    assert!(errors.windows(2).all(|e| e[1] < e[0] / 8.0) && errors[3] < 2e-7, "{errors:?}");
}

#[test]
fn faces_look_where_the_convention_says() {
    let centres = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    let map = CubeMap::black(5).unwrap();
    for (face, centre) in centres.into_iter().enumerate() {
        assert_eq!(cube_direction(CubePoint { face, s: 0.0, t: 0.0 }), centre);
        assert_eq!(map.texel_direction(face, 2, 2), centre);
        for (x, y) in [(0, 0), (4, 0), (1, 3)] {
            assert_eq!(map.texel_at(map.texel_direction(face, x, y)), Some([face, x, y]));
        }
    }
    assert_eq!(cube_point(DVec3::ZERO), None);
    assert_eq!(cube_point(dvec3(f64::NAN, 1.0, 0.0)), None);
    assert_eq!(cube_point(DVec3::Y * f64::MIN_POSITIVE).map(|p| p.face), Some(2));
    // Upper left of +X: right of it is −Z, so it looks to +Y and +Z.
    assert_eq!(cube_direction(CubePoint { face: 0, s: -1.0, t: -1.0 }), dvec3(1.0, 1.0, 1.0));
}

#[test]
fn panoramas_look_where_the_convention_says() {
    let map = Panorama::from_fn(64, 32, |direction| direction.max(DVec3::ZERO)).unwrap();
    let near = |a: DVec3, b: DVec3| a.distance(b) < 0.08;
    assert!(near(map.pixel_direction(32, 16), -DVec3::Z));
    assert!(near(map.pixel_direction(48, 16), DVec3::X));
    assert!(near(map.pixel_direction(10, 0), DVec3::Y));
    for direction in [DVec3::X, DVec3::Y, -DVec3::Y, dvec3(0.01, 0.3, 1.0), dvec3(-0.01, 0.3, 1.0)] {
        let direction = direction.normalize();
        let seen = map.at(direction).as_dvec3();
        assert!(seen.distance(direction.max(DVec3::ZERO)) < 0.04, "{direction} {seen}");
    }
    let sphere: f64 = (0..32).map(|y| 64.0 * map.solid_angle(y)).sum();
    assert!((sphere / (4.0 * PI) - 1.0).abs() < 1e-13);
}

#[test]
fn a_cube_of_a_panorama_has_the_same_light() {
    let sky = |d: DVec3| dvec3(1.0 + d.x, 1.0 + d.y * d.z, if d.y > 0.3 { 4.0 } else { 0.5 });
    let map = Panorama::from_fn(256, 128, sky).unwrap();
    let direct = PanoramaProjector::new(256, 128, 2, Weights::Exact).unwrap().project(&map).unwrap();
    // Also with a cube so coarse that each texel is the mean of many pixels.
    for (size, limit) in [(8, 2e-2), (32, 3e-3), (128, 1e-3)] {
        let cube = CubeProjector::new(size, 2, Weights::Exact)
            .unwrap()
            .project(&map.to_cube(size).unwrap())
            .unwrap();
        let error = facts::difference(&direct, &cube);
        assert!(error < limit, "{size}: {error}");
    }
}

#[test]
fn cosine_lobe_is_that_of_phong_with_exponent_1() {
    let phong = Lobe::phong(1.0).unwrap();
    for (cosine, phong) in Lobe::COSINE.bands().iter().zip(phong.bands()) {
        assert!((cosine - PI * phong).abs() < 1e-15);
    }
    // The other way to the same numbers: the integral.
    for l in 0..=MAX_ORDER {
        let y = |z: f64| {
            basis(MAX_ORDER, dvec3((1.0 - z * z).sqrt(), 0.0, z))[l * (l + 1)]
                / basis(MAX_ORDER, DVec3::Z)[l * (l + 1)]
        };
        let a: f64 = gauss_legendre(12)
            .iter()
            .map(|&(x, w)| (0.5 * (x + 1.0), 0.5 * w))
            .map(|(z, w)| TAU * w * z * y(z))
            .sum();
        assert!((Lobe::COSINE.bands()[l] - a).abs() < 1e-14, "band {l}");
    }
}

#[test]
fn lobes_keep_the_mean_and_get_narrow() {
    let widths = [1.0, 0.5, 0.1, 0.01, 1e-4].map(|alpha| Lobe::ggx(alpha).unwrap());
    for pair in widths.windows(2) {
        assert_eq!(pair[0].bands()[0], 1.0);
        // Band 4 and above of wide lobes are about 0, on either side.
        assert!((1..=3).all(|l| pair[1].bands()[l] > pair[0].bands()[l]), "{pair:?}");
    }
    assert!(widths[4].bands()[MAX_ORDER] > 0.9999);
    // Where D is constant, it is the cosine.
    assert!(widths[0].bands().iter().zip(Lobe::COSINE.bands()).all(|(a, b)| (a * PI - b).abs() < 1e-12));
    let sky = Sh::constant(DVec3::ONE, 3).unwrap();
    assert!((sky.glossy(DVec3::X, &Lobe::phong(40.0).unwrap()) - DVec3::ONE).length() < 1e-14);
    assert_eq!(sky.convolved(&Lobe::MIRROR), sky);
}

#[test]
fn the_power_of_a_band_is_that_of_its_coefficients() {
    let sh = Sh::new((0..9).map(|i| DVec3::new(f64::from(i), -1.0, 0.0)).collect()).unwrap();
    assert_eq!(sh.band_power(0), dvec3(0.0, 1.0, 0.0));
    assert_eq!(sh.band_power(1), dvec3(1.0 + 4.0 + 9.0, 3.0, 0.0));
    assert_eq!(sh.band_power(2), dvec3(16.0 + 25.0 + 36.0 + 49.0 + 64.0, 5.0, 0.0));
}

#[test]
fn dominant_light_finds_a_lamp() {
    let lamp = DominantLight { direction: dvec3(0.48, 0.6, -0.64), irradiance: dvec3(3.0, 2.0, 1.0) };
    let sky = Sh::constant(DVec3::splat(0.2), 4).unwrap();
    let both = lamp.to_sh(4).unwrap().plus(&sky).unwrap();
    let found = both.dominant_light().unwrap();
    assert!(
        found.direction.distance(lamp.direction) < 1e-14
            && found.irradiance.distance(lamp.irradiance) < 1e-13
    );
    // Bands 3 and 4 show that it is a lamp: all of it is taken out, and the rest is the sky. A peak is flat: its
    // direction is known to the root of its value's error.
    let split = both.split(2).unwrap();
    assert!(facts::difference(&sky.with_order(2).unwrap(), &split.rest) < 1e-6);
    let n = dvec3(0.6, 0.0, 0.8);
    assert!((split.irradiance(n) - DVec3::splat(0.2 * PI) - lamp.irradiance(n)).length() < 1e-6);
    // A sky has none, and needs none.
    assert_eq!(sky.split(2).unwrap().light, None);
    assert!(sky.dominant_light().is_none());
}

/// High bands that look like a lamp, and none of its light below them: as much of it is taken out as leaves no direction dark.
#[test]
fn a_split_takes_no_more_than_there_is() {
    let lamp = DominantLight { direction: dvec3(0.48, 0.6, -0.64), irradiance: dvec3(3.0, 3.0, 3.0) };
    let mut coefficients = lamp.to_sh(4).unwrap().coefficients().to_vec();
    coefficients[..9].fill(DVec3::ZERO);
    coefficients[0] = DVec3::ONE;
    let sky = Sh::new(coefficients).unwrap();
    let split = sky.split(2).unwrap();
    let light = split.light.expect("some of it");
    assert!(light.irradiance.x > 0.1 && light.irradiance.x < 3.0, "{light:?}");
    // What is left is not deringed: both together are all that there was.
    let sum = split.rest.plus(&light.to_sh(2).unwrap()).unwrap();
    assert!(facts::difference(&sum, &sky.with_order(2).unwrap()) < 1e-12);
    // And it is dark somewhere: more could not be taken, up to the steps of the search.
    let least = split.rest.channel(0).convolved(&Lobe::COSINE).minimum().1;
    assert!((0.0..1e-5).contains(&least), "{least:e}");
}

#[test]
fn windows_are_their_formulas() {
    let pi = std::f64::consts::PI;
    for (window, l, strength, factor) in [
        (Window::Hanning, 1, 0.5, 0.5),
        (Window::Hanning, 2, 0.25, 0.5),
        (Window::Lanczos, 1, 0.5, 2.0 / pi),
        (Window::Lanczos, 3, 0.25, 4.0 / (3.0 * pi) * 0.5_f64.sqrt()),
        // λ = 1 and 3.
        (Window::Laplacian, 2, 0.5, 1.0 / 37.0),
        (Window::Laplacian, 1, 0.75, 1.0 / 13.0),
        (Window::Even, 5, 0.3, 0.7),
    ] {
        let found = window.factor(l, strength);
        assert!((found - factor).abs() < 1e-15, "{window:?} of band {l} at {strength}: {found}");
    }
}

/// A single lamp: order 2 is negative opposite to it.
#[test]
fn a_split_loses_less_than_a_window() {
    let lamp = DominantLight { direction: DVec3::Y, irradiance: DVec3::ONE };
    let sky = Sh::constant(DVec3::splat(0.005), 2).unwrap();
    let both = lamp.to_sh(2).unwrap().plus(&sky).unwrap();
    let truth = |n| lamp.irradiance(n) + DVec3::splat(0.005 * PI);
    assert!(both.channel(0).convolved(&Lobe::COSINE).minimum().1 < 0.0);
    let rms = |f: &dyn Fn(DVec3) -> DVec3| {
        SphereQuadrature::new(40).integrate(|n| (f(n) - truth(n)).length_squared()).sqrt()
    };
    let (deringed, split) = (both.deringed(), both.split(2).unwrap());
    let (plain, windowed) = (rms(&|n| both.irradiance(n)), rms(&|n| deringed.irradiance(n)));
    let split = rms(&|n| split.irradiance(n));
    assert!(split < plain && plain < windowed && windowed < 2.0 * plain, "{plain} {windowed} {split}");
    for window in [Window::Hanning, Window::Lanczos, Window::Laplacian, Window::Even] {
        let strength = both.strength_for(&Lobe::COSINE, window);
        let least = both.windowed(window, strength).channel(0).convolved(&Lobe::COSINE).minimum().1;
        assert!((0.0..1e-6).contains(&least), "{window:?} {strength} {least}");
    }
}

#[test]
fn half_a_sky_occludes_by_the_cosine() {
    let size = 64;
    let projector = CubeProjector::new(size, 8, Weights::Exact).unwrap();
    let map = CubeMap::from_fn(size, |d| DVec3::splat(if d.y > 0.0 { 1.0 } else { 0.0 })).unwrap();
    let visible = projector.project_plane(&map.planes()[0]).unwrap();
    assert!((visible.mean() - 0.5).abs() < 1e-6);
    for (normal, wanted) in [(DVec3::Y, 1.0), (DVec3::X, 0.5), (-DVec3::Y, 0.0), (dvec3(0.6, 0.8, 0.0), 0.9)]
    {
        assert!((visible.ambient_occlusion(normal) - wanted).abs() < 0.01, "{normal}");
    }
    let lit = visible.lit_by(&Sh::constant(dvec3(3.0, 2.0, 1.0), 2).unwrap());
    assert!((lit.irradiance(DVec3::Y) - PI * dvec3(3.0, 2.0, 1.0)).length() < 0.2);
}

#[test]
fn product_truncates_to_the_order_asked_for() {
    let [x, y] = [3, 1].map(|i| Sh::new((0..4).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).unwrap());
    let product = x.product(&y, 8).unwrap();
    // x·y: one function of band 2 alone.
    let others = product.coefficients().iter().enumerate().filter(|(i, _)| *i != 4);
    assert!(others.map(|(_, c): (usize, &f64)| c.abs()).fold(0.0, f64::max) < 1e-14);
    assert!((product.coefficient(2, -2) - (3.0 / (4.0 * PI)) / 1.092_548_430_592_079).abs() < 1e-14);
    assert!(matches!(
        Product::new(1, 2, 2).unwrap().of(&x, &y),
        Err(ShError::MixedOrders { left: 2, right: 1 })
    ));
}

#[test]
fn photographs_become_radiance() {
    let srgb = Response::srgb();
    assert_eq!(srgb.radiance(255, 1.0), 2.0);
    assert!((srgb.radiance(188, 0.0) - 0.5029).abs() < 1e-4);
    assert!((Response::gamma(2.0).unwrap().radiance(128, 0.0) - (128.0_f32 / 255.0).powi(2)).abs() < 1e-6);
    // A curve that is a square root, sampled: its inverse is the square.
    let curve: Vec<f32> = (0..=1000).map(|i| (i as f32 / 1000.0).sqrt()).collect();
    let measured = Response::from_curve(&curve).unwrap();
    assert!((0..=255).all(|v| (measured.radiance(v, 0.0) - (f32::from(v) / 255.0).powi(2)).abs() < 3e-4));
    // One that begins above black, as of a camera with a veil: brightness from 0.2 to 0.6 is radiance from 0 to 1.
    let veiled = Response::from_curve(&[0.2, 0.4, 0.6]).unwrap();
    assert!((0..=255).all(|v| (veiled.radiance(v, 0.0) - f32::from(v) / 255.0).abs() < 1e-6));
    let levels: Vec<f32> = (0..256).map(|i| i as f32 * 3.0).collect();
    assert_eq!(Response::from_levels(&levels).unwrap().radiance(7, -1.0), 10.5);

    // Four rows: those at the poles are smaller than the others.
    let pixels: Vec<[u8; 3]> = (0..32).map(|i| if i < 8 { [255, 10, 0] } else { [0; 3] }).collect();
    let (_, Clipping { over_exposed, under_exposed, .. }) =
        Panorama::from_photograph(8, 4, &pixels, &Response::linear(), 0.0).unwrap();
    assert!((over_exposed - 0.5 * (1.0 - 0.5_f64.sqrt())).abs() < 1e-12);
    assert!((over_exposed + under_exposed - 1.0).abs() < 1e-12);
    assert_eq!(srgb.linearise(&pixels, 0.0).unwrap().1.over_exposed, 0.25);
}

#[test]
fn bad_input_has_its_own_error() {
    use ShError as E;
    assert_eq!(Sh::<f64>::zero(9).unwrap_err(), E::OrderTooHigh { order: 9, limit: 8 });
    for count in [0, 2, 3, 8, 100] {
        assert_eq!(Sh::new(vec![0.0; count]).unwrap_err(), E::CoefficientCount { count });
    }
    assert_eq!(Sh::new(vec![1.0, 0.0, f64::NAN, 0.0]).unwrap_err(), E::CoefficientNotFinite { index: 2 });
    let (one, two) = (Sh::<DVec3>::zero(1).unwrap(), Sh::<DVec3>::zero(2).unwrap());
    assert_eq!(one.plus(&two).unwrap_err(), E::MixedOrders { left: 1, right: 2 });
    assert_eq!(Sh::blend([(&one, 0.5), (&two, 0.5)]).unwrap_err(), E::MixedOrders { left: 1, right: 2 });
    assert_eq!(Sh::<DVec3>::blend([]).unwrap_err(), E::NothingToBlend);
    assert_eq!(CubeMap::black(0).unwrap_err(), E::CubeSize { size: 0, limit: 8192 });
    let texels = CubeMap::from_texels(2, &[[0.0; 3]; 23]).unwrap_err();
    assert_eq!(texels, E::CubeTexelCount { size: 2, expected: 24, count: 23 });
    let projector = CubeProjector::new(4, 2, Weights::Exact).unwrap();
    let wrong = projector.project(&CubeMap::black(8).unwrap()).unwrap_err();
    assert_eq!(wrong, E::WrongCubeSize { expected: 4, size: 8 });
    let mut map = CubeMap::black(4).unwrap();
    map.planes_mut()[2][3 * 16 + 2 * 4 + 1] = f32::INFINITY;
    assert_eq!(projector.project(&map).unwrap_err(), E::TexelNotFinite { face: 3, x: 1, y: 2 });
    let pixels = Panorama::new(3, 1, &[[0.0; 3], [f32::NAN; 3], [0.0; 3]]).unwrap_err();
    assert_eq!(pixels, E::PixelNotFinite { x: 1, y: 0 });
    assert!(matches!(Panorama::new(0, 4, &[]), Err(E::PanoramaSize { .. })));
    assert_eq!(two.rotated(DQuat::from_xyzw(0.0, 0.0, 0.0, 2.0)).unwrap_err(), E::NotARotation);
    assert_eq!(Rotation::new(2, DMat3::from_diagonal(dvec3(1.0, 1.0, -1.0))).unwrap_err(), E::NotARotation);
    assert!(matches!(Lobe::phong(-1.0), Err(E::LobeShape { .. })) && Lobe::ggx(f64::NAN).is_err());
    assert!(Response::gamma(0.0).is_err() && Response::from_levels(&[0.0, 1.0]).is_err());
    assert_eq!(Response::from_curve(&[]).unwrap_err(), E::ResponseCurve { index: 0 });
    assert_eq!(Response::from_curve(&[0.5]).unwrap_err(), E::ResponseCurve { index: 1 });
    assert_eq!(Response::from_curve(&[0.0, 0.5, 0.5]).unwrap_err(), E::ResponseCurve { index: 2 });
    assert!(Response::linear().linearise(&[], f32::NAN).is_err());
}

mod regressions {
    use super::*;

    /// Constants of the matrix typed from memory were right to nine digits only.
    #[test]
    fn matrix_has_its_constants_to_all_digits() {
        let at = |i: usize, n: DVec3| {
            let c = (0..9).map(|j| DVec3::splat(if i == j { 1.0 } else { 0.0 })).collect();
            IrradianceMatrix::new(&Sh::new(c).unwrap()).at(n).x
        };
        let near = |a: f64, b: f64| (a - b).abs() < 2e-16;
        assert!(near(at(8, DVec3::X), (15.0 * PI).sqrt() / 16.0));
        assert!(near(at(3, DVec3::X), (3.0 * PI).sqrt() / 3.0));
        assert!(near(at(6, DVec3::Z), (5.0 * PI).sqrt() / 8.0));
        assert!(near(at(0, DVec3::Z), PI.sqrt() / 2.0));
    }

    /// Laplacian damping removed band 2 before band 1 and had to remove nearly all: 49 % error on a map with 1.5 %
    /// ringing.
    #[test]
    fn damping_all_bands_alike_changes_less_than_a_smooth_window() {
        let lamp = DominantLight { direction: DVec3::Y, irradiance: DVec3::ONE };
        let sh = lamp.to_sh(2).unwrap().plus(&Sh::constant(DVec3::splat(0.01), 2).unwrap()).unwrap();
        let change = |window| {
            let strength = sh.strength_for(&Lobe::COSINE, window);
            facts::difference(&sh, &sh.windowed(window, strength))
        };
        assert!(4.0 * change(Window::Even) < change(Window::Laplacian));
    }

    /// Without a linear part the secular equation has its solution at the end of the interval.
    #[test]
    fn minimum_without_a_linear_part_is_an_eigenvector() {
        for i in 4..9 {
            let c = (0..9).map(|j| if i == j { 1.0 } else { 0.0 }).collect();
            let (direction, value) = Sh::<f64>::new(c).unwrap().minimum();
            let wanted = if i == 6 { -0.315_391_565_252_52 } else { -0.546_274_215_296_039_6 };
            assert!((value - wanted).abs() < 1e-14, "{i}: {value} at {direction}");
        }
        assert_eq!(Sh::<f64>::constant(2.0, 2).unwrap().minimum().1, 2.0);
    }
}

/// Numbers from outside overflowed where they were multiplied.
#[test]
fn numbers_beyond_all_bands_and_faces_are_answered() {
    assert_eq!(coefficient_count(usize::MAX), usize::MAX);
    assert_eq!(coefficient_count(8), 81);
    for (l, m) in [(usize::MAX, 0), (0, -5), (1, 2), (2, isize::MIN)] {
        assert_eq!(pointillist_sh::coefficient_index(l, m), usize::MAX, "{l}, {m}");
    }
    assert_eq!([pointillist_sh::coefficient_index(2, -2), pointillist_sh::coefficient_index(2, 2)], [4, 8]);
    assert_eq!(CubeMap::black(2).unwrap().texel(usize::MAX, usize::MAX, usize::MAX), None);
}

#[test]
fn what_is_not_finite_can_be_told() {
    let sh = Sh::constant(1.0, 2).unwrap();
    assert!(sh.is_finite() && !sh.scaled(f64::NAN).is_finite());
}

#[test]
#[should_panic(expected = "degree 4097 is above 4096")]
fn a_rule_of_too_high_a_degree_panics_as_documented() {
    let _ = SphereQuadrature::new(SphereQuadrature::MAX_DEGREE + 1);
}
