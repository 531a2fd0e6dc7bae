//! `sample` turns meshes into clouds.

use crate::common::{Folder, PROPERTIES};
use predicates::str::contains;
use std::fs;

/// The header's lines and the numbers of each point of an ascii cloud.
fn cloud(folder: &Folder, name: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let text = fs::read_to_string(folder.path(name)).unwrap();
    let (head, body) = text.split_once("end_header\n").unwrap();
    let point = |line: &str| line.split(' ').map(|n| n.parse().unwrap()).collect();
    (head.lines().map(str::to_owned).collect(), body.lines().map(point).collect())
}

#[test]
fn a_mesh_becomes_exactly_as_many_points() {
    let folder = Folder::new();
    folder.prints(&["sample", "triangle.obj", "--count", "123", "--ascii", "-o", "a.ply"]);
    let (head, points) = cloud(&folder, "a.ply");
    let properties: Vec<_> = head.iter().filter_map(|l| l.strip_prefix("property ")).collect();
    assert_eq!(properties, PROPERTIES);
    assert_eq!(points.len(), 123);
    for p in points {
        assert!(p[1] >= 0.0 && p[1] <= 1.5 * (1.0 - p[0].abs()) + 1e-6 && p[2] == 0.0, "{p:?}");
        assert!(p[3..6] == [0.0, 0.0, 1.0] && p[9] > 0.0 && p[9] < 1.0, "{p:?}");
    }
}

#[test]
fn binary_clouds_read_back_and_depend_on_seed_and_not_on_threads() {
    let folder = Folder::new();
    for (more, name) in
        [(["--threads", "1"], "a.ply"), (["--threads", "4"], "b.ply"), (["--seed", "7"], "c.ply")]
    {
        folder.prints(
            &[&["sample", "triangle.obj", "--count", "500", "--quiet", "-o", name][..], &more].concat(),
        );
    }
    let bytes = |name: &str| fs::read(folder.path(name)).unwrap();
    assert!(bytes("a.ply") == bytes("b.ply") && bytes("a.ply") != bytes("c.ply"));
    assert!(bytes("a.ply").starts_with(b"ply\nformat binary_little_endian 1.0\nelement vertex 500\n"));
    folder.prints(&["scan", "a.ply", "--size", "16x16", "-o", "a.png"]);
}

#[test]
fn rays_are_as_far_apart_as_asked() {
    let folder = Folder::new();
    folder.prints(&[
        "sample",
        "triangle.obj",
        "--method",
        "ldi",
        "--spacing",
        "0.1",
        "--ascii",
        "-o",
        "a.ply",
    ]);
    let (_, points) = cloud(&folder, "a.ply");
    // 1.5 square units of 0.01 each; the hypotenuses cut cells.
    assert!(points.len().abs_diff(150) <= 10, "{}", points.len());
    assert!(
        points.iter().all(|p| ((p[0] + 1.0) * 10.0 - 0.5).fract().abs() < 1e-4
            || ((p[0] + 1.0) * 10.0 - 0.5).fract() > 0.9999)
    );
}

#[test]
fn colours_come_from_textures_and_materials() {
    let folder = Folder::new();
    // Left half red, right half green, times a blue-less white.
    let picture =
        image::RgbImage::from_fn(2, 1, |x, _| image::Rgb(if x == 0 { [255, 0, 0] } else { [0, 255, 0] }));
    picture.save(folder.path("map.png")).unwrap();
    folder.write("a.mtl", "newmtl m\nKd 1 1 1\nmap_Kd map.png\nnewmtl plain\nKd 0.5 0 1\n");
    folder.write(
        "a.obj",
        "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 9\nv 1 0 9\nv 1 1 9\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
         usemtl m\nf 1/1 2/2 3/3 4/4\nusemtl plain\nf 5 6 7\n",
    );
    folder.prints(&["sample", "a.obj", "--count", "300", "--ascii", "-o", "a.ply"]);
    for p in cloud(&folder, "a.ply").1 {
        // 0.5 linear is 188 encoded.
        let expected = match (p[2] > 1.0, p[0] < 0.5) {
            (true, _) => [188.0, 0.0, 255.0],
            (false, true) => [255.0, 0.0, 0.0],
            (false, false) => [0.0, 255.0, 0.0],
        };
        assert_eq!(p[6..9], expected, "{p:?}");
    }
}

#[test]
fn statistics_and_names() {
    let folder = Folder::new();
    folder
        .command(&["sample", "triangle.obj", "--count", "9", "--stats", "s.json"])
        .assert()
        .success()
        .stderr(contains("triangle.points.ply: 9 points"));
    let stats: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("s.json")).unwrap()).unwrap();
    assert_eq!(stats["counts"]["points"], 9);
    assert_eq!(stats["counts"]["triangles"], 1);
    assert!(stats["seconds"]["sample"].is_number() && stats["cpu_seconds"]["write"].is_number());
}

#[test]
fn bad_input_and_bad_options_are_told_apart() {
    let folder = Folder::new();
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    folder.write("nan.obj", "v 0 0 0\nv nan 0 0\nv 2 1 0\nf 1 2 3\n");
    let to = ["-o", "no.ply"];
    let fails = |line: &[&str], code, piece| folder.fails(&[line, &to].concat(), code, &[piece]);
    fails(&["sample", "flat.obj"], 3, "area of 0");
    fails(&["sample", "nan.obj"], 3, "nan.obj");
    fails(&["sample", "lost.obj"], 3, "lost.obj");
    fails(&["sample", "triangle.obj", "--count", "0"], 2, "--count");
    fails(&["sample", "triangle.obj", "--count", "99999999999"], 2, "--count");
    fails(&["sample", "triangle.obj", "--spacing", "0"], 2, "more than 0");
    fails(&["sample", "triangle.obj", "--spacing", "1e-9"], 2, "at most");
    fails(&["sample", "triangle.obj", "--spacing", "1", "--count", "3"], 2, "cannot be used");
    folder.fails(&["sample", "triangle.obj", "-o", "a.obj"], 2, &["ends in .ply"]);
    folder.fails(&["sample", "triangle.obj", "-o", "no/a.ply"], 1, &["cannot be written"]);
    assert!(!folder.names().iter().any(|name| name.contains("no.ply") || name.ends_with(".tmp")));
}
