//! Ctrl-C, SIGTERM, kill -9 and readers that go away: what is kept, what is left, and that the next run gives the same bytes.

use crate::common::Folder;
use serde_json::Value;
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Two triangles under a lamp of so many points that its shadow takes some seconds in 320 × 240 pixels without optimisation, and a third of one with it.
const SLOW: &str = r#"[camera]
eye = [0, 0.5, 4]
target = [0, 0.5, 0]
fov = 40
[image]
size = [320, 240]
background = [0.1, 0.2, 0.3]
[render]
subpixel = 4
[[object]]
mesh = "triangle.obj"
[[object]]
mesh = "triangle.obj"
translate = [0.3, 0.2, 0.5]
[[light]]
name = "lamp"
type = "rect"
position = [1, 2, 3]
edge_u = [0, 1, 0]
edge_v = [1, 0, 0]
radiance = [3, 3, 3]
samples = 16
"#;

/// What an interrupted command left.
struct End {
    code: Option<i32>,
    message: String,
}

fn slow_folder() -> Folder {
    let folder = Folder::new();
    folder.write("slow.toml", SLOW);
    folder
}

fn start(folder: &Folder, line: &[&str]) -> Child {
    Command::new(assert_cmd::cargo::cargo_bin!("pointillist"))
        .current_dir(folder.path("."))
        .args(line)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs")
}

fn send(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill");
    assert!(sent.success(), "kill {signal}");
}

/// Starts a command, waits until its progress is past `percent`, and sends it signals.
fn interrupt(folder: &Folder, line: &[&str], percent: u32, signals: &[&str]) -> End {
    let line = [line, &["--progress", "openjd"]].concat();
    let mut child = start(folder, &line);
    let lines = BufReader::new(child.stdout.take().expect("a pipe")).lines();
    let mut at = lines
        .map_while(Result::ok)
        .filter_map(|line| line.strip_prefix("openjd_progress: ")?.parse::<u32>().ok());
    assert!(at.any(|now| now >= percent), "{line:?} ended before {percent} %");
    for signal in signals {
        send(&child, signal);
        // Two signals of a kind that come at once are one.
        std::thread::sleep(Duration::from_millis(300));
    }
    // Read on, so that the pipe does not fill up or break.
    at.for_each(drop);
    end_of(child)
}

fn end_of(mut child: Child) -> End {
    let mut message = String::new();
    child.stderr.take().expect("a pipe").read_to_string(&mut message).expect("text");
    End { code: child.wait().expect("the command ends").code(), message }
}

fn render<'a>(output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["render", "slow.toml", "-o", output][..], more].concat()
}

/// Interrupts a picture, goes on with it, and compares the bytes with those of an undivided run.
fn goes_on(signal: &str, end: &str, more: &[&str]) {
    let folder = slow_folder();
    let (output, part) = (format!("a.{end}"), format!("a.{end}.part.exr"));
    let stopped = interrupt(&folder, &render(&output, more), 20, &[signal]);
    assert_eq!(stopped.code, Some(130), "{}", stopped.message);
    let says = |text: &str| assert!(stopped.message.contains(text), "{}", stopped.message);
    says("interrupted: ");
    says(&format!("tiles are kept in {part}; the same command goes on from there"));
    assert_eq!(folder.names(), [&part, "scene.toml", "slow.toml", "triangle.obj"]);

    let line = [&render(&output, more)[..], &["--stats", "stats.json"]].concat();
    let run = folder.command(&line).output().expect("the command runs");
    let message = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success() && message.contains("tiles are there already"), "{message}");
    let stats: Value = serde_json::from_slice(&fs::read(folder.path("stats.json")).unwrap()).unwrap();
    let (drawn, kept) = (&stats["counts"]["tiles"], &stats["skipped"]["tiles_drawn_before"]);
    let tiles = drawn.as_u64().unwrap() + kept.as_u64().unwrap();
    assert!(
        kept.as_u64().unwrap() >= tiles / 5 && message.contains(&format!("{kept} of {tiles} tiles")),
        "{stats}"
    );

    let whole = format!("whole.{end}");
    folder.prints(&render(&whole, more));
    assert!(fs::read(folder.path(&output)).unwrap() == fs::read(folder.path(&whole)).unwrap());
    let mut names = vec![output, "scene.toml".to_owned(), "slow.toml".to_owned(), "stats.json".to_owned()];
    names.extend(["triangle.obj".to_owned(), whole]);
    assert_eq!(folder.names(), names);
}

#[test]
fn a_png_goes_on_after_ctrl_c() {
    goes_on("-INT", "png", &["--exposure", "0.5"]);
}

#[test]
fn an_exr_with_all_layers_goes_on_after_sigterm() {
    goes_on("-TERM", "exr", &["--layers", "all"]);
}

