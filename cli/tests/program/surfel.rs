//! `surfel`: pictures of clouds made here, and every kind of bad input.

use crate::common::{Folder, PROPERTIES};
use pointillist_cli::image_io::{Picture, read_exr_picture};
use predicates::prelude::*;
use predicates::str::contains;

/// A square of 41 × 41 points on this plane, 0.05 apart, that face +Z, as lines of a PLY.
fn sheet(z: f64) -> Vec<String> {
    let place = |i: i32| f64::from(i % 41 - 20) * 0.05;
    let line = |i: i32| format!("{} {} {z} 0 0 1 {} 120 60 0.0354", place(i), place(i / 41), i % 256);
    (0..41 * 41).map(line).collect()
}

fn ply(properties: &[&str], lines: &[String]) -> String {
    let head: String = properties.iter().map(|p| format!("property {p}\n")).collect();
    let body: String = lines.iter().map(|line| format!("{line}\n")).collect();
    format!("ply\nformat ascii 1.0\nelement vertex {}\n{head}end_header\n{body}", lines.len())
}

/// The folder with two sheets, one before the other.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("near.ply", ply(&PROPERTIES, &sheet(0.5)));
    folder.write("far.ply", ply(&PROPERTIES, &sheet(-0.5)));
    folder
}

const VIEW: [&str; 8] = ["--eye", "0.2,0.1,3", "--target", "0,0,0", "--fov", "40", "--size", "64x48"];

/// Draws into `name` as floats.
fn draw(folder: &Folder, name: &str, more: &[&str]) -> Picture {
    let line = [&["surfel", "near.ply", "far.ply", "--float", "-o", name], &VIEW[..], more].concat();
    folder.prints(&line);
    picture(folder, name)
}

fn picture(folder: &Folder, name: &str) -> Picture {
    read_exr_picture(&std::fs::read(folder.path(name)).unwrap()).unwrap()
}

fn stats(folder: &Folder, name: &str) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(folder.path(name)).unwrap()).unwrap()
}

#[test]
fn a_sheet_is_opaque_at_its_depth() {
    let folder = folder();
    let line = ["surfel", "near.ply", "-o", "a.exr", "--float", "--layers", "all", "--ambient", "1"];
    let view = ["--eye", "0,0,3", "--target", "0,0,0", "--fov", "30", "--size", "64x48"];
    folder.prints(&[&line[..], &view].concat());
    let drawn = picture(&folder, "a.exr");
    assert_eq!(drawn.size, [64, 48]);
    let middle = drawn.color[24 * 64 + 32];
    // 120 is 0.188 linear.
    assert!(middle[3] > 0.999 && (middle[1] - 0.188).abs() < 2e-3, "{middle:?}");
    let info = folder.prints(&["info", "a.exr"]);
    for channel in ["N.X", "N.Z", "P.X", "P.Z", "\"Z\""] {
        assert!(info.contains(channel), "{channel} is missing in {info}");
    }
}

#[test]
fn every_option_draws_something() {
    let folder = folder();
    let options: [&[&str]; 20] = [
        &[],
        &["--focus", "2.5", "--depth", "0.05"],
        &["--focus", "2.5", "--depth", "0"],
        &["--focus", "2.5", "--aperture", "0.1"],
        &["--focus", "2.5", "--aperture", "0"],
        &["--focus", "2.5", "--lens", "50", "--fstop", "1.4"],
        &["--focus", "2.5", "--lens", "50", "--fstop", "1.4", "--sensor", "60"],
        &["--focus", "2.5", "--depth", "0.2", "--no-dof"],
        &["--no-dof"],
        &["--light", "1,1,1"],
        &["--light", "-1,0,2", "--ambient", "0.3"],
        &["--ambient", "1"],
        &["--procedure", "paper"],
        &["--procedure", "paper", "--focus", "2.5", "--depth", "0.05"],
        &["--procedure", "blended"],
        &["--level", "0"],
        &["--level", "4"],
        &["--no-cull"],
        &["--estimate-normals"],
        &["--exposure", "1", "--threads", "1"],
    ];
    for more in options {
        let line = ["surfel", "near.ply", "far.ply", "-o", "a.png", "--size", "48x48"];
        folder.prints(&[&line[..], more].concat());
        let picture = image::open(folder.path("a.png")).unwrap().to_rgba8();
        let covered = picture.pixels().filter(|p| p.0[3] > 0).count();
        assert!(covered > 200, "{more:?} covers {covered} pixels");
    }
}

