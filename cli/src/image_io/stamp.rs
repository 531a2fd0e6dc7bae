//! The provenance in an EXR's header: version, fingerprint of scene and options, region and background.

use super::PixelRect;

/// The header line by which parts of one picture know one another.
#[derive(Clone, Debug, PartialEq)]
pub struct Stamp {
    /// The version that drew it.
    pub version: String,
    /// Hash of scene and options.
    pub fingerprint: u64,
    /// What the whole job covers: the picture, or `--crop`.
    pub region: PixelRect,
    /// `--tile` as it was given, if it was.
    pub tile: Option<String>,
    /// Whether tiles are missing: what an interrupted run keeps.
    pub unfinished: bool,
    /// What is behind the pixels: needed to take it out again for straight alpha.
    pub background: [f32; 3],
}

impl Stamp {
    /// As one line.
    pub fn to_text(&self) -> String {
        let [r, g, b] = self.background;
        let mut text = format!(
            "version={} fingerprint={:016x} region={} background={r},{g},{b}",
            self.version, self.fingerprint, self.region
        );
        if let Some(tile) = &self.tile {
            text.push_str(&format!(" tile={tile}"));
        }
        if self.unfinished {
            text.push_str(" unfinished=true");
        }
        text
    }

    /// From such a line; `None` if it is something else.
    pub fn from_text(text: &str) -> Option<Self> {
        let value = |key: &str| text.split(' ').find_map(|word| word.strip_prefix(key)?.strip_prefix('='));
        let numbers = |key: &str| value(key).map(|list| list.split(',').collect::<Vec<_>>());
        let region: Vec<u32> = numbers("region")?.iter().map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let background: Vec<f32> =
            numbers("background")?.iter().map(|n| n.parse().ok()).collect::<Option<_>>()?;
        let &[x0, y0, x1, y1] = region.as_slice() else { return None };
        if x0 >= x1 || y0 >= y1 {
            return None;
        }
        Some(Self {
            version: value("version")?.to_owned(),
            fingerprint: u64::from_str_radix(value("fingerprint")?, 16).ok()?,
            region: PixelRect { x0, y0, x1, y1 },
            tile: value("tile").map(str::to_owned),
            unfinished: value("unfinished").is_some(),
            background: background.try_into().ok()?,
        })
    }
}
