//! Another program that divides space by the same points, if it is there: CGAL behind a small C++ program.
//!
//! It reads points, and queries if it is to find them, as little-endian `f64`s, and prints what it took.

use std::path::PathBuf;
use std::process::Command;

use glam::DVec3;

use crate::common::peers;

/// An executable.
pub(crate) struct Peer(PathBuf);

/// What it took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Took {
    /// Seconds that passed, and of processor time.
    pub(crate) wall: f64,
    pub(crate) cpu: f64,
    pub(crate) cells: usize,
    /// Millions of queries a second: anywhere, and along a path.
    pub(crate) random: f64,
    pub(crate) coherent: f64,
}

impl Took {
    /// The better of two runs.
    pub(crate) fn or_better(self, other: Self) -> Self {
        Self {
            wall: self.wall.min(other.wall),
            cpu: self.cpu.min(other.cpu),
            cells: self.cells,
            random: self.random.max(other.random),
            coherent: self.coherent.max(other.coherent),
        }
    }
}

impl Peer {
    /// The program of [`peers::find`].
    pub(crate) fn find(variable: &str, name: &str) -> Option<Self> {
        peers::find(variable, name).map(Self)
    }

    /// Runs it; `None`, with a word about it, if that fails.
    pub(crate) fn run(&self, points: &[DVec3], queries: &[DVec3]) -> Option<Took> {
        let file =
            |name: &str| std::env::temp_dir().join(format!("shprobe-{}-{name}.bin", std::process::id()));
        let (points_file, queries_file) = (file("points"), file("queries"));
        let output = std::fs::write(&points_file, bytes(points)).and_then(|()| {
            let mut command = Command::new(&self.0);
            command.arg(&points_file);
            if !queries.is_empty() {
                std::fs::write(&queries_file, bytes(queries))?;
                command.arg(&queries_file);
            }
            command.output()
        });
        [points_file, queries_file].iter().for_each(|f| {
            // One of them may not have been written.
            let _ = std::fs::remove_file(f);
        });
        match output {
            Ok(output) => parse(&String::from_utf8_lossy(&output.stdout)),
            Err(error) => {
                eprintln!("shprobe: {}: {error}", self.0.display());
                None
            }
        }
    }
}

fn bytes(points: &[DVec3]) -> Vec<u8> {
    points.iter().flat_map(|p| p.to_array()).flat_map(f64::to_le_bytes).collect()
}

/// Of words, each followed by its number.
fn parse(text: &str) -> Option<Took> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let after = |name: &str| words.windows(2).find(|w| w[0] == name).and_then(|w| w[1].parse::<f64>().ok());
    Some(Took {
        wall: after("build_s")?,
        cpu: after("cpu_s")?,
        cells: after("cells")? as usize,
        random: after("locate_random_Mqps").unwrap_or(0.0),
        coherent: after("locate_coherent_Mqps").unwrap_or(0.0),
    })
}
