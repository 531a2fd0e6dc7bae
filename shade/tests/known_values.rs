//! Numbers that can be checked by hand.

use glam::{DVec2, DVec3, Vec3, dvec2, dvec3, vec3};
use pointillist_shade::{
    Falloff, Light, Material, Model, ShadeError, Weighting, Wrap, gl, interpolate_color, interpolate_normal,
    nearest, turn_to, vertex_normals,
};
use std::f64::consts::{FRAC_PI_2, PI};

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).abs().max_element() < 1e-5
}

#[test]
fn point_light_falls_with_the_square() {
    let light = Light::Point {
        position: dvec3(0.0, 2.0, 0.0),
        intensity: vec3(8.0, 4.0, 0.0),
        falloff: Falloff::InverseSquare,
    };
    let incident = light.illuminate(0, DVec3::ZERO);
    assert!(close(incident.irradiance, vec3(2.0, 1.0, 0.0)));
    // 60° away from the normal: half of it, over π.
    let normal = vec3(0.75f32.sqrt(), 0.5, 0.0);
    let radiance = Material::lambert(Vec3::ONE).reflect(&incident, normal, normal);
    assert!(close(radiance, incident.irradiance * 0.5 / PI as f32));
}

#[test]
fn polynomial_attenuation_replaces_the_square() {
    let light = Light::Point {
        position: dvec3(0.0, 2.0, 0.0),
        intensity: Vec3::splat(14.0),
        falloff: Falloff::Polynomial([1.0, 1.0, 1.0]),
    };
    assert!(close(light.illuminate(0, DVec3::ZERO).irradiance, Vec3::splat(2.0)));
}

#[test]
fn a_far_scene_is_lit_like_a_near_one() {
    let offset = dvec3(1e6, -1e6, 1e6);
    let light = |at: DVec3| Light::Point {
        position: at + dvec3(0.25, 1.0, -0.5),
        intensity: Vec3::ONE,
        falloff: Falloff::InverseSquare,
    };
    let near = light(DVec3::ZERO).illuminate(0, DVec3::ZERO);
    let far = light(offset).illuminate(0, offset);
    assert_eq!((near.irradiance, near.to_light), (far.irradiance, far.to_light));
}

#[test]
fn a_lamp_on_the_surface_lights_nothing() {
    let light = Light::Point { position: DVec3::X, intensity: Vec3::ONE, falloff: Falloff::InverseSquare };
    assert!(light.illuminate(0, DVec3::X).is_dark());
}

#[test]
fn spot_falls_linearly_in_the_angle() {
    let spot = Light::Spot {
        position: DVec3::ZERO,
        direction: dvec3(0.0, -3.0, 0.0),
        intensity: Vec3::ONE,
        beam_rad: 10f64.to_radians(),
        cutoff_rad: 20f64.to_radians(),
        exponent: 0.0,
        falloff: Falloff::Polynomial([1.0, 0.0, 0.0]),
    };
    for (degrees, wanted) in [(0.0, 1.0), (9.99, 1.0), (12.5, 0.75), (15.0, 0.5), (20.0, 0.0), (120.0, 0.0)] {
        let angle = f64::to_radians(degrees);
        let got = spot.illuminate(0, dvec3(angle.sin(), -angle.cos(), 0.0)).irradiance.x;
        assert!((got - wanted).abs() < 1e-5, "{degrees}°: {got}");
    }
}

#[test]
fn directional_light_has_no_distance() {
    let sun = Light::Directional { direction: dvec3(0.0, -5.0, 0.0), irradiance: Vec3::splat(3.0) };
    for at in [DVec3::ZERO, dvec3(1e9, 1e9, 1e9)] {
        let incident = sun.illuminate(0, at);
        assert_eq!((incident.irradiance, incident.to_light), (Vec3::splat(3.0), Vec3::Y));
    }
}

const WHITE: gl::Material = gl::Material {
    ambient: Vec3::splat(0.2),
    diffuse: Vec3::splat(0.5),
    specular: Vec3::splat(0.25),
    shininess: 2.0,
    emission: Vec3::ZERO,
};

