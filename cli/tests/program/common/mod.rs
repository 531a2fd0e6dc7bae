//! What the command-line tests share.

#[cfg(feature = "las")]
pub(crate) mod copc;
pub(crate) mod square;

use assert_cmd::Command;
use std::path::PathBuf;
use tempfile::TempDir;

/// A triangle before the camera.
pub(crate) const TRIANGLE: &str = "v -1 0 0\nv 1 0 0\nv 0 1.5 0\nf 1 2 3\n";

/// A scene of that triangle in 16 × 12 pixels.
pub(crate) const SCENE: &str = r#"[camera]
eye = [0, 0.5, 4]
target = [0, 0.5, 0]
fov = 40
[image]
size = [16, 12]
[[object]]
mesh = "triangle.obj"
[[light]]
name = "lamp"
type = "point"
position = [1, 2, 3]
intensity = [30, 30, 30]
"#;

/// The properties of a point in the clouds that `sample` writes.
pub(crate) const PROPERTIES: [&str; 10] = [
    "float x",
    "float y",
    "float z",
    "float nx",
    "float ny",
    "float nz",
    "uchar red",
    "uchar green",
    "uchar blue",
    "float radius",
];

/// A folder of its own for each test, with the triangle and its scene.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(TempDir::new().expect("a temporary folder"));
        folder.write("triangle.obj", TRIANGLE);
        folder.write("scene.toml", SCENE);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).expect("a file in the temporary folder");
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("the temporary folder");
        let mut names: Vec<String> = entries
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// The command, run in this folder.
    pub(crate) fn command(&self, line: &[&str]) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("pointillist"));
        command.current_dir(self.0.path()).args(line);
        command
    }

    /// Runs the command, expects this exit code and all of these pieces on standard error.
    pub(crate) fn fails(&self, line: &[&str], code: i32, pieces: &[&str]) {
        let output = self.command(line).output().expect("the command runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line:?}: {message}");
        for piece in pieces {
            assert!(message.contains(piece), "{line:?} does not say {piece:?}:\n{message}");
        }
    }

    /// Runs the command, expects success and gives standard output.
    pub(crate) fn prints(&self, line: &[&str]) -> String {
        let output = self.command(line).output().expect("the command runs");
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{line:?}: {message}");
        String::from_utf8(output.stdout).expect("text")
    }
}
