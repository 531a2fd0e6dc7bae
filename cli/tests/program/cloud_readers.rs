//! Readers of point clouds: every encoding gives back what was written, and every broken file a message with its place.

use crate::common::Folder;
use flate2::Compression;
use flate2::write::GzEncoder;
use glam::{DQuat, DVec3, Vec3, dvec3};
use pointillist_cli::InputError;
use pointillist_cli::cloud_io::{
    CloudFormat, CloudOptions, CloudSummary, MAX_BLOCK_POINTS, read_cloud, read_cloud_bytes, read_conf,
    read_conf_bytes,
};
use pointillist_cli::coordinate::LARGEST;
use pointillist_cli::scene::linear_from_srgb;
use proptest::prelude::*;
use std::io::Write;
use std::path::Path;

/// What was handed out, all blocks joined.
#[derive(Debug, Default, PartialEq)]
struct Points {
    positions: Vec<DVec3>,
    colours: Vec<[f32; 3]>,
    normals: Vec<Vec3>,
    radii: Vec<f32>,
}

fn read(name: &str, bytes: &[u8], options: &CloudOptions) -> Result<(Points, CloudSummary), InputError> {
    let mut points = Points::default();
    let summary = read_cloud_bytes::<InputError>(name, bytes, options, &mut |block| {
        let count = block.positions.len();
        assert!(count > 0 && count <= options.block_points.clamp(1, MAX_BLOCK_POINTS));
        assert!(block.colours.is_none_or(|colours| colours.len() == count));
        assert!(block.normals.is_none_or(|normals| normals.len() == count));
        assert!(block.radii.is_none_or(|radii| radii.len() == count));
        points.positions.extend(block.positions);
        points.colours.extend(block.colours.unwrap_or_default());
        points.normals.extend(block.normals.unwrap_or_default());
        points.radii.extend(block.radii.unwrap_or_default());
        Ok(())
    })?;
    assert_eq!(summary.points, points.positions.len() as u64);
    assert_eq!(summary.has_colours, !points.colours.is_empty());
    assert_eq!(summary.has_normals, !points.normals.is_empty());
    assert_eq!(summary.has_radii, !points.radii.is_empty());
    Ok((points, summary))
}

/// Expects an error that says all of the pieces, and a way out.
fn refused(name: &str, bytes: impl AsRef<[u8]>, pieces: &[&str]) {
    let error = read(name, bytes.as_ref(), &CloudOptions::DEFAULT).expect_err(name);
    let text = error.to_string();
    for piece in [name, "help: "].iter().chain(pieces) {
        assert!(text.contains(piece), "this does not say {piece:?}:\n{text}");
    }
}

