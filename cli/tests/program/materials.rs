//! Materials through `render`: what each key does to a picture, and what is wrong with a scene.

use crate::common::Folder;
use crate::common::square::{
    HEAD_LIGHT, SQUARE, VIEW, all, draw, draw_mesh, draw_mtl, folder, picture, pixels,
};
use pointillist_shade::MerlTable;

const PI: f32 = std::f32::consts::PI;

#[test]
fn ggx_has_its_value_under_a_head_light() {
    let folder = folder();
    // Metal, α = 1: D V F = f0 / 4π, times irradiance 2.
    let metal = "model = \"ggx\"\ndiffuse = [0.8, 0.4, 0]\nmetallic = 1\nroughness = 1\n";
    let f0 = 0.8 + 0.2 * 0.0;
    all(&draw(&folder, HEAD_LIGHT, metal), [2.0 * f0 / (4.0 * PI), 2.0 * 0.4 / (4.0 * PI), 0.0], 1e-5);
}

#[test]
fn ggx_shows_even_surroundings_by_its_albedo() {
    let folder = folder();
    // A smooth perfect mirror in light of 1 from everywhere shows 1, by map or by ambient colour.
    picture(&folder, "white.png", 8, 4, |_, _| [255; 3]);
    let mirror = "model = \"ggx\"\ndiffuse = [1, 1, 1]\nmetallic = 1\nroughness = 0\n";
    all(&draw(&folder, "environment = \"white.png\"\n", mirror), [1.0; 3], 3e-3);
    all(&draw(&folder, "[ambient]\ncolor = [1, 1, 1]\n", mirror), [1.0; 3], 3e-3);
    // A white base under a clear coat returns everything at any roughness.
    for roughness in ["0.1", "0.5", "1"] {
        let plastic = format!("model = \"ggx\"\ndiffuse = [1, 1, 1]\nroughness = {roughness}\n");
        let map = "environment = \"white.png\"\n[ambient]\nenvironment = true\n";
        all(&draw(&folder, map, &plastic), [1.0; 3], 4e-3);
    }
}

#[test]
fn a_measured_table_is_drawn_like_the_function_it_is_made_of() {
    let folder = folder();
    let table = MerlTable::tabulate(|_, _| glam::vec3(0.3, 0.2, 0.1));
    folder.write("even.binary", table.to_bytes());
    let measured = "model = \"merl\"\nmerl = \"even.binary\"\n";
    all(&draw(&folder, HEAD_LIGHT, measured), [0.6, 0.4, 0.2], 1e-5);
    folder.write("even.binary", &table.to_bytes()[..100_000]);
    folder.fails(&["check", "m.toml"], 3, &["even.binary", "bytes, not 100000", "MERL"]);
}

#[test]
fn a_ramp_of_heights_tilts_the_normal() {
    let folder = folder();
    // 0 to 255 over 256 columns, so 1 over one unit of u, which spans 2: with a height of 2, a slope of 1.
    picture(&folder, "ramp.png", 256, 4, |x, _| [x as u8; 3]);
    let bump = "diffuse = [1, 1, 1]\nwrap = \"clamp\"\nbump_map = \"ramp.png\"\nbump_scale = 2\n";
    let tilted = draw(&folder, HEAD_LIGHT, bump);
    // Facing 45° away; the outermost columns hold half a slope.
    let slope = 256.0 / 255.0;
    let wanted = 2.0 / PI / (1.0f32 + slope * slope).sqrt();
    let inner: Vec<[f32; 3]> = (0..64).filter(|i| (1..7).contains(&(i % 8))).map(|i| tilted[i]).collect();
    all(&inner, [wanted; 3], 1e-3);
    // The light from the left sees more of it: the surface rises to the right and faces left.
    let side = HEAD_LIGHT.replace("[0, 0, -1]", "[1, 0, -1]");
    let facing = draw(&folder, &side, bump)[27][0];
    assert!((facing - 2.0 / PI).abs() < 1e-2, "{facing}");
}

