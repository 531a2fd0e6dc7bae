//! Stanford's `.conf`: which range scans belong together, and where each stands.

use super::number::{Word, Words, parse_f64};
use super::source::{Line, Source};
use crate::coordinate::LARGEST;
use crate::input;
use crate::input_error::InputError;
use glam::{DQuat, DVec3, dvec3};
use std::path::{Path, PathBuf};

/// How far the length of a quaternion may be from 1. The files have seven digits; what is further off is no rotation, and
/// a typing error more likely than a matter of scale.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// Numbers of a pose: three of the translation, four of the quaternion.
const POSE_NUMBERS: usize = 7;

/// A rigid motion. For a scan it goes from the scan's frame to the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// World from scan: already the conjugate of the quaternion in the file, and of unit length.
    pub rotation: DQuat,
    /// Added after the rotation, in the unit of the scans.
    pub translation: DVec3,
}

impl Pose {
    /// The world's position of a point of the scan: `rotation · p + translation`. Normals take `rotation` alone.
    #[must_use]
    pub fn to_world(&self, point: DVec3) -> DVec3 {
        self.rotation * point + self.translation
    }

    /// The motion back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: -(rotation * self.translation) }
    }
}

/// A scan that a `.conf` names.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfScan {
    /// The file, found to be there: the folder of the `.conf` joined with the name in it, with `.gz` if only that is there.
    pub path: PathBuf,
    /// Where the scan stands: world from scan.
    pub pose: Pose,
}

/// What a `.conf` holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Conf {
    /// At least one, in the order of the file.
    pub scans: Vec<ConfScan>,
    /// The suggested view, in the same form as the scans' poses: it takes the world to the camera, which looks along −z with +y up. The
    /// first if there are several.
    pub camera: Option<Pose>,
    /// Scans that were left out, in sentences with the file's name and the line.
    pub warnings: Vec<String>,
}

/// Reads a `.conf` and looks whether its scans are there; the scans themselves are not opened.
///
/// A line is `bmesh FILE tx ty tz qx qy qz qw`: a point p of the scan goes to R(q)ᵀ·p + t, that is, it is rotated by
/// the conjugate of q. `FILE` is relative to the `.conf`, may have blanks, may be in quotes, and stands for `FILE.gz` if only that is there.
/// `mesh FILE …` is the same for other kinds of scans; cylindrical scans (`…_cybcyl`), and others that are
/// not there, are left out with a warning. `camera …` is a view. Lines that begin with `#` are comments.
///
/// # Errors
///
/// The file cannot be read or names no scan; a line has another form, numbers that are not finite, a quaternion whose length is
/// further than 0.001 from 1, or a `bmesh` that is not there.
pub fn read_conf(path: &Path) -> Result<Conf, InputError> {
    let name = input::name_of(path);
    let bytes = input::read(path)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    read(Source::new(&name, bytes.as_slice()), folder, &|path| path.is_file())
}

/// [`read_conf`] for bytes in memory, for which `exists` says which files are there.
///
/// # Errors
///
/// As [`read_conf`].
pub fn read_conf_bytes(
    name: &str,
    bytes: &[u8],
    folder: &Path,
    exists: &dyn Fn(&Path) -> bool,
) -> Result<Conf, InputError> {
    read(Source::new(name, bytes), folder, exists)
}

fn read(mut source: Source<'_>, folder: &Path, exists: &dyn Fn(&Path) -> bool) -> Result<Conf, InputError> {
    let name = source.name();
    let mut conf = Conf { scans: Vec::new(), camera: None, warnings: Vec::new() };
    while source.next_line()? {
        let line = source.line();
        let mut words = Words::of(line.text);
        let Some(keyword) = words.next().filter(|word| !word.bytes.starts_with(b"#")) else { continue };
        match keyword.bytes {
            b"camera" => {
                let (_, pose) = named_pose(name, &line, words)?;
                conf.camera = conf.camera.or(Some(pose));
            }
            b"bmesh" | b"mesh" => {
                let (file, pose) = named_pose(name, &line, words)?;
                let is_optional = keyword.bytes == b"mesh";
                match find(name, &line, folder, file, is_optional, exists)? {
                    Ok(path) => conf.scans.push(ConfScan { path, pose }),
                    Err(warning) => conf.warnings.push(warning),
                }
            }
            _ => {
                let message = format!("`{}` is no keyword of a .conf", keyword.shown());
                return Err(line
                    .error(name, Some(keyword), message)
                    .with_help("known are `camera`, `bmesh` and `mesh`, and `#` for comments"));
            }
        }
    }
    if conf.scans.is_empty() {
        return Err(InputError::of_file(name, "names no scan")
            .with_help("a scan is a line `bmesh FILE tx ty tz qx qy qz qw`"));
    }
    Ok(conf)
}

