//! Facts that hold for every input.

use glam::{DVec2, DVec3, Vec3, dvec3, vec3};
use pointillist_shade::{
    Falloff, Light, Material, Model, Weighting, Wrap, face_normal, gl, interpolate_normal, invariants,
    nearest, sees_light, turn_to, vertex_normals,
};
use proptest::prelude::*;
use std::f32::consts::TAU;
use std::num::NonZeroU32;

const MODELS: [Model; 6] = [
    Model::Lambert,
    Model::Phong,
    Model::NormalizedPhong,
    Model::BlinnPhong,
    Model::NormalizedBlinnPhong,
    Model::Ggx,
];

/// Any finite number, with the awkward ones more often than chance would have it.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>().prop_filter("finite", |n| n.is_finite()),
        -10.0..10.0,
        Just(0.0),
        Just(-0.0),
        Just(f64::MAX),
        Just(f64::MIN_POSITIVE),
    ]
}

fn point() -> BoxedStrategy<DVec3> {
    [number(), number(), number()].prop_map(DVec3::from_array).boxed()
}

fn color() -> impl Strategy<Value = Vec3> {
    let channel = || prop_oneof![0.0f32..10.0, Just(0.0), Just(f32::MAX)];
    [channel(), channel(), channel()].prop_map(Vec3::from_array)
}

fn unit() -> impl Strategy<Value = Vec3> {
    (-1.0f32..1.0, 0.0..TAU).prop_map(|(z, angle)| {
        let r = (1.0 - z * z).sqrt();
        vec3(r * angle.cos(), r * angle.sin(), z)
    })
}

fn falloff() -> impl Strategy<Value = Falloff> {
    let term = || any::<f32>();
    prop_oneof![Just(Falloff::InverseSquare), [term(), term(), term()].prop_map(Falloff::Polynomial)]
}

/// Boxed, because the nested types would need more stack than a test thread has.
fn light() -> BoxedStrategy<Light> {
    let directional =
        (point(), color()).prop_map(|(direction, irradiance)| Light::Directional { direction, irradiance });
    let lamp = (point(), color(), falloff()).prop_map(|(position, intensity, falloff)| Light::Point {
        position,
        intensity,
        falloff,
    });
    let spot = (point(), point(), color(), number(), number(), number(), falloff()).prop_map(
        |(position, direction, intensity, beam_rad, cutoff_rad, exponent, falloff)| Light::Spot {
            position,
            direction,
            intensity,
            beam_rad,
            cutoff_rad,
            exponent,
            falloff,
        },
    );
    let rect = (point(), point(), point(), color(), any::<u32>(), falloff()).prop_map(
        |(corner, edge_u, edge_v, radiance, samples, falloff)| Light::Rect {
            corner,
            edge_u,
            edge_v,
            radiance,
            samples: NonZeroU32::new(samples),
            falloff,
        },
    );
    prop_oneof![directional.boxed(), lamp.boxed(), spot.boxed(), rect.boxed()].boxed()
}

fn material() -> impl Strategy<Value = Material> {
    let number = || any::<f32>().prop_filter("not NaN", |m| !m.is_nan());
    (0..MODELS.len(), color(), color(), number(), any::<f32>()).prop_map(
        |(model, diffuse, specular, shininess, roughness)| {
            Material::lambert(diffuse)
                .with_specular(MODELS[model], specular, shininess)
                .with_roughness(roughness)
        },
    )
}

/// One that a scene could have: albedos up to 1.
fn real_material() -> impl Strategy<Value = Material> {
    let albedo = || [0.0f32..=1.0, 0.0f32..=1.0, 0.0f32..=1.0].prop_map(Vec3::from_array);
    (0..MODELS.len(), albedo(), albedo(), 0.0f32..1e4, 0.0f32..=1.0).prop_map(
        |(model, diffuse, specular, shininess, roughness)| {
            Material::lambert(diffuse)
                .with_specular(MODELS[model], specular, shininess)
                .with_roughness(roughness)
        },
    )
}

/// Lights of usual sizes, of which cones and areas miss a box as often as not.
fn usual_light() -> impl Strategy<Value = Light> {
    let place = || [-3.0..3.0_f64, -3.0..3.0, -3.0..3.0].prop_map(DVec3::from_array);
    let white = Vec3::ONE;
    let spot = (place(), place(), 0.0..1.2_f64, 0.0..1.7_f64, prop_oneof![Just(0.0), 0.5..9.0_f64]).prop_map(
        move |(position, direction, beam_rad, cutoff_rad, exponent)| Light::Spot {
            position,
            direction,
            intensity: white,
            beam_rad,
            cutoff_rad,
            exponent,
            falloff: Falloff::InverseSquare,
        },
    );
    let rect = (place(), place(), place()).prop_map(move |(corner, edge_u, edge_v)| Light::Rect {
        corner,
        edge_u,
        edge_v,
        radiance: white,
        samples: NonZeroU32::new(4),
        falloff: Falloff::InverseSquare,
    });
    prop_oneof![3 => spot, 1 => rect]
}