#[test]
fn a_constant_height_changes_no_bit() {
    let folder = folder();
    picture(&folder, "flat.png", 8, 8, |_, _| [77; 3]);
    picture(&folder, "flat_normal.png", 8, 8, |_, _| [128, 127, 255]);
    let light = HEAD_LIGHT.replace("[0, 0, -1]", "[0.3, 0.2, -1]");
    let plain = draw(&folder, &light, "diffuse = [0.5, 0.6, 0.7]\n");
    for map in ["bump_map = \"flat.png\"\nbump_scale = 100\n", "normal_map = \"flat_normal.png\"\n"] {
        assert_eq!(draw(&folder, &light, &format!("diffuse = [0.5, 0.6, 0.7]\n{map}")), plain);
    }
}

#[test]
fn a_normal_map_leans_to_the_right_and_up() {
    let folder = folder();
    // x = 0.6, z = 0.8.
    picture(&folder, "right.png", 4, 4, |_, _| [204, 128, 230]);
    picture(&folder, "up.png", 4, 4, |_, _| [128, 204, 230]);
    for (map, direction) in [("right.png", "[-0.6, 0, -0.8]"), ("up.png", "[0, -0.6, -0.8]")] {
        let light = HEAD_LIGHT.replace("[0, 0, -1]", direction);
        let facing = draw(&folder, &light, &format!("diffuse = [1, 1, 1]\nnormal_map = \"{map}\"\n"));
        all(&facing, [2.0 / PI; 3], 1e-3);
    }
}

#[test]
fn factors_of_maps_multiply_their_constants() {
    let folder = folder();
    // Half black, half white: its mean over the square is a half, over each pixel 0 or 1.
    picture(&folder, "half.png", 8, 8, |x, _| if x < 4 { [0; 3] } else { [255; 3] });
    let glow = draw(&folder, "", "diffuse = [0, 0, 0]\nemission = [2, 1, 0]\nemission_map = \"half.png\"\n");
    for (i, p) in glow.iter().enumerate() {
        assert_eq!(*p, if i % 8 < 4 { [0.0; 3] } else { [2.0, 1.0, 0.0] }, "{i}");
    }
    let shiny = "model = \"blinn-phong\"\ndiffuse = [0, 0, 0]\nspecular = 0.5\nshininess = 10\n";
    let whole = draw(&folder, HEAD_LIGHT, shiny);
    let mapped = draw(&folder, HEAD_LIGHT, &format!("{shiny}specular_map = \"half.png\"\n"));
    for i in 0..64 {
        let wanted = if i % 8 < 4 { 0.0 } else { whole[i][0] };
        assert!((mapped[i][0] - wanted).abs() < 1e-5, "{i}: {} {wanted}", mapped[i][0]);
    }
    // An exponent of 0 where the map is black: (0 + 2)(0 + 4) / 8π · 0.5 · 2.
    let dull = draw(&folder, HEAD_LIGHT, &format!("{shiny}shininess_map = \"half.png\"\n"));
    assert!((dull[0][0] - 1.0 / PI).abs() < 1e-4, "{}", dull[0][0]);
    assert!((dull[7][0] - whole[7][0]).abs() < 1e-3);
}

/// A map with one colour for each of the six directions, wide enough for corners not to mix.
fn six_colors(folder: &Folder) {
    picture(folder, "six.png", 64, 32, |x, y| match (x, y) {
        (_, 0..8) => [255, 255, 255],
        (_, 24..) => [0, 0, 0],
        (24..40, _) => [255, 0, 0],
        (40..56, _) => [0, 255, 0],
        (8..24, _) => [0, 0, 255],
        _ => [255, 255, 0],
    });
}