const LAMP: gl::Light = gl::Light {
    ambient: Vec3::splat(0.5),
    diffuse: Vec3::ONE,
    specular: Vec3::ONE,
    placement: gl::Placement::At(DVec3::new(0.0, 2.0, 0.0)),
    spot: None,
    attenuation: [1.0, 0.5, 0.0],
};

#[test]
fn opengl_formula_has_its_known_value() {
    // Attenuation 1 / (1 + 0.5·2) = 1/2; ambient 0.1, diffuse 0.5; half vector at 30°: cos² = 0.75 times 0.25.
    let to_eye = vec3(0.75f32.sqrt(), 0.5, 0.0);
    let got = gl::contribution(&LAMP, &WHITE, DVec3::ZERO, Vec3::Y, to_eye);
    assert!(close(got, Vec3::splat(0.5 * (0.1 + 0.5 + 0.75 * 0.25))), "{got}");
}

#[test]
fn opengl_light_from_behind_is_ambient_only() {
    let got = gl::contribution(&LAMP, &WHITE, DVec3::ZERO, -Vec3::Y, -Vec3::Y);
    assert!(close(got, Vec3::splat(0.5 * 0.1)), "{got}");
}

#[test]
fn opengl_spot_is_a_power_of_the_cosine() {
    let spot = gl::Spot { direction: -DVec3::Y, cutoff_rad: FRAC_PI_2 / 2.0, exponent: 4.0 };
    let light = gl::Light { spot: Some(spot), attenuation: [1.0, 0.0, 0.0], ..LAMP };
    // 30° off the axis: cos⁴ = 9/16.
    let at = dvec3(2.0 * (PI / 6.0).tan(), 0.0, 0.0);
    let flat = gl::Material { diffuse: Vec3::ZERO, specular: Vec3::ZERO, ..WHITE };
    assert!(close(gl::contribution(&light, &flat, at, Vec3::Y, Vec3::Y), Vec3::splat(0.1 * 9.0 / 16.0)));
    let outside = dvec3(2.1, 0.0, 0.0);
    assert_eq!(gl::contribution(&light, &flat, outside, Vec3::Y, Vec3::Y), Vec3::ZERO);
}

#[test]
fn opengl_attenuates_with_all_three_terms() {
    // At distance 2: 1 / (0.5 + 0.25·2 + 0.75·4) = 1/4, on ambient, diffuse and specular alike.
    let light = gl::Light { attenuation: [0.5, 0.25, 0.75], ..LAMP };
    let got = gl::contribution(&light, &WHITE, DVec3::ZERO, Vec3::Y, Vec3::Y);
    assert!(close(got, Vec3::splat(0.25 * (0.1 + 0.5 + 0.25))), "{got}");
}

#[test]
fn opengl_light_at_infinity_is_not_attenuated() {
    // From 60° off the normal: diffuse 0.5 · 0.5; half vector between 60° and 0° is 30° off: cos² = 0.75.
    let towards = dvec3(3.0 * 0.75f64.sqrt(), 1.5, 0.0);
    let light = gl::Light { placement: gl::Placement::Towards(towards), ..LAMP };
    let got = gl::contribution(&light, &WHITE, dvec3(7.0, -3.0, 1.0), Vec3::Y, Vec3::Y);
    assert!(close(got, Vec3::splat(0.1 + 0.25 + 0.25 * 0.75)), "{got}");
}

#[test]
fn opengl_global_ambient_and_emission_come_once() {
    let material = gl::Material { emission: vec3(0.3, 0.0, 0.1), ..WHITE };
    let got = gl::shade(&[], vec3(0.5, 1.0, 0.0), &material, DVec3::ZERO, Vec3::Y, Vec3::Y);
    assert!(close(got, vec3(0.3 + 0.1, 0.2, 0.1)), "{got}");
}

