//! Pictures for the impatient: `--preview`, `--watch`, `--time-budget`, `--error`.

use crate::common::{Folder, SCENE, TRIANGLE};
use pointillist_cli::image_io::{ExrFile, read_picture};
use serde_json::Value;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

fn stats(folder: &Folder, name: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.path(name)).unwrap()).unwrap()
}

fn rmse(folder: &Folder, a: &str, b: &str) -> f64 {
    let result: Value = serde_json::from_str(&folder.prints(&["compare", a, b])).unwrap();
    result["rmse"].as_f64().unwrap()
}

#[test]
fn a_preview_is_printed_and_no_file_is_written() {
    let folder = Folder::new();
    let before = folder.names();
    let text = folder.prints(&["render", "scene.toml", "--preview", "--quiet"]);
    assert_eq!(folder.names(), before);
    // 16 : 12 in 80 columns and 22 rows of two pixels.
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 22);
    for line in &lines {
        assert_eq!(line.matches('▀').count(), 59, "{line:?}");
        assert!(line.ends_with("\x1b[0m"));
    }
    assert!(text.contains("\x1b[38;2;0;0;0m"), "the background is not black");
    assert!(text.matches("\x1b[38;2;0;0;0m").count() < 22 * 59, "the triangle is not seen");
    folder.prints(&["render", "scene.toml", "--preview", "-o", "p.png", "--quiet"]);
    assert!(folder.path("p.png").is_file());
    folder.fails(&["render", "scene.toml", "--preview", "--layers", "N"], 2, &["--layers", "add -o"]);
    folder.fails(&["render", "scene.toml", "--preview", "--crop", "0,0,4,4"], 2, &["--crop"]);
}

/// Ends the program, whatever becomes of the test.
struct Watcher(Child);

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn wait_until(what: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "{what} did not happen");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn a_watched_scene_is_drawn_again_when_a_file_of_it_changes() {
    let folder = Folder::new();
    let mut command = std::process::Command::new(assert_cmd::cargo::cargo_bin!("pointillist"));
    let line = ["render", "scene.toml", "--watch", "--bg", "black", "-o", "p.png"];
    command.current_dir(folder.path("")).args(line).stderr(Stdio::null());
    let _watcher = Watcher(command.spawn().unwrap());
    let covered = || {
        let picture = read_picture(&folder.path("p.png")).map(|p| p.color).unwrap_or_default();
        picture.iter().filter(|pixel| pixel[0] > 0.0).count()
    };
    wait_until("the first picture", || covered() > 0);
    let first = covered();
    // The mesh, which the scene names.
    folder.write("triangle.obj", "v -0.2 0 0\nv 0.2 0 0\nv 0 0.3 0\nf 1 2 3\n");
    wait_until("a smaller triangle", || (1..first).contains(&covered()));
    // A fault is waited out.
    folder.write("scene.toml", "[camera\n");
    std::thread::sleep(Duration::from_millis(500));
    folder.write("triangle.obj", TRIANGLE);
    folder.write("scene.toml", SCENE.replace("[16, 12]", "[32, 24]"));
    wait_until("a larger picture", || covered() > 2 * first);
    folder.fails(&["render", "--watch"], 2, &["needs a SCENE"]);
    folder.fails(&["render", "-", "--watch"], 2, &["standard input"]);
}

