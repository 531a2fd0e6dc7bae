//! What the JSON files of this program are, told by their keys: for `info`, and for messages about a file in the wrong place.

use crate::input_error::InputError;
use serde::de::IgnoredAny;
use std::collections::HashMap;

/// What a JSON file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum JsonKind {
    /// `probe place` and `probe bake`.
    Probes,
    /// `radiosity`.
    Radiosity,
    /// `probe project`.
    Harmonics,
    /// What `probe capture` reads.
    Captures,
    /// What `--stats` writes.
    Statistics,
    /// What `compare` writes.
    Comparison,
    /// What `job` writes.
    Job,
    /// A scene file, as far as one can tell.
    Scene,
}

impl JsonKind {
    /// By the keys of the outermost object.
    pub(crate) fn of_keys<'k>(keys: impl Iterator<Item = &'k str> + Clone) -> Self {
        let has = |key: &str| keys.clone().any(|found| found == key);
        match () {
            () if has("probes") => Self::Probes,
            () if has("geometry") && has("irradiance") => Self::Radiosity,
            () if has("captures") => Self::Captures,
            () if has("seconds") && has("peak_bytes") => Self::Statistics,
            () if has("rmse") && has("max_pixel") => Self::Comparison,
            () if has("specificationVersion") => Self::Job,
            () if has("sh") => Self::Harmonics,
            () => Self::Scene,
        }
    }

    /// Of a whole text; nothing if it is no JSON object.
    pub(crate) fn of_text(text: &[u8]) -> Option<Self> {
        let keys = serde_json::from_slice::<HashMap<String, IgnoredAny>>(text).ok()?;
        Some(Self::of_keys(keys.keys().map(String::as_str)))
    }

    /// As messages say it.
    fn name(self) -> &'static str {
        match self {
            Self::Probes => "light probes",
            Self::Radiosity => "baked radiosity",
            Self::Harmonics => "spherical harmonics of one environment map",
            Self::Captures => "a list of panoramas",
            Self::Statistics => "what `--stats` wrote",
            Self::Comparison => "what `compare` wrote",
            Self::Job => "a job template",
            Self::Scene => "a scene",
        }
    }

    /// What such a file is for.
    fn use_of(self) -> &'static str {
        match self {
            Self::Probes => {
                "a scene names probes by [ambient] probes = \"FILE\"; `pointillist probe` bakes and queries them"
            }
            Self::Radiosity => "a scene names it by [ambient] radiosity = \"FILE\"",
            Self::Job => "`openjd run FILE` runs it",
            Self::Harmonics | Self::Statistics | Self::Comparison => {
                "`pointillist info FILE` says what it holds"
            }
            Self::Captures => "`pointillist probe capture FILE` makes light probes of it",
            Self::Scene => "`pointillist render FILE` draws it",
        }
    }

    /// The error that a file of this kind stands where another is wanted.
    pub(crate) fn misplaced(self, name: &str, wanted: Self) -> InputError {
        InputError::of_file(name, format!("this is {}, not {}", self.name(), wanted.name()))
            .with_help(self.use_of())
    }

    /// A better error than `error` for a text that is of another kind altogether.
    pub(crate) fn explain(wanted: Self, name: &str, text: &[u8], error: InputError) -> InputError {
        match Self::of_text(text) {
            Some(kind) if kind != wanted && kind != Self::Scene => kind.misplaced(name, wanted),
            _ => error,
        }
    }
}