fn gz(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

/// A point of a test: position, normal, radius, colour.
type Row = ([f32; 3], [f32; 3], f32, [u8; 3]);

/// A PLY with everything that is read, and things between that are not.
fn ply(rows: &[Row], encoding: Encoding, double: bool) -> Vec<u8> {
    let format = match encoding {
        Encoding::Ascii => "ascii",
        Encoding::Little => "binary_little_endian",
        Encoding::Big => "binary_big_endian",
    };
    let kind = if double { "double" } else { "float" };
    let mut file = format!(
        "ply\r\nformat {format} 1.0\ncomment caf\u{e9}\nelement before 2\nproperty short s\nelement vertex {}\n\
         property {kind} x\nproperty uchar red\nproperty {kind} y\nproperty uint8 green\nproperty {kind} z\n\
         property list uchar short marks\nproperty uchar blue\nproperty float32 nx\nproperty float ny\n\
         property float nz\nproperty int scan(angle)\nproperty float radius\nelement face 2\n\
         property list uchar int vertex_indices\nend_header\n",
        rows.len()
    )
    .into_bytes();
    let mut put = |number: Number| number.write(&mut file, encoding);
    (0..2).for_each(|_| put(Number::Short(-7)));
    let line_end = Number::LineEnd;
    for &([x, y, z], normal, radius, [red, green, blue]) in rows {
        let real = |value: f32| if double { Number::Double(f64::from(value)) } else { Number::Float(value) };
        [real(x), Number::UChar(red), real(y), Number::UChar(green), real(z)].into_iter().for_each(&mut put);
        [Number::UChar(2), Number::Short(1), Number::Short(300), Number::UChar(blue)]
            .into_iter()
            .for_each(&mut put);
        normal.into_iter().map(Number::Float).for_each(&mut put);
        [Number::Int(-1), Number::Float(radius), line_end].into_iter().for_each(&mut put);
    }
    for _ in 0..2 {
        [Number::UChar(3), Number::Int(0), Number::Int(0), Number::Int(0), line_end]
            .into_iter()
            .for_each(&mut put);
    }
    file
}

#[derive(Clone, Copy)]
enum Number {
    UChar(u8),
    Short(i16),
    Int(i32),
    Float(f32),
    Double(f64),
    LineEnd,
}

impl Number {
    fn write(self, file: &mut Vec<u8>, encoding: Encoding) {
        if encoding == Encoding::Ascii {
            // The element `before` has one number a line.
            let ending = if matches!(self, Self::Short(-7)) { "\n" } else { " " };
            match self {
                Self::UChar(n) => write!(file, "{n}{ending}"),
                Self::Short(n) => write!(file, "{n}{ending}"),
                Self::Int(n) => write!(file, "{n}{ending}"),
                Self::Float(n) => write!(file, "{n}{ending}"),
                Self::Double(n) => write!(file, "{n:e}{ending}"),
                Self::LineEnd => writeln!(file),
            }
            .unwrap();
            return;
        }
        let mut bytes = match self {
            Self::UChar(n) => n.to_le_bytes().to_vec(),
            Self::Short(n) => n.to_le_bytes().to_vec(),
            Self::Int(n) => n.to_le_bytes().to_vec(),
            Self::Float(n) => n.to_le_bytes().to_vec(),
            Self::Double(n) => n.to_le_bytes().to_vec(),
            Self::LineEnd => Vec::new(),
        };
        if encoding == Encoding::Big {
            bytes.reverse();
        }
        file.extend(bytes);
    }
}

fn points(rows: &[Row]) -> Points {
    let linear = |code: u8| linear_from_srgb(f32::from(code) / 255.0);
    Points {
        positions: rows.iter().map(|row| Vec3::from(row.0).as_dvec3()).collect(),
        colours: rows.iter().map(|row| row.3.map(linear)).collect(),
        normals: rows.iter().map(|row| row.1.into()).collect(),
        radii: rows.iter().map(|row| row.2).collect(),
    }
}

fn rows() -> impl Strategy<Value = Vec<Row>> {
    // All that is finite: zeros of both signs, subnormals, the largest.
    let real =
        prop_oneof![prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL | prop::num::f32::ZERO, -1.0f32..1.0];
    let three = [real.clone(), real.clone(), real.clone()];
    // Places go as far as they may.
    let place = three.clone().prop_map(|place| place.map(|x| x.clamp(-LARGEST as f32, LARGEST as f32)));
    prop::collection::vec((place, three, real, any::<[u8; 3]>()), 1..30)
}

proptest! {
    #![proptest_config(testkit::config(256))]

    #[test]
    fn every_ply_gives_back_its_points(rows in rows(), double in any::<bool>(), block in 1usize..40) {
        let options = CloudOptions::DEFAULT.with_block_points(block);
        for encoding in [Encoding::Ascii, Encoding::Little, Encoding::Big] {
            let file = ply(&rows, encoding, double);
            let (plain, summary) = read("a.ply", &file, &options).unwrap();
            prop_assert_eq!(&plain, &points(&rows));
            prop_assert_eq!(summary.faces, 2);
            prop_assert!(summary.warnings.is_empty());
            let (packed, _) = read("a.ply.gz", &gz(&file), &options).unwrap();
            prop_assert_eq!(plain, packed);
        }
    }

    #[test]
    fn every_text_gives_back_its_points(rows in rows(), separator in prop_oneof![Just(" "), Just("\t"), Just(","), Just(" ; ")], counted in any::<bool>(), block in 1usize..40) {
        let mut text = format!("# caf\u{e9}\n\n{}", if counted { format!("{}\n", rows.len()) } else { String::new() });
        for ([x, y, z], ..) in &rows {
            text += &format!("{x}{separator}{y}{separator}{z} // as it is\r\n");
        }
        let options = CloudOptions::DEFAULT.with_block_points(block);
        for bytes in [text.clone().into_bytes(), gz(text.as_bytes())] {
            let (read, summary) = read("a.xyz", &bytes, &options).unwrap();
            // Text has no type, so it is read in f64: `0.1` is nearer to 0.1 than the f32 was.
            prop_assert!(read.positions.iter().zip(&rows).all(|(read, row)| read.as_vec3() == Vec3::from(row.0)));
            prop_assert_eq!(summary.format, CloudFormat::Xyz);
        }
    }

    #[test]
    fn a_ply_cut_anywhere_is_an_error_or_keeps_its_points(rows in rows(), cut in any::<prop::sample::Index>()) {
        for encoding in [Encoding::Ascii, Encoding::Little, Encoding::Big] {
            let file = ply(&rows, encoding, false);
            let file = &file[..cut.index(file.len())];
            for (name, bytes) in [("a.ply", file.to_vec()), ("a.ply.gz", gz(file))] {
                match read(name, &bytes, &CloudOptions::DEFAULT) {
                    // Text that lacks only the last line end, or the last digits of a face.
                    Ok((found, _)) => prop_assert!(encoding == Encoding::Ascii && found == points(&rows)),
                    Err(error) => prop_assert!(error.help.is_some(), "{}", error),
                }
            }
        }
    }

    #[test]
    fn any_bytes_are_a_cloud_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let starts = ["ply\n", "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n", "\x1f\u{8b}", "", "1 2 3\n"];
        for start in starts {
            let bytes = [start.as_bytes(), &bytes].concat();
            for name in ["a.ply", "a.xyz", "a.gz"] {
                let _ = read(name, &bytes, &CloudOptions::DEFAULT).map_err(|error| error.to_string());
            }
            let _ = read_conf_bytes("a.conf", &bytes, Path::new(""), &|_| true).map_err(|error| error.to_string());
        }
    }
}

