//! The commands do what their help says.

use crate::common::{Folder, SCENE};
use predicates::str::contains;
use std::fs;

#[test]
fn tiles_merge_into_the_same_bytes_as_the_whole() {
    let folder = Folder::new();
    let layers = ["--layers", "all"];
    folder.prints(&[&["render", "scene.toml", "-o", "whole.exr"][..], &layers].concat());
    for tile in ["0/3", "1/3", "2/3"] {
        let part = format!("part{}.exr", &tile[..1]);
        folder.prints(&[&["render", "scene.toml", "--tile", tile, "-o", &part][..], &layers].concat());
    }
    folder.prints(&["merge", "part2.exr", "part0.exr", "part1.exr", "-o", "merged.exr"]);
    assert!(fs::read(folder.path("whole.exr")).unwrap() == fs::read(folder.path("merged.exr")).unwrap());
    folder.prints(&["render", "scene.toml", "--tile", "1-2/3", "-o", "rest.exr", "--layers", "all"]);
    folder.prints(&["merge", "part0.exr", "rest.exr", "-o", "merged2.exr"]);
    assert!(fs::read(folder.path("whole.exr")).unwrap() == fs::read(folder.path("merged2.exr")).unwrap());
    folder.prints(&["merge", "part0.exr", "rest.exr", "-o", "merged.png"]);
    folder.fails(&["merge", "part0.exr", "part2.exr", "-o", "no.exr"], 4, &["rows 4 to 7"]);
    folder.fails(&["merge", "part0.exr", "part0.exr", "rest.exr", "-o", "no.exr"], 4, &["overlap"]);
    folder.fails(&["merge", "part0.exr", "lost.exr", "-o", "no.exr"], 4, &["lost.exr is missing"]);
    folder.prints(&[
        "render",
        "scene.toml",
        "--tile",
        "1-2/3",
        "-o",
        "other.exr",
        "--layers",
        "all",
        "--fov",
        "41",
    ]);
    folder.fails(&["merge", "part0.exr", "other.exr", "-o", "no.exr"], 4, &["not parts of the same picture"]);
    assert!(!folder.path("no.exr").exists());
}

#[test]
fn crops_are_tiled_and_merged_like_pictures() {
    let folder = Folder::new();
    let crop = ["--crop", "3,2,11,9"];
    folder.prints(&[&["render", "scene.toml", "-o", "whole.exr"][..], &crop].concat());
    for (tile, part) in [("0/2", "a.exr"), ("1/2", "b.exr")] {
        folder.prints(&[&["render", "scene.toml", "--tile", tile, "-o", part][..], &crop].concat());
    }
    folder.prints(&["merge", "a.exr", "b.exr", "-o", "merged.exr"]);
    assert!(fs::read(folder.path("whole.exr")).unwrap() == fs::read(folder.path("merged.exr")).unwrap());
    let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", "whole.exr"])).unwrap();
    assert_eq!(info["window"], serde_json::json!([3, 2, 11, 9]));
    assert_eq!(info["size"], serde_json::json!([16, 12]));
}

#[test]
fn an_exr_with_the_same_fingerprint_is_kept() {
    let folder = Folder::new();
    let draw = ["render", "scene.toml", "-o", "a.exr"];
    folder.prints(&draw);
    let time = || fs::metadata(folder.path("a.exr")).unwrap().modified().unwrap();
    let first = time();
    folder.command(&draw).assert().success().stderr(contains("already there"));
    assert_eq!(time(), first);
    folder.prints(&[&draw[..], &["--overwrite"]].concat());
    assert!(time() > first);
    let second = time();
    folder.prints(&[&draw[..], &["--set", "image.background=[1, 0, 0]"]].concat());
    assert!(time() > second);
}

#[test]
fn threads_do_not_change_the_picture() {
    let folder = Folder::new();
    for (threads, path) in [("1", "a.exr"), ("2", "b.exr"), ("8", "c.exr")] {
        folder.prints(&["render", "scene.toml", "--layers", "all", "--threads", threads, "-o", path]);
    }
    let bytes = |path: &str| fs::read(folder.path(path)).unwrap();
    assert!(bytes("a.exr") == bytes("b.exr") && bytes("a.exr") == bytes("c.exr"));
}

