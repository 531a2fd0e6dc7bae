//! What pictures are written as: opaque, in 8 and 16 bits, as JPEG, and in front of a map.

use crate::common::Folder;
use image::{DynamicImage, GenericImageView as _};
use pointillist_cli::image_io::{ExrFile, read_picture};

fn open(folder: &Folder, name: &str) -> DynamicImage {
    image::open(folder.path(name)).unwrap()
}

fn exr(folder: &Folder, name: &str) -> ExrFile {
    ExrFile::read(&std::fs::read(folder.path(name)).unwrap()).unwrap()
}

#[test]
fn an_opaque_picture_has_the_colour_that_is_asked_for() {
    let folder = Folder::new();
    let draw = |more: &[&str]| folder.prints(&[&["render", "scene.toml"], more].concat());
    draw(&["-o", "a.png", "--bg", "#ff8001"]);
    draw(&["-o", "b.png", "--bg", "ff8001", "--exposure", "-2"]);
    draw(&["-o", "c.jpg", "--bg", "white"]);
    for name in ["a.png", "b.png"] {
        let picture = open(&folder, name);
        assert_eq!(picture.color(), image::ColorType::Rgb8, "{name} has alpha");
        assert_eq!(picture.get_pixel(0, 0).0[..3], [0xff, 0x80, 0x01], "{name}");
    }
    assert!(open(&folder, "c.jpg").get_pixel(0, 0).0[..3].iter().all(|&level| level > 250));
    // Linear, and the same picture as the transparent one in front of that colour.
    draw(&["-o", "t.exr", "--float"]);
    draw(&["-o", "o.exr", "--float", "--bg", "0.25,0.5,0.75"]);
    let (transparent, opaque) = (exr(&folder, "t.exr"), exr(&folder, "o.exr"));
    assert!(opaque.plane("A").unwrap().iter().all(|&a| a == 1.0));
    let alpha = transparent.plane("A").unwrap();
    assert!(alpha.iter().any(|&a| a > 0.0 && a < 1.0));
    for (channel, behind) in [("R", 0.25), ("G", 0.5), ("B", 0.75)] {
        let (own, all) = (transparent.plane(channel).unwrap(), opaque.plane(channel).unwrap());
        for i in 0..alpha.len() {
            let wanted = own[i] + (1.0 - alpha[i]) * behind;
            assert!((all[i] - wanted).abs() < 1e-6, "{channel} of pixel {i}: {} is not {wanted}", all[i]);
        }
    }
    // The background is part of what an EXR is known by.
    folder.fails(
        &["render", "scene.toml", "-o", "o.exr", "--float", "--bg", "0.25,0.5,0.75"],
        0,
        &["already there"],
    );
    folder.fails(
        &["render", "scene.toml", "-o", "o.exr", "--float", "--bg", "0.25,0.5,0.76"],
        0,
        &[" pixels in "],
    );
}

#[test]
fn points_are_drawn_in_front_of_a_colour() {
    let folder = Folder::new();
    folder.prints(&["sample", "triangle.obj", "--count", "500", "-o", "c.ply"]);
    for command in ["scan", "surfel"] {
        folder.prints(&[command, "c.ply", "--size", "32x32", "--bg", "08f", "-o", "p.png"]);
        let picture = open(&folder, "p.png");
        assert_eq!(picture.color(), image::ColorType::Rgb8);
        assert_eq!(picture.get_pixel(0, 0).0[..3], [0x00, 0x88, 0xff], "{command}");
    }
}

#[test]
fn sixteen_bits_and_jpeg_hold_the_same_picture() {
    let folder = Folder::new();
    let draw = |more: &[&str]| folder.prints(&[&["render", "scene.toml", "--bg", "black"], more].concat());
    draw(&["-o", "p.exr", "--float"]);
    draw(&["-o", "p.png", "--bits", "16"]);
    draw(&["-o", "p.jpg", "--quality", "100"]);
    draw(&["-o", "small.jpeg", "--quality", "10"]);
    assert_eq!(open(&folder, "p.png").color(), image::ColorType::Rgb16);
    let read = |name: &str| read_picture(&folder.path(name)).unwrap().color;
    let truth = read("p.exr");
    let largest = |name: &str| {
        let pairs = truth.iter().zip(read(name));
        pairs.flat_map(|(a, b)| (0..3).map(move |c| (a[c].min(1.0) - b[c]).abs())).fold(0.0, f32::max)
    };
    // Half a step of 1/65535 where the curve of sRGB is steepest, 2.3 times that.
    assert!(largest("p.png") < 2e-5, "{}", largest("p.png"));
    // JPEG transforms and rounds blocks, and mixes edges a little.
    assert!(largest("p.jpg") < 0.05, "{}", largest("p.jpg"));
    let bytes = |name: &str| std::fs::metadata(folder.path(name)).unwrap().len();
    assert!(bytes("small.jpeg") < bytes("p.jpg"));
    // Straight alpha in 16 bits: the colour at an edge is that of the triangle.
    folder.prints(&[
        "render",
        "scene.toml",
        "-o",
        "alpha.png",
        "--bits",
        "16",
        "--set",
        "image.background=[1,0,0]",
    ]);
    let picture = open(&folder, "alpha.png").into_rgba16();
    let edges: Vec<_> = picture.pixels().filter(|p| p.0[3] > 0x1000 && p.0[3] < 0xf000).collect();
    assert!(!edges.is_empty());
    for pixel in edges {
        let [r, g, _, _] = pixel.0;
        assert!(r.abs_diff(g) < 200, "{pixel:?} has red of the background");
    }
}