#[test]
fn mirrors_and_glass_look_where_they_should() {
    let folder = folder();
    six_colors(&folder);
    let map = "environment = \"six.png\"\n";
    // The eye looks along −Z at a square that faces it: mirrored is +Z, the map's yellow rim; behind is −Z, its red centre.
    all(&draw(&folder, map, "diffuse = [0, 0, 0]\nreflection = [0.5, 1, 1]\n"), [0.5, 1.0, 0.0], 1e-3);
    let clear = "diffuse = [0, 0, 0]\ntransmission = 1\nrefraction_index = 1.5\n";
    all(&draw(&folder, map, clear), [1.0, 0.04, 0.0], 1e-3);
    let thin = "diffuse = [0, 0, 0]\ntransmission = [0.5, 0.5, 0.5]\nrefraction_index = 1\n";
    all(&draw(&folder, map, thin), [0.5, 0.0, 0.0], 1e-3);
    // A map of the material's own.
    picture(&folder, "blue.png", 8, 4, |_, _| [0, 0, 255]);
    let own = "diffuse = [0, 0, 0]\nreflection = 1\nenvironment = \"blue.png\"\n";
    all(&draw(&folder, map, own), [0.0, 0.0, 1.0], 1e-3);
}

#[test]
fn glass_shows_what_stands_behind_it() {
    let folder = folder();
    folder.write(
        "wall.obj",
        "mtllib w.mtl\nv -9 -9 -3\nv 9 -9 -3\nv 9 9 -3\nv -9 9 -3\nusemtl glow\nf 1 2 3 4\n",
    );
    folder.write("w.mtl", "newmtl glow\nKd 0 0 0\nKe 4 2 1\n");
    let wall = "[[object]]\nmesh = \"wall.obj\"\n";
    let pane = "diffuse = [0, 0, 0]\ntransmission = [0.25, 0.5, 1]\n";
    all(&draw(&folder, wall, pane), [1.0, 1.0, 1.0], 1e-5);
    // A pane that refracts shows the surroundings, here the ambient light.
    let ambient = "[ambient]\ncolor = [0.5, 0.5, 0.5]\n";
    let block = format!("{pane}refraction_index = 1.000001\n");
    all(&draw(&folder, &format!("{wall}{ambient}"), &block), [0.125, 0.25, 0.5], 1e-3);
    folder.write("with_mtl.obj", format!("mtllib m.mtl\nusemtl m\n{SQUARE}"));
    let by_mtl = |mtl: &str| {
        folder.write("m.mtl", format!("newmtl m\nKd 0 0 0\n{mtl}"));
        folder.write("o.toml", format!("{VIEW}{wall}[[object]]\nmesh = \"with_mtl.obj\"\n"));
        pixels(&folder, "o.toml")
    };
    all(&by_mtl("Tf 0.25 0.5 1\nillum 9\n"), [1.0, 1.0, 1.0], 1e-5);
    all(&by_mtl("Tf 1 1 1\nd 0.5\nillum 4\n"), [2.0, 1.0, 0.5], 1e-5);
    refused(
        "transmission = [0, 0, 1.5]\n",
        &["`material.m.transmission` must be from 0 to 1", "transmission = [0, 0, 1.5]"],
    );
}

