//! What is checked before any work: outputs that cannot be written, and numbers of threads.

use crate::common::Folder;

/// A square of points.
fn cloud() -> String {
    (0..100).map(|i| format!("{} {} 0\n", i % 10, i / 10)).collect()
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_anything_is_read() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path("folder.png")).unwrap();
    std::fs::create_dir(folder.path("folder.json")).unwrap();
    // Inputs that are not there: who looks at them first complains about them.
    let picture: [&[&str]; 4] =
        [&["render", "gone.toml"], &["scan", "gone.ply"], &["surfel", "gone.ply"], &["merge", "gone.exr"]];
    for line in picture {
        let to = |output| line.iter().copied().chain(["-o", output]).collect::<Vec<_>>();
        folder.fails(&to("nodir/x.png"), 1, &["nodir/x.png cannot be written", "folder", "nodir"]);
        folder.fails(&to("folder.png"), 1, &["folder.png cannot be written: it is a folder"]);
        folder.fails(&to("x.bmp"), 2, &["`x.bmp`", ".png"]);
        folder.fails(&to("scene.toml/x.png"), 1, &["scene.toml/x.png cannot be written", "is not a folder"]);
    }
    let text: [&[&str]; 9] = [
        &["sample", "gone.obj", "-o", "nodir/x.ply"],
        &["probe", "place", "gone.toml", "-o", "nodir/x.json"],
        &["probe", "bake", "gone.toml", "gone.json", "-o", "nodir/x.json"],
        &["probe", "project", "gone.png", "-o", "nodir/x.json"],
        &["probe", "tetra", "gone.txt", "-o", "nodir/x.txt"],
        &["radiosity", "gone.toml", "-o", "nodir/x.json"],
        &["radiosity", "gone.toml", "--factors", "nodir/x.csv"],
        &["compare", "gone.png", "gone.png", "--diff", "nodir/x.png"],
        &["info", "gone.png", "-o", "nodir/x.txt"],
    ];
    for line in text {
        folder.fails(line, 1, &["nodir/x.", "cannot be written", "the folder"]);
    }
    folder.fails(&["dice", "-o", "folder.json"], 1, &["folder.json cannot be written: it is a folder"]);
    folder.fails(&["check", "gone.toml", "--stats", "nodir/s.json"], 1, &["nodir/s.json cannot be written"]);
    folder.fails(&["compare", "gone.png", "gone.png", "--diff", "x.exr"], 2, &["--diff", "x.exr", ".png"]);
    assert_eq!(folder.names(), ["folder.json", "folder.png", "scene.toml", "triangle.obj"]);
}

#[cfg(unix)]
#[test]
fn a_folder_without_permission_is_named() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    std::fs::create_dir(folder.path("locked")).unwrap();
    std::fs::set_permissions(folder.path("locked"), std::fs::Permissions::from_mode(0o555)).unwrap();
    // The superuser may write anywhere, and then there is nothing to be found.
    if std::fs::write(folder.path("locked/probe"), "").is_err() {
        let pieces = ["locked/x.png cannot be written", "may not be written to"];
        folder.fails(&["render", "gone.toml", "-o", "locked/x.png"], 1, &pieces);
    }
}

#[test]
fn checking_an_output_leaves_it_as_it_was() {
    let folder = Folder::new();
    folder.write("old.png", "as it was");
    folder.fails(&["render", "gone.toml", "-o", "old.png"], 3, &["gone.toml"]);
    folder.fails(&["render", "gone.toml", "-o", "new.png"], 3, &["gone.toml"]);
    assert_eq!(std::fs::read(folder.path("old.png")).unwrap(), b"as it was");
    assert_eq!(folder.names(), ["old.png", "scene.toml", "triangle.obj"]);
}

#[test]
fn numbers_of_threads_are_bounded() {
    let folder = Folder::new();
    for wrong in ["0", "1025", "6000", "-1", "many", "1e3"] {
        let pieces = ["--threads", wrong, "from 1 to 1024"];
        folder.fails(&["render", "scene.toml", "-o", "a.png", "--threads", wrong], 2, &pieces);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn many_threads_are_not_all_started() {
    let folder = Folder::new();
    folder.write("cloud.xyz", cloud());
    let line = ["scan", "cloud.xyz", "--size", "32x32", "-o", "a.exr", "--threads"];
    let run = |threads: &str| {
        let start = std::time::Instant::now();
        let line: Vec<&str> = line.iter().copied().chain([threads, "--overwrite"]).collect();
        folder.prints(&line);
        (start.elapsed(), std::fs::read(folder.path("a.exr")).unwrap())
    };
    let (_, one) = run("1");
    let (time, many) = run("1024");
    assert!(one == many, "results do not depend on the number of threads");
    assert!(time.as_secs() < 20, "{time:?}");
}
