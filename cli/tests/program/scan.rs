//! `scan`: pictures of clouds made here, and every kind of bad input.

use crate::common::Folder;
use pointillist_cli::image_io::{ExrFile, read_exr_picture};

/// A square of 41 × 41 points on z = 0, in rows, as XYZ text.
fn sheet(z: f64) -> String {
    let row =
        |j: i32| (-20..=20).map(move |i| format!("{} {} {z}\n", f64::from(i) * 0.05, f64::from(j) * 0.05));
    (-20..=20).flat_map(row).collect()
}

/// The same as an ascii PLY in a range grid, so that its spacing and its scanner are known.
fn range_grid(points: usize) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nobj_info num_cols {points}\nobj_info num_rows {points}\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\nelement range_grid {}\n\
         property list uchar int vertex_indices\nend_header\n",
        points * points,
        points * points
    );
    for k in 0..points * points {
        text += &format!("{} {} 0\n", (k % points) as f64 * 0.05, (k / points) as f64 * 0.05);
    }
    for k in 0..points * points {
        text += &format!("1 {k}\n");
    }
    text
}

const VIEW: [&str; 8] = ["--eye", "0,0,3", "--target", "0,0,0", "--fov", "30", "--size", "64x48"];

fn scan(files: &[&str], more: &[&str]) -> Vec<String> {
    let line = ["scan"].into_iter().chain(files.iter().copied()).chain(VIEW).chain(more.iter().copied());
    line.map(str::to_owned).collect()
}

fn run(folder: &Folder, line: &[String]) -> String {
    let line: Vec<&str> = line.iter().map(String::as_str).collect();
    folder.prints(&line)
}

#[test]
fn a_sheet_is_opaque_at_its_depth() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.5));
    run(&folder, &scan(&["sheet.xyz"], &["-o", "sheet.exr", "--float", "--layers", "all"]));
    let picture = read_exr_picture(&std::fs::read(folder.path("sheet.exr")).unwrap()).unwrap();
    assert_eq!(picture.size, [64, 48]);
    // Facing the eye: colour 0.8 wherever the sheet is, which is the middle of the picture.
    let middle = picture.color[24 * 64 + 32];
    assert_eq!(middle[3], 1.0);
    assert!((middle[0] - 0.8).abs() < 1e-3, "{middle:?}");
    let info = folder.prints(&["info", "sheet.exr"]);
    for channel in ["N.X", "P.Z", "count", "\"Z\""] {
        assert!(info.contains(channel), "{channel} is missing in {info}");
    }
}

#[test]
fn every_option_draws_something_else_than_nothing() {
    let folder = Folder::new();
    folder.write("sheet.ply", range_grid(41));
    let options: [&[&str]; 14] = [
        &["--passes", "1"],
        &["--finer", "0.66"],
        &["--alpha", "0.5", "--depth-layers", "3", "--layer-threshold", "10"],
        &["--no-cull"],
        &["--cull", "printed"],
        &["--cull", "scans"],
        &["--normals", "triangles", "--weights", "falling", "--outline", "0", "--fill", "0"],
        &["--weights", "symmetric"],
        &["--weights", "printed"],
        &["--gamma", "1", "--spacing", "0.05", "--scale", "2"],
        &["--light", "1,1,1", "--ambient", "0.3"],
        &["--edl"],
        &["--edl", "2", "--ambient", "1"],
        &["--exposure", "1"],
    ];
    for more in options {
        let mut more = more.to_vec();
        more.extend(["-o", "out.png", "--eye", "1,1,4", "--target", "1,1,0", "--stats", "stats.json"]);
        let line: Vec<&str> =
            ["scan", "sheet.ply", "--size", "48x48"].into_iter().chain(more.iter().copied()).collect();
        folder.prints(&line);
        let picture = image::open(folder.path("out.png")).unwrap().to_rgba8();
        let covered = picture.pixels().filter(|p| p.0[3] > 0).count();
        assert!(covered > 200, "{more:?} covers {covered} pixels");
    }
}

