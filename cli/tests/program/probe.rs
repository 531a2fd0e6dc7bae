//! `probe`: place, bake, project, tetra, query, parts, and light from probes in `render`.

use crate::common::Folder;
use pointillist_cli::image_io::read_exr_picture;
use pointillist_sh::Sh;
use serde_json::Value;
use std::f64::consts::PI;

/// A closed box whose inside glows at 1 and reflects half.
const GLOWING_BOX: &str = "mtllib box.mtl\nusemtl glow\n\
    v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 4 3 7 8\nf 1 4 8 5\nf 6 7 3 2\n";

const BOX_SCENE: &str = "[camera]\neye = [0, 0, 0.9]\ntarget = [0, 0, 0]\n[image]\nsize = [8, 8]\n[[object]]\nmesh = \"box.obj\"\n";

/// A ball-like solid in a constant sky.
const SKY_SCENE: &str = "[camera]\neye = [0, 0, 6]\ntarget = [0, 0, 0]\nfov = 30\n[image]\nsize = [16, 16]\n\
    background = [0.8, 0.4, 0.2]\n[[object]]\nmesh = \"block.obj\"\nmaterial = \"grey\"\n\
    [material.grey]\ndiffuse = [0.5, 0.5, 0.5]\n";

/// The box with its faces turned outward.
fn block() -> String {
    let turned = |line: &str| match line.strip_prefix("f ") {
        Some(corners) => format!("f {}\n", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
        None if line.starts_with("mtllib") || line.starts_with("usemtl") => String::new(),
        None => format!("{line}\n"),
    };
    GLOWING_BOX.lines().map(turned).collect()
}

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("box.obj", GLOWING_BOX);
    folder.write("box.mtl", "newmtl glow\nKd 0.5 0.5 0.5\nKe 1 1 1\n");
    folder.write("box.toml", BOX_SCENE);
    folder.write("block.obj", block());
    folder.write("sky.toml", SKY_SCENE);
    folder
}

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.path(name)).unwrap()).unwrap()
}

/// The mean radiance of each probe in green.
fn radiance(file: &Value) -> Vec<f64> {
    let of = |p: &Value| p["sh"][0][1].as_f64().unwrap() / (2.0 * PI.sqrt());
    file["probes"].as_array().unwrap().iter().map(of).collect()
}

#[test]
fn grids_have_the_size_asked_for_and_lie_in_the_scene() {
    let folder = folder();
    folder.prints(&["probe", "place", "box.toml", "--grid", "3x2x4", "-o", "p.json"]);
    let probes = json(&folder, "p.json")["probes"].as_array().unwrap().clone();
    assert_eq!(probes.len(), 24);
    let inside =
        |p: &Value| p["position"].as_array().unwrap().iter().all(|c| c.as_f64().unwrap().abs() < 1.0);
    assert!(probes.iter().all(inside));
    let text =
        folder.prints(&["probe", "place", "box.toml", "--strategy", "random", "--count", "7", "-o", "-"]);
    let text: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(text["probes"].as_array().unwrap().len(), 7);
}

#[test]
fn light_in_a_glowing_box_grows_as_the_geometric_series() {
    let folder = folder();
    folder.prints(&["probe", "place", "box.toml", "--grid", "2x2x2", "-o", "p.json"]);
    for (bounces, wanted) in [("0", 1.0), ("1", 1.5), ("3", 1.875)] {
        let line = [
            "probe",
            "bake",
            "box.toml",
            "p.json",
            "--what",
            "total",
            "--resolution",
            "16",
            "--bounces",
            bounces,
        ];
        folder.prints(&[&line[..], &["--until", "0", "-o", "b.json"]].concat());
        for light in radiance(&json(&folder, "b.json")) {
            assert!((light - wanted).abs() < 1e-4, "{bounces} bounces: {light}");
        }
    }
    // Without the glow itself, what it lights remains.
    let line =
        ["probe", "bake", "box.toml", "p.json", "--resolution", "16", "--bounces", "1", "-o", "b.json"];
    folder.prints(&line);
    radiance(&json(&folder, "b.json"))
        .iter()
        .for_each(|light| assert!((light - 0.5).abs() < 1e-4, "{light}"));
}