#[test]
fn parts_become_a_jpeg() {
    let folder = Folder::new();
    for tile in ["0", "1"] {
        let (share, name) = (format!("{tile}/2"), format!("{tile}.exr"));
        folder.prints(&["render", "scene.toml", "--tile", &share, "-o", &name]);
    }
    folder.prints(&["merge", "0.exr", "1.exr", "-o", "m.jpg"]);
    folder.prints(&["merge", "0.exr", "1.exr", "-o", "m.png", "--bits", "16"]);
    assert_eq!(open(&folder, "m.jpg").dimensions(), (16, 12));
    assert_eq!(open(&folder, "m.png").color(), image::ColorType::Rgba16);
}

#[test]
fn what_a_format_has_no_room_for_is_refused() {
    let folder = Folder::new();
    let refused = |more: &[&str], piece: &str| {
        folder.fails(&[&["render", "scene.toml"], more].concat(), 2, &[piece]);
    };
    refused(&["-o", "a.jpg", "--bits", "16"], "a JPEG has 8 bits");
    refused(&["-o", "a.exr", "--bits", "16"], "--bits is for PNG");
    refused(&["-o", "a.png", "--quality", "80"], "--quality is for JPEG");
    refused(&["-o", "a.jpg", "--layers", "N"], "need an .exr");
    refused(&["-o", "a.jpg", "--size", "70000x1"], "at most 65535 a side");
    refused(&["-o", "a.png", "--bg", "fffff"], "must be a colour such as ff8000");
    refused(&["-o", "a.png", "--bg", "1,2"], "2 numbers; three are needed");
    refused(&["-o", "a.png", "--bg=-1,0,0"], "from 0 to 65504");
    refused(&["-o", "a.png", "--bits", "12"], "8 or 16");
    refused(&["-o", "a.jpg", "--quality", "0"], "1 to 100");
    assert_eq!(folder.names(), ["scene.toml", "triangle.obj"]);
}

#[test]
fn a_model_is_lit_by_a_map_and_seen_in_front_of_it() {
    let folder = Folder::new();
    // Radiance 1 from everywhere.
    image::RgbImage::from_pixel(16, 8, image::Rgb([255; 3])).save(folder.path("sky.png")).unwrap();
    folder.write("m.toml", "[[object]]\nmesh=\"triangle.obj\"\n");
    let model = ["render", "triangle.obj", "--size", "32x32", "--env", "sky.png", "--float"];
    folder.prints(&[&model[..], &["-o", "m.exr", "--layers", "albedo,direct"]].concat());
    let file = exr(&folder, "m.exr");
    let (alpha, color) = (file.plane("A").unwrap(), file.plane("G").unwrap());
    let (albedo, direct) = (file.plane("albedo.G").unwrap(), file.plane("direct.G").unwrap());
    assert!(alpha.contains(&1.0) && alpha.contains(&0.0));
    for i in 0..alpha.len() {
        // White light from everywhere: albedo, and the map itself behind.
        let wanted = albedo[i] + (1.0 - alpha[i]);
        assert!((color[i] - wanted).abs() < 2e-3, "pixel {i}: {} is not {wanted}", color[i]);
        assert_eq!(direct[i], 0.0, "a lamp is there beside the map");
    }
    // With a colour behind, the map only lights.
    folder.prints(&[&model[..], &["-o", "b.exr", "--bg", "black", "--overwrite"]].concat());
    let hidden = exr(&folder, "b.exr").plane("G").unwrap();
    for i in 0..alpha.len() {
        assert!((hidden[i] - albedo[i]).abs() < 2e-3, "pixel {i}: {}", hidden[i]);
    }
    // Scenes name their own; what ambient light there is otherwise can be said beside the map.
    folder.fails(&["render", "m.toml", "--env", "sky.png"], 2, &["--set 'image.environment=\"sky.png\"'"]);
    folder.fails(&["render", "--env", "sky.png"], 2, &["--env is for models"]);
    folder.fails(&[&model[..5], &["none.hdr", "-o", "n.exr"]].concat(), 3, &["none.hdr"]);
    let dark = ["-o", "d.exr", "--bg", "black", "--set", "ambient.color=[0,0,0]", "--set", "light=[]"];
    folder.prints(&[&model[..], &dark].concat());
    let lamp = exr(&folder, "d.exr").plane("G").unwrap();
    assert!(lamp.iter().any(|&g| g > 0.1), "the lamp of models lights it, where the map does not");
}

#[test]
fn a_background_that_a_png_does_not_show_is_told_of() {
    let folder = Folder::new();
    let said = |more: &[&str]| {
        let line =
            [&["render", "scene.toml", "--set", "image.background=[1,0,0]", "--overwrite"], more].concat();
        let output = folder.command(&line).output().expect("the command runs");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{more:?}: {text}");
        text
    };
    let told = "`image.background` is under alpha 0 in a PNG";
    assert!(said(&["-o", "a.png"]).contains(told));
    assert!(said(&["-o", "a.png", "--time-budget", "60"]).contains(told));
    assert_eq!(open(&folder, "a.png").into_rgba8().get_pixel(0, 0)[3], 0);
    for more in
        [&["-o", "a.jpg"][..], &["-o", "a.exr"], &["-o", "a.png", "--bg", "f00"], &["-o", "a.png", "--quiet"]]
    {
        assert!(!said(more).contains(told), "{more:?}");
    }
    assert!(!said(&["-o", "a.png", "--set", "image.background=[0,0,0]"]).contains(told));
}