#[test]
fn without_depth_of_field_nothing_is_blurred() {
    let folder = folder();
    let sharp = draw(&folder, "a.exr", &[]);
    let none: [&[&str]; 4] = [
        &["--focus", "2", "--aperture", "0.3", "--no-dof"],
        &["--focus", "2", "--depth", "0"],
        &["--focus", "2", "--aperture", "0"],
        &["--no-cull"],
    ];
    for (i, more) in none.into_iter().enumerate() {
        assert_eq!(draw(&folder, &format!("b{i}.exr"), more).color, sharp.color, "{more:?}");
    }
    assert_ne!(draw(&folder, "c.exr", &["--focus", "2", "--aperture", "0.3"]).color, sharp.color);
}

#[test]
fn three_ways_to_say_the_same_blur() {
    let folder = folder();
    // A 50 mm lens at f/2: an opening of 12.5 mm radius.
    let lens = draw(&folder, "a.exr", &["--focus", "2", "--lens", "50", "--fstop", "2"]);
    let aperture = draw(&folder, "b.exr", &["--focus", "2", "--aperture", "0.0125"]);
    let depth = draw(&folder, "c.exr", &["--focus", "2", "--depth", "0.00625"]);
    let near = |p: &Picture, q: &Picture| {
        p.color.iter().flatten().zip(q.color.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-4)
    };
    assert!(near(&lens, &aperture) && near(&lens, &depth));
}

#[test]
fn a_lens_without_fov_has_its_own_view() {
    let folder = folder();
    // Focused at 2 m, the sensor of 24 mm stands at 50 mm / (1 − 0.05/2) behind the lens.
    let eye = ["surfel", "near.ply", "--eye", "0,0,3", "--target", "0,0,0", "--size", "32x32", "--float"];
    let of = |name: &str, more: &[&str]| {
        folder.prints(&[&eye[..], more, &["-o", name]].concat());
        picture(&folder, name)
    };
    let lens = of("a.exr", &["--focus", "2", "--lens", "50", "--fstop", "8"]);
    let fov = (2.0 * (12.0 * (1.0 - 0.05 / 2.0) / 50.0f64).atan()).to_degrees().to_string();
    let same = of("b.exr", &["--focus", "2", "--lens", "50", "--fstop", "8", "--fov", &fov]);
    let differ = |p: &Picture| {
        p.color.iter().flatten().zip(lens.color.iter().flatten()).any(|(a, b)| (a - b).abs() > 1e-3)
    };
    assert!(!differ(&same));
    assert!(differ(&of("c.exr", &["--focus", "2", "--lens", "50", "--fstop", "8", "--sensor", "36"])));
}

#[test]
fn repeat_reports_the_frames() {
    let folder = folder();
    draw(&folder, "a.exr", &["--repeat", "3", "--stats", "s.json"]);
    let line =
        ["surfel", "near.ply", "-o", "b.png", "--repeat", "2", "--progress", "openjd", "--size", "16x16"];
    let told = folder.prints(&line);
    assert!(told.contains("openjd_progress: 50") && told.contains("openjd_progress: 100"), "{told}");
    let stats = stats(&folder, "s.json");
    for key in ["frame_ms", "frame_cpu_ms"] {
        assert!(stats[key]["min"].as_f64().unwrap() <= stats[key]["median"].as_f64().unwrap(), "{stats}");
    }
    assert_eq!(stats["counts"]["points"], 2 * 41 * 41);
    for stage in ["total", "load", "prepare", "draw", "write"] {
        assert!(stats["seconds"][stage].is_number() && stats["cpu_seconds"][stage].is_number(), "{stats}");
    }
    assert!(stats["peak_bytes"].as_u64().unwrap() > 0 && stats["skipped"]["nodes_outside"].is_number());
}

#[test]
fn tiles_join_to_the_whole_picture_bit_for_bit() {
    let folder = folder();
    for procedure in ["blended", "paper"] {
        let name = |part: &str| format!("{procedure}.{part}.exr");
        let more = ["--focus", "2.5", "--depth", "0.05", "--layers", "all", "--procedure", procedure];
        let whole = draw(&folder, &name("whole"), &more);
        for i in 0..3 {
            let tile = format!("{i}/3");
            draw(&folder, &name(&tile.replace('/', "of")), &[&more[..], &["--tile", &tile]].concat());
        }
        let parts = ["2of3", "0of3", "1of3"].map(name);
        folder.prints(&["merge", &parts[0], &parts[1], &parts[2], "-o", &name("joined")]);
        let joined = picture(&folder, &name("joined"));
        let bits = |p: &Picture| p.color.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert!(bits(&joined) == bits(&whole), "{procedure}");
        let [a, b] = ["whole", "joined"]
            .map(|part| folder.prints(&["compare", &name(part), &name("whole")]).replace(&name(part), ""));
        assert_eq!(a, b);
    }
}