#[test]
fn a_constant_sky_lights_everything_alike() {
    let folder = folder();
    let far = ["--low", "-90,-90,50", "--high", "90,90,90"];
    folder.prints(&[&["probe", "place", "sky.toml", "--grid", "2x2x2", "-o", "p.json"], &far[..]].concat());
    folder.prints(&[
        "probe",
        "bake",
        "sky.toml",
        "p.json",
        "--resolution",
        "16",
        "--bounces",
        "0",
        "-o",
        "b.json",
    ]);
    folder.write("q.txt", "0 0 70  0 1 0\n# a comment\n\n3 4 60  1 1 1\n");
    let lines = folder.prints(&["probe", "query", "b.json", "q.txt"]);
    for line in lines.lines() {
        let rgb: Vec<f64> = line.split(' ').map(|v| v.parse().unwrap()).collect();
        let wanted = [0.8, 0.4, 0.2].map(|l| l * PI);
        assert!(rgb.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 2e-3), "{line}");
    }
    // Above the block the sky is open, and so is what query says of it.
    for line in folder.prints(&["probe", "query", "b.json", "q.txt", "--sky"]).lines() {
        let share: f64 = line.split(' ').nth(3).unwrap().parse().unwrap();
        assert!((share - 1.0).abs() < 2e-3, "{line}");
    }
    folder.write("blind.json", "{\"probes\":[{\"position\":[0,0,0],\"sh\":[[1,1,1]]}]}");
    folder.fails(&["probe", "query", "blind.json", "q.txt", "--sky"], 3, &["blind.json", "`sky`", "bake"]);
    let sky = json(&folder, "b.json")["probes"][0]["sky"][0].as_f64().unwrap() / (2.0 * PI.sqrt());
    assert!((sky - 1.0).abs() < 1e-2);
    // And the block before it reflects half of that.
    folder.write("lit.toml", format!("{SKY_SCENE}[ambient]\nprobes = \"b.json\"\n"));
    folder.prints(&["render", "lit.toml", "--float", "-o", "lit.exr"]);
    let picture = read_exr_picture(&std::fs::read(folder.path("lit.exr")).unwrap()).unwrap();
    let middle = picture.color[8 * 16 + 8];
    assert!((middle[0] - 0.4).abs() < 1e-3 && (middle[2] - 0.1).abs() < 1e-3, "{middle:?}");
}

#[test]
fn parts_join_to_what_one_run_bakes() {
    let folder = folder();
    folder.prints(&["probe", "place", "sky.toml", "--grid", "3x2x1", "--inside", "keep", "-o", "p.json"]);
    let bake = |more: &[&str]| {
        let line = ["probe", "bake", "sky.toml", "p.json", "--resolution", "8", "--bounces", "0"];
        folder.prints(&[&line, more].concat());
    };
    bake(&["-o", "whole.json"]);
    bake(&["--part", "0/2", "-o", "a.json"]);
    bake(&["--part", "1/2", "-o", "b.probes"]);
    folder.prints(&["merge", "b.probes", "a.json", "-o", "joined.json"]);
    let read = |name: &str| std::fs::read(folder.path(name)).unwrap();
    assert_eq!(read("whole.json"), read("joined.json"));
    folder.fails(&["merge", "a.json", "-o", "joined.json"], 4, &["gap"]);
    folder.fails(&["merge", "a.json", "a.json", "-o", "joined.json"], 4, &["overlap"]);
}

