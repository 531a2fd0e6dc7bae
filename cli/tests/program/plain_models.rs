//! Models alone, without camera, lights or normals: how `render MODEL` shows them.

use crate::common::Folder;
use pointillist_cli::image_io::ExrFile;

fn picture(folder: &Folder, line: &[&str]) -> ExrFile {
    let all = [line, &["-o", "m.exr", "--float", "--layers", "all", "--overwrite", "--quiet"]].concat();
    folder.prints(&all);
    ExrFile::read(&std::fs::read(folder.path("m.exr")).unwrap()).unwrap()
}

/// A tube of twelve flat sides and a lid, without normals.
fn tube() -> String {
    let mut text = String::new();
    for i in 0..12 {
        let a = std::f64::consts::TAU * f64::from(i) / 12.0;
        text += &format!("v {:.9} -1 {:.9}\nv {:.9} 1 {:.9}\n", a.cos(), a.sin(), a.cos(), a.sin());
    }
    for i in 0..12 {
        let (a, b) = (2 * i + 1, 2 * ((i + 1) % 12) + 1);
        text += &format!("f {a} {} {} {b}\n", a + 1, b + 1);
    }
    let lid: Vec<String> = (0..12).rev().map(|i| (2 * i + 2).to_string()).collect();
    text + &format!("f {}\n", lid.join(" "))
}

#[test]
fn shadow_sides_are_lit_by_the_sky_and_the_ground() {
    let folder = Folder::new();
    folder.write("tube.obj", tube());
    let file = picture(&folder, &["render", "tube.obj", "--size", "40x40"]);
    let (coverage, direct) = (file.plane("A").unwrap(), file.plane("direct.R").unwrap());
    let colors = ["R", "G", "B"].map(|c| file.plane(c).unwrap());
    let inside: Vec<usize> = (0..coverage.len()).filter(|&i| coverage[i] == 1.0).collect();
    assert!(inside.len() > 300);
    let dark = inside.iter().filter(|&&i| direct[i] < 1e-3).count();
    assert!(dark > 5, "nothing is in the shade of the key light");
    for &i in &inside {
        for color in &colors {
            assert!(color[i] > 0.05 && color[i] < 1.0, "pixel {i}: {}", color[i]);
        }
    }
}

#[test]
fn a_model_without_normals_is_smooth_up_to_its_creases() {
    let folder = Folder::new();
    folder.write("tube.obj", tube());
    let line = ["render", "tube.obj", "--size", "64x64", "--eye", "0,2.5,6", "--target", "0,0,0"];
    let file = picture(&folder, &line);
    let normals = ["N.X", "N.Y", "N.Z"].map(|c| file.plane(c).unwrap());
    let at = |x: usize, y: usize| normals.each_ref().map(|n| n[y * 64 + x]);
    // Along a row of the tube's side the normal turns in small steps; flat facets would turn it by 30° at once.
    let row: Vec<[f32; 3]> = (26..38).map(|x| at(x, 36)).collect();
    for pair in row.windows(2) {
        let cosine: f32 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
        assert!(cosine > 0.98, "{pair:?}");
    }
    assert!((row[0][0] - row[11][0]).abs() > 0.3, "the normals do not turn: {row:?}");
    // The lid meets the side at 90°: it stays flat.
    let coverage = file.plane("A").unwrap();
    let lid = (0..64).map(|y| (y, at(32, y))).find(|(y, _)| coverage[(y + 1) * 64 + 32] == 1.0).unwrap();
    assert!((at(32, lid.0 + 1)[1] - 1.0).abs() < 1e-6, "{lid:?}");
}

#[test]
fn a_model_whose_head_is_at_the_back_is_seen_from_there() {
    let folder = Folder::new();
    let cuboid = |low: [f64; 3], high: [f64; 3], first: usize| {
        let mut text = String::new();
        for corner in 0..8 {
            let c: Vec<f64> = (0..3).map(|i| if corner >> i & 1 == 1 { high[i] } else { low[i] }).collect();
            text += &format!("v {} {} {}\n", c[0], c[1], c[2]);
        }
        for f in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            text += &format!("f {} {} {} {}\n", f[0] + first, f[1] + first, f[2] + first, f[3] + first);
        }
        text
    };
    for (head, eye_in_front) in [(1.0, true), (-1.0, false)] {
        let body = cuboid([-0.4, 0.0, -1.5], [0.4, 1.0, 1.5], 1);
        let head = cuboid([-0.3, 1.0, head - 0.5], [0.3, 1.8, head + 0.5], 9);
        folder.write("animal.obj", body + &head);
        let file = picture(&folder, &["render", "animal.obj", "--size", "48x48"]);
        let depth = file.plane("Z").unwrap();
        let nearest = (0..depth.len()).min_by(|&a, &b| depth[a].total_cmp(&depth[b])).unwrap();
        let z = file.plane("P.Z").unwrap()[nearest];
        assert_eq!(z > 0.0, eye_in_front, "the nearest point has z = {z}");
    }
}

#[test]
fn a_scene_may_have_a_sky_and_a_ground() {
    let folder = Folder::new();
    folder.write("flat.obj", "v -9 0 -9\nv 9 0 -9\nv 9 0 9\nv -9 0 9\nf 4 3 2 1\n");
    let scene = |eye: f64, ambient: &str| {
        format!(
            "[camera]\neye = [0, {eye}, 0]\ntarget = [0, 0, 0]\nup = [0, 0, 1]\nfov = 20\n[image]\nsize = [2, 2]\n\
             [[object]]\nmesh = \"flat.obj\"\nmaterial = \"m\"\n[material.m]\ndiffuse = [0.5, 0.5, 0.5]\n[ambient]\n{ambient}\n"
        )
    };
    for (eye, expected) in [(2.0, [0.2, 0.3, 0.4]), (-2.0, [0.05, 0.04, 0.03])] {
        folder.write("sky.toml", scene(eye, "sky = [0.4, 0.6, 0.8]\nground = [0.1, 0.08, 0.06]"));
        let file = picture(&folder, &["render", "sky.toml"]);
        for (channel, value) in ["R", "G", "B"].into_iter().zip(expected) {
            let found = file.plane(channel).unwrap();
            assert!(found.iter().all(|v| (v - value).abs() < 1e-6), "{channel}: {found:?} for {value}");
        }
    }
    folder.write("both.toml", scene(2.0, "sky = [1, 1, 1]\ncolor = [1, 1, 1]"));
    folder.fails(&["check", "both.toml"], 3, &["both.toml", "ambient.color", "ambient.sky"]);
}