#[test]
fn many_points_come_in_blocks_of_65536() {
    let text = "1 2 3\n".repeat(150_000);
    let mut sizes = vec![];
    let summary =
        read_cloud_bytes::<InputError>("a.xyz", text.as_bytes(), &CloudOptions::DEFAULT, &mut |b| {
            sizes.push(b.positions.len());
            Ok(())
        });
    assert_eq!(sizes, [65_536, 65_536, 18_928]);
    assert_eq!(summary.unwrap().bounds, [dvec3(1.0, 2.0, 3.0); 2]);
}

#[test]
fn an_error_of_the_receiver_ends_the_reading_and_comes_back() {
    #[derive(Debug, PartialEq)]
    enum Mine {
        Enough,
        File,
    }
    impl From<InputError> for Mine {
        fn from(_: InputError) -> Self {
            Self::File
        }
    }
    let options = CloudOptions::DEFAULT.with_block_points(1);
    let file = format!("{HEADER}end_header\n1 2 3\n4 5 x\n");
    let result = read_cloud_bytes("a.ply", file.as_bytes(), &options, &mut |_| Err(Mine::Enough));
    assert_eq!(result.unwrap_err(), Mine::Enough);
    let result = read_cloud_bytes::<Mine>("a.ply", file.as_bytes(), &options, &mut |_| Ok(()));
    assert_eq!(result.unwrap_err(), Mine::File);
}

const HEADER: &str =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";

#[test]
fn colours_of_every_type_are_the_same_linear_colours() {
    let half = linear_from_srgb(0.5);
    for (kind, names, number) in [
        ("uchar", "red green blue", "127.5"),
        ("ushort", "diffuse_red diffuse_green diffuse_blue", "32767.5"),
        ("float", "r g b", ".5"),
        ("int", "red green blue", "127.5"),
    ] {
        let properties: String = names.split(' ').map(|name| format!("property {kind} {name}\n")).collect();
        let file =
            format!("{HEADER}{properties}end_header\n{0}{0}", format!("1 2 3 {number} {number} {number}\n"));
        let (points, _) = read("a.ply", file.as_bytes(), &CloudOptions::DEFAULT).unwrap();
        assert!(points.colours.iter().flatten().all(|c| (c - half).abs() < 0.002), "{kind}: {points:?}");
    }
}

#[test]
fn six_numbers_are_colours_or_normals_by_their_values() {
    let read = |text: &str| read("a.xyz", text.as_bytes(), &CloudOptions::DEFAULT).unwrap().0;
    assert_eq!(read("0 0 0 255 0 255\n").colours, [[1.0, 0.0, 1.0]]);
    assert_eq!(read("0 0 0 0 0 0\n").colours, [[0.0; 3]]);
    assert_eq!(read("0 0 0 1.0 0.0 1\n").colours, [[1.0, 0.0, 1.0]]);
    assert_eq!(read("0 0 0 0 0 1\n0 0 0 0.6 0.8 0\n").normals, [Vec3::Z, Vec3::new(0.6, 0.8, 0.0)]);
    assert_eq!(read("0 0 0 0.1 0.1 -2\n").normals, [Vec3::new(0.1, 0.1, -2.0)]);
    assert_eq!(read("1\n0 0 0 77 255 0 255\n").colours, [[1.0, 0.0, 1.0]]);
    refused("a.xyz", "0 0 0 300 0 0\n", &["line 1", "300", "0 to 255"]);
}