/// Dark at some places of a box that the light cannot reach.
fn unreached_is_dark(light: &Light, a: DVec3, b: DVec3, shares: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let (low, high) = (a.min(b), a.max(b));
    if light.may_reach(low, high) {
        return Ok(());
    }
    for share in shares.iter().map(|s| DVec3::from_array(*s)).chain([DVec3::ZERO, DVec3::ONE]) {
        let point = low + (high - low) * share;
        for sample in 0..light.samples().min(16) {
            let incident = light.illuminate(sample, point);
            prop_assert!(incident.is_dark(), "{point} of {low} to {high} gets {:?}", incident.irradiance);
        }
    }
    Ok(())
}

fn shares() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec([0.0..=1.0, 0.0..=1.0, 0.0..=1.0_f64], 20)
}

proptest! {
    #![proptest_config(testkit::config(2000))]
    #[test]
    fn what_a_light_cannot_reach_is_dark(
        light in usual_light(),
        at in [-3.0..3.0_f64, -3.0..3.0, -3.0..3.0],
        size in [0.0..2.0_f64, 0.0..2.0, 0.0..2.0],
        shares in shares(),
    ) {
        let (low, size) = (DVec3::from_array(at), DVec3::from_array(size));
        unreached_is_dark(&light, low, low + size, &shares)?;
    }

    #[test]
    fn what_any_light_cannot_reach_is_dark(light in light(), a in point(), b in point(), shares in shares()) {
        unreached_is_dark(&light, a, b, &shares)?;
    }
}

#[test]
fn lights_miss_what_is_not_before_them() {
    let spot = |direction: DVec3, intensity: f32| Light::Spot {
        position: DVec3::ZERO,
        direction,
        intensity: Vec3::splat(intensity),
        beam_rad: 0.2,
        cutoff_rad: 0.4,
        exponent: 0.0,
        falloff: Falloff::InverseSquare,
    };
    let boxed = (DVec3::new(-1.0, -1.0, 5.0), DVec3::new(1.0, 1.0, 6.0));
    assert!(spot(DVec3::Z, 1.0).may_reach(boxed.0, boxed.1));
    assert!(!spot(DVec3::Z, 0.0).may_reach(boxed.0, boxed.1));
    assert!(!spot(DVec3::NEG_Z, 1.0).may_reach(boxed.0, boxed.1));
    assert!(!spot(DVec3::X, 1.0).may_reach(boxed.0, boxed.1));
    assert!(spot(DVec3::NEG_Z, 1.0).may_reach(-boxed.1, boxed.1));
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn finite_input_gives_finite_light(light in light(), sample in any::<u32>(), at in point(), m in material(), n in unit(), v in unit()) {
        let incident = light.illuminate(sample, at);
        prop_assert!(incident.irradiance.is_finite(), "{incident:?}");
        prop_assert!(incident.to_light.is_finite());
        let length = incident.to_light.length();
        prop_assert!(length == 0.0 || (length - 1.0).abs() < 1e-5, "{length}");
        prop_assert!(m.reflect(&incident, n, v).is_finite());
    }

    #[test]
    fn light_and_eye_can_be_exchanged(m in real_material(), n in unit(), l in unit(), v in unit()) {
        invariants::brdf_is_reciprocal(&m, n, l, v).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn interpolated_normals_face_the_eye(a in unit(), b in unit(), c in unit(), w in [0.0f32..1.0, 0.0f32..1.0], face in unit(), eye in unit()) {
        let face = turn_to(face, eye);
        let weights = vec3(w[0] * (1.0 - w[1]), w[1] * w[0], 1.0 - w[0]);
        let n = interpolate_normal([a, b, c], weights, face, eye);
        prop_assert!((n.length() - 1.0).abs() < 1e-4);
        prop_assert!(n.dot(eye) > -1e-3, "{}", n.dot(eye));
    }

    #[test]
    fn equal_corners_are_flat_shading(n in unit(), w in [0.0f32..1.0, 0.0f32..1.0], eye in unit()) {
        let face = turn_to(n, eye);
        let weights = vec3(w[0] * (1.0 - w[1]), w[1] * w[0], 1.0 - w[0]);
        let phong = interpolate_normal([n, n, n], weights, face, eye);
        // A face seen edge-on may be tilted by rounding.
        prop_assume!(face.dot(eye) > 1e-4);
        prop_assert!((phong - face).length() < 1e-5, "{phong} {face}");
    }

    #[test]
    fn every_index_wraps_into_the_texture(i in any::<i64>(), size in any::<u32>()) {
        let i = i / 4;
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            prop_assert!(wrap.texel(i, size) < size.max(1));
        }
    }

    #[test]
    fn repeat_and_mirror_have_their_periods(i in -1000i64..1000, size in 1u32..50) {
        let n = i64::from(size);
        prop_assert_eq!(Wrap::Repeat.texel(i, size), Wrap::Repeat.texel(i + n, size));
        prop_assert_eq!(Wrap::Mirror.texel(i, size), Wrap::Mirror.texel(i + 2 * n, size));
        prop_assert_eq!(Wrap::Mirror.texel(i, size), Wrap::Mirror.texel(-1 - i, size));
    }

    #[test]
    fn any_coordinate_has_a_texel(u in any::<f64>(), v in any::<f64>(), width in 1u32..9, height in 1u32..9) {
        let texels: Vec<u32> = (0..width * height).collect();
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            prop_assert!(nearest(&texels, width, height, wrap, DVec2::new(u, v)).is_ok());
        }
    }

    #[test]
    fn vertex_normals_take_anything(positions in prop::collection::vec(point(), 0..6), triangles in prop::collection::vec([0u32..7, 0u32..7, 0u32..7], 0..6)) {
        for weighting in [Weighting::Area, Weighting::Angle, Weighting::Plain] {
            match vertex_normals(&positions, &triangles, weighting) {
                Ok(normals) => for n in normals {
                    prop_assert!(n == Vec3::ZERO || (n.length() - 1.0).abs() < 1e-5, "{n}");
                },
                Err(_) => prop_assert!(triangles.iter().flatten().any(|&v| v as usize >= positions.len())),
            }
        }
    }

    #[test]
    fn face_normals_take_anything(a in point(), b in point(), c in point()) {
        let n = face_normal(a, b, c);
        prop_assert!(n == DVec3::ZERO || (n.length() - 1.0).abs() < 1e-9, "{n}");
    }

    #[test]
    fn opengl_takes_anything(at in point(), position in point(), n in unit(), v in unit(), shininess in 0.0f32..200.0) {
        let light = gl::Light {
            ambient: Vec3::ONE, diffuse: Vec3::ONE, specular: Vec3::ONE,
            placement: gl::Placement::At(position), spot: None, attenuation: [1.0, 0.0, 0.0],
        };
        let material = gl::Material { ambient: Vec3::ONE, diffuse: Vec3::ONE, specular: Vec3::ONE, shininess, emission: Vec3::ZERO };
        prop_assert!(gl::shade(&[light], Vec3::ONE, &material, at, n, v).is_finite());
    }
}

