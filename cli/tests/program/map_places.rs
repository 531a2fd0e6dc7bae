//! Where maps lie on surfaces, what is done to their values, and light maps.

use crate::common::Folder;
use crate::common::square::{HEAD_LIGHT, VIEW, all, draw, draw_mtl, folder, picture, warnings};

const PI: f32 = std::f32::consts::PI;

/// Red and green above, blue and white below.
fn four(folder: &Folder) {
    let color = |x, y| match (x, y) {
        (0, 0) => [255, 0, 0],
        (1, 0) => [0, 255, 0],
        (0, 1) => [0, 0, 255],
        _ => [255; 3],
    };
    picture(folder, "four.png", 2, 2, color);
}

const RED: [f32; 3] = [1.0, 0.0, 0.0];
const GREEN: [f32; 3] = [0.0, 1.0, 0.0];
const BLUE: [f32; 3] = [0.0, 0.0, 1.0];
const WHITE: [f32; 3] = [1.0; 3];

/// The corner pixels: upper left, upper right, lower left, lower right.
fn corners(pixels: &[[f32; 3]]) -> [[f32; 3]; 4] {
    [pixels[0], pixels[7], pixels[56], pixels[63]]
}

#[test]
fn maps_are_scaled_turned_and_moved() {
    let folder = folder();
    four(&folder);
    // The square glows as the map says.
    let glow = |map: &str| {
        let material = format!("diffuse = [0, 0, 0]\nemission_map = {map}\n");
        draw(&folder, "", &material)
    };
    let as_it_is = glow("\"four.png\"");
    assert_eq!(corners(&as_it_is), [RED, GREEN, BLUE, WHITE]);
    assert_eq!(glow("{ file = \"four.png\" }"), as_it_is);
    assert_eq!(glow("{ file = \"four.png\", scale = [1, 1], offset = [3, -2], rotate = 0 }"), as_it_is);
    // Coordinates from 0.5 to 1 in both: the upper right texel.
    all(&glow("{ file = \"four.png\", scale = [0.5, 0.5], offset = [0.5, 0.5] }"), GREEN, 0.0);
    // Twice in each direction: all four in each quarter, so that the quarters are equal.
    let twice = glow("{ file = \"four.png\", scale = [2, 2] }");
    assert_eq!(corners(&twice), [RED, GREEN, BLUE, WHITE]);
    assert_eq!([twice[3], twice[4], twice[24], twice[32]], [GREEN, RED, BLUE, RED]);
    // Coordinates turned counter-clockwise: the picture clockwise. (u, v) becomes (−v, u).
    assert_eq!(corners(&glow("{ file = \"four.png\", rotate = 90 }")), [BLUE, RED, WHITE, GREEN]);
}

#[test]
fn colours_and_holes_may_lie_in_different_places() {
    let folder = folder();
    four(&folder);
    picture(&folder, "left.png", 2, 1, |x, _| [255 * u8::from(x == 0); 3]);
    let lamp = "[ambient]\ncolor = [1, 1, 1]\n";
    let draw = |diffuse: &str, opacity: &str| {
        corners(&draw(&folder, lamp, &format!("diffuse_map = {diffuse}\nopacity_map = {opacity}\n")))
    };
    let (color, holes) = ("\"four.png\"", "\"left.png\"");
    assert_eq!(draw(color, holes), [RED, [0.0; 3], BLUE, [0.0; 3]]);
    let moved = "{ file = \"left.png\", offset = [0.5, 0] }";
    assert_eq!(draw(color, moved), [[0.0; 3], GREEN, [0.0; 3], WHITE]);
    let colors_moved = "{ file = \"four.png\", offset = [0.5, 0] }";
    assert_eq!(draw(colors_moved, holes), [GREEN, [0.0; 3], WHITE, [0.0; 3]]);
    assert_eq!(draw(colors_moved, moved), [[0.0; 3], RED, [0.0; 3], BLUE]);
}

