//! Every kind of bad input gets its exit code and a message that shows where; outputs stay as they were.

use crate::common::{Folder, SCENE};

/// Draws a scene whose `good` text is replaced by `bad` and expects the message; the old output is untouched.
fn scene_error(good: &str, bad: &str, pieces: &[&str]) {
    let folder = Folder::new();
    assert!(SCENE.contains(good), "{good}");
    folder.write("scene.toml", SCENE.replacen(good, bad, 1));
    folder.write("out.exr", "as it was");
    folder.fails(&["render", "scene.toml", "-o", "out.exr"], 3, pieces);
    folder.fails(&["check", "scene.toml"], 3, pieces);
    assert_eq!(std::fs::read(folder.path("out.exr")).unwrap(), b"as it was");
    assert_eq!(folder.names(), ["out.exr", "scene.toml", "triangle.obj"]);
}

fn obj_error(text: impl AsRef<[u8]>, pieces: &[&str]) {
    let folder = Folder::new();
    folder.write("triangle.obj", text);
    folder.fails(&["check", "scene.toml"], 3, pieces);
    folder.fails(&["render", "triangle.obj", "-o", "out.png"], 3, pieces);
    assert_eq!(folder.names(), ["scene.toml", "triangle.obj"]);
}

#[test]
fn unknown_key_shows_the_line_and_the_nearest_key() {
    scene_error(
        "fov = 40",
        "fow = 40",
        &["scene.toml:4:1", "`camera.fow`", "fow = 40", "^^^", "did you mean `fov`?"],
    );
}

#[test]
fn wrong_type_shows_what_was_found_and_what_is_wanted() {
    scene_error("fov = 40", "fov = \"wide\"", &["scene.toml:4:7", "a string, \"wide\"", "a number"]);
    scene_error("[16, 12]", "[16]", &["`image.size` has 1 entries", "2 numbers"]);
}

#[test]
fn numbers_out_of_range_are_named() {
    scene_error("[16, 12]", "[0, 0]", &["`image.size` is [0, 0]", "from 1"]);
    scene_error("fov = 40", "fov = 180", &["`camera.fov` is 180", "less than 180"]);
    scene_error("[30, 30, 30]", "[30, nan, 30]", &["`light[0].intensity`", "finite"]);
    scene_error("[0, 0.5, 4]", "[inf, 0, 0]", &["`camera.eye`", "finite"]);
}

#[test]
fn degenerate_cameras_are_named() {
    scene_error(
        "target = [0, 0.5, 0]",
        "target = [0, 0.5, 4]",
        &["scene.toml:3", "`camera.target`", "same point"],
    );
    scene_error("fov = 40", "up = [0, 0, 2]", &["`camera.up`", "parallel"]);
}

#[test]
fn missing_mesh_shows_the_line_that_names_it() {
    scene_error(
        "triangle.obj",
        "nowhere.obj",
        &["scene.toml:8:8", "nowhere.obj", "cannot be read", "relative"],
    );
}

#[test]
fn missing_keys_are_asked_for() {
    scene_error("position = [1, 2, 3]\n", "", &["`light[0]` needs `position`"]);
    scene_error("\"point\"", "\"pont\"", &["`light[0].type`", "did you mean \"point\"?"]);
}

#[test]
fn broken_toml_shows_the_place() {
    scene_error("fov = 40", "fov = = 40", &["scene.toml:4:", "not TOML"]);
}

#[test]
fn unknown_material_lists_the_known_ones() {
    let with_material = "mesh = \"triangle.obj\"\nmaterial = \"clay\"\n[material.stone]";
    scene_error("mesh = \"triangle.obj\"", with_material, &["no material `clay`", "stone"]);
}

#[test]
fn json_scenes_have_the_same_messages() {
    let folder = Folder::new();
    folder.write("scene.json", "{\"object\": [{\"mesh\": \"triangle.obj\"}],\n \"camera\": {\"fow\": 3}}");
    folder.fails(&["check", "scene.json"], 3, &["scene.json:2:13", "did you mean `fov`?"]);
    folder.write("scene.json", "{\"object\": [}");
    folder.fails(&["check", "scene.json"], 3, &["scene.json:1:", "not JSON"]);
}

