//! `model = "opengl"`: pictures have the values of the formula, term by term.

use crate::common::square::{HEAD_LIGHT, VIEW, all, draw, folder, picture, pixels, warnings};
use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_shade::gl;

/// The three kinds of lights of the formula, each with an ambient part.
const LIGHTS: &str = r#"
[ambient]
color = [0.1, 0.2, 0.3]
[[light]]
type = "point"
position = [2, 1, 3]
intensity = [0.9, 0.5, 0.7]
attenuation = [0.5, 0.1, 0.02]
ambient = [0.2, 0.1, 0.05]
specular = [0.1, 0.8, 0.4]
[[light]]
type = "spot"
position = [-1, 0, 4]
direction = [0.3, 0, -1]
cutoff = 40
exponent = 12
intensity = [0.4, 0.8, 0.2]
attenuation = [1, 0, 0]
ambient = [0.05, 0.1, 0.2]
[[light]]
type = "directional"
direction = [-1, -2, -2]
irradiance = [0.3, 0.3, 0.6]
ambient = [0.02, 0, 0]
specular = [0.5, 0, 0.1]
"#;

fn lights() -> [gl::Light; 3] {
    let light = |color: Vec3, ambient: Vec3, placement, attenuation| gl::Light {
        ambient,
        diffuse: color,
        specular: color,
        placement,
        spot: None,
        attenuation,
    };
    let spot = gl::Spot { direction: dvec3(0.3, 0.0, -1.0), cutoff_rad: 40f64.to_radians(), exponent: 12.0 };
    let at = |x, y, z| gl::Placement::At(dvec3(x, y, z));
    let constant = [1.0, 0.0, 0.0];
    [
        gl::Light {
            specular: vec3(0.1, 0.8, 0.4),
            ..light(vec3(0.9, 0.5, 0.7), vec3(0.2, 0.1, 0.05), at(2.0, 1.0, 3.0), [0.5, 0.1, 0.02])
        },
        gl::Light {
            spot: Some(spot),
            ..light(vec3(0.4, 0.8, 0.2), vec3(0.05, 0.1, 0.2), at(-1.0, 0.0, 4.0), constant)
        },
        gl::Light {
            specular: vec3(0.5, 0.0, 0.1),
            ..light(
                vec3(0.3, 0.3, 0.6),
                vec3(0.02, 0.0, 0.0),
                gl::Placement::Towards(dvec3(1.0, 2.0, 2.0)),
                constant,
            )
        },
    ]
}

#[test]
fn every_term_is_in_the_picture() {
    let folder = folder();
    let material = "model = \"opengl\"\nambient = [0.5, 0.6, 0.7]\ndiffuse = [0.8, 0.4, 0.2]\n\
                    specular = [0.3, 0.3, 0.9]\nshininess = 6\nemission = [0.01, 0.02, 0.03]\n";
    let seen = draw(&folder, LIGHTS, material);
    let surface = gl::Material {
        ambient: vec3(0.5, 0.6, 0.7),
        diffuse: vec3(0.8, 0.4, 0.2),
        specular: vec3(0.3, 0.3, 0.9),
        shininess: 6.0,
        emission: vec3(0.01, 0.02, 0.03),
    };
    for (i, pixel) in seen.iter().enumerate() {
        let at = |k: usize| (k as f64 + 0.5) / 4.0 - 1.0;
        let point = dvec3(at(i % 8), -at(i / 8), 0.0);
        let wanted = gl::shade(&lights(), vec3(0.1, 0.2, 0.3), &surface, point, Vec3::Z, Vec3::Z);
        let error = (Vec3::from_array(*pixel) - wanted).abs().max_element();
        assert!(error < 3e-3, "{i}: {pixel:?} {wanted}");
    }
    assert_eq!(warnings(&folder, "m.toml"), "");
}