/// A band of a picture costs what it shows: what lies beside it is not drawn. (Seconds would depend on the machine.)
#[test]
fn a_part_draws_the_points_that_it_shows() {
    let folder = Folder::new();
    let rabbit = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/rabbit.obj");
    folder.prints(&["sample", rabbit, "--count", "40000", "--method", "ldi", "-o", "r.ply", "--quiet"]);
    let drawn = |more: &[&str]| {
        let line =
            ["surfel", "r.ply", "--size", "640x1024", "-o", "r.exr", "--stats", "s.json", "--overwrite"];
        folder.prints(&[&line[..], more].concat());
        let stats: serde_json::Value =
            serde_json::from_slice(&std::fs::read(folder.path("s.json")).unwrap()).unwrap();
        stats["counts"]["points_drawn"].as_u64().unwrap()
    };
    let whole = drawn(&[]);
    // Eight bands of tiles; points near their borders are in both.
    let parts: Vec<u64> = (0..8).map(|i| drawn(&["--tile", &format!("{i}/8")])).collect();
    assert!(parts.iter().all(|&part| 2 * part < whole), "{parts:?} of {whole}");
    assert!((whole..2 * whole).contains(&parts.iter().sum()), "{parts:?} of {whole}");
    assert_eq!(drawn(&["--crop", "0,0,8,8"]), 0);
}

/// A unit sphere of five bands of ten quadrilaterals, without normals.
fn coarse_sphere() -> String {
    let corner = |i: usize| {
        let (s, z) = (std::f64::consts::PI * (i / 10) as f64 / 5.0).sin_cos();
        let (y, x) = (std::f64::consts::TAU * (i % 10) as f64 / 10.0).sin_cos();
        format!("v {} {} {z}\n", s * x, s * y)
    };
    let at = |row: usize, column: usize| row * 10 + column % 10 + 1;
    let face = |i: usize| {
        let (r, c) = (i / 10, i % 10);
        format!("f {} {} {} {}\n", at(r, c), at(r + 1, c), at(r + 1, c + 1), at(r, c + 1))
    };
    (0..60).map(corner).chain((0..50).map(face)).collect()
}

/// The least opacity more than three pixels inside of the outline of a convex solid.
fn least_inside(drawn: &Picture) -> f32 {
    let rows: Vec<&[[f32; 4]]> = drawn.color.chunks(drawn.size[0] as usize).collect();
    let ends = |row: &&[[f32; 4]]| {
        let first = row.iter().position(|c| c[3] > 0.5)?;
        Some((first + 4, row.iter().rposition(|c| c[3] > 0.5)?.saturating_sub(3)))
    };
    let inside = |row: &&[[f32; 4]]| {
        let (first, last) = ends(row).unwrap_or((0, 0));
        row.get(first..last).unwrap_or_default().iter().fold(1.0f32, |least, c| least.min(c[3]))
    };
    let shown: Vec<usize> = (0..rows.len()).filter(|&y| ends(&rows[y]).is_some()).collect();
    rows[shown[0] + 4..shown[shown.len() - 1] - 3].iter().map(inside).fold(1.0, f32::min)
}

#[test]
fn a_sampled_mesh_with_smooth_normals_has_no_holes_beside_its_outline() {
    let folder = Folder::new();
    folder.write("coarse.obj", coarse_sphere());
    let sample = ["sample", "coarse.obj", "--method", "ldi", "--count", "60000", "--ascii", "--quiet"];
    folder.prints(&[&sample[..], &["-o", "a.ply"]].concat());
    let text = std::fs::read_to_string(folder.path("a.ply")).unwrap();
    assert!(
        text.contains("property float face_nx\nproperty float face_ny\nproperty float face_nz\nend_header\n")
    );
    // As other programs write it.
    let bare: String = text.replace("face_", "other_").lines().map(|line| format!("{line}\n")).collect();
    folder.write("bare.ply", bare);
    let least = |cloud: &[&str]| {
        let view = ["--eye", "4,0.3,1.2", "--target", "0,0,0", "--fov", "35", "--size", "100x100"];
        let line =
            [&["surfel"], cloud, &view, &["-o", "a.exr", "--float", "--overwrite", "--quiet"]].concat();
        folder.prints(&line);
        least_inside(&picture(&folder, "a.exr"))
    };
    let (own, octree, alone) = (least(&["a.ply"]), least(&["a.ply", "--octree"]), least(&["bare.ply"]));
    assert!(own > 0.97 && octree > 0.97 && alone < 0.8, "{own}, {octree} with an octree, {alone} without");
}