#[test]
fn toml_and_json_are_the_same_scene() {
    let folder = Folder::new();
    folder.write(
        "scene.json",
        r#"{"camera": {"eye": [0, 0.5, 4], "target": [0, 0.5, 0], "fov": 40}, "image": {"size": [16, 12]},
            "object": [{"mesh": "triangle.obj"}],
            "light": [{"name": "lamp", "type": "point", "position": [1, 2, 3], "intensity": [30, 30, 30]}]}"#,
    );
    let print =
        |file: &str| -> serde_json::Value { serde_json::from_str(&folder.prints(&["info", file])).unwrap() };
    assert_eq!(print("scene.toml")["fingerprint"], print("scene.json")["fingerprint"]);
}

#[test]
fn options_win_over_the_scene_and_set() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "--set", "image.size=[5, 5]", "--size", "7x3", "-o", "a.exr"]);
    let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", "a.exr"])).unwrap();
    assert_eq!(info["size"], serde_json::json!([7, 3]));
    // A field of view takes the place of an orthographic height.
    folder.prints(&["check", "scene.toml", "--set", "camera.height=3"]);
}

#[test]
fn a_mesh_alone_is_framed_and_lit() {
    let folder = Folder::new();
    folder.prints(&["render", "triangle.obj", "--size", "96x54"]);
    let picture = image_of(&folder, "triangle.png");
    let opaque = picture.pixels().filter(|p| p.0[3] > 0).count();
    assert!(opaque > 96 * 54 / 10, "{opaque} pixels are covered");
    let border = (0..96).flat_map(|x| [(x, 0), (x, 53)]).all(|(x, y)| picture.get_pixel(x, y).0[3] == 0);
    assert!(border, "the mesh is cut by the border");
}

fn image_of(folder: &Folder, name: &str) -> image::RgbaImage {
    let bytes = fs::read(folder.path(name)).unwrap();
    image::load_from_memory(&bytes).unwrap().to_rgba8()
}

#[test]
fn compare_measures_and_limits() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "-o", "a.exr"]);
    folder.prints(&["render", "scene.toml", "-o", "b.exr", "--eye", "0.2,0.5,4"]);
    let same: serde_json::Value =
        serde_json::from_str(&folder.prints(&["compare", "a.exr", "a.exr"])).unwrap();
    assert_eq!(
        (&same["rmse"], &same["flip"], &same["psnr"]),
        (&0.0.into(), &0.0.into(), &serde_json::Value::Null)
    );
    let line = ["compare", "a.exr", "b.exr", "--diff", "d.png", "-o", "c.json"];
    assert_eq!(folder.prints(&line), "");
    let other: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("c.json")).unwrap()).unwrap();
    assert!(other["rmse"].as_f64() > Some(0.0) && other["flip"].as_f64() > Some(0.0));
    assert_eq!(image_of(&folder, "d.png").dimensions(), (16, 12));
    folder.fails(&["compare", "a.exr", "b.exr", "--max-rmse", "1e-6"], 5, &["the limit is 1.000e-6"]);
    folder.prints(&["compare", "a.exr", "b.exr", "--max-rmse", "10"]);
    folder.prints(&["render", "scene.toml", "-o", "c.exr", "--size", "8x8"]);
    folder.fails(&["compare", "a.exr", "c.exr"], 3, &["8×8", "16×12"]);
}

#[test]
fn times_of_a_debug_build_are_called_so() {
    let folder = Folder::new();
    let told = |line: &[&str]| {
        let output = folder.command(line).output().expect("the command runs");
        assert!(output.status.success());
        String::from_utf8_lossy(&output.stderr).contains("this is a debug build")
    };
    let stats = |name: &str| -> serde_json::Value {
        serde_json::from_slice(&fs::read(folder.path(name)).unwrap()).unwrap()
    };
    // The program is of the same build as this test.
    let is_debug = cfg!(debug_assertions);
    assert_eq!(told(&["render", "scene.toml", "-o", "a.png", "--stats", "s.json"]), is_debug);
    assert_eq!(stats("s.json").get("debug_build").is_some_and(|v| v == true), is_debug);
    assert_eq!(told(&["render", "scene.toml", "--dry-run"]), is_debug);
    assert!(!told(&["render", "scene.toml", "-o", "b.png"]), "no times were asked for");
}

