//! `probe capture`: panoramas at positions become probes.

use crate::common::Folder;
use serde_json::Value;
use std::f64::consts::PI;

const WIDTH: u32 = 64;
const HEIGHT: u32 = 32;

/// Radiance of a pixel: a dim room with a lamp 40 times as bright right of the centre, and red above.
fn radiance(x: u32, y: u32) -> [f32; 3] {
    let lamp = x.abs_diff(48) < 4 && y.abs_diff(16) < 3;
    let value = if lamp { 8.0 } else { 0.2 };
    if y < 8 { [3.0 * value, value, value] } else { [value; 3] }
}

/// A float picture of the whole range.
fn write_hdr(folder: &Folder, name: &str) {
    let picture = image::Rgb32FImage::from_fn(WIDTH, HEIGHT, |x, y| image::Rgb(radiance(x, y)));
    picture.save(folder.path(name)).unwrap();
}

/// A photograph with levels proportional to radiance; what is brighter than 2^exposure is clipped.
fn write_photograph(folder: &Folder, name: &str, exposure: f32) {
    let level = |v: f32| (v * (-exposure).exp2() * 255.0).round().clamp(0.0, 255.0) as u8;
    let picture = image::RgbImage::from_fn(WIDTH, HEIGHT, |x, y| image::Rgb(radiance(x, y).map(level)));
    picture.save(folder.path(name)).unwrap();
}

fn capture(folder: &Folder, list: &str, more: &[&str]) -> Value {
    folder.write("list.json", list);
    folder.prints(&[&["probe", "capture", "list.json", "-o", "probes.json"], more].concat());
    serde_json::from_slice(&std::fs::read(folder.path("probes.json")).unwrap()).unwrap()
}

fn sh(probe: &Value) -> Vec<[f64; 3]> {
    serde_json::from_value(probe["sh"].clone()).unwrap()
}

/// The largest difference over the first coefficient.
fn off(found: &[[f64; 3]], wanted: &[[f64; 3]]) -> f64 {
    assert_eq!(found.len(), wanted.len());
    let difference = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
    found.iter().zip(wanted).map(difference).fold(0.0, f64::max) / wanted[0][0]
}

#[test]
fn one_picture_becomes_what_project_makes_of_it() {
    let folder = Folder::new();
    write_hdr(&folder, "room.hdr");
    let text = r#"{"captures":[{"image":"room.hdr","position":[1,2,3],"rotate":[0,0,0],"name":"hall"}]}"#;
    let file = capture(&folder, text, &["--order", "4"]);
    let probe = &file["probes"][0];
    assert_eq!(probe["position"], serde_json::json!([1.0, 2.0, 3.0]));
    assert_eq!((probe["name"].as_str(), file["order"].as_u64()), (Some("hall"), Some(4)));
    let project: Value =
        serde_json::from_str(&folder.prints(&["probe", "project", "room.hdr", "--order", "4"])).unwrap();
    assert!(off(&sh(probe), &sh(&project)) < 1e-6);
    // Stops brighten, as they do there.
    let text = r#"{"captures":[{"image":"room.hdr","position":[1,2,3],"rotate":[0,0,0],"exposure":2}]}"#;
    let brighter = capture(&folder, text, &["--order", "4"]);
    let wanted: Vec<[f64; 3]> = sh(probe).iter().map(|c| c.map(|v| 4.0 * v)).collect();
    assert!(off(&sh(&brighter["probes"][0]), &wanted) < 1e-6);
}