#[test]
fn probes_inside_of_walls_are_told_from_all_probes_however_they_were_baked() {
    let folder = folder();
    // Without its last face the block is no solid, and places in it are not refused.
    let block = block();
    folder.write("block.obj", &block[..block.trim_end().rfind('\n').unwrap() + 1]);
    let place = |inside: bool, x: f64| {
        let x = if inside { x * 0.1 - 0.3 } else { x + 2.0 };
        format!("{{\"position\":[{x},0,0]}}")
    };
    let probes = |inside: &[bool]| {
        let places: Vec<String> = inside.iter().zip(1..).map(|(&i, x)| place(i, f64::from(x))).collect();
        format!("{{\"probes\":[{}]}}", places.join(","))
    };
    let bake = |more: &[&str]| {
        let line = ["probe", "bake", "sky.toml", "p.json", "--resolution", "8", "--bounces", "0"];
        folder.prints(&[&line, more].concat());
    };
    let buried = |name: &str| -> Vec<bool> {
        let file = json(&folder, name);
        file["probes"].as_array().unwrap().iter().map(|p| p["buried"] == true).collect()
    };
    let inside = [true, true, false, false, false, false];
    folder.write("p.json", probes(&inside));
    bake(&["-o", "whole.json"]);
    assert_eq!(buried("whole.json"), inside);
    // By itself the first part is all in the wall.
    for part in ["0/3", "1/3", "2/3"] {
        bake(&["--part", part, "-o", &format!("{}.json", &part[..1])]);
    }
    folder.prints(&["merge", "0.json", "1.json", "2.json", "-o", "joined.json"]);
    assert_eq!(json(&folder, "joined.json"), json(&folder, "whole.json"));
    // Nor are those of before told from those that are new.
    folder.write("p.json", probes(&inside[..1]));
    bake(&["-o", "grown.json"]);
    folder.write("p.json", probes(&inside));
    bake(&["-o", "grown.json", "--stats", "s.json"]);
    assert!(json(&folder, "s.json")["counts"]["probes"].as_u64().unwrap() < 6);
    assert_eq!(json(&folder, "grown.json"), json(&folder, "whole.json"));
    bake(&["-o", "kept.json", "--inside", "keep"]);
    assert_eq!(buried("kept.json"), [false; 6]);
}

#[test]
fn probes_that_see_the_same_are_kept() {
    let folder = folder();
    // One probe on each side of the block.
    folder.write("p.json", "{\"probes\":[{\"position\":[4,0,0]},{\"position\":[-4,0,0]}]}");
    let lamp = |x: f64| format!("{SKY_SCENE}[[object]]\nmesh = \"triangle.obj\"\ntranslate = [{x}, 0, 1]\n");
    folder.write("scene.toml", lamp(6.0));
    let baked = |folder: &Folder| {
        let line =
            ["probe", "bake", "scene.toml", "p.json", "--resolution", "16", "--bounces", "0", "-o", "b.json"];
        folder.prints(&[&line[..], &["--stats", "s.json"]].concat());
        json(folder, "s.json")["counts"]["probes"].as_u64().unwrap()
    };
    assert_eq!(baked(&folder), 2);
    let before = std::fs::read(folder.path("b.json")).unwrap();
    assert_eq!(baked(&folder), 0);
    assert_eq!(before, std::fs::read(folder.path("b.json")).unwrap());
    // The triangle moves, behind the block for one of the probes.
    folder.write("scene.toml", lamp(7.0));
    assert_eq!(baked(&folder), 1);
}