#[test]
fn a_part_of_a_crop_goes_on_after_ctrl_c() {
    goes_on("-INT", "exr", &["--crop", "33,21,290,230", "--tile", "0/2", "--float"]);
}

#[test]
fn a_run_may_be_interrupted_more_than_once() {
    let folder = slow_folder();
    let line = render("a.png", &[]);
    for percent in [10, 40, 70] {
        assert_eq!(interrupt(&folder, &line, percent, &["-INT"]).code, Some(130));
    }
    folder.prints(&line);
    folder.prints(&render("whole.png", &[]));
    assert!(fs::read(folder.path("a.png")).unwrap() == fs::read(folder.path("whole.png")).unwrap());
}

#[test]
fn a_killed_run_leaves_nothing_and_the_next_one_is_right() {
    let folder = slow_folder();
    let line = render("a.exr", &[]);
    let killed = interrupt(&folder, &line, 20, &["-KILL"]);
    assert_eq!(killed.code, None);
    assert_eq!(folder.names(), ["scene.toml", "slow.toml", "triangle.obj"]);
    folder.prints(&line);
    folder.prints(&render("whole.exr", &[]));
    assert!(fs::read(folder.path("a.exr")).unwrap() == fs::read(folder.path("whole.exr")).unwrap());
}

#[test]
fn a_picture_that_was_there_stays_until_the_new_one_is_finished() {
    let folder = slow_folder();
    folder.write("a.png", "as it was");
    interrupt(&folder, &render("a.png", &[]), 20, &["-INT"]);
    assert_eq!(fs::read(folder.path("a.png")).unwrap(), b"as it was");
}

#[test]
fn what_another_picture_left_is_told_and_overwritten_only_when_needed() {
    let folder = slow_folder();
    let part = || fs::read(folder.path("a.exr.part.exr")).unwrap();
    interrupt(&folder, &render("a.exr", &[]), 20, &["-INT"]);
    let first = part();
    // Of another scene: ignored, and still there after the run.
    let other = render("a.exr", &["--fov", "41"]);
    let run = folder.command(&other).output().expect("the command runs");
    let message = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{message}");
    assert!(
        message.contains("warning: a.exr.part.exr is of another scene, or of other options"),
        "{message}"
    );
    assert!(part() == first);
    // Needed for the tiles of an interrupted run: overwritten.
    let again = render("a.exr", &["--fov", "42"]);
    assert_eq!(interrupt(&folder, &again, 20, &["-INT"]).code, Some(130));
    assert!(part() != first);
    folder.prints(&again);
    assert!(!folder.path("a.exr.part.exr").exists());
}

#[test]
fn a_damaged_file_of_tiles_is_told_and_not_used() {
    let folder = slow_folder();
    let small = ["render", "slow.toml", "--size", "32x24", "-o", "a.png"];
    let warns = |text: &str| {
        let run = folder.command(&small).output().expect("the command runs");
        let message = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success() && message.contains(text), "{message}");
    };
    folder.write("a.png.part.exr", "no picture");
    warns("warning: a.png.part.exr is damaged");
    assert_eq!(fs::read(folder.path("a.png.part.exr")).unwrap(), b"no picture");
    interrupt(&folder, &render("a.png", &[]), 20, &["-INT"]);
    let whole = fs::read(folder.path("a.png.part.exr")).unwrap();
    folder.write("a.png.part.exr", &whole[..whole.len() / 2]);
    warns("warning: a.png.part.exr is damaged");
}

#[test]
fn unfinished_tiles_do_not_pass_for_a_picture() {
    let folder = slow_folder();
    interrupt(&folder, &render("a.exr", &[]), 20, &["-INT"]);
    folder.fails(&["merge", "a.exr.part.exr", "-o", "b.exr"], 4, &["interrupted", "run that `render` again"]);
    fs::rename(folder.path("a.exr.part.exr"), folder.path("a.exr")).unwrap();
    folder.prints(&render("a.exr", &[]));
    folder.prints(&render("whole.exr", &[]));
    assert!(fs::read(folder.path("a.exr")).unwrap() == fs::read(folder.path("whole.exr")).unwrap());
}

#[test]
fn what_is_left_of_a_picture_that_is_there_is_removed() {
    let folder = slow_folder();
    interrupt(&folder, &render("a.exr", &[]), 20, &["-INT"]);
    folder.prints(&render("whole.exr", &[]));
    fs::copy(folder.path("whole.exr"), folder.path("a.exr")).unwrap();
    folder.prints(&render("a.exr", &[]));
    assert!(!folder.path("a.exr.part.exr").exists());
}