#[test]
fn a_rectangle_far_away_is_a_point() {
    let rect = Light::Rect {
        corner: dvec3(-0.5, 100.0, -1.0),
        // u × v points down, at the receiver.
        edge_u: DVec3::X,
        edge_v: 2.0 * DVec3::Z,
        radiance: Vec3::splat(10.0),
        samples: NonZeroU32::new(16),
        falloff: Falloff::InverseSquare,
    };
    let total: f32 = (0..rect.samples()).map(|i| rect.illuminate(i, DVec3::ZERO).irradiance.x).sum();
    let wanted = 10.0 * 2.0 / 1e4;
    assert!((total / wanted - 1.0).abs() < 1e-3, "{total} {wanted}");
    let behind: f32 = (0..16).map(|i| rect.illuminate(i, dvec3(0.0, 200.0, 0.0)).irradiance.x).sum();
    assert_eq!(behind, 0.0);
}

#[test]
fn a_rectangle_near_by_converges_to_the_form_factor() {
    // Unit square one above a parallel patch below its corner: F = (2 / 2π) · (1/√2 · atan(1/√2)) for each term.
    let s = 0.5f64.sqrt();
    let factor = (2.0 * s * s.atan()) / (2.0 * std::f64::consts::PI);
    let mut before = f64::INFINITY;
    for samples in [4, 16, 64, 256] {
        let rect = Light::Rect {
            corner: dvec3(0.0, 1.0, 0.0),
            edge_u: DVec3::X,
            edge_v: DVec3::Z,
            radiance: Vec3::ONE,
            samples: NonZeroU32::new(samples),
            falloff: Falloff::InverseSquare,
        };
        let sum: f64 = (0..samples)
            .map(|i| rect.illuminate(i, DVec3::ZERO))
            .map(|incident| f64::from(incident.irradiance.x * incident.to_light.y))
            .sum();
        let error = (sum / std::f64::consts::PI - factor).abs();
        assert!(error < before, "{samples} samples: {error}");
        before = error;
    }
    assert!(before < 2e-3, "{before}");
}

#[test]
fn light_and_eye_on_two_sides_see_nothing() {
    let face = turn_to(-Vec3::Y, Vec3::Y);
    assert!(sees_light(face, vec3(0.6, 0.8, 0.0)));
    assert!(!sees_light(face, vec3(0.6, -0.8, 0.0)));
}
