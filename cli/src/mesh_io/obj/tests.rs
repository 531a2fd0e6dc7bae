//! Plain lines handed to the parser as they are give, bit for bit, the mesh that every line taken apart gives.

use super::super::obj_lines::ObjLines;
use super::{FileMesh, InputError, read_lines, read_obj};
use proptest::prelude::*;
use std::fmt::Write;

/// Both ways to read `bytes`: in runs of plain lines, and one by one.
fn both(bytes: &[u8]) -> [Result<FileMesh, InputError>; 2] {
    [ObjLines::new(bytes), ObjLines::one_by_one(bytes)].map(|lines| read_lines("a", bytes, lines))
}

/// Meshes are written out to compare them, so that −0 is not 0.
fn agree(bytes: &[u8]) -> Result<(), String> {
    let [runs, lines] = both(bytes);
    let shown = |mesh: &FileMesh| format!("{mesh:?}");
    match (&runs, &lines) {
        (Ok(runs), Ok(lines)) if shown(runs) == shown(lines) => {}
        (Err(_), Err(_)) => {}
        _ => return Err(format!("in runs {}, one by one {}", kind_of(&runs), kind_of(&lines))),
    }
    let read = read_obj("a", bytes);
    // An empty file is refused before it is looked at.
    if bytes.is_empty() && read.is_err() {
        return Ok(());
    }
    if read.as_ref().map(shown) == lines.as_ref().map(shown) {
        Ok(())
    } else {
        Err("the second look".to_owned())
    }
}

fn kind_of(result: &Result<FileMesh, InputError>) -> String {
    match result {
        Ok(mesh) => format!("{} triangles", mesh.triangles.len()),
        Err(error) => error.message.clone(),
    }
}

/// Numbers in the spellings that files have.
fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        8 => (-1e3..1e3).prop_map(|n: f64| format!("{n:.6}")),
        2 => any::<f32>().prop_filter("finite", |n| n.is_finite() && n.abs() < 1e18).prop_map(|n| format!("{n:e}")),
        2 => "[+-]?[0-9]{1,3}(\\.[0-9]{0,25})?",
        1 => "[+-]?\\.[0-9]{1,3}[eE][+-]?[0-9]",
        1 => Just("-0".to_owned()),
    ]
}

/// Words that are no number, or none that is used.
fn odd_word() -> impl Strategy<Value = String> {
    const ODD: &[&str] = &[
        "nan",
        "inf",
        "1e999",
        "-1e19",
        "1-2",
        "e",
        ".",
        "+",
        "--1",
        "1.5.",
        "0x1",
        "1_0",
        "\u{663}",
        "1\u{a0}2",
        "#",
        "\\",
        "\0",
        "-",
        "1//",
        "1///5",
        "0/1",
        "1/0/1",
        "//1",
        "/1",
        "1/+1",
        "999999999",
        "2147483648",
        "99999999999999999999",
        "1/",
        "-1/-1/-9",
        "6148914691236517207",
    ];
    prop::sample::select(ODD).prop_map(str::to_owned)
}

/// What stands between the words of a line, and at its end.
fn blank() -> impl Strategy<Value = &'static str> {
    prop::sample::select(&[" ", " ", " ", " ", "  ", "\t", "\r", " \\\n", "\u{b}", "\u{c}", "\u{2003}"][..])
}

fn line_end() -> impl Strategy<Value = &'static str> {
    prop::sample::select(
        &["\n", "\n", "\n", "\r\n", " \n", "\n\n", " # x\n", "#\n", "\\\n", "\r", "\u{85}\n"][..],
    )
}

/// A line of any kind, mostly as it should be.
fn line() -> impl Strategy<Value = String> {
    let corner = "-?[1-4](/(-?[1-4])?(/-?[1-3])?)?";
    let words = |most: usize| {
        prop::collection::vec(prop_oneof![30 => number().boxed(), 1 => odd_word().boxed()], 1..=most)
    };
    let keyword = |keyword: &'static str, words| (Just(keyword), words);
    let corners = prop::collection::vec(prop_oneof![30 => corner.boxed(), 1 => odd_word().boxed()], 2..7);
    const STATEMENTS: &[&str] = &[
        "usemtl a",
        "usemtl b c",
        "usemtl",
        "usemtl\tb",
        "g",
        "g a b",
        "o x",
        "s off",
        "mtllib \"a b.mtl\" c.mtl",
        "l 1 2",
        "p 1",
        "# v 1",
        " v 1 2 3",
        "fo 1 2 3",
        "vp 1",
        "quack 1",
        "\u{feff}v 1 2 3",
        "",
    ];
    let statement = prop_oneof![
        6 => keyword("v", words(3).boxed()),
        1 => keyword("v", words(8).boxed()),
        4 => keyword("vt", words(3).boxed()),
        4 => keyword("vn", words(3).boxed()),
        10 => keyword("f", corners.boxed()),
        3 => prop::sample::select(STATEMENTS).prop_map(|name| (name, vec![])),
    ];
    (statement, blank(), line_end()).prop_map(|((keyword, words), blank, end)| {
        let words = words.iter().flat_map(|word| [blank, word]);
        std::iter::once(keyword).chain(words).chain([end]).collect()
    })
}

