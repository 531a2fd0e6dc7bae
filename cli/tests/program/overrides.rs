//! `--set`, and materials that a scene describes for nothing.

use crate::common::{Folder, SCENE, TRIANGLE};

/// The triangle with a material of its own, in a folder below the user's.
fn folder() -> Folder {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("scenes")).unwrap();
    folder.write("scenes/scene.toml", SCENE);
    folder.write("scenes/triangle.obj", TRIANGLE.replace("f 1", "usemtl Floor\nf 1"));
    folder.write("scenes/floor.mtl", "newmtl Floor\n");
    image::RgbImage::from_pixel(1, 1, image::Rgb([255, 0, 0])).save(folder.path("here.png")).unwrap();
    image::RgbImage::from_pixel(1, 1, image::Rgb([0, 255, 0])).save(folder.path("scenes/there.png")).unwrap();
    folder
}

#[test]
fn a_path_in_an_option_is_relative_to_the_user_and_one_in_a_scene_to_the_scene() {
    let folder = folder();
    let check = |set: &str| folder.prints(&["check", "scenes/scene.toml", "--set", set]);
    check("material.Floor.diffuse_map=here.png");
    check("image.environment=here.png");
    check("object.0.mesh=scenes/triangle.obj");
    check("object=[{ mesh = \"triangle.obj\" }]");
    let wrong = ["check", "scenes/scene.toml", "--set", "material.Floor.diffuse_map=there.png"];
    folder.fails(&wrong, 3, &["there.png", "relative to the folder you are in"]);
    let map = "[material.Floor]\ndiffuse_map = ";
    folder.write("scenes/map.toml", format!("{}{map}\"there.png\"\n", SCENE));
    folder.prints(&["check", "scenes/map.toml"]);
    folder.write("scenes/wrong.toml", format!("{}{map}\"here.png\"\n", SCENE));
    folder.fails(&["check", "scenes/wrong.toml"], 3, &["here.png", "relative to the scene file"]);
}

#[test]
fn baked_light_named_by_an_option_is_looked_for_where_the_user_is() {
    let folder = folder();
    folder.prints(&["radiosity", "scenes/scene.toml", "--patch", "1", "-o", "baked.json"]);
    folder.prints(&["check", "scenes/scene.toml", "--set", "ambient.radiosity=baked.json"]);
    folder.prints(&["check", "scenes/scene.toml", "--set", "ambient.radiosity=./baked.json"]);
    folder.fails(
        &["check", "scenes/scene.toml", "--set", "ambient.radiosity=scenes/baked.json"],
        3,
        &["`scenes/baked.json` is not there"],
    );
}

#[test]
fn a_material_that_no_mesh_has_is_a_warning_and_fails_check() {
    let folder = folder();
    let text = format!("{}[material.florr]\ndiffuse = [1, 0, 0]\n", SCENE);
    folder.write("scenes/scene.toml", text);
    let pieces = ["scenes/scene.toml:14:11", "`material.florr` matches no material", "did you mean `Floor`?"];
    let line = ["render", "scenes/scene.toml", "-o", "a.png"];
    let output = folder.command(&line).output().unwrap();
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(message.contains("warning: "), "{message}");
    pieces.iter().for_each(|piece| assert!(message.contains(piece), "{piece}: {message}"));
    folder.fails(&["check", "scenes/scene.toml"], 3, &pieces);
}

#[test]
fn an_option_for_a_material_that_no_mesh_has_is_a_warning_and_fails_check() {
    let folder = folder();
    let line = ["check", "scenes/scene.toml", "--set", "material.nosuch.opacity=0.5"];
    folder.fails(&line, 3, &["--set:1:1", "`material.nosuch`", "materials of the meshes are Floor"]);
    // Named by an object, a material needs no mesh that has it.
    let used = ["--set", "object.0.material=nosuch"];
    folder.prints(&[&line[..], &used].concat());
    folder.prints(&["check", "scenes/scene.toml", "--set", "material.Floor.opacity=0.5"]);
}

/// A scene with `ambient.color` could not be drawn with what was baked for it: both were "given".
#[test]
fn ambient_light_of_the_command_line_takes_the_place_of_the_scenes() {
    let folder = Folder::new();
    let scene = std::fs::read_to_string(folder.path("scene.toml")).unwrap();
    folder.write("lit.toml", format!("{scene}\n[ambient]\ncolor = [0.2, 0.2, 0.2]\n"));
    folder.prints(&["radiosity", "lit.toml", "-o", "baked.json", "--quiet"]);
    folder.prints(&["render", "lit.toml", "--set", "ambient.radiosity=baked.json", "-o", "a.png", "--quiet"]);
    folder.prints(&["check", "lit.toml", "--set", "ambient.sky=[1,1,1]", "--set", "ambient.ground=[0,0,0]"]);
    folder
        .write("twice.toml", format!("{scene}\n[ambient]\ncolor = [0, 0, 0]\nradiosity = \"baked.json\"\n"));
    folder.fails(&["check", "twice.toml"], 3, &["ambient.color", "ambient.radiosity", "are both given"]);
}
