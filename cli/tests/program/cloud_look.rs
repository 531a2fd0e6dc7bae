//! `scan` and `surfel`: which points are drawn and in which colours; `info` for what there is to choose from.

use crate::common::Folder;
use image::Rgba;

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3362\nproperty double x\nproperty double y\nproperty double z\n\
    property float nx\nproperty float ny\nproperty float nz\nproperty float scalar_Intensity\nproperty uchar classification\n\
    property uchar return_number\nend_header\n";

/// Two sheets of 41 × 41 points that face +Z: on the left buildings (6) at z = 0, on the right ground (2) at z = 1 with a higher
/// intensity and the second return.
fn town(folder: &Folder) {
    let mut text = HEADER.to_owned();
    for (offset, z, intensity, class, number) in [(-1.2, 0, 10, 6, 1), (1.2, 1, 90, 2, 2)] {
        for i in 0..41 * 41 {
            let (x, y) = (offset + f64::from(i % 41 - 20) * 0.05, f64::from(i / 41 - 20) * 0.05);
            text += &format!("{x} {y} {z} 0 0 1 {intensity} {class} {number}\n");
        }
    }
    folder.write("town.ply", text);
}

const VIEW: [&str; 8] = ["--eye", "0,0,6", "--target", "0,0,0", "--fov", "30", "--size", "120x80"];

/// Colours in the middle of the left and of the right sheet, without shading.
fn sheets(folder: &Folder, command: &str, more: &[&str]) -> [Rgba<u8>; 2] {
    let line = [&[command, "town.ply", "-o", "a.png", "--ambient", "1"][..], &VIEW, more].concat();
    folder.prints(&line);
    let picture = image::open(folder.path("a.png")).unwrap().into_rgba8();
    [*picture.get_pixel(30, 40), *picture.get_pixel(96, 40)]
}

fn is_near(found: Rgba<u8>, wanted: [u8; 3]) -> bool {
    found[3] == 255 && found.0.iter().zip(wanted).all(|(a, b)| a.abs_diff(b) <= 3)
}

#[test]
fn points_take_the_colours_of_what_was_measured() {
    let folder = Folder::new();
    town(&folder);
    for command in ["scan", "surfel"] {
        let colours = |more: &[&str]| sheets(&folder, command, more);
        // The ends of viridis, and those of grey.
        let (dark, light) = ([68, 1, 84], [254, 232, 37]);
        for by in ["intensity", "elevation", "z"] {
            let [left, right] = colours(&["--color-by", by]);
            assert!(is_near(left, dark) && is_near(right, light), "{command} {by}: {left:?} {right:?}");
        }
        let [left, right] =
            colours(&["--color-by", "intensity", "--color-map", "gray", "--color-range", "10,170"]);
        assert!(is_near(left, [0; 3]) && is_near(right, [128; 3]), "{command}: {left:?} {right:?}");
        let [left, right] = colours(&["--color-by", "class"]);
        assert!(
            is_near(left, [216, 84, 62]) && is_near(right, [166, 118, 72]),
            "{command}: {left:?} {right:?}"
        );
        let [left, right] = colours(&["--color-by", "return"]);
        assert_ne!(left, right, "{command}");
        let [left, right] = colours(&["--color-by", "scan"]);
        assert_eq!(left, right, "{command}");
        // Towards +Z, whatever the light.
        let [left, _] = colours(&["--color-by", "normal"]);
        assert!(is_near(left, [128, 128, 255]), "{command}: {left:?}");
    }
}

#[test]
fn boxes_and_classes_choose_points() {
    let folder = Folder::new();
    town(&folder);
    let left_only: [&[&str]; 6] = [
        &["--classes", "6"],
        &["--drop-classes", "2,7"],
        &["--box", "-3,-3,-1,0,3,2"],
        &["--box", "0,-inf,-inf,-inf,inf,inf"],
        &["--drop-box", "0,-3,0.5,3,3,3"],
        &["--box", "-3,-3,-1,-1.2,3,2", "--box", "-1.2,-3,-1,0,3,2"],
    ];
    for command in ["scan", "surfel"] {
        let whole = sheets(&folder, command, &[]);
        assert!(whole.iter().all(|pixel| pixel[3] == 255), "{command}: {whole:?}");
        for more in left_only {
            let [left, right] = sheets(&folder, command, more);
            assert!(left[3] == 255 && right[3] == 0, "{command} {more:?}: {left:?} {right:?}");
        }
        let line = |more: &[&'static str]| [&[command, "town.ply", "-o", "b.png"][..], more].concat();
        folder.fails(
            &line(&["--box", "9,9,9,10,10,10"]),
            3,
            &["town.ply", "no point is left", "pointillist info"],
        );
        folder.fails(&line(&["--classes", "9"]), 3, &["town.ply", "no point is left"]);
        folder.fails(&line(&["--classes", "300"]), 2, &["--classes", "255"]);
        folder.fails(&line(&["--box", "1,2,3"]), 2, &["3 numbers", "six"]);
        folder.fails(&line(&["--box", "1,2,3,4,5,nan"]), 2, &["--box", "must be numbers"]);
    }
    // A scan of a list is chosen by where its pose puts it; one of which nothing is left is no error.
    folder.write("two.conf", "bmesh town.ply 100 0 0 0 0 0 1\nbmesh town.ply 0 0 0 0 0 0 1\n");
    folder.prints(
        &[&["scan", "two.conf", "-o", "c.png", "--box", "90,-5,-5,110,5,5", "--stats", "s.json"][..], &VIEW]
            .concat(),
    );
    let stats: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path("s.json")).unwrap()).unwrap();
    assert_eq!(stats["counts"]["points"], 3362, "{stats}");
}

