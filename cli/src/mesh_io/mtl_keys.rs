//! All keys of an MTL and all options of its maps, and what becomes of each: `docs/materials.md` has the same list.

/// What becomes of a key or an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// It is drawn as the format describes it.
    Read,
    /// It is drawn as something that is close to what the format describes.
    Approximated,
    /// It is not drawn, and a warning says so. Unknown keys are likewise.
    Ignored,
}

/// What stands behind a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Material,
    Color,
    Number,
    Transmission,
    Roughness,
    Metallic,
    Illumination,
    /// Options and a file; the map is called this here.
    Map(&'static str),
    Nothing,
}

use Kind::{Color, Illumination, Map, Material, Metallic, Nothing, Number, Roughness, Transmission};
use Reading::{Approximated, Ignored, Read};

pub(super) const KEYS: [(&str, Kind, Reading); 36] = [
    ("newmtl", Material, Read),
    ("Ka", Color, Approximated),
    ("Kd", Color, Read),
    ("Ks", Color, Read),
    ("Ke", Color, Read),
    ("Ns", Number, Read),
    ("Ni", Number, Read),
    ("d", Number, Approximated),
    ("Tr", Number, Read),
    ("Tf", Transmission, Approximated),
    ("Pr", Roughness, Read),
    ("Pm", Metallic, Read),
    ("illum", Illumination, Approximated),
    ("map_Kd", Map("map_Kd"), Read),
    ("map_Ks", Map("map_Ks"), Read),
    ("map_Ns", Map("map_Ns"), Read),
    ("map_Ke", Map("map_Ke"), Read),
    ("map_d", Map("map_d"), Read),
    ("map_Pr", Map("map_Pr"), Read),
    ("map_Pm", Map("map_Pm"), Read),
    ("map_bump", Map("map_bump"), Approximated),
    ("map_Bump", Map("map_bump"), Approximated),
    ("bump", Map("map_bump"), Approximated),
    ("norm", Map("norm"), Read),
    ("refl", Map("refl"), Read),
    ("map_refl", Map("refl"), Read),
    ("map_Ka", Nothing, Ignored),
    ("map_Tr", Nothing, Ignored),
    ("disp", Nothing, Ignored),
    ("map_disp", Nothing, Ignored),
    ("decal", Nothing, Ignored),
    ("map_aat", Nothing, Ignored),
    ("Ps", Nothing, Ignored),
    ("Pc", Nothing, Ignored),
    ("aniso", Nothing, Ignored),
    ("sharpness", Nothing, Ignored),
];

/// How many words may follow an option.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Words {
    /// Exactly so many.
    Just(usize),
    /// One to three numbers.
    UpToThreeNumbers,
}

/// Other options are taken to have one word.
pub(super) const OPTIONS: [(&str, Words, Reading); 13] = [
    ("-s", Words::UpToThreeNumbers, Read),
    ("-o", Words::UpToThreeNumbers, Read),
    ("-mm", Words::Just(2), Read),
    ("-bm", Words::Just(1), Approximated),
    ("-clamp", Words::Just(1), Approximated),
    ("-type", Words::Just(1), Approximated),
    ("-imfchan", Words::Just(1), Approximated),
    ("-blendu", Words::Just(1), Approximated),
    ("-blendv", Words::Just(1), Approximated),
    ("-cc", Words::Just(1), Approximated),
    ("-t", Words::UpToThreeNumbers, Ignored),
    ("-boost", Words::Just(1), Ignored),
    ("-texres", Words::Just(1), Ignored),
];

/// All keys that are known, and what becomes of them.
pub fn mtl_keys() -> impl Iterator<Item = (&'static str, Reading)> {
    KEYS.iter().map(|(name, _, reading)| (*name, *reading))
}

/// All options of maps that are known, and what becomes of them.
pub fn mtl_options() -> impl Iterator<Item = (&'static str, Reading)> {
    OPTIONS.iter().map(|(name, _, reading)| (*name, *reading))
}