#[test]
fn a_turned_camera_sees_the_same_world() {
    let folder = Folder::new();
    // Brighter towards −Z, the picture's centre: the only coefficient of band 1 is that of z.
    let towards_centre = |x: u32| {
        let angle = 2.0 * std::f32::consts::PI * (x as f32 + 0.5) / WIDTH as f32;
        1.0 - angle.cos()
    };
    let picture = image::Rgb32FImage::from_fn(WIDTH, HEIGHT, |x, _| image::Rgb([towards_centre(x); 3]));
    picture.save(folder.path("front.hdr")).unwrap();
    let entry =
        |x: f64, rotate: &str| format!(r#"{{"image":"front.hdr","position":[{x},0,0],"rotate":{rotate}}}"#);
    // About y by 90° from −Z to −X; about x by 90° from −Z to +Y; x first, then y: the turn about y leaves +Y alone.
    let turns = ["[0,0,0]", "[0,90,0]", "[90,0,0]", "[90,90,0]"];
    let entries: Vec<String> = turns.iter().zip(0..).map(|(t, x)| entry(f64::from(x), t)).collect();
    let file = capture(&folder, &format!("{{\"captures\":[{}]}}", entries.join(",")), &[]);
    // Coefficients 1 to 3 are those of y, z and x.
    let ways = [(2, -1.0), (3, -1.0), (1, 1.0), (1, 1.0)];
    for (i, (axis, sign)) in ways.into_iter().enumerate() {
        let sh = sh(&file["probes"][i]);
        let strength = sh[axis][0] * sign;
        assert!(strength > 0.3 * sh[0][0], "{i}: {sh:?}");
        let rest = (1..4).filter(|&k| k != axis).map(|k| sh[k][0].abs()).fold(0.0, f64::max);
        assert!(rest < 1e-3 * strength, "{i}: {sh:?}");
    }
}

#[test]
fn brackets_hold_the_range_that_no_photograph_has() {
    let folder = Folder::new();
    write_hdr(&folder, "room.hdr");
    let (mut entries, mut alone) = (vec![], vec![]);
    for (i, exposure) in [-2.0_f32, 1.0, 5.0].into_iter().enumerate() {
        write_photograph(&folder, &format!("p{i}.png"), exposure);
        let at = |x: usize| {
            format!(
                r#"{{"image":"p{i}.png","position":[{x},0,-0.0],"rotate":[0,30,0],"exposure":{exposure}}}"#
            )
        };
        entries.push(at(7));
        alone.push(at(8 + i));
    }
    alone.push(r#"{"image":"room.hdr","position":[0,0,0],"rotate":[0,30,0]}"#.to_owned());
    let list = format!("{{\"captures\":[{}]}}", [entries, alone].concat().join(","));
    let file = capture(&folder, &list, &["--response", "linear"]);
    let probes = file["probes"].as_array().unwrap();
    assert_eq!(probes.len(), 5);
    let wanted = sh(&probes[4]);
    let merged = off(&sh(&probes[0]), &wanted);
    assert!(merged < 0.01, "{merged}");
    // Of single ones the bright ones are clipped, and the dark one has hardly any levels for the room.
    for single in &probes[1..4] {
        assert!(off(&sh(single), &wanted) > 2.0 * merged, "{single}");
    }
}

#[test]
fn captured_probes_light_a_scene() {
    let folder = Folder::new();
    let grey = image::Rgb32FImage::from_pixel(32, 16, image::Rgb([0.5, 0.25, 0.125]));
    grey.save(folder.path("grey.hdr")).unwrap();
    folder.write("q.txt", "0 0 0  0 1 0\n");
    for output in ["probes.json", "probes.probes"] {
        folder.write(
            "list.json",
            r#"{"captures":[{"image":"grey.hdr","position":[0,0,0],"rotate":[10,20,30]},
                {"image":"grey.hdr","position":[4,0,0],"rotate":[0,0,0]}]}"#,
        );
        folder.prints(&["probe", "capture", "list.json", "-o", output]);
        let line = folder.prints(&["probe", "query", output, "q.txt"]);
        let light: Vec<f64> = line.trim().split(' ').map(|v| v.parse().unwrap()).collect();
        for (found, wanted) in light.iter().zip([0.5, 0.25, 0.125]) {
            assert!((found / (PI * wanted) - 1.0).abs() < 2e-3, "{line}");
        }
    }
    assert!(folder.prints(&["info", "list.json"]).contains("captures"));
}

#[test]
fn lists_that_cannot_be_used_name_what_is_wrong() {
    let folder = Folder::new();
    write_hdr(&folder, "room.hdr");
    let small = image::Rgb32FImage::from_pixel(16, 8, image::Rgb([1.0; 3]));
    small.save(folder.path("small.hdr")).unwrap();
    let entry =
        |image: &str, rotate: &str| format!(r#"{{"image":"{image}","position":[0,0,0],"rotate":{rotate}}}"#);
    let list = |entries: &[String]| format!("{{\"captures\":[{}]}}", entries.join(","));
    let whole = entry("room.hdr", "[0,0,0]");
    for (text, words) in [
        (list(&[]), vec!["`captures` is empty"]),
        (list(&[entry("nowhere.hdr", "[0,0,0]")]), vec!["captures[0].image", "nowhere.hdr", "is not there"]),
        (list(&[r#"{"image":"room.hdr","position":[0,0,0]}"#.to_owned()]), vec!["captures[0]", "rotate"]),
        (list(&[r#"{"image":"room.hdr","rotate":[0,0,0]}"#.to_owned()]), vec!["captures[0]", "position"]),
        (list(&[r#"{"position":[0,0,0],"rotate":[0,0,0]}"#.to_owned()]), vec!["captures[0]", "image"]),
        (list(&[whole.clone(), entry("small.hdr", "[0,0,0]")]), vec!["captures[1]", "16×8", "64×32"]),
        (list(&[whole.clone(), entry("room.hdr", "[0,1,0]")]), vec!["captures[1].rotate", "captures[0]"]),
        (whole.replace("}", r#","exposure":100}"#), vec!["unknown field"]),
        (list(&[whole.replace('}', r#","exposure":100}"#)]), vec!["captures[0].exposure", "-60 to 60"]),
        (list(&[whole.replace("[0,0,0],", "[1e19,0,0],")]), vec!["captures[0].position"]),
        (list(&[whole.replace('}', r#","tilt":1}"#)]), vec!["captures[0]", "tilt"]),
    ] {
        folder.write("list.json", &text);
        folder.fails(&["probe", "capture", "list.json", "-o", "p.json"], 3, &words);
    }
    folder.write("list.json", list(&[whole]));
    folder.fails(&["probe", "capture", "list.json", "--order", "9"], 2, &["--order"]);
    folder.fails(&["probe", "capture", "list.json", "-o", "p.png"], 2, &[".json or .probes"]);
    folder.fails(&["probe", "capture", "missing.json"], 3, &["missing.json"]);
    folder.write("p.json", "{\"probes\":[]}");
    folder.fails(&["probe", "capture", "p.json"], 3, &["light probes", "list of panoramas"]);
}