#[test]
fn the_grid_of_a_range_scan_gives_its_spacing() {
    // Two rows of three; the hole parts its neighbours, and the pair across rows is none.
    let header =
        HEADER.replace("element vertex 2", "obj_info num_cols 3\nobj_info num_rows 2\nelement vertex 5");
    let file = format!(
        "{header}element range_grid 6\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0\n1 0 0\n3 0 0\n100 0 0\n104 0 0\n1 0\n1 1\n1 2\n1 3\n0\n1 4\n"
    );
    let grid = read("a.ply", file.as_bytes(), &CloudOptions::DEFAULT).unwrap().1.grid.unwrap();
    assert_eq!((grid.cols, grid.rows, grid.filled), (3, 2, 5));
    assert_eq!(grid.spacing, Some(2.0));
    refused("a.ply", file.replace("1 4\n", "1 5\n"), &["a.ply:22:1", "vertex 5", "there are 5"]);
    let (_, summary) =
        read("a.ply", file.replace("num_rows 2", "num_rows 3").as_bytes(), &CloudOptions::DEFAULT).unwrap();
    assert!(summary.grid.is_none() && summary.warnings[0].contains("range grid"));
}

#[test]
fn broken_ply_names_line_or_byte() {
    let ascii = |rest: &str| format!("{HEADER}{rest}");
    refused("a.ply", ascii("end_header\n1 2 3\n"), &["after line 8", "1 of 2 `vertex`"]);
    refused("a.ply", ascii("end_header\n1 2 3\n1 2 x\n"), &["a.ply:9:5", "`x` is no number", "1 2 x"]);
    refused("a.ply", ascii("end_header\n1 2 3\n1 2\n"), &["a.ply:9:1", "before the property `z`"]);
    refused("a.ply", ascii("end_header\n1 2 3\n1 2 3 4\n"), &["a.ply:9:7", "`4` is more"]);
    refused(
        "a.ply",
        ascii("end_header\n1 2 3\n1 2 \u{fffd}\n").replace('\u{fffd}', "\u{e9}"),
        &["a.ply:9:5"],
    );
    refused("a.ply", ascii("property float16 w\nend_header\n"), &["a.ply:7:10", "`float16` is no type"]);
    refused("a.ply", ascii("property float x\nend_header\n"), &["a.ply:7:16", "`x` is there a second time"]);
    refused("a.ply", ascii("property list float int l\nend_header\n"), &["a.ply:7:15", "integer"]);
    refused("a.ply", ascii("bye\nend_header\n"), &["a.ply:7:1", "not PLY", "bye"]);
    refused("a.ply", ascii(""), &["no line `end_header`"]);
    refused("a.ply", "ply\nelement vertex 1\nend_header\n", &["not PLY"]);
    refused("a.ply", "ply\nformat ascii 1.0\nend_header\n", &["no line `element vertex`"]);
    refused("a.ply", HEADER.replace("float y", "float h") + "end_header\n", &["a.ply:3:1", "no property y"]);
    refused("a.ply", HEADER.replace("vertex 2", "vertex 0") + "end_header\n", &["no points"]);
    refused("a.ply", "hello", &["first line is not `ply`"]);
    refused("a.ply", "", &["first line is not `ply`"]);
    let colour =
        ascii("property float red\nproperty float green\nproperty float blue\nend_header\n1 2 3 0 0 255\n");
    refused("a.ply", colour, &["a.ply:11:1", "`blue` is 255", "0 to 1"]);
    let long = ascii("end_header\n1 2 3\n") + &"1".repeat(1 << 19);
    refused("a.ply", long, &["line 9 is longer than"]);
}

