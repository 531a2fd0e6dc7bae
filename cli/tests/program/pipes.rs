//! Commands read from and write to other commands: `-`, and pipes that stay open.

use crate::common::{Folder, SCENE, TRIANGLE};
use serde_json::Value;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Stdio;
use std::sync::mpsc::channel;
use std::time::Duration;

/// Standard output and standard error of a command that gets `input`.
fn piped(folder: &Folder, line: &[&str], input: &[u8]) -> (Vec<u8>, String) {
    let output = folder.command(line).write_stdin(input).output().expect("the command runs");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{line:?}: {message}");
    (output.stdout, message)
}

#[test]
fn a_mesh_goes_through_sample_into_surfel_and_scan_without_a_file() {
    let folder = Folder::new();
    let sample = ["sample", "-", "--count", "60", "-o", "-"];
    let (cloud, _) = piped(&folder, &sample, TRIANGLE.as_bytes());
    assert!(cloud.starts_with(b"ply\nformat binary_little_endian"));
    folder.prints(&["sample", "triangle.obj", "--count", "60", "-o", "cloud.ply"]);
    assert!(cloud == std::fs::read(folder.path("cloud.ply")).unwrap());
    for command in ["surfel", "scan"] {
        let size = ["--size", "16x16", "--float"];
        piped(&folder, &[&[command, "-", "-o", "piped.exr"], &size[..]].concat(), &cloud);
        folder.prints(&[&[command, "cloud.ply", "-o", "file.exr"], &size[..]].concat());
        let same: Value =
            serde_json::from_str(&folder.prints(&["compare", "piped.exr", "file.exr"])).unwrap();
        assert_eq!(
            same["max"]["difference"].as_f64().or(same["rmse"].as_f64()),
            Some(0.0),
            "{command}: {same}"
        );
    }
    piped(&folder, &["surfel", "-", "--size", "16x16"], &cloud);
    assert!(folder.path("pointillist.png").exists());
}