#[test]
fn tiles_join_to_the_whole_picture() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.0));
    let whole = scan(&["sheet.xyz"], &["-o", "whole.exr"]);
    run(&folder, &whole);
    for i in 0..3 {
        let tile = format!("{i}/3");
        let part = format!("part{i}.exr");
        run(&folder, &scan(&["sheet.xyz"], &["-o", &part, "--tile", &tile]));
    }
    folder.prints(&["merge", "part2.exr", "part0.exr", "part1.exr", "-o", "joined.exr"]);
    let [a, b] = ["whole.exr", "joined.exr"].map(|n| std::fs::read(folder.path(n)).unwrap());
    assert_eq!(read_exr_picture(&a).unwrap().color, read_exr_picture(&b).unwrap().color);
}

#[test]
fn a_crop_is_a_part_of_the_whole_picture_and_may_be_empty() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.0));
    for more in [&["--edl"][..], &["--alpha", "0.5"], &["--passes", "2"]] {
        run(&folder, &scan(&["sheet.xyz"], &[&["-o", "whole.png"], more].concat()));
        run(&folder, &scan(&["sheet.xyz"], &[&["-o", "part.png", "--crop", "9,20,31,37"], more].concat()));
        let [whole, part] =
            ["whole.png", "part.png"].map(|n| image::open(folder.path(n)).unwrap().into_rgba8());
        assert_eq!(part.dimensions(), (22, 17));
        assert!(part.pixels().any(|p| p.0[3] > 0));
        assert!(part == image::imageops::crop_imm(&whole, 9, 20, 22, 17).to_image(), "{more:?}");
    }
    for (command, crop) in [("scan", "0,0,2,2"), ("surfel", "0,0,2,2")] {
        let line = [&[command, "sheet.xyz"], &VIEW[..], &["-o", "corner.png", "--crop", crop]].concat();
        let output = folder.command(&line).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && !told.contains("nothing was drawn"), "{command}: {told}");
    }
}

#[test]
fn repeat_reports_the_frames() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.0));
    run(&folder, &scan(&["sheet.xyz"], &["-o", "a.png", "--repeat", "3", "--stats", "stats.json"]));
    let told = run(&folder, &scan(&["sheet.xyz"], &["-o", "b.png", "--repeat", "2", "--progress", "openjd"]));
    assert!(told.contains("openjd_progress: 50") && told.contains("openjd_progress: 100"), "{told}");
    let stats: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path("stats.json")).unwrap()).unwrap();
    for key in ["frame_ms", "frame_cpu_ms"] {
        assert!(stats[key]["min"].as_f64().unwrap() <= stats[key]["median"].as_f64().unwrap());
    }
    assert_eq!(stats["counts"]["points"], 41 * 41);
}

#[test]
fn scans_of_a_conf_are_placed_and_a_mesh_joins_them() {
    let folder = Folder::new();
    folder.write("a.ply", range_grid(21));
    // Turned by 180° about y and moved back: its scanner looks from behind.
    folder.write("two.conf", "bmesh a.ply 0 0 0 0 0 0 1\nbmesh a.ply 1 0 0 0 1 0 0\n");
    let points = |size: &str| {
        let line = ["scan", "two.conf", "triangle.obj", "-o", "a.png", "--size", size, "--stats", "s.json"];
        folder.prints(&line);
        let stats = std::fs::read(folder.path("s.json")).unwrap();
        let stats: serde_json::Value = serde_json::from_slice(&stats).unwrap();
        stats["counts"]["points"].as_u64().unwrap() - 2 * 441
    };
    // The triangle of area 1.5 gets points at the spacing of the scans, 0.05, where pixels are smaller than that.
    assert!((600..700).contains(&points("256x256")));
    assert!((100..500).contains(&points("16x16")));
}

#[test]
fn an_empty_picture_is_drawn_with_a_warning() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.0));
    let line = ["scan", "sheet.xyz", "--eye", "0,0,3", "--target", "0,0,6", "-o", "a.png", "--size", "8x8"];
    let output = folder.command(&line).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stderr).contains("no point is in view"));
    assert!(folder.path("a.png").exists());
}