#[test]
fn bumps_follow_the_place_of_their_map() {
    let folder = folder();
    // Heights rise to the right by 1 over the map.
    picture(&folder, "ramp.png", 256, 4, |x, _| [x as u8; 3]);
    let side = HEAD_LIGHT.replace("[0, 0, -1]", "[1, 0, -1]");
    let lit = |map: &str| {
        let material = format!("diffuse = [1, 1, 1]\nwrap = \"clamp\"\nbump_scale = 2\nbump_map = {map}\n");
        draw(&folder, &side, &material)[27][0]
    };
    let facing = |slope: f32| 2.0 / PI * (1.0 + slope) / (2.0 * (1.0 + slope * slope)).sqrt();
    assert!((lit("\"ramp.png\"") - facing(1.0)).abs() < 1e-2);
    assert!((lit("{ file = \"ramp.png\", scale = [0.5, 1] }") - facing(0.5)).abs() < 1e-2);
    // Turned by a right angle, heights rise along v: neither towards the light nor away.
    let along_v = 2.0 / PI / (2.0f32 * 2.0).sqrt();
    assert!((lit("{ file = \"ramp.png\", rotate = 90, offset = [1, 0] }") - along_v).abs() < 1e-2);
}

#[test]
fn values_get_a_base_and_a_gain() {
    let folder = folder();
    picture(&folder, "grey.png", 2, 2, |_, _| [51; 3]);
    let glow =
        |map: &str| draw(&folder, "", &format!("diffuse = [0, 0, 0]\ncolor_space = \"linear\"\n{map}\n"));
    all(&glow("emission_map = { file = \"grey.png\", base = 0.1, gain = 2 }"), [0.5; 3], 1e-6);
    all(&glow("emission_map = { file = \"grey.png\", gain = 10 }"), [2.0; 3], 1e-5);
    all(&glow("emission_map = { file = \"grey.png\", base = -0.5 }"), [0.0; 3], 0.0);
    let covered = glow("emission = [1, 1, 1]\nopacity_map = { file = \"grey.png\", gain = 2.5 }");
    all(&covered, [0.5; 3], 3e-3);
    // The same picture with another tone is another texture.
    let both = "emission_map = \"grey.png\"\nopacity_map = { file = \"grey.png\", gain = 9 }";
    all(&glow(both), [0.2; 3], 1e-6);
}

#[test]
fn options_of_mtl_maps_are_read() {
    let folder = folder();
    four(&folder);
    picture(&folder, "grey.png", 2, 2, |_, _| [51; 3]);
    picture(&folder, "a b.png", 2, 2, |_, _| [255, 0, 0]);
    let glow = |options: &str| draw_mtl(&folder, "", &format!("Kd 0 0 0\nmap_Ke {options}\n"));
    assert_eq!(corners(&glow("four.png")), [RED, GREEN, BLUE, WHITE]);
    all(&glow("-s 0.5 0.5 1 -o 0.5 0.5 0 four.png"), GREEN, 0.0);
    // Numbers that are left out, and options in any order.
    all(&glow("-o 0 0.5 -clamp on -s .5 .5 four.png"), RED, 0.0);
    assert_eq!(corners(&glow("-s 2 four.png")), [RED, GREEN, BLUE, WHITE]);
    all(&glow("-s 1 1 1 -o 0 a b.png"), RED, 0.0);
    // In linear values: 51 of 255, decoded.
    let linear = ((0.2 + 0.055) / 1.055f32).powf(2.4);
    all(&glow("-mm 0.1 2 grey.png"), [0.1 + 2.0 * linear; 3], 1e-6);
    assert!(!warnings(&folder, "o.toml").contains("ignored"));
    glow("-t 0.1 0.1 0.1 -texres 256 -imfchan z -blendu on four.png");
    let said = warnings(&folder, "o.toml");
    for option in ["map_Ke -t", "map_Ke -texres", "map_Ke -imfchan z"] {
        assert!(said.contains(&format!("`{option}` of material `m` is not understood; ignored")), "{said}");
    }
    assert!(!said.contains("blendu"), "{said}");
    for (line, message) in [
        ("map_Kd -s x four.png", "`map_Kd -s x`: not a number"),
        ("map_Kd -mm 1 four.png", "`map_Kd -mm` needs a base and a gain"),
    ] {
        folder.write("m.mtl", format!("newmtl m\n{line}\n"));
        folder.fails(&["check", "o.toml"], 3, &["m.mtl:2", line, message]);
    }
}

