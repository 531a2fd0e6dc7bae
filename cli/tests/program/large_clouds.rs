//! Clouds drawn from an octree beside the file.

use crate::common::Folder;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;

/// A wavy square of points without normals, more than a node holds, in this order.
fn wave(backwards: bool) -> String {
    const SIDE: i32 = 250;
    let point = |i: i32| {
        let (x, y) = (f64::from(i % SIDE) / 100.0, f64::from(i / SIDE) / 100.0);
        format!("{x} {y} {:.4} {} 120 60\n", 0.2 * (3.0 * x).sin(), i % 256)
    };
    let numbers = 0..SIDE * SIDE;
    if backwards { numbers.rev().map(point).collect() } else { numbers.map(point).collect() }
}

const VIEW: [&str; 8] = ["--eye", "1.2,1.2,4", "--target", "1.2,1.2,0", "--fov", "40", "--size", "160x120"];

fn line<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["surfel", "wave.xyz", "--octree", "--overwrite"], &VIEW[..], more].concat()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("wave.xyz", wave(false));
    folder
}

#[test]
fn the_octree_is_made_once_and_gives_the_same_picture() {
    let folder = folder();
    folder.command(&line(&["-o", "a.png"])).assert().success().stderr(contains("is made, once"));
    let again = folder.command(&line(&["-o", "b.png", "--threads", "1"])).assert().success();
    again.stderr(contains("is made").not());
    let picture = fs::read(folder.path("a.png")).unwrap();
    assert_eq!(picture, fs::read(folder.path("b.png")).unwrap());

    // Points in another order are another file, with the same tree.
    let before = fs::read(folder.path("wave.xyz.octree")).unwrap();
    folder.write("wave.xyz", wave(true));
    let anew = folder.command(&line(&["-o", "c.png"])).assert().success();
    anew.stderr(contains("of another file, and is made anew"));
    let after = fs::read(folder.path("wave.xyz.octree")).unwrap();
    assert_ne!(before, after, "the fingerprint is of the file");
    assert_eq!(before[16..before.len() - 32], after[16..after.len() - 32]);
    assert_eq!(picture, fs::read(folder.path("c.png")).unwrap());
}

#[test]
fn an_octree_that_was_cut_off_or_altered_is_not_used() {
    let folder = folder();
    folder.command(&line(&["-o", "a.png"])).assert().success();
    let picture = fs::read(folder.path("a.png")).unwrap();
    let tree = folder.path("wave.xyz.octree");
    let sound = fs::read(&tree).unwrap();
    fs::write(&tree, &sound[..sound.len() / 2]).unwrap();
    let anew = folder.command(&line(&["-o", "b.png"])).assert().success();
    anew.stderr(contains("is damaged or of another file, and is made anew"));
    assert_eq!(fs::read(&tree).unwrap(), sound);
    assert_eq!(fs::read(folder.path("b.png")).unwrap(), picture);

    // A point of the first node: found when it is read.
    let mut altered = sound;
    altered[60] ^= 1;
    fs::write(&tree, &altered).unwrap();
    let refused = folder.command(&line(&["-o", "c.png"])).assert().code(3);
    refused.stderr(contains("wave.xyz.octree").and(contains("the octree is damaged")));
}

#[test]
fn a_build_that_is_killed_leaves_nothing_that_is_used() {
    let folder = folder();
    folder.command(&line(&["-o", "a.png"])).assert().success();
    let picture = fs::read(folder.path("a.png")).unwrap();
    let tree = folder.path("wave.xyz.octree");
    let sound = fs::read(&tree).unwrap();
    for milliseconds in [0, 20, 50, 100, 200, 400] {
        fs::remove_file(&tree).unwrap();
        let mut build = std::process::Command::new(assert_cmd::cargo::cargo_bin!("pointillist"));
        build.current_dir(folder.path(".")).args(line(&["-o", "killed.png", "--quiet"]));
        let mut child = build.spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(milliseconds));
        // It may have ended.
        let _ = child.kill();
        child.wait().unwrap();
        if let Ok(there) = fs::read(&tree) {
            assert_eq!(there, sound, "killed after {milliseconds} ms");
        }
        folder.command(&line(&["-o", "b.png"])).assert().success();
        assert_eq!(fs::read(folder.path("b.png")).unwrap(), picture);
    }
}

#[test]
fn an_octree_is_a_cloud_of_its_own() {
    let folder = folder();
    folder.command(&line(&["-o", "a.png"])).assert().success();
    let own = [&["surfel", "wave.xyz.octree", "-o", "b.png"], &VIEW[..]].concat();
    folder.command(&own).assert().success();
    assert_eq!(fs::read(folder.path("a.png")).unwrap(), fs::read(folder.path("b.png")).unwrap());
}

#[test]
fn a_flight_draws_each_view_and_reads_each_node_once() {
    let folder = folder();
    let views: String =
        (0..20).map(|i| format!("{} 1.2 4  1.2 1.2 0  0 1 0 # {i}\n", 1.0 + 0.02 * f64::from(i))).collect();
    folder.write("flight.txt", views);
    let flight = [
        "surfel",
        "wave.xyz",
        "--octree",
        "--views",
        "flight.txt",
        "-o",
        "f{frame:03}.png",
        "--size",
        "80x60",
    ];
    folder.command(&[&flight[..], &["--stats", "s.json"]].concat()).assert().success();
    assert!(folder.path("f001.png").exists() && folder.path("f020.png").exists());
    let stats: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("s.json")).unwrap()).unwrap();
    let bytes = stats["counts"]["bytes_read"].as_u64().unwrap();
    let whole = fs::metadata(folder.path("wave.xyz.octree")).unwrap().len();
    assert!(bytes > 0 && bytes < whole, "{bytes} of {whole}");
    // All views need the same nodes.
    assert_eq!(stats["skipped"]["clouds_made_ready"], 19, "{stats}");
    assert!(stats["counts"]["nodes_read"].as_u64().unwrap() <= 5, "{stats}");

    // The same view from memory, without an octree.
    let whole = ["surfel", "wave.xyz", "--views", "flight.txt", "-o", "m{frame}.png", "--size", "80x60"];
    folder.command(&whole).assert().success();
    assert!(folder.path("m20.png").exists());
}