#[test]
fn opengl_local_viewer_moves_the_highlight() {
    // Above a point one to the right, the eye two above the origin: towards it is (−1, 2)/√5; with a viewer at infinity (0, 1).
    let at = dvec3(1.0, 0.0, 0.0);
    let shiny = gl::Material { ambient: Vec3::ZERO, diffuse: Vec3::ZERO, ..WHITE };
    let light = gl::Light { placement: gl::Placement::Towards(DVec3::Y), ..LAMP };
    let local = (dvec3(0.0, 2.0, 0.0) - at).normalize().as_vec3();
    // Half way between the normal and a direction at angle a with cos a = 2/√5: cos² (a/2) = (1 + cos a)/2.
    let wanted = 0.25 * 0.5 * (1.0 + 2.0 / 5f32.sqrt());
    let got = gl::contribution(&light, &shiny, at, Vec3::Y, local);
    assert!(close(got, Vec3::splat(wanted)), "{got}");
    let infinite = gl::contribution(&light, &shiny, at, Vec3::Y, Vec3::Y);
    assert!(close(infinite, Vec3::splat(0.25)), "{infinite}");
}

#[test]
fn opengl_cutoff_of_180_degrees_is_no_cone() {
    let spot = gl::Spot { direction: DVec3::Y, cutoff_rad: PI, exponent: 8.0 };
    let light = gl::Light { spot: Some(spot), ..LAMP };
    let plain = gl::contribution(&LAMP, &WHITE, DVec3::ZERO, Vec3::Y, Vec3::Y);
    assert_eq!(gl::contribution(&light, &WHITE, DVec3::ZERO, Vec3::Y, Vec3::Y), plain);
}

#[test]
fn opengl_sum_is_clamped_only_for_display() {
    let material = gl::Material { emission: Vec3::splat(3.0), ..WHITE };
    let sum = gl::shade(&[LAMP, LAMP], Vec3::ONE, &material, DVec3::ZERO, Vec3::Y, Vec3::Y);
    assert!(sum.x > 3.0);
    assert_eq!(gl::display(sum), Vec3::ONE);
}

#[test]
fn area_weights_keep_slivers_quiet() {
    // A large face up and a small one to the side share the vertex at the origin.
    let positions = [
        DVec3::ZERO,
        dvec3(0.0, 0.0, 2.0),
        dvec3(2.0, 0.0, 0.0),
        dvec3(0.0, 0.02, 0.0),
        dvec3(0.0, 0.0, 0.02),
    ];
    let triangles = [[0, 1, 2], [0, 3, 4]];
    let area = vertex_normals(&positions, &triangles, Weighting::Area).unwrap()[0];
    let plain = vertex_normals(&positions, &triangles, Weighting::Plain).unwrap()[0];
    assert!(area.y > 0.9999, "{area}");
    // Both have a right angle there.
    let angle = vertex_normals(&positions, &triangles, Weighting::Angle).unwrap()[0];
    assert!(close(angle, plain), "{angle}");
    assert!(close(plain, vec3(0.5f32.sqrt(), 0.5f32.sqrt(), 0.0)), "{plain}");
}

#[test]
fn wrong_meshes_are_named() {
    let error = vertex_normals(&[DVec3::ZERO], &[[0, 0, 1]], Weighting::Area).unwrap_err();
    assert_eq!(error, ShadeError::VertexOutOfRange { triangle: 0, vertex: 1, count: 1 });
    let error = vertex_normals(&[DVec3::NAN], &[], Weighting::Area).unwrap_err();
    assert!(matches!(error, ShadeError::VertexNotFinite { index: 0, .. }), "{error:?}");
}

#[test]
fn a_vertex_without_faces_has_no_normal() {
    assert_eq!(vertex_normals(&[DVec3::ONE], &[], Weighting::Area).unwrap(), [Vec3::ZERO]);
}

#[test]
fn normals_that_cancel_fall_back_to_the_face() {
    let n = interpolate_normal([Vec3::X, -Vec3::X, Vec3::X], vec3(0.25, 0.5, 0.25), Vec3::Y, Vec3::Y);
    assert_eq!(n, Vec3::Y);
}

#[test]
fn a_back_face_is_turned_to_the_eye() {
    let eye = vec3(0.0, 0.6, 0.8);
    let face = turn_to(-Vec3::Y, eye);
    assert_eq!(face, Vec3::Y);
    // The vertex normals still point down, with the front.
    assert_eq!(interpolate_normal([-Vec3::Y; 3], Vec3::splat(1.0 / 3.0), face, eye), Vec3::Y);
}