#[test]
fn stats_have_the_keys_that_are_promised() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "-o", "a.png", "--stats", "s.json"]);
    let stats: serde_json::Value = serde_json::from_slice(&fs::read(folder.path("s.json")).unwrap()).unwrap();
    let keys = |key: &str| stats[key].as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(keys("seconds"), keys("cpu_seconds"));
    for stage in ["total", "load", "write"] {
        assert!(stats["seconds"][stage].is_number(), "{stage}");
    }
    assert!(stats["counts"].is_object() && stats["skipped"].is_object() && stats["peak_bytes"].is_u64());
}

#[test]
fn openjd_progress_goes_to_standard_output() {
    let folder = Folder::new();
    let lines = folder.prints(&["render", "scene.toml", "-o", "a.png", "--progress", "openjd"]);
    assert!(lines.lines().all(|line| line.starts_with("openjd_progress: ")), "{lines}");
    assert!(lines.contains("openjd_progress: 100"), "{lines}");
    assert_eq!(folder.prints(&["render", "scene.toml", "-o", "a.png"]), "");
}

#[test]
fn scenes_come_from_standard_input() {
    let folder = Folder::new();
    folder
        .command(&["check", "-"])
        .write_stdin(SCENE)
        .assert()
        .success()
        .stdout(contains("fine; triangles: 1, objects: 1"));
}

/// Stages of tiles have no wall time of their own: they were told to take 0 s.
#[test]
fn details_tell_how_long_each_stage_took() {
    let folder = Folder::new();
    let output = folder.command(&["render", "scene.toml", "-v", "-o", "a.png"]).output().expect("it runs");
    let told = String::from_utf8(output.stderr).expect("text");
    for (stage, is_timed_by_processor) in
        [("tiles ", false), ("total ", true), ("visibility ", true), ("shade ", true)]
    {
        let line = told.lines().find(|line| line.trim_start().starts_with(stage)).expect(&told);
        assert_eq!(line.ends_with(" of processor time"), is_timed_by_processor, "{told}");
    }
}

#[test]
fn dice_reads_lines_and_names_bad_ones() {
    let folder = Folder::new();
    let line = "{\"polygon\":[[0.5,0.5],[1.5,0.5],[1.5,1.5],[0.5,1.5]]}\n";
    folder
        .command(&["dice", "--areas"])
        .write_stdin(line)
        .assert()
        .success()
        .stdout(contains("\"area\":0.25"));
    folder.command(&["dice"]).write_stdin("{}\n").assert().code(3);
    folder.fails(&["dice", "nowhere.jsonl"], 3, &["nowhere.jsonl"]);
}

#[test]
fn info_describes_every_kind_of_file() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "-o", "a.png"]);
    for (file, kind) in [("scene.toml", "scene"), ("triangle.obj", "mesh"), ("a.png", "image")] {
        let info: serde_json::Value = serde_json::from_str(&folder.prints(&["info", file])).unwrap();
        assert_eq!(info["kind"], kind);
    }
    folder.fails(&["info", "a.abc"], 3, &["known are"]);
}

#[test]
fn completions_and_manual_pages_are_made() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(folder.prints(&["completions", shell]).contains("pointillist"));
    }
    assert!(folder.prints(&["man"]).contains(".TH pointillist 1"));
    folder.prints(&["man", "-o", "man1"]);
    assert!(folder.path("man1/pointillist-render.1").exists());
}

#[test]
fn every_command_has_help_with_an_example() {
    let folder = Folder::new();
    for command in ["render", "dice", "compare", "info", "check", "merge", "completions", "man"] {
        let help = folder.prints(&[command, "--help"]);
        assert!(help.contains("Example") && help.contains("pointillist "), "{command}:\n{help}");
    }
}

#[test]
fn nothing_is_left_beside_the_output() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "-o", "a.exr"]);
    folder.fails(&["render", "scene.toml", "-o", "no/such/folder/a.exr"], 1, &["cannot be written"]);
    assert_eq!(folder.names(), ["a.exr", "scene.toml", "triangle.obj"]);
}
