//! `--dry-run`: what a run is expected to take, without a result.

use crate::common::Folder;
use serde_json::Value;

/// Runs a command dry, looks that no file is new, and gives what it expects.
fn expects(folder: &Folder, line: &[&str]) -> Value {
    let before = folder.names();
    let text = folder.prints(&[line, &["--dry-run", "--stats", "stats.json"]].concat());
    assert!(text.starts_with("expected: ") && text.contains(" of memory"), "{text}");
    assert!(text.contains("nothing was written"), "{text}");
    let stats = std::fs::read_to_string(folder.path("stats.json")).unwrap();
    std::fs::remove_file(folder.path("stats.json")).unwrap();
    assert_eq!(folder.names(), before, "{line:?} wrote something");
    let expected = serde_json::from_str::<Value>(&stats).unwrap()["expected"].take();
    for times in ["seconds", "cpu_seconds"] {
        let stages = expected[times].as_object().unwrap_or_else(|| panic!("no {times}: {expected}"));
        let sum: f64 = stages.iter().filter(|(n, _)| *n != "total").map(|(_, s)| s.as_f64().unwrap()).sum();
        let total = stages["total"].as_f64().unwrap();
        assert!(total > 0.0 && (sum - total).abs() < 1e-9, "{expected}");
    }
    assert!(expected["peak_bytes"].as_u64() > Some(1 << 20), "{expected}");
    assert!(expected["threads"].as_u64() >= Some(1));
    assert!(expected["heavy"].is_array() && expected["basis"].is_string());
    expected
}

#[test]
fn a_picture_is_expected_and_not_drawn() {
    let folder = Folder::new();
    let small = expects(&folder, &["render", "scene.toml"]);
    let large =
        expects(&folder, &["render", "scene.toml", "--size", "1600x1200", "--layers", "all", "-o", "p.exr"]);
    // The frame alone: 25 numbers a pixel, and once more for writing.
    assert!(
        large["peak_bytes"].as_u64().unwrap() > small["peak_bytes"].as_u64().unwrap() + 1600 * 1200 * 100
    );
    assert!(large["basis"].as_str().unwrap().contains("of 7500 tiles"), "{large}");
    // What is wrong is found, as without.
    folder.fails(&["render", "none.toml", "--dry-run"], 3, &["none.toml"]);
}

#[test]
fn bakes_are_expected_and_not_begun() {
    let folder = Folder::new();
    folder.write("room.toml", "[[object]]\nmesh = \"room.obj\"\n[[light]]\ntype = \"point\"\nposition = [0.5, 0.9, 0.5]\nintensity = [1, 1, 1]\n");
    folder.write("room.obj", "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 0 1 0\nv 1 1 0\nf 4 3 2 1\nf 1 2 6 5\n");
    let coarse = expects(&folder, &["radiosity", "room.toml", "--patch", "0.5"]);
    let fine = expects(&folder, &["radiosity", "room.toml", "--patch", "0.05"]);
    assert!(coarse["basis"].as_str().unwrap().contains(" of 16 patches"), "{coarse}");
    assert!(fine["basis"].as_str().unwrap().contains("longer patches"), "{fine}");
    let rays = expects(&folder, &["radiosity", "room.toml", "--links", "rays", "--patch", "0.2"]);
    assert!(
        rays["basis"].as_str().unwrap().contains("among some")
            || rays["basis"].as_str().unwrap().contains("longer")
    );
    // A long, narrow board is a row of squares to groups, and four patches by rays.
    folder.write("board.obj", "v 0 0 0\nv 1 0 0\nv 1 0 0.01\nv 0 0 0.01\nf 4 3 2 1\n");
    folder.write("board.toml", "[[object]]\nmesh = \"board.obj\"\n");
    let of = |links: &str| {
        let line = ["radiosity", "board.toml", "--links", links, "--patch", "0.25"];
        let basis = expects(&folder, &line)["basis"].as_str().unwrap().to_owned();
        let (before, _) = basis.split_once(" patches").expect("it says of how many");
        before.rsplit(' ').next().unwrap().parse::<usize>().unwrap()
    };
    assert!(10 * of("rays") <= of("hierarchical"), "{} of {}", of("rays"), of("hierarchical"));
    folder.write("p.json", "{\"probes\":[{\"position\":[0.5,0.5,0.5]},{\"position\":[0.2,0.5,0.5]},{\"position\":[0.5,0.5,0.2]}]}");
    let line = ["probe", "bake", "room.toml", "p.json", "--resolution", "16", "-o", "b.json"];
    let probes = expects(&folder, &line);
    assert!(probes["basis"].as_str().unwrap().contains(" of 3 probes"), "{probes}");
    expects(&folder, &[&line[..], &["--bounces", "0", "--fit", "4"]].concat());
}