#[test]
fn a_captured_mirror_shows_what_is_behind_the_eye() {
    let folder = folder();
    // A glowing wall of two colours behind the camera, at z = 8, and the square in between mirrors it.
    folder.write(
        "wall.obj",
        "mtllib w.mtl\nv -90 -90 8\nv 0 -90 8\nv 0 90 8\nv -90 90 8\nv 90 -90 8\nv 90 90 8\n\
                              usemtl left\nf 1 2 3 4\nusemtl right\nf 2 5 6 3\n",
    );
    folder.write("w.mtl", "newmtl left\nKd 0 0 0\nKe 1 0 0\nnewmtl right\nKd 0 0 0\nKe 0 1 0\n");
    let scene = format!(
        "{VIEW}[[object]]\nmesh = \"wall.obj\"\n[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n\
         [material.m]\ndiffuse = [0, 0, 0]\nreflection = 1\nenvironment = \"capture\"\n"
    );
    folder.write("c.toml", scene);
    // Tilted to both sides by hand would need a sphere; straight on the border between the colours is seen.
    let seen = pixels(&folder, "c.toml");
    assert!(seen.iter().all(|p| (p[0] + p[1] - 1.0).abs() < 1e-2 && p[2] == 0.0), "{:?}", seen[0]);
    // A normal map turns the mirror to the right: mirrored is +X and +Z, where the wall is green.
    picture(&folder, "right.png", 4, 4, |_, _| [200, 128, 230]);
    let tilted = std::fs::read_to_string(folder.path("c.toml")).unwrap() + "normal_map = \"right.png\"\n";
    folder.write("t.toml", tilted);
    all(&pixels(&folder, "t.toml"), [0.0, 1.0, 0.0], 1e-2);
}