#[test]
fn a_second_ctrl_c_ends_at_once() {
    let folder = slow_folder();
    // One tile, which takes a minute.
    let (_, lamp) = SLOW.split_once("name = \"lamp\"\n").expect("a lamp");
    let lamps = format!("[[light]]\n{}", lamp.replace("64", "4096")).repeat(100);
    folder.write("slow.toml", SLOW.to_owned() + &lamps);
    let line = render("a.png", &["--size", "16x16"]);
    let begin = Instant::now();
    let stopped = interrupt(&folder, &line, 0, &["-INT", "-INT"]);
    assert_eq!(stopped.code, Some(130), "{}", stopped.message);
    assert!(begin.elapsed() < Duration::from_secs(30), "{:?}", begin.elapsed());
    assert_eq!(stopped.message, "interrupted\n");
    assert_eq!(folder.names(), ["scene.toml", "slow.toml", "triangle.obj"]);
}

#[test]
fn a_film_goes_on_with_the_frame_that_was_interrupted() {
    for (end, advice) in [("exr", "the same command goes on from there"), ("png", "go on with --frames 1-2")]
    {
        let folder = slow_folder();
        let path = "[camera.path]\ntimes = [0, 2]\neye = [[0, 0.5, 4], [1, 0.5, 4]]\n[image]";
        folder.write("slow.toml", SLOW.replace("[image]", path));
        let name = format!("a.{{frame}}.{end}");
        let line = render(&name, &["--size", "160x120", "--frames", "0-2"]);
        let stopped = interrupt(&folder, &line, 50, &["-INT"]);
        assert_eq!(stopped.code, Some(130), "{}", stopped.message);
        let kept = format!("tiles are kept in a.1.{end}.part.exr; 1 of 3 frames are finished; {advice}");
        assert!(stopped.message.contains(&kept), "{}", stopped.message);
        assert!(!folder.path(&format!("a.1.{end}")).exists() && folder.path(&format!("a.0.{end}")).exists());
        folder.prints(&[&line[..], &["--stats", "stats.json"]].concat());
        let stats: Value = serde_json::from_slice(&fs::read(folder.path("stats.json")).unwrap()).unwrap();
        assert!(stats["skipped"]["tiles_drawn_before"].as_u64().unwrap() > 0, "{stats}");
        let name = format!("whole.{{frame}}.{end}");
        folder.prints(&render(&name, &["--size", "160x120", "--frames", "0-2"]));
        for frame in 0..3 {
            let [a, b] =
                ["a", "whole"].map(|name| fs::read(folder.path(&format!("{name}.{frame}.{end}"))).unwrap());
            assert!(a == b, "frame {frame}");
        }
        assert!(folder.names().iter().all(|name| !name.contains("part")), "{:?}", folder.names());
    }
}

#[test]
fn other_commands_end_at_once_and_leave_no_temporary_file() {
    let folder = slow_folder();
    folder.write(
        "probes.json",
        r#"{"probes":[{"position":[0,0,2]},{"position":[1,0,2]},{"position":[0,1,2]}]}"#,
    );
    let bake =
        ["probe", "bake", "slow.toml", "probes.json", "--thorough", "--inside", "keep", "-o", "baked.json"];
    for signal in ["-INT", "-TERM"] {
        let stopped = interrupt(&folder, &bake, 0, &[signal]);
        assert_eq!((stopped.code, stopped.message.as_str()), (Some(130), "interrupted\n"));
        // One that waits for its input.
        let mut child = start(&folder, &["dice", "--areas"]);
        let mut input = child.stdin.take().expect("a pipe");
        writeln!(input, r#"{{"polygon":[[0,0],[1,0],[1,1]]}}"#).expect("the command reads");
        let mut answers = BufReader::new(child.stdout.take().expect("a pipe")).lines();
        assert!(answers.next().is_some());
        send(&child, signal);
        let stopped = end_of(child);
        assert_eq!((stopped.code, stopped.message.as_str()), (Some(130), "interrupted\n"));
        assert_eq!(folder.names(), ["probes.json", "scene.toml", "slow.toml", "triangle.obj"]);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = slow_folder();
    // More lines than a pipe holds.
    folder.write(
        "lines.jsonl",
        r#"{"polygon":[[0,0],[40,0],[40,40]]}"#.to_owned()
            + "\n"
            + &"{\"polygon\":[[0,0],[40,0],[40,40]]}\n".repeat(20),
    );
    let mut child = start(&folder, &["dice", "lines.jsonl"]);
    let mut first = [0; 16];
    child.stdout.take().expect("a pipe").read_exact(&mut first).expect("an answer");
    let end = end_of(child);
    assert_eq!((end.code, end.message.as_str()), (Some(0), ""));
    // A picture is drawn whoever looks at its progress.
    let line = [&render("a.png", &["--size", "64x48", "--progress", "openjd"])[..], &["--quiet"]].concat();
    let mut child = start(&folder, &line);
    drop(child.stdout.take());
    let end = end_of(child);
    assert_eq!((end.code, end.message.as_str()), (Some(0), ""));
    assert!(folder.path("a.png").exists());
}