#[test]
fn gouraud_mixes_colors() {
    let mixed = interpolate_color([Vec3::X, Vec3::Y, Vec3::Z], vec3(0.5, 0.25, 0.25));
    assert_eq!(mixed, vec3(0.5, 0.25, 0.25));
}

#[test]
fn wrap_modes_at_the_borders() {
    let row = |wrap: Wrap| -> Vec<u32> { (-4..8).map(|i| wrap.texel(i, 4)).collect() };
    assert_eq!(row(Wrap::Repeat), [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]);
    assert_eq!(row(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3]);
    assert_eq!(row(Wrap::Mirror), [3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0]);
}

#[test]
fn v_runs_upward_and_row_zero_is_the_top() {
    let texels = ["top left", "top right", "bottom left", "bottom right"];
    let at = |u: f64, v: f64| nearest(&texels, 2, 2, Wrap::Repeat, dvec2(u, v)).unwrap();
    assert_eq!(at(0.25, 0.75), "top left");
    assert_eq!(at(0.75, 0.25), "bottom right");
    // On the borders: the right and lower texel; u = 1 is u = 0 again, and so is v = 0 as v = 1.
    assert_eq!(at(0.5, 0.5), "bottom right");
    assert_eq!(at(1.0, 1.0), "top left");
    assert_eq!(at(0.0, 0.0), "top left");
    assert_eq!(at(f64::NAN, f64::NAN), "top left");
}

#[test]
fn a_texture_of_the_wrong_size_is_refused() {
    let error = nearest(&[0u8; 3], 2, 2, Wrap::Clamp, DVec2::ZERO).unwrap_err();
    assert_eq!(error, ShadeError::TextureSize { len: 3, width: 2, height: 2 });
    assert!(nearest::<u8>(&[], 0, 0, Wrap::Clamp, DVec2::ZERO).is_err());
}

/// The number of texels overflowed, and an angle that is no number made every edge a crease.
#[test]
fn sizes_and_angles_that_cannot_be_are_refused() {
    let texels = pointillist_shade::CubeMap::new(u32::MAX, &[]);
    assert!(matches!(texels, Err(ShadeError::TextureSize { len: 0, width: u32::MAX, .. })), "{texels:?}");
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let creased = |angle| pointillist_shade::corner_normals(&corners, &[[0, 1, 2]], Weighting::Area, angle);
    assert!(matches!(creased(f64::NAN), Err(ShadeError::BadCrease { .. })));
    assert!(creased(-1.0).is_ok() && creased(f64::INFINITY).is_ok());
}

/// Directions whose squared length overflows or underflows gave no light.
#[test]
fn opengl_lights_may_be_any_distance_away() {
    use pointillist_shade::gl;
    let material = gl::Material {
        ambient: Vec3::ZERO,
        diffuse: Vec3::ONE,
        specular: Vec3::ZERO,
        shininess: 1.0,
        emission: Vec3::ZERO,
    };
    let shaded = |placement, spot| {
        let (ambient, attenuation) = (Vec3::ZERO, [1.0, 0.0, 0.0]);
        let light =
            gl::Light { ambient, diffuse: Vec3::ONE, specular: Vec3::ONE, placement, spot, attenuation };
        gl::contribution(&light, &material, DVec3::ZERO, Vec3::Y, Vec3::Y)
    };
    for far in [1e-200, 1.0, 1e200] {
        assert_eq!(shaded(gl::Placement::Towards(DVec3::Y * far), None), Vec3::ONE, "{far:e}");
        let spot = gl::Spot { direction: DVec3::NEG_Y * far, cutoff_rad: 0.5, exponent: 1.0 };
        assert_eq!(shaded(gl::Placement::At(DVec3::Y * far), Some(spot)), Vec3::ONE, "{far:e}");
    }
}

