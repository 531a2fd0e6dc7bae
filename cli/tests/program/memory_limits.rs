//! What does not fit into memory is refused with a message, whoever asks for it.

use crate::common::{Folder, SCENE};
use flate2::{Compression, write::GzEncoder};
use std::io::Write as _;

/// Two million points in a few kilobytes.
fn bomb(header: &str) -> Vec<u8> {
    let mut packed = GzEncoder::new(vec![], Compression::default());
    packed.write_all(header.as_bytes()).unwrap();
    let lines = "1 2 3\n".repeat(20_000);
    for _ in 0..100 {
        packed.write_all(lines.as_bytes()).unwrap();
    }
    packed.finish().unwrap()
}

#[test]
fn a_cloud_that_unpacks_to_more_than_there_is_room_for_is_refused() {
    let folder = Folder::new();
    folder.write("bomb.xyz.gz", bomb(""));
    let size = folder.path("bomb.xyz.gz").metadata().unwrap().len();
    assert!(size < 100_000, "{size} bytes");
    let pieces = ["bomb.xyz.gz", "its points take", "of memory", "are available", "--memory SIZE"];
    for command in ["scan", "surfel"] {
        folder.fails(
            &[command, "bomb.xyz.gz", "-o", "a.png", "--size", "64x64", "--memory", "120M"],
            3,
            &pieces,
        );
    }
    // The points of a range grid are kept by its reader.
    let header = "ply\nformat ascii 1.0\nobj_info num_cols 1\nobj_info num_rows 1\nelement vertex 2000000\n\
                  property float x\nproperty float y\nproperty float z\nelement range_grid 1\n\
                  property list uchar int vertex_indices\nend_header\n";
    folder.write("grid.ply.gz", bomb(header));
    folder.fails(
        &["info", "grid.ply.gz", "--memory", "60M"],
        3,
        &["grid.ply.gz", "of memory", "--memory SIZE"],
    );
}

#[test]
fn standard_input_is_read_for_as_long_as_there_is_room() {
    let folder = Folder::new();
    let output = folder
        .command(&["check", "-", "--memory", "100M"])
        .write_stdin("# a comment\n".repeat(16 << 20))
        .output()
        .unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{message}");
    for piece in ["standard input", "its bytes take", "--memory SIZE"] {
        assert!(message.contains(piece), "{message}");
    }
}