#[test]
fn highlights_have_the_specular_light_of_their_lamp_in_every_kind_of_shading() {
    let folder = folder();
    let material = "model = \"opengl\"\ndiffuse = [0.5, 0.5, 0.5]\nspecular = [1, 1, 1]\nshininess = 2\n";
    for shading in ["flat", "gouraud", "phong"] {
        let seen = |specular: &str| {
            draw(&folder, &format!("[render]\nshading = \"{shading}\"\n{HEAD_LIGHT}{specular}"), material)
        };
        // Straight from the eye both factors are 1: diffuse light of 2 · 0.5, and the highlight.
        all(&seen(""), [3.0; 3], 1e-5);
        all(&seen("specular = [0.25, 0, 7]\n"), [1.25, 1.0, 8.0], 1e-5);
    }
    // A lamp that makes nothing but highlights; its shadow is theirs, too.
    let dark = HEAD_LIGHT.replace("[2, 2, 2]", "[0, 0, 0]") + "specular = [0.5, 1, 2]\n";
    all(&draw(&folder, &dark, material), [0.5, 1.0, 2.0], 1e-5);
    assert_eq!(warnings(&folder, "m.toml"), "");
    let wall = "[[object]]\nmesh = \"square.obj\"\ntranslate = [0, 0, 5]\nscale = 3\n";
    all(&draw(&folder, &format!("{wall}{dark}"), material), [0.0; 3], 0.0);
    // Other materials have the light's own colour, and `check` says that the key does nothing.
    let matt =
        "model = \"blinn-phong\"\ndiffuse = [0.5, 0.5, 0.5]\nspecular = [0.1, 0.1, 0.1]\nshininess = 2\n";
    let (with, without) = (
        draw(&folder, &format!("{HEAD_LIGHT}specular = [9, 0, 0]\n"), matt),
        draw(&folder, HEAD_LIGHT, matt),
    );
    assert_eq!(with, without);
    draw(&folder, &format!("{HEAD_LIGHT}specular = [9, 0, 0]\n"), matt);
    assert!(warnings(&folder, "m.toml").contains("`light.0.specular` has no effect"));
}

#[test]
fn ambient_light_of_lights_passes_through_what_casts_shadows() {
    let folder = folder();
    // A wall between the lamp and the square, out of the camera's sight.
    let scene = |ambient: &str| {
        format!(
            "{VIEW}[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n\
             [[object]]\nmesh = \"square.obj\"\ntranslate = [0, 0, 5]\nscale = 3\n\
             [[light]]\ntype = \"point\"\nposition = [0, 0, 7]\nintensity = [9, 9, 9]\nattenuation = [1, 0, 0]\n{ambient}\
             [material.m]\nmodel = \"opengl\"\ndiffuse = [0.5, 0.25, 1]\n"
        )
    };
    folder.write("dark.toml", scene(""));
    all(&pixels(&folder, "dark.toml"), [0.0; 3], 0.0);
    // By the diffuse colour, unless there is one of its own.
    folder.write("dim.toml", scene("ambient = [0.4, 0.4, 0.4]\n"));
    all(&pixels(&folder, "dim.toml"), [0.2, 0.1, 0.4], 1e-6);
}

#[test]
fn textures_multiply_diffuse_and_ambient_colours() {
    let folder = folder();
    picture(&folder, "grey.png", 2, 2, |_, _| [51; 3]);
    let material = "model = \"opengl\"\ndiffuse = [1, 1, 1]\nambient = 0.5\ndiffuse_map = \"grey.png\"\ncolor_space = \"linear\"\n";
    let lights = format!("[ambient]\ncolor = [1, 1, 1]\n{HEAD_LIGHT}");
    // 0.2 of the light of 2, and 0.2 of half the ambient light.
    all(&draw(&folder, &lights, material), [0.4 + 0.1; 3], 1e-6);
}