#[test]
fn automatic_coordinates_serve_meshes_without() {
    let folder = folder();
    folder.write("bare.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
    picture(&folder, "half.png", 8, 8, |x, _| if x < 4 { [0; 3] } else { [255; 3] });
    let material = "diffuse_map = \"half.png\"\ncolor_space = \"linear\"\n";
    let with = draw(&folder, HEAD_LIGHT, material);
    for uv in ["", "uv = \"box\"\n", "uv = \"planar\"\n"] {
        assert_eq!(draw_mesh(&folder, "bare.obj", HEAD_LIGHT, &format!("{material}{uv}")), with, "{uv}");
        let output = folder.command(&["check", "m.toml"]).output().unwrap();
        let warned = String::from_utf8_lossy(&output.stderr).contains("no texture coordinates");
        assert_eq!(warned, uv.is_empty(), "{uv}");
    }
}

/// Two faces that meet at a right angle along a vertical edge towards the eye.
const CORNER: &str = "v -1 -1 -1\nv 0 -1 0\nv 0 1 0\nv -1 1 -1\nv 1 -1 -1\nv 1 1 -1\nf 1 2 3 4\nf 2 5 6 3\n";
const CORNER_PLY: &str = "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
    element face 2\nproperty list uchar int vertex_indices\nend_header\n\
    -1 -1 -1\n0 -1 0\n0 1 0\n-1 1 -1\n1 -1 -1\n1 1 -1\n4 0 1 2 3\n4 1 4 5 2\n";

#[test]
fn flat_gouraud_and_phong_differ_on_meshes_without_normals() {
    let folder = folder();
    folder.write("corner.obj", CORNER);
    folder.write("corner.ply", CORNER_PLY);
    let shade = |mesh: &str, render: &str| {
        draw_mesh(&folder, mesh, &format!("{HEAD_LIGHT}[render]\n{render}"), "diffuse = [1, 1, 1]\n")
    };
    let flat = 2.0 / PI / 2f32.sqrt();
    for mesh in ["corner.obj", "corner.ply"] {
        all(&shade(mesh, "shading = \"flat\"\n"), [flat; 3], 1e-5);
        // Between the edge, which faces the light, and the rim at 45°: colours mix, or normals turn.
        let gouraud = shade(mesh, "shading = \"gouraud\"\n")[31][0];
        let phong = shade(mesh, "shading = \"phong\"\n")[31][0];
        assert!(gouraud != phong && gouraud > flat && phong > flat, "{gouraud} {phong}");
        assert!((gouraud - phong).abs() < 0.1, "{gouraud} {phong}");
        // A crease below the fold leaves the faces flat, one above does not.
        all(&shade(mesh, "crease = 60\n"), [flat; 3], 1e-5);
        assert_eq!(shade(mesh, "crease = 120\n"), shade(mesh, "shading = \"phong\"\n"));
        // The faces mirror each other, but not the way they are cut into triangles: only angles do not see that (but for
        // where in a pixel each triangle is shaded).
        for (normals, even) in [("area", false), ("angle", true), ("plain", false)] {
            let weighted = shade(mesh, &format!("normals = \"{normals}\"\n"));
            let symmetric =
                (0..64).all(|i| (weighted[i][0] - weighted[8 * (i / 8) + 7 - i % 8][0]).abs() < 5e-3);
            assert_eq!(symmetric, even, "{normals}");
        }
    }
}

#[test]
fn mtl_keys_change_the_picture() {
    let folder = folder();
    six_colors(&folder);
    picture(&folder, "half.png", 8, 8, |x, _| if x < 4 { [0; 3] } else { [255; 3] });
    picture(&folder, "right.png", 4, 4, |_, _| [204, 128, 230]);
    let draw = |more: &str, mtl: &str| draw_mtl(&folder, more, mtl);
    let glow = draw("", "Kd 0 0 0\nmap_Ke half.png\n");
    assert_eq!((glow[0], glow[7]), ([0.0; 3], [1.0; 3]));
    let map = "environment = \"six.png\"\n";
    all(&draw(map, "Kd 0 0 0\nKs 0.5 1 1\nNs 10\nillum 2\n"), [0.0; 3], 1e-6);
    all(&draw(map, "Kd 0 0 0\nKs 0.5 1 1\nNs 10\nillum 3\n"), [0.5, 1.0, 0.0], 1e-3);
    all(&draw(map, "Kd 0 0 0\nTf 1 1 1\nNi 1\nillum 6\n"), [1.0, 0.0, 0.0], 1e-3);
    all(&draw("", "Kd 0 0 0\nrefl -type sphere six.png\n"), [1.0, 1.0, 0.0], 1e-3);
    let light = HEAD_LIGHT.replace("[0, 0, -1]", "[-0.6, 0, -0.8]");
    all(&draw(&light, "Kd 1 1 1\nnorm right.png\n"), [2.0 / PI; 3], 1e-3);
    // Metal of roughness 1.
    all(&draw(HEAD_LIGHT, "Kd 0.8 0.8 0.8\nPr 1\nPm 1\n"), [0.4 / PI; 3], 1e-4);
    picture(&folder, "ramp.png", 256, 4, |x, _| [x as u8; 3]);
    let bump = |m: &str| draw(HEAD_LIGHT, &format!("Kd 1 1 1\nmap_bump {m} ramp.png\n"))[27][0];
    // -bm 33.333: white is as high as the texture is long, a slope of 1.
    assert!((bump("-bm 33.33333") - 2.0 / PI / 2f32.sqrt()).abs() < 5e-3, "{}", bump("-bm 33.33333"));
    assert!((bump("-bm 0") - 2.0 / PI).abs() < 1e-5);
    let output = folder.command(&["check", "o.toml"]).output().unwrap();
    assert!(!String::from_utf8_lossy(&output.stderr).contains("ignored"));
    folder.write("m.mtl", "newmtl m\ndisp half.png\n");
    let output = folder.command(&["check", "o.toml"]).output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains("`disp` of material `m` is not understood"));
}

/// The scene with this material is refused with these pieces of a message.
fn refused(material: &str, pieces: &[&str]) {
    let folder = folder();
    folder.write("text.png", "no picture");
    let object = "[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n";
    folder.write("m.toml", format!("{VIEW}{object}[material.m]\n{material}"));
    folder.fails(&["render", "m.toml", "-o", "m.exr"], 3, pieces);
    assert!(!folder.path("m.exr").exists());
}