#[test]
fn every_kind_of_text_and_picture_is_known_on_standard_input() {
    let folder = Folder::new();
    folder.prints(&["render", "scene.toml", "-o", "a.png"]);
    let read = |name: &str| std::fs::read(folder.path(name)).unwrap();
    let json = br#"{"object": [{"mesh": "triangle.obj"}]}"#;
    let inputs: [(&[u8], &str); 6] = [
        (SCENE.as_bytes(), "scene"),
        (json, "scene"),
        (TRIANGLE.as_bytes(), "mesh"),
        (b"0 0 0\n1 0 0\n", "cloud"),
        (br#"{"probes":[{"position":[0,0,0]}]}"#, "probes"),
        (&read("a.png"), "image"),
    ];
    for (input, kind) in inputs {
        let (text, _) = piped(&folder, &["info", "-"], input);
        assert_eq!(serde_json::from_slice::<Value>(&text).unwrap()["kind"], kind);
    }
    let (text, _) = piped(&folder, &["compare", "a.png", "-"], &read("a.png"));
    assert_eq!(serde_json::from_slice::<Value>(&text).unwrap()["rmse"], 0.0);
    let (text, _) = piped(&folder, &["probe", "tetra", "-"], b"0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
    assert!(text.starts_with(b"# tetrahedra 1\n"));
}

#[test]
fn probes_are_placed_baked_and_queried_through_pipes() {
    let folder = Folder::new();
    let place = ["probe", "place", "scene.toml", "--grid", "2x2x1", "--inside", "keep", "-o", "-"];
    let (places, _) = piped(&folder, &place, b"");
    let bake = ["probe", "bake", "scene.toml", "-", "--resolution", "4", "--bounces", "0", "-o", "-"];
    let bake = [&bake[..], &["--inside", "keep", "--progress", "openjd"]].concat();
    let (baked, messages) = piped(&folder, &bake, &places);
    assert!(messages.contains("openjd_progress: 100\n"), "{messages}");
    let file: Value = serde_json::from_slice(&baked).expect("nothing but JSON on standard output");
    assert!(file["probes"][0]["sh"].is_array());
    folder.write("points.txt", "0 0.5 1  0 0 1\n");
    let (light, _) = piped(&folder, &["probe", "query", "-", "points.txt"], &baked);
    assert_eq!(String::from_utf8(light).unwrap().split(' ').count(), 3);
}

#[test]
fn progress_lines_never_mix_with_a_result_on_standard_output() {
    let folder = Folder::new();
    let progress = ["--progress", "openjd"];
    let line = [&["radiosity", "scene.toml", "--patch", "1", "-o", "-"], &progress[..]].concat();
    let (text, messages) = piped(&folder, &line, b"");
    serde_json::from_slice::<Value>(&text).expect("nothing but JSON on standard output");
    assert!(messages.contains("openjd_progress: 100\n"), "{messages}");
    let line = [&["render", "scene.toml", "-o", "a.png", "--stats", "-"], &progress[..]].concat();
    let (text, messages) = piped(&folder, &line, b"");
    serde_json::from_slice::<Value>(&text).expect("nothing but JSON on standard output");
    assert!(messages.contains("openjd_progress: 100\n"), "{messages}");
}

#[test]
fn standard_streams_carry_one_thing_and_no_pictures() {
    let folder = Folder::new();
    folder.fails(&["render", "scene.toml", "-o", "-"], 2, &["-o -", "a picture is no text"]);
    folder.fails(&["compare", "a.png", "b.png", "--diff", "-"], 2, &["--diff -"]);
    folder.fails(&["compare", "-", "-"], 2, &["given twice"]);
    folder.fails(&["probe", "query", "-", "-"], 2, &["given twice"]);
    folder.fails(&["dice", "--stats", "-"], 2, &["two results"]);
    folder.fails(&["check", "scene.toml", "--stats", "-"], 2, &["two results"]);
    folder.prints(&["check", "scene.toml", "--stats", "-", "--quiet"]);
    folder.fails(&["radiosity", "scene.toml", "-o", "-", "--factors", "-"], 2, &["two results"]);
}

/// Writes one line after the other, each after the answer to the one before, and leaves the pipe open till the end.
fn answers_each_line_before_the_next(line: &[&str], requests: &[&str]) {
    let folder = Folder::new();
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin!("pointillist"))
        .current_dir(folder.path("."))
        .args(line)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the command runs");
    let mut input = child.stdin.take().expect("a pipe");
    let answers = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let (send, receive) = channel();
    // A thread of its own, so that a command that does not answer is a failure and not a test without end.
    std::thread::spawn(move || answers.map_while(Result::ok).try_for_each(|answer| send.send(answer)));
    for request in requests {
        writeln!(input, "{request}").expect("the command reads");
        let answer = receive.recv_timeout(Duration::from_secs(60)).expect("an answer while the pipe is open");
        assert!(answer.starts_with('{') && answer.ends_with('}'), "{answer}");
    }
    drop(input);
    assert!(child.wait().expect("the command ends").success());
}

#[test]
fn dice_answers_while_the_pipe_is_open() {
    let square = r#"{"polygon":[[0.5,0.5],[1.5,0.5],[1.5,1.5]]}"#;
    answers_each_line_before_the_next(&["dice", "--areas"], &[square, square]);
    answers_each_line_before_the_next(&["dice"], &[square]);
}

#[test]
fn form_factors_are_answered_while_the_pipe_is_open() {
    let pair = r#"{"from":[[0,0,0],[1,0,0],[1,1,0]],"to":[[0,0,1],[0,1,1],[1,1,1]]}"#;
    answers_each_line_before_the_next(&["radiosity", "factors"], &[pair, pair]);
}

#[test]
fn lines_before_a_bad_one_are_answered() {
    let folder = Folder::new();
    let good = r#"{"polygon":[[0,0],[1,0],[1,1]]}"#;
    let mut input = format!("{good}\n\n{good}\n").into_bytes();
    input.extend_from_slice(b"{\"polygon\":\xff}\n");
    let output = folder.command(&["dice"]).write_stdin(input).output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(String::from_utf8(output.stdout).unwrap().lines().count(), 2);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(message.contains("standard input, line 4: not UTF-8"), "{message}");
}
