//! Scenes that move: `--frames`, `--turntable`, paths of the camera and of objects.

use crate::common::{Folder, SCENE};
use serde_json::Value;
use std::fs;

/// A camera that moves, nothing else.
const WALK: &str = r#"[camera]
eye = [0, 0.5, 4]
target = [0, 0.5, 0]
fov = 40
[camera.path]
times = [0, 4]
eye = [[0, 0.5, 4], [2, 0.5, 4]]
[image]
size = [24, 16]
[[object]]
mesh = "triangle.obj"
[[light]]
name = "lamp"
type = "point"
position = [1, 2, 3]
intensity = [30, 30, 30]
"#;

/// The scene of the tests with an object on a path.
fn moving(path: &str) -> String {
    SCENE.replace("mesh = \"triangle.obj\"", &format!("mesh = \"triangle.obj\"\npath = {{ {path} }}"))
}

fn stats(folder: &Folder) -> Value {
    serde_json::from_slice(&fs::read(folder.path("s.json")).unwrap()).unwrap()
}

fn same(folder: &Folder, a: &str, b: &str) -> bool {
    fs::read(folder.path(a)).unwrap() == fs::read(folder.path(b)).unwrap()
}

/// The largest difference between two pictures.
fn difference(folder: &Folder, a: &str, b: &str) -> f64 {
    let text = folder.prints(&["compare", a, b]);
    serde_json::from_str::<Value>(&text).unwrap()["rmse"].as_f64().unwrap()
}

#[test]
fn a_moving_camera_shares_what_is_prepared_and_shows_what_it_shows_alone() {
    let folder = Folder::new();
    folder.write("walk.toml", WALK);
    folder.prints(&["render", "walk.toml", "--frames", "0-5", "-o", "w.{frame:03}.exr", "--stats", "s.json"]);
    let counts = &stats(&folder)["counts"];
    assert_eq!((counts["pictures"].as_u64(), counts["preparations"].as_u64()), (Some(6), Some(1)));
    // Each frame by itself, and without its path.
    folder.prints(&["render", "walk.toml", "--frames", "3-3", "-o", "alone.exr"]);
    assert!(same(&folder, "w.003.exr", "alone.exr"));
    folder.prints(&["render", "walk.toml", "--eye", "1.5,0.5,4", "-o", "still.exr"]);
    assert!(same(&folder, "w.003.exr", "still.exr"));
    // After its last time it stands still.
    folder.prints(&["render", "walk.toml", "--set", "camera.eye=[2, 0.5, 4]", "-o", "end.exr"]);
    assert!(same(&folder, "w.005.exr", "end.exr") && same(&folder, "w.004.exr", "w.005.exr"));
    folder.prints(&["render", "walk.toml", "-o", "plain.exr"]);
    assert!(same(&folder, "w.000.exr", "plain.exr"));
    assert!(!same(&folder, "w.000.exr", "w.001.exr"));
}

#[test]
fn an_object_on_a_path_is_where_a_still_one_would_be() {
    let folder = Folder::new();
    let still = |name: &str, keys: &str| {
        let text = SCENE.replace("mesh = \"triangle.obj\"", &format!("mesh = \"triangle.obj\"\n{keys}"));
        folder.write("still.toml", text);
        folder.prints(&["render", "still.toml", "--float", "-o", name, "--overwrite"]);
    };
    folder.write("m.toml", moving("times = [2, 6], translate = [[0, 0, 0], [1, 0.5, -1]]"));
    folder.prints(&["render", "m.toml", "--float", "--frames", "0-8", "-o", "m.{frame}.exr"]);
    for (frame, keys) in
        [(0, "scale = 1"), (4, "translate = [0.5, 0.25, -0.5]"), (8, "translate = [1, 0.5, -1]")]
    {
        still("still.exr", keys);
        let error = difference(&folder, &format!("m.{frame}.exr"), "still.exr");
        assert!(error < 1e-6, "frame {frame}: {error}");
    }
    folder.prints(&["render", "m.toml", "--float", "--frames", "5-5", "-o", "alone.exr"]);
    assert!(same(&folder, "m.5.exr", "alone.exr"), "the frames before leave nothing behind");
    // Turned about its own origin, then placed; the scale stays.
    folder.write(
        "r.toml",
        moving("times = [0, 10], rotate = [[0, 0, 0], [0, 90, 0]]")
            .replace("path =", "scale = 0.8\ntranslate = [0.2, 0, 0]\npath ="),
    );
    folder.prints(&["render", "r.toml", "--float", "--frames", "3-3", "-o", "r.exr"]);
    still("still.exr", "scale = 0.8\ntranslate = [0.2, 0, 0]\nrotate = [0, 27, 0]");
    assert!(difference(&folder, "r.exr", "still.exr") < 1e-6);
    // With normals that were made, which turn along.
    folder.write("tent.obj", "v -1 0 0\nv 0 0 0.5\nv 1 0 0\nv 0 1.5 0\nf 1 2 4\nf 2 3 4\n");
    let smooth = |text: String| text.replace("triangle.obj", "tent.obj") + "[render]\nshading = \"phong\"\n";
    folder.write("t.toml", smooth(moving("times = [0, 10], rotate = [[0, 0, 0], [0, 90, 0]]")));
    folder.prints(&["render", "t.toml", "--float", "--frames", "3-3", "-o", "t.exr"]);
    folder.write("u.toml", smooth(SCENE.replace("mesh =", "rotate = [0, 27, 0]\nmesh =")));
    folder.prints(&["render", "u.toml", "--float", "-o", "u.exr"]);
    assert!(difference(&folder, "t.exr", "u.exr") < 1e-6);
}