#[test]
fn clouds_with_and_without_face_normals_are_drawn_together() {
    let folder = folder();
    let with_faces = |name: &str, z: f64| {
        let properties = [&PROPERTIES[..], &["float face_nx", "float face_ny", "float face_nz"]].concat();
        let lines: Vec<String> = sheet(z).iter().map(|line| format!("{line} 0 0 1")).collect();
        folder.write(name, ply(&properties, &lines));
    };
    with_faces("near_faces.ply", 0.5);
    with_faces("far_faces.ply", -0.5);
    let drawn = |clouds: [&str; 2]| {
        folder.prints(&[&["surfel"], &clouds[..], &VIEW, &["-o", "b.exr", "--overwrite"]].concat());
        std::fs::read(folder.path("b.exr")).map(|bytes| read_exr_picture(&bytes).unwrap().color).unwrap()
    };
    let plain = drawn(["near.ply", "far.ply"]);
    for clouds in
        [["near_faces.ply", "far.ply"], ["near.ply", "far_faces.ply"], ["near_faces.ply", "far_faces.ply"]]
    {
        // Packed, normals are off by 0.005°.
        let other = drawn(clouds);
        let off = plain.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f32::max);
        assert!(off < 2e-3, "{clouds:?}: {off}");
    }
}

#[test]
fn parts_of_another_picture_do_not_join() {
    let folder = folder();
    draw(&folder, "a.exr", &["--tile", "0/2"]);
    draw(&folder, "b.exr", &["--tile", "1/2", "--focus", "2", "--depth", "0.1"]);
    folder.fails(&["merge", "a.exr", "b.exr", "-o", "c.exr"], 4, &["b.exr"]);
}

#[test]
fn threads_do_not_change_a_bit() {
    let folder = folder();
    let more = |threads| ["--focus", "2.5", "--depth", "0.1", "--threads", threads];
    let [one, many] = [("a.exr", "1"), ("b.exr", "8")].map(|(name, n)| draw(&folder, name, &more(n)));
    assert_eq!(one.color, many.color);
}

#[test]
fn clouds_that_lack_something_are_drawn_with_a_warning() {
    let folder = folder();
    let bare: Vec<String> =
        sheet(0.0).iter().map(|l| l.split(' ').take(3).collect::<Vec<_>>().join(" ")).collect();
    folder.write("bare.ply", ply(&PROPERTIES[..3], &bare));
    folder.write("bare.xyz", bare.join("\n"));
    for file in ["bare.ply", "bare.xyz"] {
        let line = ["surfel", file, "-o", "a.png", "--size", "32x32", "--overwrite"];
        folder.command(&line).assert().success().stderr(contains(file).and(contains("normals")));
        let drawn = image::open(folder.path("a.png")).unwrap().to_rgba8();
        assert!(drawn.get_pixel(16, 16).0[3] == 255, "{file}");
    }
    // Together with one that has normals, too.
    let line = ["surfel", "near.ply", "bare.ply", "-o", "b.png", "--size", "32x32"];
    folder.command(&line).assert().success().stderr(contains("bare.ply: has no normals"));
}

#[test]
fn an_empty_picture_is_drawn_with_a_warning() {
    let folder = folder();
    let away = ["--eye", "0,0,3", "--target", "0,0,6"];
    let behind = ["--eye", "0,0,-3", "--target", "0,0,0"];
    for (view, piece) in [(away, "no point is in view"), (behind, "faces away")] {
        let line = [&["surfel", "near.ply", "-o", "a.png", "--size", "8x8"], &view[..]].concat();
        folder.command(&line).assert().success().stderr(contains(piece));
        assert!(folder.path("a.png").exists());
    }
}

