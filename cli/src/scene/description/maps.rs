//! Pictures that keys name: maps on surfaces, and what is around everything.

use super::{FileReference, file};
use crate::input_error::InputError;
use crate::scene::text::Table;
use crate::scene::{MapPlace, UvSet};
use glam::{DAffine2, DMat2, DVec2};

/// A texture's file, how its values are meant and where it lies.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureReference {
    /// The file.
    pub file: FileReference,
    /// Whether 8-bit colours are sRGB-encoded.
    pub srgb: bool,
    /// Where it lies on the surface.
    pub place: MapPlace,
    /// What is added to its values, and what they are multiplied by before.
    pub base_and_gain: [f32; 2],
}

/// A picture of all directions, or six of the faces of a cube: +X −X +Y −Y +Z −Z.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentReference {
    /// One or six.
    pub files: Vec<FileReference>,
}

/// A map: the name of a file, or a table with more about it. `set` is what it takes unless it says so.
pub(super) fn texture(
    table: &mut Table<'_>,
    key: &'static str,
    srgb: bool,
    set: UvSet,
) -> Result<Option<TextureReference>, InputError> {
    let plain = MapPlace { set, ..MapPlace::default() };
    if !table.is_table(key) {
        let file = file(table, key)?;
        return Ok(file.map(|file| TextureReference { file, srgb, place: plain, base_and_gain: [0.0, 1.0] }));
    }
    let Some(mut map) = table.table(key)? else { return Ok(None) };
    let Some(file) = file(&mut map, "file")? else { return Err(map.missing("file", "\"wall.png\"")) };
    let scale = map.numbers::<2>("scale")?.map_or(DVec2::ONE, DVec2::from_array);
    let rotate = map.number("rotate")?.unwrap_or(0.0);
    let offset = map.numbers::<2>("offset")?.map_or(DVec2::ZERO, DVec2::from_array);
    let set = match map.count("uv_set", 0, 1)? {
        None => set,
        Some(0) => UvSet::First,
        Some(_) => UvSet::Second,
    };
    let base = map.number("base")?.unwrap_or(0.0) as f32;
    let gain = map.number("gain")?.unwrap_or(1.0) as f32;
    map.finish()?;
    let turn = DMat2::from_angle(rotate.to_radians());
    let map_from_uv = DAffine2::from_mat2_translation(turn * DMat2::from_diagonal(scale), offset);
    let place = MapPlace { set, map_from_uv };
    Ok(Some(TextureReference { file, srgb, place, base_and_gain: [base, gain] }))
}

/// What is around everything, if the key is there.
pub(super) fn environment(
    table: &mut Table<'_>,
    key: &'static str,
) -> Result<Option<EnvironmentReference>, InputError> {
    let Some(texts) = table.text_or_texts(key)? else { return Ok(None) };
    if texts.len() != 1 && texts.len() != 6 {
        let message =
            format!("`{}` names {} pictures; it must be one or six", table.name_of(key), texts.len());
        let help = "six are the faces of a cube: +X, -X, +Y, -Y, +Z, -Z";
        return Err(table.error(key, message).with_help(help));
    }
    if texts.iter().any(|(path, _)| path.is_empty()) {
        return Err(table.error(key, format!("`{}` is empty; it must name a file", table.name_of(key))));
    }
    let files = texts.into_iter().map(|(path, span)| FileReference { path: path.to_owned(), span }).collect();
    Ok(Some(EnvironmentReference { files }))
}