#[test]
fn frames_that_are_there_are_kept() {
    let folder = Folder::new();
    folder.write("walk.toml", WALK);
    let line = ["render", "walk.toml", "--frames", "0-3", "-o", "w.{frame}.exr", "--stats", "s.json"];
    folder.prints(&line);
    fs::remove_file(folder.path("w.2.exr")).unwrap();
    folder.prints(&line);
    let stats = stats(&folder);
    assert_eq!((&stats["counts"]["pictures"], &stats["skipped"]["pictures_there"]), (&1.into(), &3.into()));
}

#[test]
fn progress_of_a_film_goes_from_0_to_100_once() {
    let folder = Folder::new();
    folder.write("walk.toml", WALK);
    let line = ["render", "walk.toml", "--frames", "0-3", "-o", "w.{frame}.png", "--progress", "openjd"];
    let lines = folder.prints(&line);
    let percent = |line: &str| line.strip_prefix("openjd_progress: ").unwrap().parse::<u32>().unwrap();
    let numbers: Vec<u32> = lines.lines().map(percent).collect();
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]), "{numbers:?}");
    assert!(
        numbers.first() == Some(&0) && numbers.last() == Some(&100) && numbers.contains(&50),
        "{numbers:?}"
    );
}

#[test]
fn a_turntable_goes_around_a_plain_model() {
    let folder = Folder::new();
    let line = ["render", "triangle.obj", "--size", "24x16", "--turntable", "4"];
    folder.prints(&[&line[..], &["-o", "t.{frame:02}.exr", "--stats", "s.json"]].concat());
    assert_eq!(stats(&folder)["counts"]["preparations"], 1);
    folder.prints(&["render", "triangle.obj", "--size", "24x16", "-o", "front.exr"]);
    assert!(same(&folder, "t.00.exr", "front.exr"));
    assert!(difference(&folder, "t.00.exr", "t.01.exr") > 0.01);
    // A part of the views, and a name by default.
    folder.prints(&[&line[..], &["--frames", "1-2", "-o", "p.{frame}.exr"]].concat());
    assert!(same(&folder, "t.02.exr", "p.2.exr") && !folder.path("p.3.exr").exists());
    folder.prints(&line);
    assert!(folder.path("triangle.0003.png").exists());
    // Seen from behind, it is lit as brightly: the light goes with the camera.
    folder.prints(&["render", "triangle.obj", "--size", "24x16", "--turntable", "2", "-o", "h.{frame}.exr"]);
    assert!(difference(&folder, "h.0.exr", "h.1.exr") < 0.2);
    folder.fails(
        &["render", "scene.toml", "--turntable", "4", "-o", "a.{frame}.png"],
        2,
        &["--turntable", "[camera.path]"],
    );
    folder.fails(&[&line[..], &["--frames", "2-4"]].concat(), 2, &["--frames 2-4", "frames 0 to 3"]);
    folder.fails(&["render", "triangle.obj", "--turntable", "0"], 2, &["--turntable"]);
}

/// What is said of a turntable of a bar of this size.
fn said_of_a_bar(folder: &Folder, [x, y, z]: [f64; 3], options: &[&str]) -> String {
    let bar =
        format!("v 0 0 0\nv {x} 0 0\nv {x} {y} {z}\nv 0 {y} {z}\nv 0 0 {z}\nf 1 2 3\nf 1 4 5\nf 2 3 5\n");
    folder.write("bar.obj", bar);
    let line = ["render", "bar.obj", "--size", "96x64", "--turntable", "4", "-o", "b.{frame}.png"];
    let run = folder.command(&[&line[..], options].concat()).output().expect("the command runs");
    assert!(run.status.success());
    String::from_utf8_lossy(&run.stderr).into_owned()
}

#[test]
fn a_turntable_that_cuts_the_model_off_says_from_where_it_would_not() {
    let folder = Folder::new();
    let said = said_of_a_bar(&folder, [0.1, 0.1, 3.0], &[]);
    let (_, rest) = said.split_once("reaches beyond others; `--eye ").unwrap_or_else(|| panic!("{said}"));
    let eye = rest.split('`').next().unwrap_or_default();
    assert!(!said_of_a_bar(&folder, [0.1, 0.1, 3.0], &["--eye", eye]).contains("reaches beyond"));
    // From there no view reaches the border of the picture, and without it some do.
    let edge = |frame: u32| {
        let picture = image::open(folder.path(&format!("b.{frame}.png"))).expect("a picture").to_rgba8();
        let (width, height) = picture.dimensions();
        picture
            .enumerate_pixels()
            .any(|(x, y, p)| (x % (width - 1) == 0 || y % (height - 1) == 0) && p.0[3] > 0)
    };
    assert!((0..4).all(|frame| !edge(frame)));
    said_of_a_bar(&folder, [0.1, 0.1, 3.0], &[]);
    assert!((0..4).any(edge));
    assert!(!said_of_a_bar(&folder, [0.1, 3.0, 0.1], &[]).contains("reaches beyond"));
}