#[test]
fn bad_files_name_the_point_and_leave_no_picture() {
    let folder = folder();
    let broken = |name: &str, point: usize, line: &str| {
        let mut lines = sheet(0.0);
        lines[point] = line.to_owned();
        folder.write(name, ply(&PROPERTIES, &lines));
    };
    broken("nan.ply", 7, "0 nan 0 0 0 1 1 2 3 0.1");
    broken("normal.ply", 5, "0 0 0 0 0 0 1 2 3 0.1");
    broken("radius.ply", 3, "0 0 0 0 0 1 1 2 3 0");
    broken("negative.ply", 4, "0 0 0 0 0 1 1 2 3 -0.5");
    broken("word.ply", 6, "0 0 zero 0 0 1 1 2 3 0.1");
    folder.write("none.ply", ply(&PROPERTIES, &[]));
    folder.write("empty.xyz", "");
    let fails = |files: &[&str], pieces: &[&str]| {
        folder.fails(&[&["surfel"], files, &["-o", "a.png"]].concat(), 3, pieces);
    };
    fails(&["nan.ply"], &["nan.ply", "--drop-invalid"]);
    fails(&["normal.ply"], &["normal.ply", "point 5", "--estimate-normals"]);
    // The number is that of the file's own points.
    fails(&["near.ply", "normal.ply"], &["normal.ply", "point 5"]);
    fails(&["radius.ply"], &["radius.ply", "point 3", "is 0"]);
    fails(&["negative.ply"], &["negative.ply", "point 4", "-0.5"]);
    fails(&["word.ply"], &["word.ply", "zero"]);
    fails(&["none.ply"], &["none.ply"]);
    fails(&["empty.xyz"], &["empty.xyz"]);
    fails(&["lost.ply"], &["lost.ply"]);
    assert!(!folder.names().iter().any(|name| name.contains("a.png")), "{:?}", folder.names());
}

#[test]
fn bad_points_can_be_left_out_and_bad_normals_estimated() {
    let folder = folder();
    let mut lines = sheet(0.0);
    lines[7] = "0 nan 0 0 0 1 1 2 3 0.1".to_owned();
    folder.write("nan.ply", ply(&PROPERTIES, &lines));
    lines[7] = "0 0 0 0 0 0 1 2 3 0.1".to_owned();
    folder.write("normal.ply", ply(&PROPERTIES, &lines));
    let line = ["surfel", "nan.ply", "-o", "a.png", "--size", "16x16", "--drop-invalid"];
    folder.command(&line).assert().success().stderr(contains("1 points that are not finite were left out"));
    folder.prints(&["surfel", "normal.ply", "-o", "b.png", "--size", "16x16", "--estimate-normals"]);
}

#[test]
fn bad_options_are_wrong_usage_and_named() {
    let folder = folder();
    let wrong: [(&[&str], &str); 24] = [
        (&["--focus", "0", "--depth", "0.1"], "--focus"),
        (&["--focus", "-2", "--depth", "0.1"], "--focus"),
        (&["--focus", "nan", "--depth", "0.1"], "--focus"),
        (&["--focus", "2"], "--depth"),
        (&["--focus", "2", "--depth", "-0.1"], "--depth"),
        (&["--depth", "0.1"], "--focus"),
        (&["--aperture", "0.1"], "--focus"),
        (&["--focus", "2", "--aperture", "-1"], "--aperture"),
        (&["--focus", "2", "--aperture", "0.1", "--depth", "0.1"], "cannot be used"),
        (&["--focus", "2", "--lens", "50", "--fstop", "0"], "--fstop"),
        (&["--focus", "2", "--lens", "0", "--fstop", "2"], "--lens"),
        (&["--focus", "2", "--lens", "50"], "--fstop"),
        (&["--focus", "2", "--fstop", "2"], "--lens"),
        (&["--focus", "0.04", "--lens", "50", "--fstop", "2"], "focal length"),
        (&["--focus", "2", "--lens", "50", "--fstop", "2", "--sensor", "0"], "--sensor"),
        (
            &["--focus", "2", "--lens", "50", "--fstop", "2", "--sensor", "24", "--fov", "30"],
            "cannot be used",
        ),
        (&["--level", "-1"], "--level"),
        (&["--ambient", "1.5"], "ambient"),
        (&["--light", "0,0,0"], "light"),
        (&["--procedure", "splat"], "--procedure"),
        (&["--repeat", "0"], "--repeat"),
        (&["--layers", "count", "-o", "b.exr"], "N and P"),
        (&["--layers", "N"], ".exr"),
        (&["--up", "0,0,1", "--eye", "0,0,3", "--target", "0,0,0"], "parallel"),
    ];
    for (more, piece) in wrong {
        let line = [&["surfel", "near.ply"], more].concat();
        folder.fails(&line, 2, &[piece]);
    }
    folder.fails(&["surfel"], 2, &["CLOUD"]);
    folder.fails(&["surfel", "near.ply", "-o", "a.gif"], 2, &["a.gif"]);
    folder.fails(&["surfel", "near.ply", "-o", "no/a.png", "--size", "8x8"], 1, &["cannot be written"]);
    assert!(!folder.names().iter().any(|name| name.ends_with(".png") || name.ends_with(".exr")));
}

