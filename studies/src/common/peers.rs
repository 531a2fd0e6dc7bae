//! Programs of others that results are compared with, if they are there.

use std::path::{Path, PathBuf};
use std::process::Command;

use glam::Vec3;

use super::picture::Picture;
use super::timing::{Clock, Ratio, Timing, ratio_of, timed_part};

/// A program that a variable names, or that `studies/peers/build` made under this name.
pub(crate) fn find(variable: &str, name: &str) -> Option<PathBuf> {
    let named = std::env::var_os(variable).map(PathBuf::from);
    named.or_else(|| built(name)).filter(|path| path.is_file())
}

/// The pictures of a scene by a renderer of `studies/peers`, by as many samples along a side of a pixel as `sides` says, with its own processor seconds.
pub(crate) fn draw(
    program: &Path,
    scene: &str,
    size: [u32; 2],
    sides: &[u32],
) -> std::io::Result<Vec<(Timing, Picture)>> {
    with_files(scene, |scene, out| {
        let drawn = sides.iter().map(|side| {
            let (time, picture) =
                timed_part(Clock::Wall, || match draw_once(program, scene, *side, out, size) {
                    Ok((seconds, picture)) => (seconds, Ok(picture)),
                    Err(error) => (0.0, Err(error)),
                });
            picture.map(|picture| (time, picture))
        });
        drawn.collect()
    })
}

/// How much longer than the renderer something takes that says its own processor seconds, both in turns.
pub(crate) fn ratio_to(
    program: &Path,
    scene: &str,
    size: [u32; 2],
    side: u32,
    ours: impl FnMut() -> f64,
) -> std::io::Result<Ratio> {
    with_files(scene, |scene, out| {
        let mut done = Ok(());
        let theirs = || match draw_once(program, scene, side, out, size) {
            Ok((seconds, _)) => seconds,
            Err(error) => {
                done = Err(error);
                f64::NAN
            }
        };
        let ratio = ratio_of(ours, theirs);
        done.map(|()| ratio)
    })
}

/// Gives work a file with this text and the name of another, and removes both.
fn with_files<T>(scene: &str, work: impl FnOnce(&Path, &Path) -> std::io::Result<T>) -> std::io::Result<T> {
    let file = |name: &str| std::env::temp_dir().join(format!("peer-{}-{name}", std::process::id()));
    let [scene_file, out] = [file("scene.txt"), file("picture.f32")];
    std::fs::write(&scene_file, scene)?;
    let result = work(&scene_file, &out);
    std::fs::remove_file(&scene_file)?;
    let result = result?;
    std::fs::remove_file(&out)?;
    Ok(result)
}

fn draw_once(
    program: &Path,
    scene: &Path,
    side: u32,
    out: &Path,
    size: [u32; 2],
) -> std::io::Result<(f64, Picture)> {
    let output = Command::new(program).arg(scene).arg(side.to_string()).arg(out).output()?;
    let printed = String::from_utf8_lossy(&output.stdout);
    let seconds = printed.trim().strip_prefix("cpu_s ").and_then(|text| text.parse().ok());
    let Some(seconds) = seconds.filter(|_| output.status.success()) else {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(std::io::Error::other(format!("{}: {}", program.display(), said.trim())));
    };
    let mut picture = Picture::black(size[0], size[1]);
    let bytes = std::fs::read(out)?;
    for (pixel, color) in picture.pixels.iter_mut().zip(bytes.as_chunks::<12>().0) {
        let (channels, _) = color.as_chunks::<4>();
        *pixel = Vec3::from_array([0, 1, 2].map(|c| f32::from_le_bytes(channels[c]))).as_dvec3();
    }
    Ok((seconds, picture))
}

/// What sections say whose peer is not there.
pub(crate) const SKIPPED: &str = "was skipped: neither did `studies/peers/build` make it";

/// Why a peer is not in a table, as a sentence with [`SKIPPED`].
pub(crate) fn skipped(what: &str, variable: &str) -> String {
    format!("{what} {SKIPPED}, nor does `{variable}` name a program.")
}

/// This program is in `target/release`, peers are in `target/peers`.
fn built(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    Some(program.parent()?.parent()?.join("peers").join(name))
}