/// What stands between the keyword and the last seven words, and the pose that these are.
fn named_pose<'a>(
    name: &str,
    line: &Line<'a>,
    words: Words<'a, false>,
) -> Result<(Option<Word<'a>>, Pose), InputError> {
    let words: Vec<Word<'a>> = words.collect();
    let Some(split) = words.len().checked_sub(POSE_NUMBERS) else {
        let message =
            format!("words after the keyword: {}; a pose alone is {POSE_NUMBERS} numbers", words.len());
        return Err(line
            .error(name, None, message)
            .with_help("write tx ty tz qx qy qz qw: a translation and a unit quaternion"));
    };
    let (file, numbers) = words.split_at(split);
    let file = file.first().zip(file.last()).map(|(first, last)| {
        let end = last.start + last.bytes.len();
        let bytes = &line.text[first.start..end];
        match bytes {
            [b'"', name @ .., b'"'] if !name.is_empty() => Word { start: first.start + 1, bytes: name },
            _ => Word { start: first.start, bytes },
        }
    });
    Ok((file, pose(name, line, numbers)?))
}

fn pose(name: &str, line: &Line<'_>, words: &[Word<'_>]) -> Result<Pose, InputError> {
    let mut numbers = [0.0; POSE_NUMBERS];
    for (number, word) in numbers.iter_mut().zip(words) {
        *number = parse_f64(word.bytes).filter(|number| number.abs() <= LARGEST).ok_or_else(|| {
            line.error(name, Some(*word), format!("`{}` is no number up to ±{LARGEST:e}", word.shown()))
                .with_help("a pose is tx ty tz qx qy qz qw: a translation and a unit quaternion")
        })?;
    }
    let [tx, ty, tz, qx, qy, qz, qw] = numbers;
    let quaternion = DQuat::from_xyzw(qx, qy, qz, qw);
    let length = quaternion.length();
    if (length - 1.0).abs() > QUATERNION_TOLERANCE {
        let message =
            format!("the quaternion {qx} {qy} {qz} {qw} has the length {length:.6}, which is no rotation");
        return Err(line
            .error(name, words.get(3).copied(), message)
            .with_help("the last four numbers are a quaternion x y z w of length 1, to 0.001"));
    }
    Ok(Pose { rotation: quaternion.normalize().conjugate(), translation: dvec3(tx, ty, tz) })
}

/// The file of a scan, or a warning why there is none.
fn find(
    name: &str,
    line: &Line<'_>,
    folder: &Path,
    file: Option<Word<'_>>,
    is_optional: bool,
    exists: &dyn Fn(&Path) -> bool,
) -> Result<Result<PathBuf, String>, InputError> {
    let Some(word) = file else {
        let message = format!("{POSE_NUMBERS} numbers, but no file before them");
        return Err(line.error(name, None, message).with_help("write `bmesh FILE tx ty tz qx qy qz qw`"));
    };
    let file = std::str::from_utf8(word.bytes).map_err(|_| {
        line.error(name, Some(word), "the name of the file is not UTF-8")
            .with_help("rename the file and write the name in UTF-8")
    })?;
    if is_optional && file.trim_end_matches(".ply").ends_with("_cybcyl") {
        let why = "is a cylindrical scan, which is no range image; it is left out";
        return Ok(Err(format!("{name}:{}: `{file}` {why}", line.number)));
    }
    let plain = folder.join(file);
    let packed = folder.join(format!("{file}.gz"));
    if let Some(path) = [plain, packed].into_iter().find(|path| exists(path)) {
        return Ok(Ok(path));
    }
    if is_optional {
        return Ok(Err(format!("{name}:{}: `{file}` is not there; it is left out", line.number)));
    }
    let place = if folder.as_os_str().is_empty() { "." } else { &*folder.display().to_string() };
    Err(line
        .error(name, Some(word), format!("the scan `{file}` is not there"))
        .with_help(format!("put `{file}` or `{file}.gz` into `{place}`, or remove the line")))
}