#[test]
fn what_a_header_promises_is_not_believed() {
    let header = HEADER.replace("vertex 2", "vertex 4000000000");
    refused("a.ply", format!("{header}end_header\n1 2 3\n"), &["1 of 4000000000"]);
    let file = header.replace("ascii", "binary_big_endian") + "end_header\n123456789012";
    refused("a.ply", &file, &[&format!("at byte {}", file.len()), "1 of 4000000000"]);
    let list = "element other 1\nproperty list uint double l\nelement vertex 1\n";
    let binary = HEADER.replace("ascii", "binary_little_endian").replace("element vertex 2\n", list);
    let start = format!("{binary}end_header\n");
    let file = [start.as_bytes(), b"\xff\xff\xff\xffabc"].concat();
    let at = format!("byte {}", start.len() + 4);
    refused("a.ply", file, &["`l`", "4294967295 items", &at, "3 bytes"]);
    let start = start.replace("uint", "int");
    let file = [start.as_bytes(), b"\xff\xff\xff\xffabc"].concat();
    refused("a.ply", file, &["`l`", &format!("byte {}", start.len()), "length of -1"]);
    let ascii = HEADER.replace("element vertex 2\n", "element vertex 1\nproperty list uint double l\n");
    refused(
        "a.ply",
        format!("{ascii}end_header\n4000000000 1 2 3\n"),
        &["a.ply:9:1", "4000000000 items", "has 3"],
    );
    let skipped = HEADER
        .replace("element vertex", "element other 18446744073709551615\nproperty double d\nelement vertex");
    refused("a.ply", skipped.replace("ascii", "binary_little_endian") + "end_header\n", &["`other`", "0 of"]);
}

#[test]
fn points_that_are_not_finite_are_counted_and_refused_or_dropped() {
    let file = format!("{HEADER}end_header\n1 2 3\n1 nan 3\n-1.#IND 2 3\n").replace("vertex 2", "vertex 3");
    refused("a.ply", &file, &["2 of 3 points are not finite", "the first in line 9", "--drop-invalid"]);
    let options = CloudOptions::DEFAULT.with_drop_invalid(true);
    let (points, summary) = read("a.ply", file.as_bytes(), &options).unwrap();
    assert_eq!((points.positions, summary.dropped), (vec![dvec3(1.0, 2.0, 3.0)], 2));
    let rows: Vec<Row> = [0.0, f32::INFINITY, f32::NAN].map(|r| ([0.0; 3], [0.0; 3], r, [0; 3])).to_vec();
    refused("a.ply", ply(&rows, Encoding::Little, false), &["2 of 3 points", "at byte "]);
    refused("a.xyz", "1 2 nan\n1 2 3\n", &["1 of 2 points", "in line 1"]);
    let error = read("a.xyz", b"1 2 nan\n", &options).unwrap_err();
    assert!(error.to_string().contains("none of the 1 points is finite"));
}

#[test]
fn broken_text_names_its_line() {
    refused("a.xyz", "", &["no points"]);
    refused("a.xyz", "# nothing\n", &["no points"]);
    refused("a.xyz", "1 2 3\n1 2\n", &["a.xyz:2:1", "2 numbers", "have 3"]);
    refused("a.xyz", "1 2\n", &["a.xyz:1:1", "2 numbers"]);
    refused("a.xyz", "1 2 3 4 5 6 7 8\n", &["a.xyz:1:1", "more than seven"]);
    refused("a.xyz", "1 2 3\nx y z\n", &["a.xyz:2:1", "`x` is no number", "# or //"]);
    refused("a.xyz", b"1 2 3\n1 \xff 3\n", &["a.xyz:2:3", "not UTF-8"]);
    refused("a.xyz", "3\n1 2 3\n", &["line 1 announces 3", "1 follow"]);
    refused("a.png", "1 2 3\n", &["what kind of cloud"]);
    refused("a.conf", "bmesh a.ply 0 0 0 0 0 0 1\n", &["list of scans", "pointillist scan"]);
}

#[test]
fn broken_gzip_names_its_byte() {
    let file = gz(b"1 2 3\n4 5 6\n");
    let joined = [&*file, &file, &[0; 600]].concat();
    assert_eq!(read("a.xyz.gz", &joined, &CloudOptions::DEFAULT).unwrap().1.points, 4);
    let at = format!("at byte {}", file.len());
    refused("a.xyz.gz", [&*file, b"rubbish"].concat(), &["behind the gzip stream", &at]);
    refused("a.xyz.gz", &file[..file.len() - 3], &["cut off at byte"]);
    refused("a.xyz.gz", gz(&file), &["unpack it"]);
    refused("a.ply.gz", "ply\n", &["a.ply.gz"]);
    let mut damaged = file;
    let crc = damaged.len() - 6;
    damaged[crc] ^= 1;
    refused("a.xyz.gz", damaged, &["damaged"]);
}

