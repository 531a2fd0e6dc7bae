//! Texture coordinates, bumps, creases and maps of the surroundings.

use glam::{DVec2, DVec3, Vec2, Vec3, dvec2, dvec3, vec3};
use pointillist_shade::{
    AutoUv, CubeMap, Environment, Equirectangular, ShadeError, UvFrame, Weighting, corner_normals,
    cube_direction, equirectangular_direction, equirectangular_uv, keep_visible, mirror, refract,
    slope_of_heights, vertex_normals,
};
use proptest::prelude::*;

fn direction() -> impl Strategy<Value = DVec3> {
    [-1.0f64..1.0, -1.0..1.0, -1.0..1.0]
        .prop_map(DVec3::from_array)
        .prop_filter("a direction", |d| d.length() > 1e-3)
        .prop_map(|d| d.normalize())
}

/// The ground from the origin along x and −z, with u along x and v along −z.
const GROUND: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::NEG_Z];
const UV: [DVec2; 3] = [DVec2::ZERO, DVec2::X, DVec2::Y];

#[test]
fn a_slope_tilts_the_normal_by_its_angle() {
    let frame = UvFrame::new(GROUND, UV).unwrap();
    // Rising by 1 for each unit along u: the normal leans back by 45°.
    let n = frame.bumped(Vec3::Y, 1.0, Vec2::X);
    assert!((n - vec3(-1.0, 1.0, 0.0).normalize()).length() < 1e-6, "{n}");
    // Seen from below the hill is a hollow: the same plane.
    assert!((frame.bumped(-Vec3::Y, -1.0, Vec2::X) + n).length() < 1e-6);
    // A texture twice as large has half the slope for the same heights.
    let large = UvFrame::new(GROUND.map(|p| 2.0 * p), UV).unwrap();
    let n = large.bumped(Vec3::Y, 1.0, Vec2::X);
    assert!((n - vec3(-0.5, 1.0, 0.0).normalize()).length() < 1e-6, "{n}");
    assert!((large.span - 2.0).abs() < 1e-6);
}

#[test]
fn a_slope_of_a_plane_wave_is_its_derivative() {
    // h = sin(2π u) on 256 columns: the central difference is off by (2π/256)²/6.
    let height = |x: i64, _: i64| ((x as f32 + 0.5) / 256.0 * std::f32::consts::TAU).sin();
    for x in [0, 17, 100, 255] {
        let slope = slope_of_heights([256, 4], x, 1, height);
        let wanted = std::f32::consts::TAU * ((x as f32 + 0.5) / 256.0 * std::f32::consts::TAU).cos();
        assert!((slope.x - wanted).abs() < 2e-3 && slope.y == 0.0, "{slope} {wanted}");
    }
    // Row 0 is the top: heights that grow with the row fall with v.
    assert_eq!(slope_of_heights([4, 8], 0, 3, |_, y| y as f32).y, -8.0);
}

#[test]
fn a_mirrored_texture_bumps_the_same_way() {
    let mirrored = UvFrame::new(GROUND, UV.map(|uv| dvec2(-uv.x, uv.y))).unwrap();
    assert_eq!(mirrored.handedness, -1.0);
    // Rising with growing u is rising with falling x.
    let n = mirrored.bumped(Vec3::Y, 1.0, Vec2::X);
    assert!((n - vec3(1.0, 1.0, 0.0).normalize()).length() < 1e-6, "{n}");
    // In a normal map, x is along u and y along v, whichever way they lie.
    let n = mirrored.mapped(Vec3::Y, 1.0, vec3(0.6, 0.0, 0.8));
    assert!((n - vec3(-0.6, 0.8, 0.0)).length() < 1e-6, "{n}");
    let n = mirrored.mapped(Vec3::Y, 1.0, vec3(0.0, 0.6, 0.8));
    assert!((n - vec3(0.0, 0.8, -0.6)).length() < 1e-6, "{n}");
}