#[test]
fn highlights_widen_by_the_variance_of_slopes() {
    // α² = 0.5⁴ = 1/16; 2/(6 + 2) = 1/4; 2/(4 · 1.5 + 2) = 1/4.
    let rough = Material::ggx(Vec3::ZERO, Vec3::ONE, 0.5).widened(3.0 / 16.0);
    assert!((rough.roughness - 0.5f32.sqrt()).abs() < 1e-6, "{rough:?}");
    let shiny = |model, m| Material::lambert(Vec3::ZERO).with_specular(model, Vec3::ONE, m);
    let blinn = shiny(Model::NormalizedBlinnPhong, 6.0).widened(0.25);
    assert!((blinn.shininess - 2.0).abs() < 1e-5 && blinn.specular == Vec3::ONE, "{blinn:?}");
    let phong = shiny(Model::NormalizedPhong, 1.5).widened(0.25);
    assert!((phong.shininess - 0.5).abs() < 1e-5, "{phong:?}");
    // What the plain lobe reflects in sum stays: (m + 2) times the specular albedo.
    let plain = shiny(Model::Phong, 1.5).widened(0.25);
    assert!((plain.specular.x * 3.5 - 2.5).abs() < 1e-5, "{plain:?}");
}

#[test]
fn no_variance_widens_nothing() {
    for variance in [0.0, -1.0, f32::NAN] {
        let metal = Material::ggx(Vec3::ZERO, Vec3::ONE, 0.01);
        assert_eq!(metal.widened(variance), metal);
    }
    let matt = Material::lambert(Vec3::ONE);
    assert_eq!(matt.widened(1.0), matt);
    assert_eq!(Material::ggx(Vec3::ZERO, Vec3::ONE, 0.5).widened(f32::INFINITY).roughness, 1.0);
}

#[test]
fn a_material_of_opengls_formula_has_the_values_of_the_formula() {
    let spot = gl::Spot { direction: dvec3(0.3, -1.0, 0.1), cutoff_rad: 1.0, exponent: 3.0 };
    let attenuation = [0.5, 0.25, 0.125];
    let lamp = gl::Light { ambient: Vec3::ZERO, spot: Some(spot), attenuation, ..LAMP };
    let lamp = gl::Light { diffuse: vec3(0.9, 0.6, 0.3), specular: vec3(0.9, 0.6, 0.3), ..lamp };
    let gl::Placement::At(position) = lamp.placement else { panic!("a lamp in a place") };
    let same = Light::Spot {
        position,
        direction: spot.direction,
        intensity: lamp.diffuse,
        beam_rad: spot.cutoff_rad,
        cutoff_rad: spot.cutoff_rad,
        exponent: 3.0,
        falloff: Falloff::Polynomial(attenuation),
    };
    let material = gl::Material { ambient: Vec3::ZERO, emission: Vec3::ZERO, ..WHITE };
    let surface = Material::lambert(material.diffuse).with_specular(
        Model::OpenGl,
        material.specular,
        material.shininess,
    );
    for (x, z) in [(0.0, 0.0), (0.4, -0.2), (-0.7, 0.3), (3.0, 0.0)] {
        let (point, normal) = (dvec3(x, 0.0, z), vec3(0.1, 0.9, 0.2).normalize());
        let to_eye = vec3(0.5, 0.6, -0.3).normalize();
        let wanted = gl::contribution(&lamp, &material, point, normal, to_eye);
        let got = surface.reflect(&same.illuminate(0, point), normal, to_eye);
        assert!((got - wanted).abs().max_element() < 1e-6, "{x} {z}: {got} {wanted}");
    }
    // Phong's highlight is the same where the eye is in the mirrored direction, and narrower aside.
    let phong = surface.with_specular(Model::OpenGlPhong, surface.specular, surface.shininess);
    let light = same.illuminate(0, DVec3::ZERO);
    let mirrored = vec3(-light.to_light.x, light.to_light.y, -light.to_light.z);
    let at = |material: &Material, to_eye: Vec3| material.reflect(&light, Vec3::Y, to_eye);
    assert!((at(&phong, mirrored) - at(&surface, mirrored)).length() < 1e-5);
    let aside = (mirrored + vec3(0.4, 0.0, 0.0)).normalize();
    assert!(at(&phong, aside).x < at(&surface, aside).x);
    // The BRDF is what is reflected of irradiance 1, by the cosine.
    let brdf = surface.brdf(Vec3::Y, light.to_light, mirrored) * light.irradiance * light.to_light.y;
    assert!((brdf - at(&surface, mirrored)).length() < 1e-5);
}