#[test]
fn bad_files_name_the_place_and_leave_no_picture() {
    let folder = Folder::new();
    let whole = range_grid(9);
    folder.write("cut.ply", &whole[..whole.len() / 2]);
    folder.fails(&["scan", "cut.ply", "-o", "a.png"], 3, &["cut.ply:"]);
    folder.write("nan.xyz", "0 0 0\n1 nan 0\n0 1 0\n");
    folder.fails(&["scan", "nan.xyz", "-o", "a.png"], 3, &["nan.xyz", "--drop-invalid"]);
    folder.write("none.xyz", "");
    folder.fails(&["scan", "none.xyz", "-o", "a.png"], 3, &["none.xyz"]);
    folder.write("lost.conf", "bmesh lost.ply 0 0 0 0 0 0 1\n");
    folder.fails(&["scan", "lost.conf", "-o", "a.png"], 3, &["lost.conf:1", "lost.ply"]);
    folder.write("turned.conf", "bmesh a.ply 0 0 0 0 0 0 2\n");
    folder.fails(&["scan", "turned.conf", "-o", "a.png"], 3, &["turned.conf:1"]);
    assert!(!folder.path("a.png").exists());
}

#[test]
fn invalid_points_can_be_dropped() {
    let folder = Folder::new();
    folder.write("nan.xyz", sheet(0.0) + "1 nan 0\n");
    let line = scan(&["nan.xyz"], &["-o", "a.png", "--drop-invalid"]);
    let line: Vec<&str> = line.iter().map(String::as_str).collect();
    let output = folder.command(&line).output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert!(String::from_utf8_lossy(&output.stderr).contains("1 points that are not finite were left out"));
}

#[test]
fn bad_options_are_wrong_usage() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.0));
    let wrong: [(&[&str], &str); 8] = [
        (&["--scale", "0.5"], "at least 1"),
        (&["--alpha", "1.5"], "--alpha"),
        (&["--outline", "2"], "--outline"),
        (&["--depth-layers", "99", "--alpha", "0.5"], "--depth-layers"),
        (&["--light", "0,0,0"], "--light"),
        (&["--up", "0,0,1", "--eye", "0,0,3", "--target", "0,0,0"], "parallel"),
        (&["--layers", "albedo"], "N, P and count"),
        (&["--layers", "N", "-o", "a.png"], ".exr"),
    ];
    for (more, piece) in wrong {
        let line: Vec<&str> = ["scan", "sheet.xyz"].into_iter().chain(more.iter().copied()).collect();
        folder.fails(&line, 2, &[piece]);
    }
}