#[test]
fn normal_maps_lean_along_u_and_v() {
    let frame = UvFrame::new(GROUND, UV).unwrap();
    let n = frame.mapped(Vec3::Y, 1.0, vec3(0.6, 0.0, 0.8));
    assert!((n - vec3(0.6, 0.8, 0.0)).length() < 1e-6, "{n}");
    let n = frame.mapped(Vec3::Y, 1.0, vec3(0.0, 0.6, 0.8));
    assert!((n - vec3(0.0, 0.8, -0.6)).length() < 1e-6, "{n}");
    // A bump and the normal map made of it agree.
    let slope = Vec2::new(0.7, -0.3);
    let bumped = frame.bumped(Vec3::Y, 1.0, slope);
    let mapped = frame.mapped(Vec3::Y, 1.0, vec3(-slope.x, -slope.y, 1.0));
    assert!((bumped - mapped).length() < 1e-6, "{bumped} {mapped}");
}

#[test]
fn textures_without_directions_have_no_frame() {
    assert!(UvFrame::new(GROUND, [DVec2::ONE; 3]).is_none());
    assert!(UvFrame::new([DVec3::X; 3], UV).is_none());
    assert!(UvFrame::new(GROUND, [DVec2::ZERO, DVec2::X, 2.0 * DVec2::X]).is_none());
}

/// Two squares that meet along the z axis at a right angle.
fn roof() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let positions =
        vec![DVec3::ZERO, DVec3::Z, DVec3::X, dvec3(1.0, 0.0, 1.0), DVec3::NEG_Y, dvec3(0.0, -1.0, 1.0)];
    (positions, vec![[0, 1, 3], [0, 3, 2], [0, 4, 5], [0, 5, 1]])
}

#[test]
fn a_crease_splits_normals_and_a_fold_below_it_does_not() {
    let (positions, triangles) = roof();
    let sharp = corner_normals(&positions, &triangles, Weighting::Area, 1.0).unwrap();
    let normal =
        |c: &pointillist_shade::CornerNormals, t: usize, k: usize| c.normals[c.normal_of[t][k] as usize];
    assert_eq!(normal(&sharp, 0, 0), Vec3::Y);
    assert_eq!(normal(&sharp, 2, 0), -Vec3::X);
    let smooth = corner_normals(&positions, &triangles, Weighting::Area, 1.6).unwrap();
    let both = (Vec3::Y - Vec3::X).normalize();
    assert!((normal(&smooth, 0, 0) - both).length() < 1e-6);
    assert_eq!(normal(&smooth, 0, 0), normal(&smooth, 2, 0));
    // Away from the edge nothing is shared.
    assert_eq!(normal(&smooth, 1, 2), Vec3::Y);
}

#[test]
fn without_creases_corners_have_their_vertex_normal() {
    let (positions, triangles) = roof();
    for weighting in [Weighting::Area, Weighting::Angle, Weighting::Plain] {
        let corners = corner_normals(&positions, &triangles, weighting, std::f64::consts::PI).unwrap();
        let vertices = vertex_normals(&positions, &triangles, weighting).unwrap();
        for (triangle, normals) in triangles.iter().zip(&corners.normal_of) {
            for (&v, &n) in triangle.iter().zip(normals) {
                assert_eq!(vertices[v as usize], corners.normals[n as usize]);
            }
        }
    }
}

#[test]
fn angles_do_not_see_how_a_square_is_cut() {
    // The corner of a cube, one face cut through the corner and two not: angle weights give the diagonal.
    let p = |x, y, z| dvec3(f64::from(x), f64::from(y), f64::from(z));
    let positions = [p(0, 0, 0), p(1, 0, 0), p(1, 1, 0), p(0, 1, 0), p(0, 0, 1), p(1, 0, 1), p(0, 1, 1)];
    let triangles = [[0, 3, 2], [0, 2, 1], [0, 4, 3], [3, 4, 6], [0, 1, 4], [1, 5, 4]];
    let n = vertex_normals(&positions, &triangles, Weighting::Angle).unwrap()[0];
    assert!((n + Vec3::ONE.normalize()).length() < 1e-6, "{n}");
}

