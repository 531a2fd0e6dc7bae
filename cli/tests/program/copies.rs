//! `copies` of an object: the same pictures as objects that are written out, with less to write and to hold.

use crate::common::{Folder, SCENE};
use pointillist_cli::scene::{Overrides, load};
use serde_json::Value;

/// A triangle with texture coordinates.
const CARD: &str = "v -1 0 0\nv 1 0 0\nv 0 1.5 0\nvt 0 0\nvt 1 0\nvt 0.5 1\nf 1/1 2/2 3/3\n";

/// The scene of the tests with these objects in place of its own.
fn scene_of(objects: &str) -> String {
    SCENE.replace("[[object]]\nmesh = \"triangle.obj\"\n", objects)
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("card.obj", CARD);
    folder
}

/// The largest difference of two scenes' pictures, all layers drawn.
fn rmse(folder: &Folder, [a, b]: [&str; 2], more: &[&str]) -> f64 {
    for (scene, output) in [(a, "a.exr"), (b, "b.exr")] {
        folder.prints(&[&["render", scene, "--layers", "all", "--overwrite", "-o", output], more].concat());
    }
    let text = folder.prints(&["compare", "a.exr", "b.exr"]);
    serde_json::from_str::<Value>(&text).unwrap()["rmse"].as_f64().unwrap()
}

const OWN: &str = "scale = 0.4\nrotate = [0, 20, 0]\n";

#[test]
fn copies_are_objects_that_are_placed_once_more() {
    let folder = folder();
    let copies = "copies = [{ translate = [-0.6, 0, 0] }, { translate = [0.5, 0.3, 0], rotate = [0, 0, 30], scale = [1, 2, 1] }, \
                  { matrix = [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0.9,0,1] }]\n";
    folder.write(
        "copies.toml",
        scene_of(&format!("[[object]]\nname = \"card\"\nmesh = \"card.obj\"\n{OWN}{copies}")),
    );
    // The same written out: turning by 20° and scaling evenly go with the copy's own transform into one matrix.
    let (sine, cosine) = 20f64.to_radians().sin_cos();
    let own = glam::DMat3::from_cols_array(&[cosine, 0.0, -sine, 0.0, 1.0, 0.0, sine, 0.0, cosine]) * 0.4;
    let turned = glam::DMat3::from_rotation_z(30f64.to_radians())
        * glam::DMat3::from_diagonal(glam::dvec3(1.0, 2.0, 1.0));
    let mirrored = glam::DMat3::from_diagonal(glam::dvec3(-1.0, 1.0, 1.0));
    let placed =
        [(glam::DMat3::IDENTITY, [-0.6, 0.0, 0.0]), (turned, [0.5, 0.3, 0.0]), (mirrored, [0.0, 0.9, 0.0])];
    let object = |(linear, [x, y, z]): (glam::DMat3, [f64; 3])| {
        let m = (linear * own).to_cols_array_2d();
        let columns: Vec<String> = m.iter().map(|[a, b, c]| format!("{a}, {b}, {c}, 0")).collect();
        // A file of its own, so that it is stored by itself.
        let file = format!("card{}.obj", y * 10.0);
        folder.write(&file, CARD);
        format!("[[object]]\nmesh = \"{file}\"\nmatrix = [{}, {x}, {y}, {z}, 1]\n", columns.join(", "))
    };
    folder.write("objects.toml", scene_of(&placed.map(object).concat()));
    assert!(rmse(&folder, ["copies.toml", "objects.toml"], &[]) < 1e-6);
    folder.prints(&["compare", "a.exr", "b.exr", "--max-rmse", "1e-6"]);
    // And they are there at all.
    folder.write("one.toml", scene_of(&format!("[[object]]\nmesh = \"card.obj\"\n{OWN}")));
    assert!(rmse(&folder, ["copies.toml", "one.toml"], &[]) > 0.01);
    let info: Value = serde_json::from_str(&folder.prints(&["info", "copies.toml"])).unwrap();
    assert_eq!(info["objects"], serde_json::json!(["card[0]", "card[1]", "card[2]"]));
}

#[test]
fn copies_of_a_file_are_those_of_a_list() {
    let folder = folder();
    let list = "copies = [{ translate = [-0.6, 0, 0] }, { translate = [0.5, 0.3, 0], rotate = [0, 0, 30] }, \
                { translate = [0, 0.5, 0.1], rotate = [10, 0, 0], scale = 0.5 }, \
                { translate = [0, 1, 0.1], scale = [0.5, 0.25, 1] }, { matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 0.2,-0.5,0,1] }]\n";
    folder.write("list.toml", scene_of(&format!("[[object]]\nmesh = \"card.obj\"\n{OWN}{list}")));
    let lines = "# five cards\n-0.6 0 0\n\n0.5 0.3 0 0 0 30\n0 0.5 0.1  10 0 0  0.5\n0, 1, 0.1, 0, 0, 0, 0.5, 0.25, 1\n\
                 1 0 0 0 0 1 0 0 0 0 1 0 0.2 -0.5 0 1\n";
    folder.write("cards.txt", lines);
    folder.write(
        "file.toml",
        scene_of(&format!("[[object]]\nmesh = \"card.obj\"\n{OWN}copies = \"cards.txt\"\n")),
    );
    assert_eq!(rmse(&folder, ["list.toml", "file.toml"], &[]), 0.0);
}