#[test]
fn malformed_obj_lines_are_shown() {
    obj_error("v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n", &["triangle.obj:2:1", "v 1 x 0"]);
    obj_error("v 0 0 0\nv 1 0\n", &["triangle.obj:2:1", "2 numbers"]);
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 drei\n", &["triangle.obj:4:1", "`drei`"]);
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", &["triangle.obj:4:1", "2 corners"]);
    obj_error("hello\n", &["triangle.obj:1:1", "not an OBJ keyword"]);
}

#[test]
fn obj_indices_out_of_range_are_shown() {
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n", &["triangle.obj:5:1", "index 4", "f 1 2 4"]);
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["triangle.obj:4:1", "vertex 0"]);
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -1 -2\n", &["triangle.obj:4:1", "vertex -4"]);
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/9 2/9 3/9\n", &["triangle.obj:4:1", "texture coordinates"]);
}

#[test]
fn vertices_that_are_not_finite_are_shown() {
    obj_error("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", &["triangle.obj:2:1", "not finite", "v 1 nan 0"]);
    obj_error("v 0 0 0\nv 1 0 0\nv 0 1e999 0\nf 1 2 3\n", &["triangle.obj:3:1", "not finite"]);
}

#[test]
fn a_mesh_without_faces_is_refused() {
    obj_error("", &["the file is empty"]);
    obj_error("v 0 0 0\n", &["no faces"]);
}

#[test]
fn a_missing_mtl_is_a_warning_and_a_missing_texture_an_error() {
    let folder = Folder::new();
    let with_mtl = "mtllib a.mtl\nv -1 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
    folder.write("triangle.obj", with_mtl);
    let output = folder.command(&["check", "scene.toml"]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.contains("a.mtl` is not there") && message.contains("`red` is not defined"), "{message}");
    folder.write("a.mtl", "newmtl red\nKd 1 0 0\nmap_Kd no.png\n");
    folder.fails(&["check", "scene.toml"], 3, &["a.mtl:3:1", "no.png", "map_Kd no.png"]);
    folder.write("no.png", "not a picture");
    folder.fails(&["check", "scene.toml"], 3, &["a.mtl:3:1", "no.png", "cannot be decoded"]);
    folder.write("a.mtl", "newmtl red\nKd 1 0\n");
    folder.fails(&["check", "scene.toml"], 3, &["a.mtl:2:1", "three numbers"]);
}