/// The properties of a sampled cloud, and `alpha` of this type.
fn with_alpha(kind: &str) -> Vec<String> {
    PROPERTIES.iter().map(|p| (*p).to_owned()).chain([format!("{kind} alpha")]).collect()
}

/// A file with a sheet whose points all have this `alpha`.
fn glassy(z: f64, kind: &str, alpha: &str) -> String {
    let properties = with_alpha(kind);
    let lines: Vec<String> = sheet(z).iter().map(|line| format!("{line} {alpha}")).collect();
    ply(&properties.iter().map(String::as_str).collect::<Vec<_>>(), &lines)
}

#[test]
fn points_with_an_alpha_of_their_own_are_seen_through() {
    let folder = folder();
    for (name, z, kind, alpha) in [
        ("half.ply", 0.5, "uchar", "51"),
        ("float.ply", 0.5, "float", "0.2"),
        ("whole.ply", 0.5, "uchar", "255"),
        ("none.ply", 0.8, "float", "0"),
    ] {
        folder.write(name, glassy(z, kind, alpha));
    }
    let middle = |files: &[&str], more: &[&str]| {
        let line =
            [&["surfel"], files, &["--float", "--overwrite", "--ambient", "1", "-o", "out.exr"], &VIEW, more]
                .concat();
        folder.prints(&line);
        picture(&folder, "out.exr").color[24 * 64 + 32]
    };
    // 120 and 60 are 0.1878 and 0.0452 linear; red differs from point to point.
    let (green, blue) = (0.1878, 0.0452);
    let close = |files: &[&str], more: &[&str], alpha: f32| {
        let got = middle(files, more);
        let apart = got[1..]
            .iter()
            .zip([green * alpha, blue * alpha, alpha])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(apart < 1e-3, "{files:?} {more:?}: {got:?}, not opaque to {alpha}");
    };
    close(&["half.ply"], &[], 0.2);
    close(&["float.ply"], &[], 0.2);
    close(&["half.ply"], &["--procedure", "paper"], 0.2);
    close(&["half.ply"], &["--ignore-alpha"], 1.0);
    close(&["whole.ply"], &[], 1.0);
    // Files without are opaque, in either order.
    close(&["half.ply", "far.ply"], &[], 1.0);
    close(&["far.ply", "half.ply"], &[], 1.0);
    // In front of the other, and not seen.
    close(&["half.ply", "none.ply"], &[], 0.2);
    let same = |a: &str, b: &str| {
        let [a, b] = [a, b].map(|name| middle(&[name, "far.ply"], &[]));
        assert_eq!(a.map(f32::to_bits), b.map(f32::to_bits));
    };
    same("near.ply", "whole.ply");
}

#[test]
fn opacities_of_discs_are_checked_and_told_of() {
    let folder = Folder::new();
    folder.write("wrong.ply", glassy(0.0, "float", "1.5"));
    folder.write("none.ply", glassy(0.0, "uchar", "0"));
    folder.fails(&["surfel", "wrong.ply"], 3, &["wrong.ply", "`alpha` is 1.5, not from 0 to 1"]);
    folder.fails(&["surfel", "none.ply"], 0, &["none.ply", "opacity 0", "--ignore-alpha"]);
    // A picture of other opacities is another picture.
    folder.write("near.ply", glassy(0.0, "uchar", "90"));
    folder.prints(&["surfel", "near.ply", "-o", "kept.png", "--size", "32x32"]);
    let before = std::fs::read(folder.path("kept.png")).unwrap();
    folder.write("near.ply", glassy(0.0, "uchar", "200"));
    folder.prints(&["surfel", "near.ply", "-o", "kept.png", "--size", "32x32"]);
    assert!(before != std::fs::read(folder.path("kept.png")).unwrap(), "the old picture was kept");
}