#[test]
fn copies_share_what_is_the_same_for_all() {
    let folder = folder();
    let objects = "[[object]]\nmesh = \"card.obj\"\ncopies = [{}, { translate = [1, 0, 0] }]\n[[object]]\nmesh = \"card.obj\"\n";
    folder.write("scene.toml", scene_of(objects));
    let mesh = load(&folder.path("scene.toml"), &Overrides::default()).unwrap().scene.mesh;
    assert_eq!((mesh.triangle_count(), mesh.triangles.len(), mesh.instances().len()), (3, 0, 3));
    let [shape] = mesh.shapes() else { panic!("{} shapes", mesh.shapes().len()) };
    assert_eq!((shape.triangles.len(), shape.positions.len(), shape.uvs.len()), (1, 3, 3));
    // What has another material, stands in one place or moves is stored where it stands.
    let path = "path = { times = [0, 10], translate = [[0, 0, 0], [1, 0, 0]] }";
    let red = "[material.red]\nmodel = \"lambert\"\ndiffuse = [1, 0, 0]\n";
    for (line, triangles, shapes) in [
        ("material = \"red\"".to_owned(), 1, 1),
        ("material = \"red\"\ncopies = [{}, {}]".to_owned(), 0, 2),
        (format!("{path}\ncopies = [{{}}, {{}}]"), 2, 1),
    ] {
        let text = scene_of(&format!("{objects}[[object]]\nmesh = \"card.obj\"\n{line}\n"));
        folder.write("scene.toml", text + red);
        let mesh = load(&folder.path("scene.toml"), &Overrides::default()).unwrap().scene.mesh;
        assert_eq!((mesh.triangles.len(), mesh.shapes().len()), (triangles, shapes), "{line}");
    }
}

#[test]
fn a_further_copy_takes_next_to_no_memory() {
    let folder = Folder::new();
    let vertices: String = (0..1000).map(|i| format!("v {i} {} 0\n", i % 2)).collect();
    let faces: String = (1..=998).map(|i| format!("f {i} {} {}\n", i + 1, i + 2)).collect();
    folder.write("strip.obj", vertices + &faces);
    let bytes = |copies: usize| {
        let places: Vec<String> = (0..copies).map(|i| format!("{{ translate = [0, {i}, 0] }}")).collect();
        let object = format!("[[object]]\nmesh = \"strip.obj\"\ncopies = [{}]\n", places.join(", "));
        folder.write("scene.toml", scene_of(&object));
        let info: Value = serde_json::from_str(&folder.prints(&["info", "scene.toml"])).unwrap();
        assert_eq!(info["triangles"], 998 * copies);
        info["memory_bytes"].as_u64().unwrap()
    };
    let further = (bytes(300) - bytes(100)) / (200 * 998);
    assert!(further < 10, "{further} bytes a triangle");
}

#[test]
fn copies_of_what_moves_move_each_in_its_place() {
    let folder = folder();
    let path =
        "path = { times = [0, 10], translate = [[0, 0, 0], [1, 0, 0]], rotate = [[0, 0, 0], [0, 60, 0]] }\n";
    let still = "translate = [0.5, 0, 0]\nrotate = [0, 30, 0]\n";
    let copies =
        "scale = 0.4\ncopies = [{ translate = [-0.5, 0, 0] }, { rotate = [0, 0, 90], scale = [1, 2, 1] }]\n";
    for (name, placed) in [("moving.toml", path), ("still.toml", still)] {
        let text = scene_of(&format!("[[object]]\nmesh = \"card.obj\"\n{copies}{placed}"));
        folder.write(name, text.replace("[image]", "[render]\nshading = \"phong\"\n[image]"));
    }
    folder.prints(&["render", "moving.toml", "--frames", "5-5", "-o", "m.exr"]);
    folder.prints(&["render", "still.toml", "-o", "s.exr"]);
    folder.prints(&["compare", "m.exr", "s.exr", "--max-rmse", "1e-6"]);
    folder.prints(&["render", "moving.toml", "--frames", "0-0", "-o", "start.exr"]);
    folder.fails(&["compare", "m.exr", "start.exr", "--max-rmse", "1e-3"], 5, &["RMSE"]);
}

#[test]
fn what_is_wrong_with_copies_is_told_with_its_place() {
    let folder = folder();
    let with = |line: &str| scene_of(&format!("[[object]]\nmesh = \"card.obj\"\n{line}\n"));
    let wrong = [
        ("copies = []", "`object[0].copies` is empty"),
        ("copies = 4", "a list of tables"),
        ("copies = [{ translate = [0, 0] }]", "object[0].copies[0].translate"),
        ("copies = [{}, { turn = [0, 0, 1] }]", "object[0].copies[1].turn"),
        ("copies = [{ scale = 0 }]", "flatten"),
        ("copies = \"none.txt\"", "`none.txt` is not there"),
        ("scale = 1e9\ncopies = [{}, { scale = 1e15 }]", "of copy 1"),
    ];
    for (line, piece) in wrong {
        folder.write("scene.toml", with(line));
        folder.fails(&["check", "scene.toml"], 3, &[piece]);
    }
    folder.write("scene.toml", with("copies = \"cards.txt\""));
    let wrong = [
        ("# nothing\n", "has no copies"),
        ("0 0 0\n1 2 3 4\n", "4 numbers"),
        ("0 0 0\n1 2 x\n", "`x` is not a number"),
        ("0 0 0\n0 0 0 0 0 0 0\n", "the scale is 0"),
        ("0 0 0\n1 0 0 0 0 1 0 0 0 0 1 1 0 0 0 1\n", "the last row"),
    ];
    for (lines, piece) in wrong {
        folder.write("cards.txt", lines);
        folder.fails(&["check", "scene.toml"], 3, &["cards.txt", piece]);
        if lines.starts_with('0') {
            folder.fails(&["check", "scene.toml"], 3, &["cards.txt:2"]);
        }
    }
    folder.write("cards.txt", "0 0 0\n".repeat(100_000));
    folder.fails(
        &["check", "scene.toml", "--memory", "40MiB"],
        3,
        &["100000 copies of 1 triangles", "memory"],
    );
}