#[test]
fn formats_that_were_left_out_say_how_to_get_them() {
    let expected: &[(&str, &[u8], bool)] =
        &[("las", b"LASF", cfg!(feature = "las")), ("e57", b"ASTM-E57", cfg!(feature = "e57"))];
    for &(feature, start, is_there) in expected {
        let name = format!("a.{feature}");
        let piece = if is_there { "get it again".to_owned() } else { format!("--features {feature}") };
        refused(&name, [start, &[0; 300]].concat(), &[&piece]);
        refused(&name, "hello", &["this is not"]);
    }
}

#[test]
fn a_conf_turns_by_the_conjugate() {
    let folder = Folder::new();
    folder.write("a b.ply", format!("{HEADER}end_header\n1 0 0\n0 1 0\n"));
    folder.write("c.ply.gz", gz(format!("{HEADER}end_header\n1 0 0\n0 1 0\n").as_bytes()));
    // A quarter about z, whose R takes x to y; its conjugate takes x to −y.
    let quarter = "10 0 0 0 0 0.70710678 0.70710678";
    folder.write(
        "a.conf",
        format!("# two\ncamera 0 -1 0 0 1 0 0\n\nbmesh a b.ply {quarter}\nmesh x_cybcyl {quarter}\nbmesh c.ply {quarter}\nmesh d.ply {quarter}\n"),
    );
    let conf = read_conf(&folder.path("a.conf")).unwrap();
    assert_eq!(conf.scans.len(), 2);
    assert!(conf.scans[0].pose.to_world(DVec3::X).distance(dvec3(10.0, -1.0, 0.0)) < 1e-9);
    assert!((conf.scans[0].pose.rotation.length() - 1.0).abs() < 1e-15);
    assert_eq!(conf.camera.unwrap().rotation, DQuat::from_xyzw(0.0, -1.0, 0.0, 0.0));
    assert!(conf.warnings[0].contains("a.conf:5") && conf.warnings[1].contains("a.conf:7"));
    for scan in &conf.scans {
        let summary = read_cloud::<InputError>(&scan.path, &CloudOptions::DEFAULT, &mut |_| Ok(()));
        assert_eq!(summary.unwrap().points, 2);
    }
    let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", "a.conf"])).unwrap();
    assert_eq!((&info["kind"], &info["points"]), (&"scans".into(), &4.into()));
    let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", "c.ply.gz"])).unwrap();
    assert_eq!((&info["kind"], &info["points"]), (&"cloud".into(), &2.into()));
}

#[test]
fn a_broken_conf_names_its_line() {
    let refused = |text: &[u8], pieces: &[&str]| {
        let error = read_conf_bytes("a.conf", text, Path::new("scans"), &|_| false).unwrap_err();
        let text = error.to_string();
        for piece in pieces.iter().chain(&["a.conf", "help: "]) {
            assert!(text.contains(piece), "this does not say {piece:?}:\n{text}");
        }
    };
    refused(b"# no scans\n", &["names no scan"]);
    refused(
        b"\nbmesh a.ply 0 0 0 0 0 0 1\n",
        &["a.conf:2:7", "`a.ply` is not there", "`a.ply.gz`", "`scans`"],
    );
    refused(b"bmesh a.ply 0 0 0 0 0 0 1.1\n", &["a.conf:1:19", "0 0 0 1.1", "length 1.1"]);
    refused(b"bmesh a.ply 0 0 0 0 0 1\n", &["a.conf:1:7", "`a.ply` is no number up to"]);
    refused(b"bmesh 0 0 0 0 0 0 1\n", &["a.conf:1:1", "no file"]);
    refused(b"bmesh a.ply 0 0 0 0\n", &["a.conf:1:1", "7 numbers"]);
    refused(b"bmesh a.ply 0 0 0 0 0 nan 1\n", &["a.conf:1:23", "`nan`"]);
    refused(b"mash a.ply 0 0 0 0 0 0 1\n", &["a.conf:1:1", "`mash`"]);
    refused(b"bmesh \xff 0 0 0 0 0 0 1\n", &["a.conf:1:7", "not UTF-8"]);
    let folder = Folder::new();
    folder.write("a.conf", "bmesh a.ply 0 0 0 0 0 0 1\n");
    folder.fails(&["info", "a.conf"], 3, &["a.conf:1:7", "a.ply"]);
    folder.fails(&["info", "no.conf"], 3, &["no.conf", "cannot be read"]);
}