#[test]
fn a_legend_is_drawn_where_there_is_room_and_something_to_say() {
    let folder = Folder::new();
    town(&folder);
    let draw = |output: &str, more: &[&str]| {
        let line = [&["surfel", "town.ply", "-o", output, "--size", "320x240"][..], more].concat();
        folder.prints(&line);
        image::open(folder.path(output)).unwrap().into_rgba8()
    };
    let plain = draw("plain.png", &["--color-by", "class"]);
    for more in [&["--legend"][..], &["--legend", "--exposure", "3"]] {
        let legend = draw("legend.png", &[&["--color-by", "class"], more].concat());
        let corner = |picture: &image::RgbaImage| {
            (0..60)
                .flat_map(|x| (190..235).map(move |y| (x, y)))
                .filter(|&(x, y)| picture.get_pixel(x, y).0 == [255; 4])
                .count()
        };
        assert!(corner(&legend) > 50 && corner(&plain) == 0, "{} white letters", corner(&legend));
        assert_eq!(legend.get_pixel(319, 0), plain.get_pixel(319, 0));
        let ground = legend.pixels().filter(|pixel| is_near(**pixel, [166, 118, 72])).count();
        assert!(ground >= 64, "the colour of the ground is not shown as it is: {ground}");
    }
    let fails = |more: &[&str], pieces: &[&str]| {
        folder.fails(&[&["surfel", "town.ply"][..], more].concat(), 2, pieces);
    };
    fails(&["--legend"], &["--legend", "--color-by"]);
    fails(&["--legend", "--color-by", "normal"], &["--legend"]);
    fails(&["--legend", "--color-by", "class", "-o", "a.exr"], &["--legend", "png"]);
    fails(&["--color-map", "turbo"], &["--color-map", "intensity"]);
    fails(&["--color-range", "0,1", "--color-by", "class"], &["--color-range"]);
    fails(&["--color-range", "2,1", "--color-by", "x"], &["smaller first"]);
    let small = folder.command(&[
        "scan",
        "town.ply",
        "-o",
        "s.png",
        "--size",
        "30x30",
        "--color-by",
        "x",
        "--legend",
    ]);
    let output = { small }.output().unwrap();
    assert!(String::from_utf8_lossy(&output.stderr).contains("too small for one"), "{output:?}");
}

#[test]
fn what_a_file_does_not_have_is_an_error_that_names_it() {
    let folder = Folder::new();
    folder.write("bare.xyz", "0 0 0\n1 0 0\n0 1 0\n");
    for command in ["scan", "surfel"] {
        let fails = |more: &[&str], pieces: &[&str]| {
            folder.fails(&[&[command, "bare.xyz"][..], more].concat(), 3, pieces);
        };
        fails(&["--color-by", "intensity"], &["bare.xyz", "no intensity"]);
        fails(&["--color-by", "return"], &["bare.xyz", "no return number"]);
        fails(&["--classes", "2"], &["bare.xyz", "no classes"]);
    }
    folder.fails(
        &["scan", "triangle.obj", "--classes", "2"],
        3,
        &["triangle.obj", "mesh", "pointillist sample"],
    );
    folder.fails(&["scan", "triangle.obj", "--color-by", "class"], 3, &["triangle.obj", "mesh"]);
    folder.prints(&["scan", "triangle.obj", "--color-by", "y", "--legend", "-o", "t.png"]);
}