#[test]
fn flights_that_cannot_be_flown_are_refused() {
    let folder = folder();
    folder.write("bad.txt", "1 2 3 4 5 6\n1 2 3 4 5\n");
    let base = ["surfel", "wave.xyz", "--views", "bad.txt"];
    let bad = folder.command(&[&base[..], &["-o", "f{frame}.png"]].concat()).assert().code(3);
    bad.stderr(contains("bad.txt:2").and(contains("a view of 5 numbers")));
    folder.write("bad.txt", "1 2 3 4 5 6\n");
    let unnamed = folder.command(&[&base[..], &["-o", "f.png"]].concat()).assert().code(2);
    unnamed.stderr(contains("{frame:04}"));
}

#[test]
fn what_was_drawn_before_does_not_show() {
    let folder = folder();
    // Over the corner, the middle, and the corner again: parts that are kept, and others between them.
    let corner = "0.4 0.4 0.5  0.4 0.5 0  0 1 0\n";
    folder.write("there.txt", corner);
    folder.write("back.txt", format!("1.2 1.2 4  1.2 1.2 0  0 1 0\n1.9 1.9 1  1.2 1.2 0  0 0 1\n{corner}"));
    let line = ["surfel", "wave.xyz", "--octree", "--size", "120x90", "--views"];
    folder.command(&[&line[..], &["there.txt", "-o", "there{frame}.png"]].concat()).assert().success();
    folder.command(&[&line[..], &["back.txt", "-o", "back{frame}.png"]].concat()).assert().success();
    let picture = |name: &str| fs::read(folder.path(name)).unwrap();
    assert_eq!(picture("there1.png"), picture("back3.png"));
}

#[test]
fn a_scale_is_the_same_in_all_views_of_a_flight() {
    let folder = folder();
    // Near and far, low and high: a pixel in the middle of each shows the same place.
    folder.write("views.txt", "1.2 1.2 4  1.2 1.2 0  0 1 0\n1.2 1.2 0.6  1.2 1.2 0  0 1 0\n");
    let line = ["surfel", "wave.xyz", "--octree", "--color-by", "elevation", "--ambient", "1"];
    let more = ["--views", "views.txt", "-o", "v{frame}.png", "--size", "81x61"];
    folder.command(&[&line[..], &more].concat()).assert().success();
    let middle = |name: &str| image::open(folder.path(name)).unwrap().into_rgba8().get_pixel(40, 30).0;
    let (far, near) = (middle("v1.png"), middle("v2.png"));
    assert!(far.iter().zip(near).all(|(a, b)| a.abs_diff(b) < 6), "{far:?} {near:?}");
}

#[test]
fn scan_draws_an_octree_and_names_what_it_cannot() {
    let folder = folder();
    let view = ["--eye", "1.2,1.2,4", "--target", "1.2,1.2,0", "--fov", "40", "--size", "160x120"];
    let scan =
        |cloud: &str, more: &[&str]| folder.command(&[&["scan", cloud][..], more, &view].concat()).assert();
    scan("wave.xyz", &["-o", "made.png", "--octree"]).success().stderr(contains("is made, once"));
    let own = ["-o", "own.exr", "--layers", "all", "--stats", "s.json", "--threads", "1"];
    scan("wave.xyz.octree", &own).success().stderr(contains("is made").not());
    scan("wave.xyz.octree", &own[..4]).success().stderr(contains("is already there"));
    scan("wave.xyz.octree", &["-o", "own.png", "--alpha", "0.5", "--edl", "--scale", "3"]).success();
    let picture = image::open(folder.path("made.png")).unwrap().into_rgba8();
    assert!(picture.pixels().filter(|pixel| pixel.0[3] == 255).count() > 5000);
    let stats: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("s.json")).unwrap()).unwrap();
    assert!(stats["counts"]["nodes_read"].as_u64().unwrap() > 0, "{stats}");

    folder.write("list.conf", "bmesh wave.xyz 0 0 0 0 0 0 1\n");
    folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write(
        "mesh.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    );
    for (other, what) in [("list.conf", "a list of scans"), ("mesh.obj", "a mesh"), ("mesh.ply", "a mesh")] {
        let refused = scan("wave.xyz.octree", &["-o", "both.png", other]).code(3);
        refused.stderr(contains(other).and(contains(what)).and(contains("pointillist sample")));
    }
    scan("mesh.ply", &["-o", "vertices.png", "--octree", "--vertices", "--scale", "9"]).success();
    let nothing = scan("wave.xyz.octree", &["-o", "empty.png", "--box", "90,90,90,91,91,91"]);
    nothing.failure();
}

#[cfg(unix)]
#[test]
fn a_folder_that_may_not_be_written_is_named_and_nothing_is_left() {
    let folder = folder();
    fs::create_dir(folder.path("wave.xyz.octree")).unwrap();
    let refused = folder.command(&line(&["-o", "a.png"])).assert().code(3);
    refused.stderr(contains("wave.xyz.octree").and(contains("the octree cannot be written")));
    let left = fs::read_dir(folder.path(".")).unwrap().filter_map(Result::ok);
    assert_eq!(left.filter(|entry| entry.file_name().to_string_lossy().contains(".tmp")).count(), 0);
}