#[test]
fn wrong_materials_name_material_and_key() {
    refused("bump_map = \"text.png\"\n", &["m.toml:11:", "text.png", "cannot be decoded", "bump_map"]);
    refused("normal_map = \"lost.png\"\n", &["lost.png", "cannot be read"]);
    refused("shininess = -1\n", &["`material.m.shininess` is -1", "0 or more"]);
    refused("model = \"ggx\"\nroughness = nan\n", &["`material.m.roughness`"]);
    refused("diffuse = [0.5, nan, 0]\n", &["`material.m.diffuse`", "finite"]);
    refused("model = \"ggx\"\nroughness = 2\n", &["`material.m.roughness` is 2", "from 0 to 1"]);
    refused("model = \"ggx\"\nspecular = 3\n", &["`material.m.specular`", "from 0 to 1"]);
    refused("model = \"ggx\"\nshininess = 3\n", &["`material.m.shininess` does nothing here", "roughness"]);
    refused("roughness = 0.5\n", &["`material.m.roughness` does nothing here", "ggx"]);
    refused("metallic = 0.5\n", &["`material.m.metallic` does nothing here"]);
    refused("emits = true\n", &["`material.m.emits` does nothing here", "emission"]);
    refused("bump_scale = 0.5\n", &["`material.m.bump_scale` does nothing here"]);
    refused("refraction_index = 1.5\n", &["`material.m.refraction_index` does nothing here"]);
    refused("model = \"merl\"\n", &["`material.m` needs `merl`"]);
    refused("merl = \"x.binary\"\n", &["`material.m.merl` does nothing here", "model"]);
    refused("model = \"merl\"\nmerl = \"lost.binary\"\n", &["lost.binary", "cannot be read"]);
    refused("uv = \"sphere\"\n", &["`material.m.uv`", "polar"]);
    refused("reflection = -0.5\n", &["`material.m.reflection`"]);
    refused("[ambient]\nenvironment = true\n", &["`ambient.environment` needs `image.environment`"]);
    refused("[render]\nshading = \"flat\"\ncrease = 30\n", &["`render.crease`", "flat"]);
}

#[test]
fn pictures_with_everything_do_not_depend_on_tiles_or_threads() {
    let folder = folder();
    six_colors(&folder);
    picture(&folder, "ramp.png", 16, 16, |x, y| [(x * y) as u8, 128, 255]);
    folder.write("corner.obj", CORNER);
    let scene = format!(
        "{VIEW}environment = \"six.png\"\n{HEAD_LIGHT}[ambient]\nenvironment = true\n\
         [[object]]\nmesh = \"corner.obj\"\nmaterial = \"m\"\n[[object]]\nmesh = \"square.obj\"\nmaterial = \"c\"\ntranslate = [0.5, 0.5, -1]\n\
         [material.m]\nmodel = \"ggx\"\ndiffuse_map = \"ramp.png\"\nbump_map = \"ramp.png\"\nbump_scale = 0.1\nroughness = 0.4\nuv = \"polar\"\n\
         [material.c]\nreflection = 0.5\nenvironment = \"capture\"\n"
    );
    folder.write("all.toml", scene);
    folder.prints(&["render", "all.toml", "-o", "whole.exr", "--threads", "1"]);
    folder.prints(&["render", "all.toml", "-o", "two.exr", "--threads", "2"]);
    for (tile, part) in [("0/2", "a.exr"), ("1/2", "b.exr")] {
        folder.prints(&["render", "all.toml", "--tile", tile, "-o", part]);
    }
    folder.prints(&["merge", "a.exr", "b.exr", "-o", "merged.exr"]);
    let bytes = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert!(bytes("whole.exr") == bytes("two.exr") && bytes("whole.exr") == bytes("merged.exr"));
    let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", "all.toml"])).unwrap();
    assert_eq!(info["textures"].as_array().map(Vec::len), Some(3), "{info}");
    assert_eq!(info["surfaces"][0]["model"], "ggx");
    assert_eq!(info["surfaces"][0]["maps"], serde_json::json!(["diffuse", "bump"]));
    assert_eq!(info["surfaces"][1]["mirrors"], true);
}