#[test]
fn names_without_a_place_for_the_frame_are_refused() {
    let folder = Folder::new();
    folder.write("walk.toml", WALK);
    let fails = |options: &[&str], pieces: &[&str]| {
        folder.fails(&[&["render", "walk.toml"], options].concat(), 2, pieces);
    };
    fails(&["--frames", "1-2", "-o", "a.png"], &["2 frames need {frame}", "a.{frame:04}.png"]);
    fails(&["-o", "a.{frame}.png"], &["{frame} is for --frames"]);
    fails(&["--frames", "1-2", "-o", "a.{frame:x}.png"], &["{frame:04} for four digits"]);
    for wrong in ["2-1", "a-b", "1-2-3", "", "99999999"] {
        fails(&["--frames", wrong, "-o", "a.{frame}.png"], &["--frames"]);
    }
    let run =
        folder.command(&["render", "scene.toml", "--frames", "0-1", "-o", "a.{frame}.png"]).output().unwrap();
    assert!(String::from_utf8_lossy(&run.stderr).contains("warning: nothing in the scene moves"));
    assert!(same(&folder, "a.0.png", "a.1.png"));
}

#[test]
fn paths_that_cannot_be_followed_are_named() {
    let folder = Folder::new();
    let camera = |path: &str, pieces: &[&str]| {
        let (_, rest) = WALK.split_once("[image]").unwrap();
        let (head, _) = WALK.split_once("[camera.path]").unwrap();
        folder.write("bad.toml", format!("{head}[camera.path]\n{path}\n[image]{rest}"));
        folder.fails(&["render", "bad.toml", "--frames", "0-9", "-o", "a.{frame}.png"], 3, pieces);
    };
    camera(
        "times = [0, 5, 5]\neye = [[0,0,1],[0,0,2],[0,0,3]]",
        &["bad.toml:6", "`camera.path.times[2]` is 5", "increase"],
    );
    camera(
        "times = [0, 5]\neye = [[0,0,1]]",
        &["`camera.path.eye` has 1 entries, and `times` has 2", "each time needs one value"],
    );
    camera("times = []\neye = []", &["`camera.path.times` is empty"]);
    camera("times = [0, nan]\neye = [[0,0,1],[0,0,2]]", &["`camera.path.times`", "nan", "finite"]);
    camera("times = [0, 1]\neye = [[0,0,1],[0,inf,2]]", &["`camera.path.eye`", "inf"]);
    camera("times = [0, 1]", &["`camera.path` moves nothing", "add eye"]);
    camera("eye = [[0,0,1]]", &["`camera.path` needs `times`", "add times = [0, 24]"]);
    camera("times = [0]\neye = [[0,0,1]]\ninterpolation = \"linaer\"", &["did you mean \"linear\"?"]);
    camera("times = [0]\neye = [[0,0,1]]\neyes = 3", &["unknown key `camera.path.eyes`"]);
    // Through its target on the way.
    camera(
        "times = [0, 8]\neye = [[0,0.5,4],[0,0.5,-4]]",
        &["`camera.path` at frame 4", "eye and target are the same point"],
    );
    // And before anybody draws it.
    folder.fails(&["check", "bad.toml"], 3, &["`camera.path` at frame 4"]);
    let object = |path: &str, pieces: &[&str]| {
        folder.write("bad.toml", moving(path));
        folder.fails(&["render", "bad.toml", "--frames", "0-9", "-o", "a.{frame}.png"], 3, pieces);
    };
    object(
        "times = [3, 2], translate = [[0,0,0],[0,0,0]]",
        &["`object[0].path.times[1]` is 2", "the 3 before it"],
    );
    object("times = [0, 2], rotate = [[0,0,0]]", &["`object[0].path.rotate` has 1 entries"]);
    object("times = [0, 2]", &["`object[0].path` moves nothing"]);
    object("times = [0, 4], translate = [[0,0,0],[1e25,0,0]]", &["at frame 1, vertex 0", "±1e18"]);
    assert!(!folder.path("a.1.png").exists());
}

#[test]
fn an_eye_of_the_command_line_stands_still() {
    let folder = Folder::new();
    folder.write("walk.toml", WALK);
    let line = ["render", "walk.toml", "--eye", "1,1,4", "--frames", "2-3", "-o", "a.{frame}.exr"];
    folder.prints(&line);
    assert!(same(&folder, "a.2.exr", "a.3.exr"));
    folder.prints(&["render", "walk.toml", "--eye", "1,1,4", "-o", "b.exr"]);
    assert!(same(&folder, "a.2.exr", "b.exr"));
}
