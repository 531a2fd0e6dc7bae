//! Lists of panoramas at positions, for `probe capture`.

use crate::coordinate::{LARGEST, is_usable};
use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use crate::json_words;
use glam::DVec3;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Pictures of all directions, and where they were taken.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaptureList {
    /// The pictures; those of equal positions are brackets.
    pub captures: Vec<CaptureEntry>,
    /// What the list is called in messages.
    #[serde(skip)]
    name: String,
    /// What images are relative to.
    #[serde(skip)]
    folder: PathBuf,
}

/// One picture.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaptureEntry {
    /// Its file, relative to the list.
    pub image: String,
    /// Where it was taken, in the world.
    pub position: [f64; 3],
    /// How it is turned: degrees about x, then y, then z. Without a turn, its centre looks along −Z, and its upper edge is +Y.
    pub rotate: [f64; 3],
    /// Stops by which it is to be brightened: of brackets, the darkest has the highest.
    #[serde(default)]
    pub exposure: f32,
    /// A name for the probe.
    #[serde(default)]
    pub name: Option<String>,
}

impl CaptureEntry {
    /// Where it was taken.
    #[must_use]
    pub fn position(&self) -> DVec3 {
        DVec3::from_array(self.position)
    }
}

/// Exposures that are accepted, in stops.
const EXPOSURES: std::ops::RangeInclusive<f32> = -60.0..=60.0;

const HELP: &str = "a list is {\"captures\":[{\"image\":\"pano.hdr\",\"position\":[x,y,z],\"rotate\":[x,y,z],\"exposure\":0}, …]}";

/// Reads a list.
///
/// # Errors
/// A file that is missing or holds something else, an entry without image, position or orientation, an image that is not there, an empty
/// list; brackets that are turned differently.
pub fn read_captures(path: &Path) -> Result<CaptureList, InputError> {
    let (name, bytes) = (input::name_of(path), input::read(path)?);
    let mut list: CaptureList = json_words::parse(&name, &bytes, HELP)
        .map_err(|error| JsonKind::explain(JsonKind::Captures, &name, &bytes, error))?;
    list.name = name;
    list.folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
    list.check()?;
    Ok(list)
}

impl CaptureList {
    /// The file of a picture.
    #[must_use]
    pub fn path_of(&self, entry: &CaptureEntry) -> PathBuf {
        self.folder.join(&entry.image)
    }

    /// An error about the list.
    pub fn error(&self, message: impl Into<String>) -> InputError {
        InputError::of_file(self.name.as_str(), message)
    }

    /// Indices of the pictures of each position, in the order of the first of each.
    #[must_use]
    pub fn brackets(&self) -> Vec<Vec<usize>> {
        let mut brackets: Vec<Vec<usize>> = vec![];
        let mut of_position = std::collections::HashMap::new();
        for (index, entry) in self.captures.iter().enumerate() {
            // Adding 0 makes −0 and 0 one position.
            let key = entry.position.map(|c| (c + 0.0).to_bits());
            let group = *of_position.entry(key).or_insert(brackets.len());
            if group == brackets.len() {
                brackets.push(vec![]);
            }
            brackets[group].push(index);
        }
        brackets
    }

    fn check(&self) -> Result<(), InputError> {
        if self.captures.is_empty() {
            return Err(self.error("`captures` is empty").with_help(HELP));
        }
        for (i, entry) in self.captures.iter().enumerate() {
            self.check_entry(i, entry)?;
        }
        for brackets in self.brackets() {
            let first = &self.captures[brackets[0]];
            if let Some(i) = brackets.iter().find(|&&i| self.captures[i].rotate != first.rotate) {
                let message = format!(
                    "`captures[{i}].rotate` differs from that of captures[{}], which has the same position",
                    brackets[0]
                );
                return Err(self.error(message).with_help("brackets are taken with the camera held still"));
            }
        }
        Ok(())
    }

    fn check_entry(&self, i: usize, entry: &CaptureEntry) -> Result<(), InputError> {
        if !is_usable(entry.position()) {
            let message = format!("`captures[{i}].position` is {:?}, beyond ±{LARGEST:e}", entry.position);
            return Err(self.error(message));
        }
        if !entry.rotate.iter().all(|angle| angle.is_finite()) {
            return Err(self.error(format!("`captures[{i}].rotate` is not finite")));
        }
        if !EXPOSURES.contains(&entry.exposure) {
            let message = format!("`captures[{i}].exposure` is {}, not from -60 to 60", entry.exposure);
            return Err(self.error(message));
        }
        if !self.path_of(entry).is_file() {
            let message = format!("`captures[{i}].image`: `{}` is not there", self.path_of(entry).display());
            return Err(self.error(message).with_help("images are named relative to the list"));
        }
        Ok(())
    }
}