#[test]
fn panoramas_and_cubes_of_one_colour_have_one_coefficient() {
    let folder = folder();
    let grey = |name: &str, width: u32, height: u32| {
        image::RgbImage::from_pixel(width, height, image::Rgb([188, 188, 188]))
            .save(folder.path(name))
            .unwrap();
    };
    grey("sky.png", 64, 32);
    grey("strip.png", 96, 16);
    grey("tall.png", 16, 96);
    let level = (((188.0_f64 / 255.0) + 0.055) / 1.055).powf(2.4);
    for name in ["sky.png", "strip.png", "tall.png"] {
        let sh: Value =
            serde_json::from_str(&folder.prints(&["probe", "project", name, "--exposure", "1"])).unwrap();
        let first = sh["sh"][0][0].as_f64().unwrap() / (2.0 * PI.sqrt());
        assert!((first - 2.0 * level).abs() < 1e-6, "{name}: {first}");
        let rest = sh["sh"].as_array().unwrap().iter().skip(1).flat_map(|c| c.as_array().unwrap().clone());
        assert!(rest.into_iter().all(|c| c.as_f64().unwrap().abs() < 1e-6));
    }
    grey("small.png", 8, 8);
    let six =
        ["probe", "project", "small.png", "small.png", "small.png", "small.png", "small.png", "sky.png"];
    folder.fails(&six, 3, &["sky.png", "8×8"]);
}

