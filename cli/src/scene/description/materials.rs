//! `[material.NAME]`.

use super::{FileReference, file};
use crate::input_error::InputError;
use crate::scene::text::Table;
use glam::Vec3;
use pointillist_shade::{Material, Model, Wrap};

/// Diffuse albedo of a surface that nothing is said about.
pub const DEFAULT_ALBEDO: f32 = 0.8;

/// A texture's file and how its values are meant.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureReference {
    /// The file.
    pub file: FileReference,
    /// Whether 8-bit colours are sRGB-encoded.
    pub srgb: bool,
}

/// A material of the scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDescription {
    /// Model and constants.
    pub surface: Material,
    /// Multiplies the diffuse albedo.
    pub diffuse_map: Option<TextureReference>,
    /// Multiplies the opacity.
    pub opacity_map: Option<TextureReference>,
    /// Outside the unit square.
    pub wrap: Wrap,
}

#[derive(Clone, Copy)]
enum ModelName {
    Known(Model),
    NotYet,
}

/// The models by name: the normalised forms, because lights are in physical units.
const MODELS: [(&str, ModelName); 5] = [
    ("lambert", ModelName::Known(Model::Lambert)),
    ("phong", ModelName::Known(Model::NormalizedPhong)),
    ("blinn-phong", ModelName::Known(Model::NormalizedBlinnPhong)),
    ("ggx", ModelName::NotYet),
    ("merl", ModelName::NotYet),
];

pub(super) fn read_all(root: &mut Table<'_>) -> Result<Vec<(String, MaterialDescription)>, InputError> {
    let tables = root.named_tables("material")?;
    tables.into_iter().map(|(name, table)| Ok((name.to_owned(), read(table)?))).collect()
}

fn read(mut table: Table<'_>) -> Result<MaterialDescription, InputError> {
    table.not_yet(&[
        "map_bump",
        "bump_map",
        "normal_map",
        "specular_map",
        "roughness",
        "metallic",
        "table",
    ])?;
    let model = match table.choice("model", &MODELS)? {
        None => Model::Lambert,
        Some(ModelName::Known(model)) => model,
        Some(ModelName::NotYet) => {
            let message = format!("`{}`: this model is not in this version yet", table.name_of("model"));
            return Err(table
                .error("model", message)
                .with_help("use \"lambert\", \"phong\" or \"blinn-phong\""));
        }
    };
    let srgb = table.choice("color_space", &[("srgb", true), ("linear", false)])?.unwrap_or(true);
    table.choice("filter", &[("texel", ())])?;
    let wrap = table
        .choice("wrap", &[("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp), ("mirror", Wrap::Mirror)])?
        .unwrap_or_default();
    let texture = |file: Option<FileReference>| file.map(|file| TextureReference { file, srgb });
    let diffuse_map = texture(file(&mut table, "diffuse_map")?);
    let opacity_map = texture(file(&mut table, "opacity_map")?);
    let default_albedo = if diffuse_map.is_some() { 1.0 } else { DEFAULT_ALBEDO };
    let surface = Material {
        model,
        diffuse: table.color("diffuse")?.unwrap_or(Vec3::splat(default_albedo)),
        specular: table.color("specular")?.unwrap_or(Vec3::ZERO),
        shininess: table.number_where("shininess", "0 or more", |n| n >= 0.0)?.unwrap_or(0.0) as f32,
        roughness: 1.0,
        emission: table.color("emission")?.unwrap_or(Vec3::ZERO),
        opacity: table.number_where("opacity", "from 0 to 1", |n| (0.0..=1.0).contains(&n))?.unwrap_or(1.0)
            as f32,
    };
    table.finish()?;
    Ok(MaterialDescription { surface, diffuse_map, opacity_map, wrap })
}