#[test]
fn text_has_intensities_in_its_fourth_column_or_by_name() {
    let folder = Folder::new();
    let rows = |line: &dyn Fn(i32) -> String| (0..400).map(|i| line(i) + "\n").collect::<String>();
    let place = |i: i32| format!("{} {} 0", f64::from(i % 20) * 0.1, f64::from(i / 20) * 0.1);
    folder.write("four.xyz", rows(&|i| format!("{} {}", place(i), i % 20)));
    folder.write("seven.pts", rows(&|i| format!("{} {} 255 0 0", place(i), i % 20)));
    let named = rows(&|i| format!("{} {} 5", place(i), i % 20).replace(' ', ","));
    folder.write("named.csv", format!("X,Y,Z,Intensity,Classification\n{named}"));
    let view = ["--eye", "0.95,0.95,5", "--target", "0.95,0.95,0", "--fov", "20", "--size", "40x40"];
    let draw = |file: &str| {
        folder.prints(&[&["scan", file, "--color-by", "intensity", "-o", "a.png"][..], &view].concat());
        image::open(folder.path("a.png")).unwrap().into_rgba8()
    };
    let four = draw("four.xyz");
    assert_ne!(four.get_pixel(8, 20), four.get_pixel(32, 20));
    assert_eq!(four, draw("seven.pts"));
    assert_eq!(four, draw("named.csv"));
    let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", "named.csv"])).unwrap();
    assert_eq!(info["intensities"], serde_json::json!([0.0, 19.0]));
    assert_eq!(
        info["classes"],
        serde_json::json!([{ "class": 5, "name": "high vegetation", "points": 400 }])
    );
    assert_eq!(info["warnings"], serde_json::json!([]), "{info}");
    assert!((info["spacing"].as_f64().unwrap() - 0.1).abs() < 1e-9, "{info}");
    let density = info["density"].as_f64().unwrap();
    assert!((density - 400.0 / (1.9 * 1.9)).abs() < 1e-6, "{density}");
}

#[cfg(feature = "las")]
mod las_files {
    use super::*;
    use las::point::Classification;
    use las::{Builder, Point, Transform, Vector, Writer};
    use std::io::Cursor;

    /// A field at coordinates of a national grid in millimetres, as LAS and as text with all digits.
    fn field(folder: &Folder) {
        let mut builder = Builder::from((1, 2));
        let axis = |offset| Transform { scale: 0.001, offset };
        builder.transforms = Vector { x: axis(393_000.0), y: axis(5_819_000.0), z: axis(0.0) };
        let mut writer = Writer::new(Cursor::new(Vec::new()), builder.into_header().unwrap()).unwrap();
        let mut text = "x y z intensity classification return_number\n".to_owned();
        for i in 0..1600 {
            let [x, y, z] = [393_123_456 + 37 * (i % 40), 5_819_876_543 + 41 * (i / 40), 301_007 + i % 7];
            let (intensity, class) = ((i % 100) as u16, [2, 6][(i % 2) as usize]);
            let meters = |n: i64| n as f64 / 1000.0;
            let classification = Classification::new(class).unwrap();
            let point = Point {
                x: meters(x),
                y: meters(y),
                z: meters(z),
                intensity,
                classification,
                return_number: 1,
                number_of_returns: 1,
                ..Point::default()
            };
            writer.write_point(point).unwrap();
            let decimal = |n: i64| format!("{}.{:03}", n / 1000, n % 1000);
            text += &format!("{} {} {} {intensity} {class} 1\n", decimal(x), decimal(y), decimal(z));
        }
        folder.write("field.las", writer.into_inner().unwrap().into_inner());
        folder.write("field.txt", text);
    }

    #[test]
    fn las_is_the_same_to_the_last_digit_as_text() {
        let folder = Folder::new();
        field(&folder);
        let info = |name: &str| -> serde_json::Value {
            let mut info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", name])).unwrap();
            info["format"] = "".into();
            info
        };
        let las = info("field.las");
        assert_eq!(las, info("field.txt"));
        assert_eq!(las["bounds"][1][1], 5_819_878.142);
        assert_eq!(las["classes"].as_array().unwrap().len(), 2, "{las}");
        for command in ["scan", "surfel"] {
            for by in ["intensity", "class", "return", "elevation"] {
                for name in ["field.las", "field.txt"] {
                    let output = format!("{name}.exr");
                    folder.prints(&[
                        command,
                        name,
                        "--color-by",
                        by,
                        "--classes",
                        "2",
                        "--size",
                        "60x60",
                        "-o",
                        &output,
                    ]);
                }
                let [las, text] =
                    ["field.las.exr", "field.txt.exr"].map(|name| std::fs::read(folder.path(name)).unwrap());
                assert!(las == text, "{command} {by}");
                for name in ["field.las.exr", "field.txt.exr"] {
                    std::fs::remove_file(folder.path(name)).unwrap();
                }
            }
        }
    }
}