#[test]
fn sizes_of_pictures_are_looked_at_before_anything_is_loaded() {
    let folder = Folder::new();
    let size = ["--size", "100000x100000"];
    let fails = |line: &[&str], code, pieces: &[&str]| folder.fails(&[line, &size].concat(), code, pieces);
    let wanted = ["--size 100000x100000", "of memory", "--tile"];
    fails(&["render", "gone.toml", "-o", "a.png", "--memory", "1G"], 2, &wanted);
    for command in ["scan", "surfel"] {
        fails(&[command, "gone.ply", "-o", "a.png"], 2, &["--size 100000x100000", "16384"]);
    }
    let large = ["--size", "16384x16384", "--memory", "1G"];
    for command in ["scan", "surfel"] {
        folder.fails(
            &[&[command, "gone.ply", "-o", "a.png"][..], &large].concat(),
            2,
            &["--size", "of memory"],
        );
    }
    // A size in the scene is the scene's fault; a tile of it may fit.
    folder.write("large.toml", SCENE.replace("[16, 12]", "[100000, 100000]"));
    folder.fails(&["render", "large.toml", "-o", "a.png", "--memory", "1G"], 3, &["image.size", "of memory"]);
    let tile = ["render", "large.toml", "-o", "a.png", "--memory", "1G", "--tile", "0/100000", "--dry-run"];
    let output = folder.command(&tile[..8]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn patches_probes_and_points_are_not_made_beyond_memory() {
    let folder = Folder::new();
    let many = ["--max-patches", "100000000000"];
    let fails = |more: &[&str], pieces: &[&str]| {
        let line = ["radiosity", "scene.toml", "-o", "a.json", "--memory", "100M"];
        folder.fails(&[&line[..], &many, more].concat(), 2, pieces);
    };
    fails(&["--patch", "0.0001"], &["patches take more than", "of memory", "--patch"]);
    fails(&["--patch", "0.05", "--links", "full"], &["the links of", "of memory", "--links hierarchical"]);
    let cluster = ["probe", "place", "scene.toml", "--strategy", "cluster", "--count", "10000000"];
    let pieces = ["80000000 places", "of memory", "--count"];
    folder.fails(&[&cluster[..], &["--memory", "1G"]].concat(), 2, &pieces);
    folder.fails(
        &["sample", "triangle.obj", "--count", "200000000", "--memory", "1G"],
        2,
        &["--count", "of memory"],
    );
}

#[test]
fn a_file_is_not_read_into_memory_that_is_not_there() {
    let folder = Folder::new();
    // Nothing but a length: 8 GiB of zeros that take no room on the disc.
    let file = std::fs::File::create(folder.path("long.obj")).unwrap();
    file.set_len(8 << 30).unwrap();
    folder.fails(
        &["info", "long.obj", "--memory", "100M"],
        3,
        &["long.obj", "8.0 GiB of memory", "--memory SIZE"],
    );
    folder.fails(&["check", "long.obj", "--memory", "100M"], 3, &["long.obj", "8.0 GiB of memory"]);
}

#[test]
fn how_much_may_be_used_can_be_said_in_two_ways() {
    let folder = Folder::new();
    let line = ["sample", "triangle.obj", "--count", "2000000"];
    let pieces = ["--count", "of memory"];
    let mut command = folder.command(&line);
    let output = command.env("POINTILLIST_MEMORY", "64M").output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(pieces.iter().all(|piece| message.contains(piece)), "{message}");
    for wrong in ["-1", "0", "much", "3X", "nan", "1e40"] {
        folder.fails(
            &["info", "triangle.obj", "--memory", wrong],
            2,
            &["--memory", wrong, "such as 512M or 8G"],
        );
    }
    for right in ["1000000000", "512M", "1.5GiB", "2 gb", "1T"] {
        folder.prints(&["info", "triangle.obj", "--memory", right]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_limit_on_the_address_space_is_seen() {
    let folder = Folder::new();
    let program = assert_cmd::cargo::cargo_bin!("pointillist").display().to_string();
    let line =
        format!("ulimit -v 400000; exec '{program}' sample triangle.obj --count 2000000 --memory 100G");
    let mut command = std::process::Command::new("sh");
    let output = command.current_dir(folder.path("")).args(["-c", &line]).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("--count 2000000 takes") && message.contains("of memory"), "{message}");
}

#[cfg(target_os = "linux")]
#[test]
fn an_allocation_that_fails_all_the_same_is_a_failure_and_no_abort() {
    let folder = Folder::new();
    let program = assert_cmd::cargo::cargo_bin!("pointillist").display().to_string();
    for limit in [50_000, 60_000, 80_000] {
        let line = format!("ulimit -v {limit}; exec '{program}' render scene.toml -o a.png");
        let mut command = std::process::Command::new("sh");
        let output = command.current_dir(folder.path("")).args(["-c", &line]).output().unwrap();
        // 127: not even the program could be loaded.
        let code = output.status.code();
        assert!(matches!(code, Some(0..=3 | 127)), "{limit}: {:?}", output);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn where_no_thread_can_be_started_the_one_there_is_does_the_work() {
    let folder = Folder::new();
    let program = assert_cmd::cargo::cargo_bin!("pointillist").display().to_string();
    let run = |limit: u32, arguments: &str| {
        let line = format!("ulimit -v {limit}; exec '{program}' {arguments}");
        // While the standard library collects a backtrace, it waits for itself if there is no memory for that.
        let mut shell = std::process::Command::new("sh");
        shell.env_remove("RUST_BACKTRACE").current_dir(folder.path("")).args(["-c", &line]).output().unwrap()
    };
    // Below this the system ends the program before it begins; with debug information it is larger.
    let loads = |limit: &u32| run(*limit, "--version").status.success();
    let least = (24_000..80_000).step_by(4_000).find(loads).unwrap();
    for limit in (least..least + 36_000).step_by(4_000) {
        let output = run(limit, &format!("render scene.toml -o a{limit}.png --threads 16"));
        assert!(matches!(output.status.code(), Some(0..=3 | 127)), "{limit}: {output:?}");
    }
}