#[test]
fn cells_are_printed_as_the_contract_has_it() {
    let folder = folder();
    folder.write("cube.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n");
    let text = folder.prints(&["probe", "tetra", "cube.txt"]);
    let (head, cells) = text.split_once('\n').unwrap();
    let cells: Vec<Vec<usize>> =
        cells.lines().map(|l| l.split(' ').map(|v| v.parse().unwrap()).collect()).collect();
    assert_eq!(head, format!("# tetrahedra {}", cells.len()));
    assert!(cells.iter().all(|c| c.len() == 4 && c.iter().all(|&i| i < 5)));
    folder.write("flat.txt", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n");
    assert!(folder.prints(&["probe", "tetra", "flat.txt"]).starts_with("# dimension 2\n"));
    folder.write("line.txt", "0 0 0\n2 0 0\n1 0 0\n");
    let line = folder.prints(&["probe", "tetra", "line.txt"]);
    assert!(line == "# dimension 1\n0 2\n2 1\n" || line == "# dimension 1\n1 2\n2 0\n", "{line}");
    assert_eq!(folder.prints(&["probe", "tetra", "cube.txt", "--quiet", "-o", "c.bin"]), "");
    assert_eq!(std::fs::read(folder.path("c.bin")).unwrap().len(), cells.len() * 16);
    folder.prints(&["probe", "tetra", "cube.txt", "--locate", "cube.txt", "--stats", "s.json"]);
    let stats = json(&folder, "s.json");
    for key in ["build_s", "cells", "locate_random_mqps", "locate_coherent_mqps"] {
        assert!(stats[key].as_f64().is_some(), "{key}");
    }
}

#[test]
fn bad_input_is_named() {
    let folder = folder();
    folder.write("nan.txt", "0 0 0\n1 nan 0\n");
    folder.fails(&["probe", "tetra", "nan.txt"], 3, &["nan.txt:2", "not finite"]);
    folder.write("few.txt", "0 0\n");
    folder.fails(&["probe", "tetra", "few.txt"], 3, &["only 2 numbers of 3"]);
    folder.write("none.txt", "");
    assert_eq!(folder.prints(&["probe", "tetra", "none.txt"]), "# tetrahedra 0\n");
    folder.write("bad.json", "{\"probes\":[\n{\"position\":[0,0,0],\"sh\":[[1,2]]}]}");
    folder.fails(&["probe", "query", "bad.json"], 3, &["bad.json:2", "probes[0].sh[0]"]);
    folder.write("raw.json", "{\"probes\":[{\"position\":[0,0,0]}]}");
    folder.fails(&["probe", "query", "raw.json"], 3, &["probes[0].sh", "probe bake"]);
    folder.write("mixed.json", "{\"probes\":[{\"position\":[0,0,0],\"sh\":[[1,1,1]]},{\"position\":[1,0,0],\"sh\":[[1,1,1],[0,0,0],[0,0,0],[0,0,0]]}]}");
    folder.fails(&["probe", "query", "mixed.json"], 3, &["mixed.json"]);
    folder.write("inside.json", "{\"probes\":[{\"position\":[0,0,0]}]}");
    let refuse = ["probe", "bake", "sky.toml", "inside.json", "--inside", "refuse"];
    folder.fails(&refuse, 1, &["inside of a solid"]);
    folder.write("both.toml", format!("{SKY_SCENE}[ambient]\nprobes = \"nope.json\"\n"));
    folder.fails(&["check", "both.toml"], 3, &["nope.json", "probe bake"]);
    folder.fails(&["probe", "bake", "sky.toml", "raw.json", "--part", "0/1"], 2, &["--bounces 0"]);
    folder.fails(&["probe", "place", "sky.toml", "--grid", "0x1x1"], 2, &["at least 1"]);
}

#[test]
fn fitted_probes_light_what_lies_between_them_better() {
    let folder = folder();
    // A lamp close to the wall between two of the probes: they see little of the bright spot.
    let scene = format!(
        "{BOX_SCENE}material = \"grey\"\n[material.grey]\ndiffuse = [0.8, 0.8, 0.8]\n\
         [[light]]\ntype = \"point\"\nposition = [0, 0, -0.7]\nintensity = [1, 1, 1]\n"
    );
    folder.write("lamp.toml", scene);
    folder.prints(&["probe", "place", "lamp.toml", "--grid", "2x2x2", "-o", "p.json"]);
    folder.prints(&["probe", "place", "lamp.toml", "--grid", "5x5x5", "-o", "fine.json"]);
    let bake = |probes: &str, fit: &str, output: &str| {
        let line =
            ["probe", "bake", "lamp.toml", probes, "--resolution", "16", "--bounces", "0", "--fit", fit];
        folder.prints(&[&line[..], &["-o", output]].concat());
        json(&folder, output)
    };
    let (plain, fitted, fine) = (
        bake("p.json", "0", "plain.json"),
        bake("p.json", "200", "fit.json"),
        bake("fine.json", "0", "f.json"),
    );
    assert_eq!(fitted["fit"], 200);
    let about: Value = serde_json::from_str(&folder.prints(&["info", "fit.json"])).unwrap();
    assert_eq!((&about["kind"], &about["baked"], &about["fit"]), (&"probes".into(), &8.into(), &200.into()));
    assert_ne!(plain["fingerprint"], fitted["fingerprint"]);
    let positions: Vec<Vec<f64>> = fine["probes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["position"].as_array().unwrap().iter().map(|c| c.as_f64().unwrap()).collect())
        .collect();
    let queries: String = positions.iter().fold(String::new(), |text, p| {
        let at: Vec<String> = p.iter().map(f64::to_string).collect();
        text + &at.join(" ") + " 0 0 1\n" + &at.join(" ") + " 0 0 -1\n"
    });
    folder.write("q.txt", queries);
    let light = |file: &str| -> Vec<f64> {
        let text = folder.prints(&["probe", "query", file, "q.txt"]);
        text.lines().map(|l| l.split(' ').next().unwrap().parse().unwrap()).collect()
    };
    let truth = light("f.json");
    // The eight probes are in the corners of a box.
    let corner = plain["probes"][0]["position"][0].as_f64().unwrap().abs();
    let is_between: Vec<bool> =
        positions.iter().flat_map(|p| [p.iter().all(|c| c.abs() < corner); 2]).collect();
    assert_eq!(is_between.iter().filter(|is| **is).count(), 54);
    // As they are everywhere, and relative to the light at each place between the probes.
    let errors = |file: &str| -> [f64; 2] {
        let mut sums = [0.0; 2];
        for ((a, b), is_between) in light(file).iter().zip(&truth).zip(&is_between) {
            sums[0] += (a - b).powi(2);
            sums[1] += if *is_between { (a / b - 1.0).powi(2) } else { 0.0 };
        }
        sums
    };
    let shares = folder.prints(&["probe", "query", "fit.json", "q.txt", "--shares"]);
    let sum = |line: &str| -> f64 {
        line.split(' ').skip(3).map(|s| s.split_once(':').unwrap().1.parse::<f64>().unwrap()).sum()
    };
    assert!(shares.lines().all(|line| (sum(line) - 1.0).abs() < 1e-3), "{shares}");
    for (with, without) in errors("fit.json").into_iter().zip(errors("plain.json")) {
        assert!(with < 0.7 * without, "{with} against {without}");
    }
    folder.fails(
        &["probe", "bake", "lamp.toml", "p.json", "--bounces", "0", "--fit", "9", "--part", "0/2"],
        2,
        &["--part and --fit"],
    );
}

#[test]
fn deringed_probes_light_nothing_negatively() {
    let folder = folder();
    // A small bright panel far away: nine coefficients ring.
    folder.write("panel.obj", "mtllib box.mtl\nusemtl glow\nv -0.3 -0.3 -3\nv 0.3 -0.3 -3\nv 0.3 0.3 -3\nv -0.3 0.3 -3\nf 1 2 3 4\n");
    folder.write("panel.toml", BOX_SCENE.replace("box.obj", "panel.obj"));
    folder.write("one.json", r#"{"probes":[{"position":[0,0,0]}]}"#);
    let sh = |option: &[&str]| -> Sh {
        let line =
            ["probe", "bake", "panel.toml", "one.json", "--what", "total", "--bounces", "0", "-o", "b.json"];
        folder.prints(&[&line[..], option].concat());
        let of = |c: &Value| glam::DVec3::splat(c[0].as_f64().unwrap());
        Sh::new(json(&folder, "b.json")["probes"][0]["sh"].as_array().unwrap().iter().map(of).collect())
            .unwrap()
    };
    let least = |sh: &Sh| {
        (0..60)
            .map(|i| (f64::from(i) * PI / 60.0).sin_cos())
            .map(|(s, c)| sh.irradiance(glam::dvec3(s, 0.0, c)).x)
            .fold(f64::INFINITY, f64::min)
    };
    let (plain, damped) = (sh(&[]), sh(&["--dering"]));
    assert!(least(&plain) < -1e-3 * plain.irradiance(-glam::DVec3::Z).x, "{}", least(&plain));
    assert!(least(&damped) > -1e-9, "{}", least(&damped));
}

/// A closed room of which two walls differ, with a lamp.
fn lit_room(folder: &Folder) {
    folder.write("room.obj", block().lines().map(turned_back).collect::<String>());
    folder.write(
        "room.toml",
        "[camera]\neye = [0, 0, 0.9]\ntarget = [0, 0, 0]\n[image]\nsize = [8, 8]\n\
         [[light]]\ntype = \"point\"\nposition = [0.3, 0.4, 0.2]\nintensity = [1, 1, 1]\n\
         [[object]]\nmesh = \"room.obj\"\nmaterial = \"grey\"\n[material.grey]\ndiffuse = [0.6, 0.5, 0.3]\n",
    );
}

fn turned_back(line: &str) -> String {
    match line.strip_prefix("f ") {
        Some(corners) => format!("f {}\n", corners.split(' ').rev().collect::<Vec<_>>().join(" ")),
        None => format!("{line}\n"),
    }
}

#[test]
fn bounces_come_from_a_radiosity_solution_read_or_solved_on_the_way() {
    let folder = folder();
    lit_room(&folder);
    folder.write("p.json", "{\"probes\":[{\"position\":[-0.2,0.1,0.3]},{\"position\":[0.4,-0.3,-0.5]}]}");
    folder.prints(&["radiosity", "room.toml", "-o", "light.json"]);
    let bake = |output: &str, more: &[&str]| {
        let line = ["probe", "bake", "room.toml", "p.json", "--resolution", "32", "-o", output];
        folder.prints(&[&line, more].concat());
        let file = json(&folder, output);
        (radiance(&file), file)
    };
    let (read, file) = bake("read.json", &["--indirect", "light.json"]);
    assert_eq!((file["bounces"].as_u64(), file["indirect"].as_str().map(str::len)), (Some(0), Some(16)));
    let (solved, file) = bake("solved.json", &["--indirect", "solve"]);
    assert_eq!(file["indirect"], "solve");
    let (bounced, _) = bake("bounced.json", &["--bounces", "12", "--until", "0"]);
    let (direct, _) = bake("direct.json", &["--bounces", "0"]);
    for i in 0..2 {
        assert!((read[i] / solved[i] - 1.0).abs() < 0.01, "{} {}", read[i], solved[i]);
        // Two probes light the walls roughly, but there is as much light in the room.
        assert!((read[i] / bounced[i] - 1.0).abs() < 0.1, "{} {}", read[i], bounced[i]);
        assert!(read[i] > 1.4 * direct[i], "{} {}", read[i], direct[i]);
    }
    // What is there already is kept for the same light only.
    let kept = |more: &[&str]| {
        let line = [
            "probe",
            "bake",
            "room.toml",
            "p.json",
            "--resolution",
            "32",
            "-o",
            "read.json",
            "--stats",
            "s.json",
        ];
        folder.prints(&[&line, more].concat());
        2 - json(&folder, "s.json")["counts"]["probes"].as_u64().unwrap_or(0)
    };
    assert_eq!(kept(&["--indirect", "light.json"]), 2);
    assert_eq!(kept(&["--bounces", "0"]), 0);
    // Parts are possible, since no probe depends on another.
    for part in ["0/2", "1/2"] {
        bake(&format!("{}.json", &part[..1]), &["--indirect", "light.json", "--part", part]);
    }
    folder.prints(&["merge", "0.json", "1.json", "-o", "joined.json"]);
    assert_eq!(radiance(&json(&folder, "joined.json")), read);
}

#[test]
fn light_of_another_scene_is_refused() {
    let folder = folder();
    lit_room(&folder);
    folder.write("p.json", "{\"probes\":[{\"position\":[0,0,0]}]}");
    folder.prints(&["radiosity", "room.toml", "-o", "light.json"]);
    let bake = ["probe", "bake", "room.toml", "p.json", "--resolution", "8", "-o", "b.json"];
    let fails = |more: &[&str], code: i32, words: &[&str]| folder.fails(&[&bake, more].concat(), code, words);
    let other = ["--indirect", "light.json", "--set"];
    fails(
        &[&other[..], &["material.grey.diffuse=[0.1,0.1,0.1]"]].concat(),
        4,
        &["light.json", "lights or materials"],
    );
    folder.write(
        "room.obj",
        std::fs::read_to_string(folder.path("room.obj")).unwrap().replace("-1 -1 -1", "-1.1 -1 -1"),
    );
    fails(&["--indirect", "light.json"], 4, &["light.json", "another scene", "triangles", "radiosity"]);
    fails(&["--indirect", "p.json"], 3, &["p.json", "light probes", "baked radiosity"]);
    fails(&["--indirect", "none.json"], 3, &["none.json"]);
    fails(&["--indirect", "solve", "--bounces", "2"], 2, &["--bounces"]);
    fails(&["--indirect", "solve", "--set", "material.grey.diffuse=[1.2,1,1]"], 3, &["grey", "below 1"]);
    fails(&["--order", "9"], 2, &["--order"]);
}

#[test]
fn near_and_far_say_which_surfaces_probes_see() {
    let folder = folder();
    // The glowing box of 2 around the probe, in a sky.
    let scene = format!("{BOX_SCENE}[ambient]\ncolor = [0, 0, 0]\n")
        .replace("[8, 8]", "[8, 8]\nbackground = [3, 3, 3]");
    folder.write("box.toml", scene);
    folder.write("p.json", "{\"probes\":[{\"position\":[0,0,0]}]}");
    let light = |more: &[&str]| {
        let line =
            ["probe", "bake", "box.toml", "p.json", "--what", "total", "--resolution", "8", "--bounces", "0"];
        folder.prints(&[&line, more, &["-o", "b.json"]].concat());
        let file = json(&folder, "b.json");
        (radiance(&file)[0], file["probes"][0]["sky"][0].as_f64().unwrap() / (2.0 * PI.sqrt()))
    };
    let close = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() < 1e-4 && (b - d).abs() < 1e-4;
    for (range, wanted) in [
        (&[][..], (1.0, 0.0)),
        (&["--near", "0.5"], (1.0, 0.0)),
        (&["--near", "0.5", "--far", "1.5"], (1.0, 0.0)),
        (&["--near", "1.5"], (3.0, 1.0)),
        (&["--far", "0.5"], (3.0, 1.0)),
    ] {
        let found = light(range);
        assert!(close(found, wanted), "{range:?}: {found:?}");
    }
    let file = json(&folder, "b.json");
    assert_eq!((file["near"].as_f64(), file["far"].as_f64()), (None, Some(0.5)));
    let line = ["probe", "bake", "box.toml", "p.json", "-o", "b.json"];
    folder.fails(&[&line[..], &["--near", "2", "--far", "1"]].concat(), 2, &["--far", "--near"]);
    folder.fails(&[&line[..], &["--near=-1"]].concat(), 2, &["--near"]);
    folder.fails(&[&line[..], &["--far", "0"]].concat(), 2, &["--far"]);
}

#[test]
fn mirrors_in_a_room_show_what_probes_of_any_order_hold_and_not_the_sky_behind_its_walls() {
    let folder = folder();
    let sky = image::Rgb32FImage::from_pixel(32, 16, image::Rgb([9.0; 3]));
    sky.save(folder.path("sky.hdr")).unwrap();
    let under_the_sky =
        |text: &str| text.replace("size = [8, 8]", "size = [8, 8]\nenvironment = \"sky.hdr\"");
    folder.write("room.toml", under_the_sky(BOX_SCENE));
    folder.write("mirror.obj", "v -0.5 0 0.5\nv 0.5 0 0.5\nv 0.5 0 -0.5\nv -0.5 0 -0.5\nf 1 2 3 4\n");
    folder.write("p.json", "{\"probes\":[{\"position\":[0,0.5,0]},{\"position\":[0.5,-0.5,0.2]}]}");
    let shown = |roughness: f64, more: &str| {
        let scene = under_the_sky(BOX_SCENE)
            .replace("box.obj\"", "mirror.obj\"\nmaterial = \"metal\"")
            .replace("eye = [0, 0, 0.9]", "eye = [0, 0.3, 0.3]");
        let metal = format!(
            "[material.metal]\nmodel = \"ggx\"\ndiffuse = [1, 1, 1]\nmetallic = 1\nroughness = {roughness}\n"
        );
        folder.write("mirror.toml", scene + &metal + more);
        folder.prints(&["render", "mirror.toml", "--overwrite", "--float", "-o", "mirror.exr"]);
        let picture = read_exr_picture(&std::fs::read(folder.path("mirror.exr")).unwrap()).unwrap();
        f64::from(picture.color[4 * 8 + 4][1])
    };
    for order in ["2", "4", "8"] {
        let line = [
            "probe",
            "bake",
            "room.toml",
            "p.json",
            "--what",
            "total",
            "--resolution",
            "16",
            "--bounces",
            "0",
        ];
        folder.prints(&[&line[..], &["--order", order, "-o", "baked.json"]].concat());
        assert_eq!(json(&folder, "baked.json")["order"].to_string(), order);
        for roughness in [0.0, 0.4] {
            let open = shown(roughness, "");
            let indoors = shown(roughness, "[ambient]\nprobes = \"baked.json\"\n");
            assert!((indoors / open - 1.0 / 9.0).abs() < 0.003, "{order} {roughness}: {indoors} of {open}");
        }
    }
}