#[test]
fn broken_ply_is_refused() {
    let folder = Folder::new();
    folder.write("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 7\n");
    folder.fails(&["check", "a.ply"], 3, &["face 0", "vertex 7"]);
    folder.write("a.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
    folder.fails(&["check", "a.ply"], 3, &["4000000000", "announced"]);
    folder.write("a.ply", "no ply");
    folder.fails(&["check", "a.ply"], 3, &["not PLY"]);
}

#[test]
fn more_pixels_than_memory_are_refused_with_the_amount() {
    let folder = Folder::new();
    folder.fails(
        &["render", "scene.toml", "--size", "1000000x1000000", "-o", "a.exr"],
        2,
        &["--size 1000000x1000000", "TiB", "--tile"],
    );
}

/// What new users stumbled over: each message says what to do instead.
#[test]
fn usual_slips_have_a_way_out() {
    let folder = Folder::new();
    folder.fails(&["scene.toml"], 2, &["a command comes first: pointillist render scene.toml"]);
    folder.fails(&["house.conf"], 2, &["a command comes first: pointillist scan house.conf"]);
    folder.fails(&["rendr", "scene.toml"], 2, &["'render'"]);
    folder.fails(
        &["render", "scene.toml", "--eye", "1", "2", "3"],
        2,
        &["commas between them", "--eye 1,2,3"],
    );
    folder.fails(&["render", "scene.toml", "--sise", "4x3"], 2, &["'--size'"]);
    folder.write("bare.toml", "[[object]]\nmesh = models/house.obj # as it is\n");
    folder.fails(
        &["check", "bare.toml"],
        3,
        &["bare.toml:2:", "text stands in quotes: \"models/house.obj\""],
    );
    folder.fails(&["dice", "{\"polygon\":[]}"], 3, &["by standard input: echo"]);
    for name in ["e.obj", "e.ply", "e.glb", "e.gltf"] {
        folder.write(name, "");
        folder.fails(&["render", name], 3, &[name, "the file is empty", "get or write it again"]);
    }
    folder.write("e.exr", "");
    folder.fails(&["compare", "e.exr", "e.exr"], 3, &["e.exr", "the file is empty"]);
    folder.fails(&["merge", "e.exr", "-o", "all.exr"], 3, &["e.exr", "the file is empty"]);
    folder.prints(&["render", "scene.toml", "-o", "a.png", "--quiet"]);
    folder.fails(&["merge", "a.png", "-o", "all.exr"], 3, &["a.png", "parts are the EXR files of `--tile`"]);
}

#[test]
fn wrong_usage_exits_2() {
    let folder = Folder::new();
    for line in [
        &["render", "scene.toml", "-o", "a.bmp"][..],
        &["render", "scene.toml", "--eye", "1,2"],
        &["render", "scene.toml", "--eye", "1,2,nan"],
        &["render", "scene.toml", "--size", "0x5"],
        &["render", "scene.toml", "--crop", "0,0,99,99"],
        &["render", "scene.toml", "--crop", "5,5,5,9"],
        &["render", "scene.toml", "--tile", "4/4"],
        &["render", "scene.toml", "--tile", "0/13", "-o", "a.exr"],
        &["render", "scene.toml", "--fov", "180"],
        &["render", "scene.toml", "--layers", "all", "-o", "a.png"],
        &["render", "scene.toml", "--layers", "depths", "-o", "a.exr"],
        &["render", "scene.toml", "--layers", "lit.sun", "-o", "a.exr"],
        &["render", "scene.toml", "--threads", "0"],
        &["merge", "-o", "a.exr"],
        &["fly"],
        &[],
    ] {
        folder.fails(line, 2, &[]);
    }
    assert_eq!(folder.names(), ["scene.toml", "triangle.obj"]);
}

#[test]
fn set_overrides_show_themselves() {
    let folder = Folder::new();
    folder.fails(
        &["check", "scene.toml", "--set", "camera.fov=200"],
        3,
        &["--set:1:12", "camera.fov=200", "^^^"],
    );
    folder.fails(&["check", "scene.toml", "--set", "light.7.shadow=false"], 3, &["`7` is not one of the 1"]);
    folder.fails(&["check", "scene.toml", "--set", "camera.fov"], 3, &["no `=`"]);
    folder.prints(&[
        "check",
        "scene.toml",
        "--set",
        "light[0].shadow=false",
        "--set",
        "render.occlusion=paper",
    ]);
}

#[test]
fn lights_with_an_area_are_checked() {
    const LAMP: &str = "type = \"point\"\nposition = [1, 2, 3]\nintensity = [30, 30, 30]\n";
    let polygon = |vertices: &str, rest: &str| {
        format!("type = \"polygon\"\nvertices = {vertices}\nradiance = [1, 1, 1]\n{rest}")
    };
    let square = "[[0, 2, 0], [1, 2, 0], [1, 2, 1], [0, 2, 1]]";
    let wrong = |light: String, pieces: &[&str]| scene_error(LAMP, &light, pieces);
    wrong(
        polygon("[[0, 2, 0], [1, 2, 0]]", ""),
        &["scene.toml:12", "`light[0].vertices`", "2 vertices", "3 to 12"],
    );
    wrong(
        polygon("[[0, 2, 0], [1, 2, 0], [1, 3, 1], [0, 2, 1]]", ""),
        &["`light[0].vertices`", "not in the plane"],
    );
    let dent = "[[0, 2, 0], [1, 2, 0], [0.2, 2, 0.2], [0, 2, 1]]";
    wrong(polygon(dent, ""), &["`light[0].vertices`", "not convex at vertex 2"]);
    wrong(polygon("[[0, 2, 0], [1, 2, 0], [1, 2]]", ""), &["`light[0].vertices`", "3 numbers"]);
    wrong(polygon(square, "samples = 0\n"), &["`light[0].samples`", "1"]);
    wrong(polygon(square, "").replace("[1, 1, 1]\n", "[1, -1, 1]\n"), &["`light[0].radiance`", "negative"]);
    let line = |to: &str| format!("type = \"line\"\nfrom = [0, 2, 0]\nto = {to}\nradiance = [1, 1, 1]\n");
    wrong(line("[0, 2, 0]"), &["`light[0].to`", "no length"]);
    wrong(line("[0, 2, inf]"), &["`light[0].to`"]);
    wrong(line("[0, 2, 1]") + "samples = 0\n", &["`light[0].samples`"]);
    let folder = Folder::new();
    for right in [polygon(square, "two_sided = true\n"), line("[0, 2, 1]")] {
        folder.write("scene.toml", SCENE.replacen(LAMP, &right, 1));
        folder.prints(&["check", "scene.toml"]);
    }
}