#[test]
fn lights_with_an_area_are_summed_up_over_it() {
    let folder = folder();
    let light = "[[light]]\ntype = \"rect\"\nposition = [-1, -1, 3]\nedge_u = [0, 2, 0]\nedge_v = [2, 0, 0]\nradiance = [1, 1, 1]\n";
    let matt = draw(&folder, light, "diffuse = [0.9, 0.6, 0.3]\n");
    let opengl = draw(&folder, light, "model = \"opengl\"\ndiffuse = [0.9, 0.6, 0.3]\n");
    for (matt, opengl) in matt.iter().zip(opengl) {
        let ratio = opengl[0] / matt[0];
        assert!((ratio - std::f32::consts::PI).abs() < 1e-4, "{ratio}");
    }
    // A highlight of exponent 0 is as bright everywhere: irradiance before the cosine.
    let shiny =
        draw(&folder, light, "model = \"opengl\"\ndiffuse = [0, 0, 0]\nspecular = [1, 1, 1]\n")[27][0];
    let samples = (0..400).map(|i| {
        let at = |k: i32| (f64::from(k) + 0.5) / 10.0 - 1.0;
        let d = dvec3(at(i % 20), at(i / 20), 3.0) - dvec3(-0.125, 0.125, 0.0);
        0.01 * (3.0 / d.length()) / d.length_squared()
    });
    let wanted = samples.sum::<f64>() as f32;
    assert!((shiny - wanted).abs() < 1e-3, "{shiny} {wanted}");
}

#[test]
fn phongs_highlight_is_about_the_mirrored_light() {
    let folder = folder();
    let light = HEAD_LIGHT.replace("[0, 0, -1]", "[-0.6, 0, -0.8]");
    let seen = |highlight: &str| {
        let material = "model = \"opengl\"\ndiffuse = [0, 0, 0]\nspecular = [1, 1, 1]\nshininess = 3\n";
        draw(&folder, &light, &format!("{material}{highlight}"))
    };
    let to_light = DVec3::new(0.6, 0.0, 0.8).as_vec3();
    let half = (to_light + Vec3::Z).normalize().z;
    all(&seen(""), [2.0 * half.powi(3); 3], 1e-5);
    assert_eq!(seen("highlight = \"blinn\"\n"), seen(""));
    all(&seen("highlight = \"phong\"\n"), [2.0 * 0.8f32.powi(3); 3], 1e-5);
}

#[test]
fn keys_of_the_formula_are_refused_elsewhere() {
    let folder = folder();
    let refused = |material: &str, pieces: &[&str]| {
        let object = "[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n";
        folder.write("m.toml", format!("{VIEW}{object}[material.m]\n{material}\n"));
        folder.fails(&["check", "m.toml"], 3, pieces);
    };
    refused("ambient = [1, 1, 1]", &["`material.m.ambient` does nothing here", "opengl"]);
    refused("highlight = \"phong\"", &["`material.m.highlight` does nothing here", "opengl"]);
    refused("model = \"opengl\"\nroughness = 0.5", &["`material.m.roughness` does nothing here"]);
    refused("model = \"opengl\"\nambient = -1", &["`material.m.ambient` is -1", "0 or more"]);
    let lamp =
        "type = \"line\"\nfrom = [0, 0, 1]\nto = [1, 0, 1]\nradiance = [1, 1, 1]\nambient = [1, 1, 1]\n";
    refused(&format!("[[light]]\n{lamp}"), &["unknown key `light[0].ambient`"]);
    refused(
        &format!("[[light]]\n{}", lamp.replace("ambient", "specular")),
        &["unknown key `light[0].specular`"],
    );
    let spot = "type = \"spot\"\nposition = [0, 0, 1]\ndirection = [0, 0, -1]\nintensity = [1, 1, 1]\ncutoff = 30\nexponent = -2\n";
    refused(&format!("[[light]]\n{spot}"), &["`light[0].exponent` is -2", "0 or more"]);
    draw(&folder, &format!("{HEAD_LIGHT}ambient = [1, 1, 1]\n"), "diffuse = [1, 1, 1]\n");
    assert!(warnings(&folder, "m.toml").contains("`light.0.ambient` has no effect"));
}