#[test]
fn automatic_coordinates_lie_as_documented() {
    let (low, high) = (dvec3(-1.0, 0.0, -2.0), dvec3(1.0, 4.0, 2.0));
    let at = |kind: AutoUv, p: DVec3, normal: DVec3| kind.corners(low, high, [p; 3], normal)[0];
    let close = |a: DVec2, u: f64, v: f64| assert!((a - dvec2(u, v)).length() < 1e-12, "{a}");
    close(at(AutoUv::Cylindrical, dvec3(0.0, 1.0, 2.0), DVec3::Z), 0.5, 0.25);
    close(at(AutoUv::Cylindrical, dvec3(1.0, 4.0, 0.0), DVec3::X), 0.75, 1.0);
    close(at(AutoUv::Polar, dvec3(0.0, 2.0, 2.0), DVec3::Z), 0.5, 0.5);
    close(at(AutoUv::Polar, dvec3(0.0, 4.0, 0.0), DVec3::Y), 0.5, 1.0);
    close(at(AutoUv::Planar, dvec3(0.5, 1.0, 1.0), DVec3::X), 0.75, 0.25);
    close(at(AutoUv::Box, dvec3(0.5, 1.0, 2.0), DVec3::Z), 0.75, 0.25);
    close(at(AutoUv::Box, dvec3(0.5, 1.0, -2.0), -DVec3::Z), 0.25, 0.25);
    close(at(AutoUv::Box, dvec3(1.0, 1.0, 1.0), DVec3::X), 0.25, 0.25);
    close(at(AutoUv::Box, dvec3(0.5, 4.0, 1.0), DVec3::Y), 0.75, 0.25);
    // A box without extent.
    close(AutoUv::Box.corners(low, low, [low; 3], DVec3::Z)[0], 0.5, 0.5);
}