/// A sound file without anything unusual: quads, triangles and larger polygons of a grid with all kinds of index.
fn sound_file() -> impl Strategy<Value = String> {
    let face = (
        0usize..4,
        3usize..8,
        any::<bool>(),
        prop::sample::select(&["", "usemtl a\n", "usemtl b\n", "g x\ns 1\n"][..]),
    );
    let places = prop::collection::vec([number(), number(), number()], 8..20);
    (places, prop::collection::vec(face, 1..40)).prop_map(|(places, faces)| {
        let mut text = String::new();
        for [x, y, z] in &places {
            writeln!(text, "v {x} {y} {z}\nvt {x}\t{z}\r\nvt {y} {x} {z}\nvn {z} {y} {x}").unwrap();
        }
        for (at, (kinds, corners, from_end, before)) in faces.into_iter().enumerate() {
            write!(text, "{before}f").unwrap();
            for corner in 0..corners {
                let from_start = 1 + (at + corner) % places.len();
                let [v, t] = if from_end { [-(from_start as i64); 2] } else { [from_start as i64; 2] };
                let ends = [String::new(), format!("/{t}"), format!("//{t}"), format!("/{t}/{v}")];
                write!(text, " {v}{}", ends[kinds]).unwrap();
            }
            text.push('\n');
        }
        text
    })
}

proptest! {
    #![proptest_config(testkit::config(512))]

    #[test]
    fn any_lines_are_read_alike(lines in prop::collection::vec(line(), 0..24)) {
        testkit::holds!(agree(lines.concat().as_bytes()));
    }

    #[test]
    fn mostly_sound_lines_are_read_alike(file in sound_file(), odd in line(), after in 0usize..200) {
        let at = file.match_indices('\n').nth(after).map_or(file.len(), |(at, _)| at + 1);
        testkit::holds!(agree([&file[..at], &odd, &file[at..]].concat().as_bytes()));
    }

    #[test]
    fn any_bytes_are_read_alike(file in sound_file(), at in 0usize..4000, byte in any::<u8>()) {
        let mut bytes = file.into_bytes();
        let at = at % bytes.len();
        bytes[at] = byte;
        testkit::holds!(agree(&bytes));
    }

    #[test]
    fn sound_files_need_no_second_look(file in sound_file()) {
        let [runs, _] = both(file.as_bytes());
        prop_assert!(runs.is_ok(), "{}", kind_of(&runs));
        testkit::holds!(agree(file.as_bytes()));
    }
}

/// Longer than a run, with an index from the end of the file to its start.
#[test]
fn runs_end_within_a_file_without_a_trace() {
    let mut text = "v 0.5 1 2\n".repeat(5_000);
    for face in 0..5_000 {
        writeln!(text, "f {} -{} {}", face + 1, face + 1, 5_000 - face).unwrap();
    }
    assert_eq!(agree(text.as_bytes()), Ok(()));
    let [runs, _] = both(text.as_bytes());
    assert_eq!(runs.unwrap().triangles.len(), 5_000);
}

/// `tobj` does not check an index of a kind that the file has none of, nor that of a corner whose number wraps.
#[test]
fn indices_without_elements_are_found_by_the_second_look() {
    for face in
        ["f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/0 2/0 3/0", "f 1/-1 2/-1 3/-1", "f 1 2 4", "f 1 2 -4"]
    {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n\n{face}\n");
        let error = read_obj("a", text.as_bytes()).unwrap_err();
        assert_eq!(error.place.map(|place| place.line), Some(5), "{face}");
    }
}

/// The parser ends a group where faces of another kind begin, and gives a kind of index that the file has none of by then no list at all.
#[test]
fn what_faces_use_is_defined_before_other_faces_begin() {
    for (face, element) in
        [("f 1/1 2/1 3/1", "vt 0 0"), ("f 1//1 2//1 3//1", "vn 0 0 1"), ("f 1/2 2/2 3/2", "vt 0 0\nvt 0 1")]
    {
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\nf 1 2 3\n{element}\n");
        let error = read_obj("a", text.as_bytes()).unwrap_err();
        assert_eq!(error.place.map(|place| place.line), Some(4), "{face}");
        // Within the same group they may follow.
        let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n{element}\n{face}\n");
        assert_eq!(read_obj("a", text.as_bytes()).map(|mesh| mesh.triangles.len()), Ok(2), "{face}");
    }
}