/// A sphere of quadrilaterals.
fn sphere(radius: f64) -> String {
    let mut text = String::new();
    for i in 0..=12 {
        for j in 0..24 {
            let (theta, phi) = (f64::from(i) * std::f64::consts::PI / 12.0, f64::from(j) * 0.261_799_387_799);
            let (r, y) = (radius * theta.sin(), radius * theta.cos());
            text += &format!("v {} {y} {}\n", r * phi.cos(), r * phi.sin());
        }
    }
    for i in 0..12 {
        for j in 0..24 {
            let at = |i: i32, j: i32| i * 24 + j % 24 + 1;
            text += &format!("f {} {} {} {}\n", at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
        }
    }
    text
}

/// What the command says about its number of points, and how much of the picture is covered.
fn points_and_cover(folder: &Folder, line: &[&str]) -> (u64, f32, String) {
    let line: Vec<&str> = line.iter().copied().chain(["-o", "out.exr", "--overwrite"]).collect();
    let output = folder.command(&line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{message}");
    let words: Vec<&str> = message.split_whitespace().collect();
    let at = words.iter().rposition(|word| *word == "points").expect("a number of points");
    let picture = read_exr_picture(&std::fs::read(folder.path("out.exr")).unwrap()).unwrap();
    let cover = picture.color.iter().map(|c| c[3]).sum::<f32>() / picture.color.len() as f32;
    (words[at - 1].parse().unwrap(), cover, message)
}

#[test]
fn points_of_a_mesh_are_tied_to_pixels_and_not_to_the_scan_beside_it() {
    let folder = Folder::new();
    folder.write("sheet.xyz", sheet(0.0));
    folder.write("huge.obj", sphere(1000.0));
    folder.write("small.obj", sphere(0.5));
    // Framed together, the scan is a dot; its spacing on the sphere would be billions of points.
    let (points, cover, message) =
        points_and_cover(&folder, &["scan", "sheet.xyz", "huge.obj", "--size", "64x64"]);
    assert!(points < 60_000, "{points} points for 4096 pixels");
    assert!((0.5..0.9).contains(&cover), "{cover}");
    assert!(!message.contains("warning"), "{message}");
    // As many pixels, as many points, whatever the unit.
    let (small, ..) = points_and_cover(&folder, &["scan", "small.obj", "--size", "64x64"]);
    let (large, ..) = points_and_cover(&folder, &["scan", "small.obj", "--size", "128x128"]);
    assert!((3.0..5.0).contains(&(large as f64 / small as f64)), "{small} {large}");
}

#[test]
fn one_vertex_far_away_does_not_multiply_the_points() {
    let folder = Folder::new();
    let ply = |last: &str| {
        let header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n\
                      property double z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
        format!("{header}-1 -1 0\n1 -1 0\n1 1 0\n{last}\n3 0 1 2\n3 0 2 3\n")
    };
    folder.write("square.ply", ply("-1 1 0"));
    folder.write("moved.ply", ply("-1e9 3e9 0"));
    let view = ["--eye", "0,0,5", "--target", "0,0,0", "--size", "64x64"];
    let scan = |file: &'static str| points_and_cover(&folder, &[&["scan", file][..], &view].concat());
    let (usual, ..) = scan("square.ply");
    let (moved, cover, message) = scan("moved.ply");
    assert!(moved < 4 * usual, "{usual} points of a square, {moved} with a vertex moved");
    assert!(cover > 0.1 && !message.contains("warning"), "{cover} {message}");
}

#[test]
fn the_camera_line_of_a_conf_is_the_default_view() {
    let folder = Folder::new();
    folder.prints(&["sample", "triangle.obj", "--count", "2000", "-o", "t.ply"]);
    // World to camera is the conjugate of this sixth of a turn about y, and then three units along −z.
    let (sine, cosine) = (30_f64.to_radians().sin(), 30_f64.to_radians().cos());
    folder.write("t.conf", format!("camera 0 -0.75 -3 0 {sine} 0 {cosine}\nbmesh t.ply 0 0 0 0 0 0 1\n"));
    let draw = |name: &str, file: &str, more: &[&str]| {
        let line = ["scan", file, "--size", "64x48", "--float", "--no-cull", "-o", name, "--overwrite"];
        folder.prints(&[&line[..], more].concat());
        std::fs::read(folder.path(name)).unwrap()
    };
    let suggested = draw("a.exr", "t.conf", &["--fov", "40"]);
    let [x, z] = [60_f64.to_radians().sin(), 60_f64.to_radians().cos()];
    let (eye, target) = (format!("{},0.75,{}", 3.0 * x, 3.0 * z), format!("{},0.75,{}", 2.0 * x, 2.0 * z));
    let view = ["--eye", &eye, "--target", &target, "--up", "0,1,0", "--fov", "40"];
    let asked = draw("b.exr", "t.conf", &view);
    let depth = |bytes: &[u8]| ExrFile::read(bytes).unwrap().plane("Z").unwrap();
    let (one, other) = (depth(&suggested), depth(&asked));
    let apart =
        one.iter().zip(&other).filter(|(a, b)| a.is_finite() != b.is_finite() || (*a - *b).abs() > 1e-4);
    assert!(one.iter().any(|z| z.is_finite()), "nothing is seen");
    assert!(apart.count() <= 2, "the camera line is another view");
    // A place on the command line takes its place as a whole.
    let framed = draw("c.exr", "t.conf", &["--target", "0,0.75,0"]);
    assert_ne!(depth(&framed), one);
    assert_eq!(depth(&framed), depth(&draw("d.exr", "t.ply", &["--target", "0,0.75,0"])));
    // Without --fov what is there fills the picture.
    folder.write("front.conf", "camera 0 -0.75 -9 0 0 0 1\nbmesh t.ply 0 0 0 0 0 0 1\n");
    let near = depth(&draw("e.exr", "front.conf", &[]));
    let rows = |z: &[f32]| (0..48).filter(|y| z[y * 64..(y + 1) * 64].iter().any(|z| z.is_finite())).count();
    assert!(rows(&near) > 40, "only {} of 48 rows are filled", rows(&near));
}

/// A sheet on `z` in one colour, whose points have this `alpha` (written as bytes, or as floats if it has a point).
fn glassy(z: f64, colour: &str, alpha: &str) -> String {
    let kind = if alpha.contains('.') { "float" } else { "uchar" };
    let points = 41 * 41;
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {points}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty {kind} alpha\nend_header\n"
    );
    for line in sheet(z).lines() {
        text += &format!("{line} {colour} {alpha}\n");
    }
    text
}

#[test]
fn points_with_an_alpha_of_their_own_are_seen_through() {
    let folder = Folder::new();
    folder.write("back.xyz", sheet(-0.5));
    folder.write("half.ply", glassy(0.5, "255 0 0", "51"));
    folder.write("float.ply", glassy(0.5, "255 0 0", "0.2"));
    folder.write("whole.ply", glassy(0.5, "255 0 0", "255"));
    folder.write("nothing.ply", glassy(0.5, "255 0 0", "0"));
    let middle = |file: &str, more: &[&str]| {
        let more = [&["--ambient", "1", "-o", "out.exr", "--float", "--overwrite"], more].concat();
        run(&folder, &scan(&[file, "back.xyz"], &more));
        let picture = read_exr_picture(&std::fs::read(folder.path("out.exr")).unwrap()).unwrap();
        picture.color[24 * 64 + 32]
    };
    let close = |file: &str, more: &[&str], wanted: [f32; 4]| {
        let got = middle(file, more);
        let apart = got.iter().zip(wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(apart < 1e-4, "{file} {more:?}: {got:?}, not {wanted:?}");
    };
    // The sheet behind is of the colour of points without one, 0.8.
    let through = [0.2 + 0.8 * 0.8, 0.8 * 0.8, 0.8 * 0.8, 1.0];
    close("half.ply", &[], through);
    close("float.ply", &[], through);
    close("whole.ply", &[], [1.0, 0.0, 0.0, 1.0]);
    close("half.ply", &["--ignore-alpha"], [1.0, 0.0, 0.0, 1.0]);
    // Both at half: 0.1 of red, then 0.9 × 0.5 of what is behind.
    close("half.ply", &["--alpha", "0.5"], [0.1 + 0.45 * 0.8, 0.45 * 0.8, 0.45 * 0.8, 0.1 + 0.45]);
    close("nothing.ply", &[], [0.8, 0.8, 0.8, 1.0]);
}

#[test]
fn opacities_are_told_of_and_checked() {
    let folder = Folder::new();
    folder.write("half.ply", glassy(0.5, "255 0 0", "51"));
    folder.write("none.ply", glassy(0.5, "255 0 0", "0"));
    folder.write("wrong.ply", glassy(0.5, "255 0 0", "1.5"));
    assert!(folder.prints(&["info", "half.ply"]).contains("\"opacities\": true"));
    folder.fails(
        &["scan", "wrong.ply"],
        3,
        &["wrong.ply", "wrong.ply:12", "`alpha` is 1.5, not from 0 to 1"],
    );
    folder.fails(&["scan", "none.ply"], 0, &["none.ply", "opacity 0", "--ignore-alpha"]);
}