#[test]
fn a_picture_is_complete_whatever_its_time() {
    let folder = Folder::new();
    let scene = SCENE.replace("[16, 12]", "[400, 300]");
    folder.write("scene.toml", scene);
    let draw = |name: &str, more: &[&str]| {
        let line = ["render", "scene.toml", "--float", "--layers", "N", "-o", name, "--stats", "s.json"];
        folder.prints(&[&line[..], more].concat());
        ExrFile::read(&std::fs::read(folder.path(name)).unwrap()).unwrap()
    };
    let plain = draw("plain.exr", &[]);
    let ample = draw("ample.exr", &["--time-budget", "100"]);
    assert_eq!(plain, ample, "with time enough it is the same picture");
    assert_eq!(stats(&folder, "s.json")["counts"]["tiles_coarse"], 0);
    // No time at all: the coarsest picture, which covers what the fine one covers.
    let hasty = draw("hasty.exr", &["--time-budget", "0.000001"]);
    assert!(stats(&folder, "s.json")["counts"]["tiles_coarse"].as_u64() > Some(0));
    let sum = |file: &ExrFile| file.plane("A").unwrap().iter().sum::<f32>();
    assert!((sum(&hasty) / sum(&plain) - 1.0).abs() < 0.02, "{} is not {}", sum(&hasty), sum(&plain));
    assert!(rmse(&folder, "hasty.exr", "plain.exr") < 0.15);
    // It is not taken for the picture itself, nor the other way round.
    assert_ne!(hasty.stamp, plain.stamp);
    draw("hasty.exr", &[]);
    assert_eq!(rmse(&folder, "hasty.exr", "plain.exr"), 0.0);
    folder.fails(&["render", "scene.toml", "--time-budget", "1", "--tile", "0/2"], 2, &["--tile"]);
}

#[test]
fn an_error_that_is_asked_for_chooses_the_cells() {
    let folder = Folder::new();
    // A narrow highlight, which cells of a pixel's size do not resolve.
    let ball = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/ball.obj"));
    let Ok(ball) = ball else { return };
    let ball: String =
        ball.lines().filter(|line| !line.starts_with("mtllib")).map(|l| format!("{l}\n")).collect();
    folder.write("ball.obj", ball);
    folder.write(
        "ball.toml",
        "[image]\nsize = [96, 96]\n[[object]]\nmesh = \"ball.obj\"\nmaterial = \"m\"\n[render]\nshading = \"phong\"\n\
         [material.m]\nmodel = \"phong\"\nspecular = 0.6\nshininess = 4000\n[[light]]\ntype = \"directional\"\n\
         direction = [-1, -1, -1]\nirradiance = [3, 3, 3]\n",
    );
    let choose = |error: &str| {
        let line = ["render", "ball.toml", "--error", error, "--float", "-o", "e.exr", "--stats", "s.json"];
        folder.prints(&line);
        let stats = stats(&folder, "s.json");
        (stats["counts"]["cells_per_pixel_side"].as_u64().unwrap(), stats["expected_rmse"].as_f64().unwrap())
    };
    let (coarse, loose) = choose("10");
    assert_eq!(coarse, 1);
    let (fine, tight) = choose("1e-9");
    assert_eq!(fine, 4);
    assert!(tight < loose, "{tight} is not less than {loose}");
    // The picture is the one with these cells.
    folder.prints(&["render", "ball.toml", "--set", "render.subpixel=4", "--float", "-o", "four.exr"]);
    assert_eq!(rmse(&folder, "e.exr", "four.exr"), 0.0);
    // What is believed of one cell a pixel is what it differs from many by.
    folder.prints(&["render", "ball.toml", "--set", "render.subpixel=1", "--float", "-o", "one.exr"]);
    let truth = rmse(&folder, "one.exr", "four.exr");
    assert!(loose < 2.0 * truth && truth < 2.0 * loose, "{loose} is believed of {truth}");
    folder.fails(&["render", "ball.toml", "--error", "1e-9", "-o", "n.png"], 0, &["not reached"]);
    folder.fails(&["render", "ball.toml", "--error", "1", "--time-budget", "1"], 2, &["--time-budget"]);
    // Tiles choose alike, or they could not be joined.
    for (tile, name) in [("0/2", "t0.exr"), ("1/2", "t1.exr")] {
        folder.prints(&["render", "ball.toml", "--error", "1e-9", "--float", "--tile", tile, "-o", name]);
    }
    folder.prints(&["merge", "t0.exr", "t1.exr", "-o", "t.exr"]);
    assert_eq!(rmse(&folder, "t.exr", "four.exr"), 0.0);
}
