//! `docs/materials.md` has all keys of materials and of maps, in scene files and in MTLs, and no others.

use crate::common::square::{VIEW, folder};
use pointillist_cli::mesh_io::{Reading, mtl_keys, mtl_options, read_mtl};
use std::collections::{BTreeMap, BTreeSet};

/// Keys of scene files, and of MTLs with what becomes of them.
#[derive(Default)]
struct Documented {
    toml: BTreeSet<String>,
    mtl: BTreeMap<String, String>,
}

/// What stands between backticks.
fn quoted(cell: &str) -> impl Iterator<Item = String> {
    cell.split('`').skip(1).step_by(2).map(str::to_owned)
}

/// The tables of keys: the first is that of materials, the second that of maps.
fn tables() -> Vec<Documented> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/materials.md");
    let text = std::fs::read_to_string(path).expect("the document");
    let mut tables = Vec::new();
    let mut is_inside = false;
    for line in text.lines() {
        if line.starts_with("| key | MTL | is |") {
            tables.push(Documented::default());
            is_inside = true;
        } else if !line.starts_with('|') {
            is_inside = false;
        } else if is_inside && !line.starts_with("| --- ") {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let table = tables.last_mut().expect("one was begun");
            for key in quoted(cells[1]) {
                assert!(table.toml.insert(key), "twice: {line}");
            }
            let how = cells[3];
            for key in quoted(cells[2]) {
                assert!(table.mtl.insert(key, how.to_owned()).is_none(), "twice: {line}");
            }
        }
    }
    assert_eq!(tables.len(), 2);
    tables
}

/// The keys that the program knows in the place of the first unknown one, by its message.
fn known(scene: &str) -> BTreeSet<String> {
    let folder = folder();
    let object = "[[object]]\nmesh = \"square.obj\"\nmaterial = \"m\"\n[material.m]\n";
    folder.write("m.toml", format!("{VIEW}{object}{scene}"));
    let output = folder.command(&["check", "m.toml"]).output().expect("the command runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let (_, list) = message.split_once("known here: ").unwrap_or_else(|| panic!("{message}"));
    list.lines().next().unwrap_or_default().split(", ").map(str::to_owned).collect()
}

#[test]
fn keys_of_scene_files_are_documented() {
    let [materials, maps] = &tables()[..] else { panic!("two tables") };
    assert_eq!(materials.toml, known("qqqqqqqq = 1\n"));
    assert_eq!(maps.toml, known("diffuse_map = { file = \"a.png\", qqqqqqqq = 1 }\n"));
}

fn documented(keys: impl Iterator<Item = (&'static str, Reading)>) -> BTreeMap<String, String> {
    let word = |reading| match reading {
        Reading::Read => "read",
        Reading::Approximated => "approximated",
        Reading::Ignored => "ignored",
    };
    keys.map(|(key, reading)| (key.to_owned(), word(reading).to_owned())).collect()
}

#[test]
fn keys_of_mtl_are_documented_with_what_becomes_of_them() {
    let [materials, maps] = &tables()[..] else { panic!("two tables") };
    assert_eq!(materials.mtl, documented(mtl_keys()));
    assert_eq!(maps.mtl, documented(mtl_options()));
}

#[test]
fn what_is_said_to_be_ignored_is() {
    let read = |line: &str| {
        let text = format!("newmtl m\n{line}\n");
        read_mtl("a.mtl", text.as_bytes()).unwrap_or_else(|e| panic!("{line}: {e}")).remove(0)
    };
    let nothing = read("");
    for (key, reading) in mtl_keys().filter(|(key, _)| *key != "newmtl") {
        let material = read(&format!("{key} 0.5"));
        assert_eq!(material.ignored.contains(&key.to_owned()), reading == Reading::Ignored, "{key}");
        // Ambient light is reflected by another key.
        assert_eq!(material == nothing, key == "Ka", "{key} leaves no trace");
    }
    assert_eq!(read("Pcr 0.5").ignored, ["Pcr"]);
    for (option, reading) in mtl_options() {
        let is_ignored = |values: &str| {
            let material = read(&format!("map_Kd {option} {values} a.png"));
            assert_eq!(
                material.map("map_Kd").map(|map| map.file.as_str()),
                Some("a.png"),
                "{option} {values}"
            );
            material.ignored.contains(&format!("map_Kd {option}"))
        };
        let values = match option {
            "-mm" => "0 2",
            "-clamp" | "-blendu" | "-blendv" => "on",
            "-cc" => "off",
            "-type" => "sphere",
            "-imfchan" => "r",
            _ => "0.5",
        };
        assert_eq!(is_ignored(values), reading == Reading::Ignored, "{option}");
    }
    assert_eq!(read("map_Kd -halo 1 a.png").ignored, ["map_Kd -halo"]);
}