#[test]
fn a_channel_of_a_picture_stands_for_a_number() {
    let folder = folder();
    picture(&folder, "green.png", 2, 2, |_, _| [0, 255, 0]);
    // Metal of roughness 1, by the green of the picture; by its red, no metal at all.
    let metal = |channel: &str| {
        draw_mtl(&folder, HEAD_LIGHT, &format!("Kd 0.8 0.8 0.8\nPr 1\nmap_Pm -imfchan {channel} green.png\n"))
    };
    all(&metal("g"), [0.4 / PI; 3], 1e-4);
    let dielectric = metal("r")[0][0];
    assert!(dielectric > 1.2 / PI, "{dielectric}");
}

#[test]
fn a_light_map_is_light_in_the_place_of_ambient_light() {
    let folder = folder();
    four(&folder);
    let ambient = "[ambient]\ncolor = [5, 5, 5]\n";
    let lit = |more: &str, material: &str| {
        corners(&draw(&folder, more, &format!("diffuse = [0.5, 0.25, 1]\n{material}\n")))
    };
    let map = "lightmap = { file = \"four.png\", uv_set = 0 }";
    let albedo = |[r, g, b]: [f32; 3]| [0.5 * r, 0.25 * g, b];
    assert_eq!(lit(ambient, map), [RED, GREEN, BLUE, WHITE].map(albedo));
    // Lights are added: irradiance 2 makes 2/π of the albedo.
    let [upper_left, ..] = lit(HEAD_LIGHT, map);
    let wanted = [0.5 + 1.0 / PI, 0.5 / PI, 2.0 / PI];
    assert!(upper_left.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-5), "{upper_left:?}");
    // A light map with a gain is brighter than 1.
    let bright = "lightmap = { file = \"four.png\", uv_set = 0, gain = 4, scale = [0.5, 0.5] }";
    assert_eq!(lit("", bright), [albedo([0.0, 0.0, 4.0]); 4]);
    assert_eq!(warnings(&folder, "m.toml"), "");
    lit("", "lightmap = \"four.png\"");
    assert!(warnings(&folder, "m.toml").contains("takes the second set of texture coordinates"));
}

#[test]
fn reflection_maps_say_where_a_surface_mirrors() {
    let folder = folder();
    picture(&folder, "half.png", 8, 8, |x, _| if x < 4 { [0; 3] } else { [255; 3] });
    let ambient = "[ambient]\ncolor = [1, 1, 1]\n";
    let black = "diffuse = [0, 0, 0]\nreflection_map = \"half.png\"\n";
    assert_eq!(corners(&draw(&folder, ambient, black)), [[0.0; 3], WHITE, [0.0; 3], WHITE]);
    let half = format!("{black}reflection = 0.5\n");
    assert_eq!(corners(&draw(&folder, ambient, &half))[1], [0.5; 3]);
    let metal =
        format!("model = \"ggx\"\nmetallic = 1\nroughness = 0\n{}", black.replace("[0, 0, 0]", "[1, 1, 1]"));
    let seen = corners(&draw(&folder, ambient, &metal));
    assert!(seen[0] == [0.0; 3] && (seen[1][0] - 1.0).abs() < 3e-3, "{seen:?}");
}

#[test]
fn wrong_maps_name_the_key() {
    let folder = folder();
    four(&folder);
    let refused = |line: &str, pieces: &[&str]| {
        let object = "[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n";
        folder.write("m.toml", format!("{VIEW}{object}[material.m]\n{line}\n"));
        folder.fails(&["check", "m.toml"], 3, pieces);
    };
    refused("diffuse_map = { scale = [1, 1] }", &["`material.m.diffuse_map` needs `file`"]);
    refused(
        "diffuse_map = { file = \"four.png\", scael = [1, 1] }",
        &["unknown key `material.m.diffuse_map.scael`", "scale"],
    );
    refused(
        "diffuse_map = { file = \"four.png\", scale = 2 }",
        &["`material.m.diffuse_map.scale`", "2 numbers"],
    );
    refused(
        "diffuse_map = { file = \"four.png\", uv_set = 2 }",
        &["`material.m.diffuse_map.uv_set` is 2", "0 to 1"],
    );
    refused("diffuse_map = { file = \"lost.png\", gain = 2 }", &["lost.png", "cannot be read"]);
    refused("diffuse_map = 3", &["`material.m.diffuse_map`", "a string"]);
    folder.write("m.toml", format!("{VIEW}[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n[material.m]\ndiffuse = [0, 0, 0]\nlightmap = {{ file = \"four.png\", uv_set = 0 }}\n"));
    assert!(warnings(&folder, "m.toml").contains("`material.m.lightmap` has no effect"));
}