#[test]
fn box_sides_are_not_mirrored() {
    // Seen from outside, u to the right and v up: a right-handed frame with the normal.
    for n in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z] {
        let x = n.any_orthonormal_vector();
        let corners = [n, n + x, n + n.cross(x)];
        let uv = AutoUv::Box.corners(DVec3::splat(-2.0), DVec3::splat(2.0), corners, n);
        assert_eq!(UvFrame::new(corners, uv).unwrap().handedness, 1.0, "{n}");
    }
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn no_triangle_jumps_at_the_seam(d in direction(), e in direction(), f in direction(), size in 0.0f64..0.3) {
        // A small triangle on a sphere, away from the poles by more than its size.
        prop_assume!(d.x.hypot(d.z) > 0.5);
        let corners = [d, d + 0.5 * size * e, d + 0.5 * size * f];
        for kind in [AutoUv::Cylindrical, AutoUv::Polar] {
            let uv = kind.corners(-DVec3::ONE, DVec3::ONE, corners, d);
            for i in 0..3 {
                let (a, b) = (uv[i], uv[(i + 1) % 3]);
                prop_assert!((a.x - b.x).abs() < 0.3, "{} {}", a, b);
            }
        }
    }

    #[test]
    fn a_constant_height_changes_nothing(n in direction(), e in direction(), f in direction(), uv in [-9.0f64..9.0, -9.0..9.0, -9.0..9.0, -9.0..9.0], height in any::<f32>()) {
        prop_assume!(e.cross(f).length() > 1e-3 && height.is_finite());
        let n = n.as_vec3();
        if let Some(frame) = UvFrame::new([DVec3::ZERO, e, f], [DVec2::ZERO, dvec2(uv[0], uv[1]), dvec2(uv[2], uv[3])]) {
            let slope = slope_of_heights([64, 32], 5, 7, |_, _| height);
            prop_assert_eq!(frame.bumped(n, 1.0, slope), n);
            prop_assert_eq!(frame.mapped(n, -1.0, Vec3::Z), n);
            // And any slope gives a unit vector on the side of the normal.
            let tilted = frame.bumped(n, 1.0, Vec2::new(uv[0] as f32, uv[1] as f32));
            prop_assert!((tilted.length() - 1.0).abs() < 1e-4 && tilted.dot(n) >= 0.0, "{}", tilted);
        }
    }

    #[test]
    fn equirectangular_there_and_back(d in direction()) {
        let uv = equirectangular_uv(d);
        prop_assert!(uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all());
        prop_assert!((equirectangular_direction(uv) - d).length() < 1e-12);
    }

    #[test]
    fn cube_lookup_is_continuous_across_faces(d in direction(), step in direction(), size in 1u32..9, seed in any::<u32>()) {
        // Texels without any order, and a direction pushed onto the nearest edge of its face.
        let noise = |i: u32| ((i ^ seed).wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
        let texels: Vec<Vec3> = (0..6 * size * size).map(|i| Vec3::splat(noise(i))).collect();
        let map = CubeMap::new(size, &texels).unwrap();
        let a = d.abs();
        let edge = d / a.max_element();
        let second = a.to_array().into_iter().filter(|&c| c < a.max_element()).fold(0.0, f64::max) / a.max_element();
        let on_edge = DVec3::from_array(edge.to_array().map(|c| if c.abs() == second { c.signum() } else { c }));
        let h = 1e-6;
        let (one, other) = (map.sample(on_edge + h * step), map.sample(on_edge - h * step));
        // The steepest slope is one texel's difference over one texel.
        prop_assert!((one - other).abs().max_element() < 8.0 * h as f32 * size as f32 + 1e-5, "{} {}", one, other);
        prop_assert!(one.min_element() >= 0.0 && one.max_element() <= 1.0);
    }

    #[test]
    fn equirectangular_lookup_is_continuous(d in direction(), near in 0usize..3, seed in any::<u32>(), width in 1u32..9, height in 1u32..9) {
        let noise = |i: u32| ((i ^ seed).wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0;
        let texels: Vec<Vec3> = (0..width * height).map(|i| Vec3::splat(noise(i))).collect();
        let map = Equirectangular::new(&texels, width, height).unwrap();
        // On the column at ±180°, or at a pole.
        let h = 1e-7;
        let (one, other) = match near {
            0 => (dvec3(h, d.y, 1.0), dvec3(-h, d.y, 1.0)),
            1 => (dvec3(h * d.x, 1.0, h * d.z), dvec3(-h * d.z, 1.0, h * d.x)),
            _ => (dvec3(h * d.x, -1.0, h * d.z), dvec3(-h * d.z, -1.0, h * d.x)),
        };
        let (a, b) = (map.sample(one), map.sample(other));
        prop_assert!((a - b).abs().max_element() < 1e-4, "{} {}", a, b);
        prop_assert!(a.min_element() >= -1e-6 && a.max_element() <= 1.0 + 1e-6, "{}", a);
    }

    #[test]
    fn refraction_follows_snell(v in direction(), index in 0.2f32..4.0) {
        let (n, v) = (Vec3::Z, vec3(v.x as f32, v.y as f32, v.z.abs() as f32));
        let onward = refract(v, n, index);
        prop_assert!((onward.direction.length() - 1.0).abs() < 1e-5);
        prop_assert!((0.0..=1.0).contains(&onward.reflectance));
        if onward.reflectance == 1.0 {
            prop_assert!((onward.direction - mirror(v, n)).length() < 1e-5);
        } else {
            let sine = |d: Vec3| d.x.hypot(d.y);
            prop_assert!((sine(v) - index * sine(onward.direction)).abs() < 1e-4);
            prop_assert!(onward.direction.z <= 1e-6);
        }
    }

    #[test]
    fn maps_take_anything(x in any::<f64>(), y in any::<f64>(), z in any::<f64>(), roughness in any::<f32>()) {
        let map = CubeMap::from_function(4, |d| d.as_vec3().abs());
        prop_assert!(map.sample(dvec3(x, y, z)).is_finite());
        let environment = Environment::sharp(map);
        prop_assert!(environment.radiance(dvec3(x, y, z).as_vec3(), roughness).is_finite());
    }
}

#[test]
fn glass_has_its_known_reflectances() {
    // Straight on: ((1.5 − 1)/(1.5 + 1))² = 0.04, from both sides.
    for index in [1.5, 1.0 / 1.5] {
        let straight = refract(Vec3::Z, Vec3::Z, index);
        assert!((straight.reflectance - 0.04).abs() < 1e-6);
        assert!((straight.direction + Vec3::Z).length() < 1e-6);
    }
    // Beyond the critical angle of 41.8°.
    assert_eq!(refract(vec3(0.8, 0.0, 0.6), Vec3::Z, 1.0 / 1.5).reflectance, 1.0);
    // Brewster's angle, tan = 1.5: only half of the light, and of that sin²(θi − θt) with θi + θt = 90°.
    let angle = 1.5f32.atan();
    let wanted = 0.5 * (2.0 * angle - std::f32::consts::FRAC_PI_2).sin().powi(2);
    let brewster = refract(vec3(angle.sin(), 0.0, angle.cos()), Vec3::Z, 1.5).reflectance;
    assert!((brewster - wanted).abs() < 1e-5, "{brewster} {wanted}");
    // No difference in index: straight through.
    let through = refract(vec3(0.6, 0.0, 0.8), Vec3::Z, 1.0);
    assert!((through.direction - vec3(-0.6, 0.0, -0.8)).length() < 1e-6 && through.reflectance < 1e-12);
}

#[test]
fn cube_faces_look_where_they_should() {
    let map = CubeMap::from_function(8, |d| d.as_vec3());
    for (face, axis) in
        [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z].into_iter().enumerate()
    {
        assert_eq!(cube_direction(face, 0.0, 0.0), axis);
        let at = axis + dvec3(0.2, 0.3, -0.1) * (DVec3::ONE - axis.abs());
        assert!((map.sample(at) - at.normalize().as_vec3()).length() < 2e-2, "{face}");
    }
    let too_few = CubeMap::new(2, &[Vec3::ZERO; 23]).unwrap_err();
    assert!(matches!(too_few, ShadeError::TextureSize { len: 23, .. }));
    assert!(Equirectangular::new(&[Vec3::ZERO; 3], 2, 2).is_err());
}

#[test]
fn an_even_surrounding_looks_even_at_any_roughness() {
    let light = vec3(0.5, 1.0, 2.0);
    let map = Environment::sharp(CubeMap::from_function(16, |_| light)).with_rough_levels().with_irradiance();
    for roughness in [0.0, 0.07, 0.3, 0.6, 1.0, 3.0, f32::NAN] {
        let got = map.radiance(vec3(0.3, -0.5, 0.2), roughness);
        assert!((got - light).abs().max_element() < 1e-5, "{roughness}: {got}");
    }
    let irradiance = map.irradiance(vec3(0.0, 0.6, 0.8));
    assert!((irradiance - std::f32::consts::PI * light).abs().max_element() < 1e-4, "{irradiance}");
}

#[test]
fn half_a_sky_gives_half_of_it_to_the_side() {
    // White above, black below: irradiance π (1 + cos)/2 for a normal at that angle to the zenith.
    let sky = CubeMap::from_function(64, |d| if d.y > 0.0 { Vec3::ONE } else { Vec3::ZERO });
    let map = Environment::sharp(sky).with_irradiance();
    for (n, wanted) in [(Vec3::Y, 1.0), (Vec3::X, 0.5), (vec3(0.6, 0.8, 0.0), 0.9), (-Vec3::Y, 0.0)] {
        let got = map.irradiance(n).x / std::f32::consts::PI;
        assert!((got - wanted).abs() < 0.02, "{n}: {got} {wanted}");
    }
}

#[test]
fn rough_mirrors_see_the_lobe_of_their_roughness() {
    // A hemisphere of light, mirrored at its rim: half of it at any roughness; at its pole: all but the lobe's tail.
    let sky = CubeMap::from_function(64, |d| if d.x > 0.0 { Vec3::ONE } else { Vec3::ZERO });
    let map = Environment::sharp(sky).with_rough_levels();
    for roughness in [0.1, 0.3, 0.5, 0.9] {
        let rim = map.radiance(Vec3::Z, roughness).x;
        assert!((rim - 0.5).abs() < 0.03, "{roughness}: {rim}");
    }
    // The share of the lobe beyond 45°, by quadrature over angles: h at 22.5° or more, weighted by the cosine of l.
    let map_at = |roughness: f32| map.radiance(vec3(1.0, 0.0, 1.0).normalize(), roughness).x;
    assert!(map_at(0.1) > 0.999 && map_at(0.9) < 0.95 && map_at(0.9) > 0.7, "{}", map_at(0.9));
}

#[test]
fn normals_behind_the_horizon_are_brought_up_to_it() {
    let n = keep_visible(vec3(0.6, 0.0, -0.8), Vec3::Z, Vec3::Y);
    assert_eq!(n, Vec3::X);
    assert_eq!(keep_visible(-Vec3::Z, Vec3::Z, Vec3::Y), Vec3::Y);
    assert_eq!(keep_visible(Vec3::Z, Vec3::Z, Vec3::Y), Vec3::Z);
}
