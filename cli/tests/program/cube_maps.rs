//! Surroundings as the six faces of a cube: in a scene, in an MTL, in one picture; mirrored, seen behind everything, and looked up by normals.

use crate::common::Folder;
use crate::common::square::{VIEW, all, draw, draw_mtl, folder, picture, pixels, warnings};

const FACES: [&str; 6] = ["px.png", "nx.png", "py.png", "ny.png", "pz.png", "nz.png"];
const COLORS: [[u8; 3]; 6] =
    [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0], [0, 255, 255], [255, 0, 255]];
const DIRECTIONS: [[i32; 3]; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

fn linear(color: [u8; 3]) -> [f32; 3] {
    color.map(|byte| f32::from(byte) / 255.0)
}

/// A face of each colour, and all of them in a strip to the right and in one downward.
fn faces(folder: &Folder) {
    for (name, color) in FACES.into_iter().zip(COLORS) {
        picture(folder, name, 8, 8, |_, _| color);
    }
    picture(folder, "right.png", 48, 8, |x, _| COLORS[x as usize / 8]);
    picture(folder, "down.png", 8, 48, |_, y| COLORS[y as usize / 8]);
}

fn list() -> String {
    format!("[{}]", FACES.map(|name| format!("\"{name}\"")).join(", "))
}

/// What a narrow view from the origin towards a direction shows of the environment.
fn look(folder: &Folder, environment: &str, towards: [i32; 3]) -> Vec<[f32; 3]> {
    let up = if towards[1] == 0 { [0, 1, 0] } else { [0, 0, 1] };
    folder.write(
        "look.toml",
        format!(
            "[camera]\neye = [0, 0, 0]\ntarget = {towards:?}\nup = {up:?}\nfov = 80\n\
             [image]\nsize = [8, 8]\nenvironment = {environment}\n\
             [[object]]\nmesh = \"square.obj\"\ntranslate = [0, 900, 900]\n"
        ),
    );
    pixels(folder, "look.toml")
}

#[test]
fn each_direction_shows_its_face() {
    let folder = folder();
    faces(&folder);
    for (direction, color) in DIRECTIONS.into_iter().zip(COLORS) {
        for environment in [&list(), "\"right.png\"", "\"down.png\""] {
            all(&look(&folder, environment, direction), linear(color), 1e-6);
        }
    }
}

#[test]
fn faces_are_oriented_as_documented() {
    let folder = folder();
    let four = |x: u32, y: u32| match (x < 4, y < 4) {
        (true, true) => [255, 0, 0],
        (false, true) => [0, 255, 0],
        (true, false) => [0, 0, 255],
        (false, false) => [255; 3],
    };
    for name in FACES {
        picture(&folder, name, 8, 8, four);
    }
    // Looking along −Z, x runs to the right and −s: the picture is mirrored. Upward in it is upward in the world.
    let seen = look(&folder, &list(), [0, 0, -1]);
    for (pixel, wanted) in [(0, [0.0, 1.0, 0.0]), (7, [1.0, 0.0, 0.0]), (56, [1.0; 3])] {
        all(&seen[pixel..=pixel], wanted, 1e-6);
    }
    // Looking up with z upward, x runs to the right as s does, and t downward: the picture is upside down.
    let seen = look(&folder, &list(), [0, 1, 0]);
    for (pixel, wanted) in [(0, [0.0, 0.0, 1.0]), (7, [1.0; 3]), (56, [1.0, 0.0, 0.0])] {
        all(&seen[pixel..=pixel], wanted, 1e-6);
    }
}

#[test]
fn mirrors_and_matt_surfaces_see_the_cube() {
    let folder = folder();
    faces(&folder);
    let mirror = "diffuse = [0, 0, 0]\nreflection = 1\n";
    let matt = "diffuse = [1, 1, 1]\n";
    let mut lit = Vec::new();
    for environment in [&list(), "\"right.png\"", "\"down.png\""] {
        let scene = format!("environment = {environment}\n");
        all(&draw(&folder, &scene, mirror), linear(COLORS[4]), 1e-6);
        lit.push(draw(&folder, &format!("{scene}[ambient]\nenvironment = true\n"), matt));
    }
    assert!(lit[0] == lit[1] && lit[0] == lit[2]);
    // The part of each face in what a surface that faces +Z sees: form factors from a point to a square before it, and to those beside it.
    let before = 4.0 / (std::f32::consts::PI * 2f32.sqrt()) * (1.0 / 2f32.sqrt()).atan();
    let beside = (1.0 - before) / 4.0;
    let share = [beside, beside, beside, beside, before, 0.0];
    let wanted = |c: usize| (0..6).map(|face| share[face] * linear(COLORS[face])[c]).sum::<f32>();
    all(&lit[0], [wanted(0), wanted(1), wanted(2)], 6e-3);
    // A map of the material's own.
    let own = format!("{mirror}environment = {}\n", list());
    all(&draw(&folder, "", &own), linear(COLORS[4]), 1e-6);
}

#[test]
fn plain_models_stand_in_a_cube_of_six_pictures() {
    let folder = folder();
    faces(&folder);
    let model = ["render", "square.obj", "--size", "24x24", "--float", "--overwrite", "-o", "m.exr"];
    let draw = |env: &str| {
        folder.prints(&[&model[..], &["--env", env]].concat());
        std::fs::read(folder.path("m.exr")).expect("a picture")
    };
    // The same cube in one picture gives the same bytes, but for the fingerprint.
    let six = FACES.join(",");
    let seen = |bytes: &[u8]| {
        let file = pointillist_cli::image_io::ExrFile::read(bytes).expect("EXR");
        ["R", "G", "B", "A"].map(|c| file.plane(c).expect("a channel"))
    };
    assert_eq!(seen(&draw(&six)), seen(&draw("right.png")));
    assert_ne!(seen(&draw(&six)), seen(&draw("px.png")));
    let fails = |env: &str, code: i32, pieces: &[&str]| {
        folder.fails(&[&model[..], &["--env", env]].concat(), code, pieces);
    };
    fails("px.png,nx.png", 2, &["--env", "2 pictures", "+X,-X,+Y,-Y,+Z,-Z"]);
    fails("px.png,,py.png", 2, &["--env", "empty"]);
    fails("", 2, &["--env", "empty"]);
    fails(&six.replace("pz", "lost"), 3, &["--env", "lost.png", "cannot be read"]);
    picture(&folder, "wide.png", 8, 4, |_, _| [0; 3]);
    fails(&six.replace("ny", "wide"), 3, &["wide.png", "all six faces of a cube must be 8×8"]);
    // A comma in the name of a file that is there is part of the name.
    std::fs::copy(folder.path("right.png"), folder.path("a,b.png")).expect("copied");
    assert_eq!(seen(&draw("a,b.png")), seen(&draw(&six)));
    folder.fails(
        &["render", "scene.toml", "--env", &six],
        2,
        &["--env is for models", "--set 'image.environment=[\"px.png\",\"nx.png\""],
    );
}

#[test]
fn maps_are_looked_up_by_normals_where_that_is_asked_for() {
    let folder = folder();
    faces(&folder);
    let seen = |lookup: &str| {
        let scene = format!(
            "{VIEW}environment = {}\n[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\nrotate = [0, 30, 0]\n\
             [material.m]\ndiffuse = [0, 0, 0]\nreflection = 1\n{lookup}",
            list()
        );
        folder.write("n.toml", scene);
        pixels(&folder, "n.toml")[27]
    };
    // Turned by 30° from the eye: the mirrored view goes off at 60°, to +X; the normal points to +Z.
    assert_eq!(seen(""), linear(COLORS[0]));
    assert_eq!(seen("environment_lookup = \"reflection\"\n"), linear(COLORS[0]));
    assert_eq!(seen("environment_lookup = \"normal\"\n"), linear(COLORS[4]));
    draw(&folder, "", "environment_lookup = \"normal\"\n");
    assert!(warnings(&folder, "m.toml").contains("`material.m.environment_lookup` has no effect"));
}

#[test]
fn mtl_has_cubes_of_six_lines() {
    let folder = folder();
    faces(&folder);
    let kinds = ["right", "left", "top", "bottom", "front", "back"];
    let line = |i: usize| format!("refl -type cube_{} {}\n", kinds[i], FACES[i]);
    let six: String = (0..6).map(line).collect();
    all(&draw_mtl(&folder, "", &format!("Kd 0 0 0\n{six}")), linear(COLORS[4]), 1e-6);
    assert_eq!(warnings(&folder, "o.toml"), "");
    let five: String = (0..5).map(line).collect();
    all(&draw_mtl(&folder, "", &format!("Kd 0 0 0\n{five}")), [0.0; 3], 0.0);
    assert!(
        warnings(&folder, "o.toml")
            .contains("`refl` of material `m` has faces of a cube, but no -type cube_back")
    );
    draw_mtl(&folder, "", "Kd 0 0 0\nrefl -type cylinder px.png\n");
    assert!(warnings(&folder, "o.toml").contains("is of -type cylinder"));
    // One picture may be a strip.
    all(&draw_mtl(&folder, "", "Kd 0 0 0\nrefl right.png\n"), linear(COLORS[4]), 1e-6);
    std::fs::remove_file(folder.path("py.png")).expect("it was there");
    folder.write("m.mtl", format!("newmtl m\nKd 0 0 0\n{six}"));
    folder.fails(&["check", "o.toml"], 3, &["m.mtl:5", "py.png", "cannot be read", "cube_top"]);
}

#[test]
fn wrong_cubes_name_the_face() {
    let folder = folder();
    faces(&folder);
    let refused = |environment: &str, pieces: &[&str]| {
        folder.write(
            "w.toml",
            format!("{VIEW}environment = {environment}\n[[object]]\nmesh = \"square.obj\"\n"),
        );
        folder.fails(&["check", "w.toml"], 3, pieces);
    };
    refused("[\"px.png\", \"nx.png\"]", &["`image.environment` names 2 pictures", "+X, -X, +Y, -Y, +Z, -Z"]);
    refused("[1, 2]", &["`image.environment`", "a string or a list of strings"]);
    refused("\"\"", &["`image.environment` is empty"]);
    picture(&folder, "ny.png", 8, 4, |_, _| [0; 3]);
    refused(&list(), &["w.toml:7:", "ny.png", "is 8×4; all six faces of a cube must be 8×8"]);
    refused(&list().replace("pz.png", "lost.png"), &["lost.png", "cannot be read"]);
}
