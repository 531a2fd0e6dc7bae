//! `[material.NAME]`.

use super::maps::{EnvironmentReference, TextureReference, environment, texture};
use super::{FileReference, file};
use crate::input_error::InputError;
use crate::scene::text::{Span, Table};
use crate::scene::{Transmission, UvSet};
use glam::Vec3;
use pointillist_shade::{AutoUv, DIELECTRIC_REFLECTANCE, Material, Model, Wrap};

/// Diffuse albedo of a surface that nothing is said about.
pub const DEFAULT_ALBEDO: f32 = 0.8;

/// A material of the scene file.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDescription {
    /// The place of its name.
    pub span: Span,
    /// Model and constants.
    pub surface: Material,
    /// Multiplies the diffuse albedo.
    pub diffuse_map: Option<TextureReference>,
    /// Multiplies the opacity.
    pub opacity_map: Option<TextureReference>,
    /// Multiplies the specular albedo.
    pub specular_map: Option<TextureReference>,
    /// Multiplies the exponent.
    pub shininess_map: Option<TextureReference>,
    /// Multiplies the roughness.
    pub roughness_map: Option<TextureReference>,
    /// Multiplies `metallic`.
    pub metallic_map: Option<TextureReference>,
    /// Multiplies the emission.
    pub emission_map: Option<TextureReference>,
    /// Multiplies what is mirrored.
    pub reflection_map: Option<TextureReference>,
    /// Light that arrives.
    pub light_map: Option<TextureReference>,
    /// Heights.
    pub bump_map: Option<TextureReference>,
    /// Height of white, in world units.
    pub bump_scale: f32,
    /// Normals in the texture's frame.
    pub normal_map: Option<TextureReference>,
    /// Outside the unit square.
    pub wrap: Wrap,
    /// How metallic, for GGX.
    pub metallic: Option<f32>,
    /// Measured reflection.
    pub merl: Option<FileReference>,
    /// The share of its surroundings that it mirrors.
    pub reflection: Option<Vec3>,
    /// What passes of the light from behind.
    pub transmission: Option<Transmission>,
    /// Where mirrored light comes from.
    pub surroundings: SurroundingsDescription,
    /// It is looked up along the normal.
    pub mirrors_by_normal: bool,
    /// Coordinates made from positions.
    pub uv: Option<AutoUv>,
    /// Its polygons are lights.
    pub emits: bool,
}

/// Where mirrored light comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum SurroundingsDescription {
    /// The scene's environment.
    Scene,
    /// Six pictures of the scene.
    Capture,
    /// A map of its own.
    Files(EnvironmentReference),
}

/// What `model` may say.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ModelName {
    Formula(Model),
    Measured,
}

/// The models by name: the normalised forms, because lights are in physical units.
const MODELS: [(&str, ModelName); 6] = [
    ("lambert", ModelName::Formula(Model::Lambert)),
    ("phong", ModelName::Formula(Model::NormalizedPhong)),
    ("blinn-phong", ModelName::Formula(Model::NormalizedBlinnPhong)),
    ("ggx", ModelName::Formula(Model::Ggx)),
    ("merl", ModelName::Measured),
    ("opengl", ModelName::Formula(Model::OpenGl)),
];

const KINDS_OF_UV: [(&str, AutoUv); 4] = [
    ("planar", AutoUv::Planar),
    ("cylindrical", AutoUv::Cylindrical),
    ("polar", AutoUv::Polar),
    ("box", AutoUv::Box),
];

/// Roughness of a GGX surface that does not say.
const DEFAULT_ROUGHNESS: f64 = 0.5;
/// Refraction index of a surface that does not say: a thin sheet, which light passes straight.
const DEFAULT_INDEX: f64 = 1.0;

pub(super) fn read_all(root: &mut Table<'_>) -> Result<Vec<(String, MaterialDescription)>, InputError> {
    let tables = root.named_tables("material")?;
    tables.into_iter().map(|(name, table)| Ok((name.name.clone(), read(name.span, table)?))).collect()
}

fn read(span: Span, mut table: Table<'_>) -> Result<MaterialDescription, InputError> {
    let model = table.choice("model", &MODELS)?.unwrap_or(ModelName::Formula(Model::Lambert));
    let model = with_highlight(&mut table, model)?;
    let srgb = table.choice("color_space", &[("srgb", true), ("linear", false)])?.unwrap_or(true);
    table.choice("filter", &[("texel", ())])?;
    let wrap = table
        .choice("wrap", &[("repeat", Wrap::Repeat), ("clamp", Wrap::Clamp), ("mirror", Wrap::Mirror)])?
        .unwrap_or_default();
    let light_map = texture(&mut table, "lightmap", srgb, UvSet::Second)?;
    let mut texture = |key| texture(&mut table, key, srgb, UvSet::First);
    let mut found = MaterialDescription {
        span,
        surface: Material::default(),
        diffuse_map: texture("diffuse_map")?,
        opacity_map: texture("opacity_map")?,
        specular_map: texture("specular_map")?,
        shininess_map: texture("shininess_map")?,
        roughness_map: texture("roughness_map")?,
        metallic_map: texture("metallic_map")?,
        emission_map: texture("emission_map")?,
        reflection_map: texture("reflection_map")?,
        light_map,
        bump_map: texture("bump_map")?,
        normal_map: texture("normal_map")?,
        bump_scale: 1.0,
        wrap,
        metallic: table.number_where("metallic", "from 0 to 1", is_share)?.map(|n| n as f32),
        merl: file(&mut table, "merl")?,
        reflection: color_or_number(&mut table, "reflection")?,
        transmission: read_transmission(&mut table)?,
        surroundings: read_surroundings(&mut table)?,
        mirrors_by_normal: table
            .choice("environment_lookup", &[("reflection", false), ("normal", true)])?
            .unwrap_or(false),
        uv: table.choice("uv", &KINDS_OF_UV)?,
        emits: table.boolean("emits")?.unwrap_or(false),
    };
    let bump_scale = table.number_where("bump_scale", "a number (world units)", f64::is_finite)?;
    found.bump_scale = bump_scale.unwrap_or(1.0) as f32;
    found.surface = read_surface(&mut table, model, &found)?;
    let is_ggx = model == ModelName::Formula(Model::Ggx);
    if found.reflection_map.is_some() && !is_ggx && found.transmission.is_none() {
        found.reflection = found.reflection.or(Some(Vec3::ONE));
    }
    if found.metallic_map.is_some() {
        found.metallic = found.metallic.or(Some(1.0));
    }
    check_unused(&table, model, &found)?;
    if found.emits && found.surface.emission == Vec3::ZERO {
        return Err(unused(
            &table,
            "emits",
            "the material has no `emission` (a radiance such as [10, 10, 10])",
        ));
    }
    if bump_scale.is_some() && found.bump_map.is_none() {
        return Err(unused(&table, "bump_scale", "it is the height of a `bump_map`, and there is none"));
    }
    table.finish()?;
    Ok(found)
}

/// `highlight`: which one OpenGL's formula has.
fn with_highlight(table: &mut Table<'_>, model: ModelName) -> Result<ModelName, InputError> {
    let highlight = table.choice("highlight", &[("blinn", Model::OpenGl), ("phong", Model::OpenGlPhong)])?;
    match highlight {
        None => Ok(model),
        Some(highlight) if model == ModelName::Formula(Model::OpenGl) => Ok(ModelName::Formula(highlight)),
        Some(_) => Err(unused(table, "highlight", "it is for model = \"opengl\"")),
    }
}

fn is_share(n: f64) -> bool {
    (0.0..=1.0).contains(&n)
}

fn read_surface(
    table: &mut Table<'_>,
    model: ModelName,
    found: &MaterialDescription,
) -> Result<Material, InputError> {
    let is_ggx = model == ModelName::Formula(Model::Ggx);
    let default_albedo = if found.diffuse_map.is_some() { 1.0 } else { DEFAULT_ALBEDO };
    let default_specular = match () {
        () if is_ggx && found.specular_map.is_none() => DIELECTRIC_REFLECTANCE,
        () if found.specular_map.is_some() => 1.0,
        () => 0.0,
    };
    let default_emission = if found.emission_map.is_some() { Vec3::ONE } else { Vec3::ZERO };
    let default_shininess = if found.shininess_map.is_some() { 100.0 } else { 0.0 };
    // What mirrors without being GGX is a plain mirror unless it says otherwise.
    let default_roughness = match () {
        () if found.roughness_map.is_some() => 1.0,
        () if is_ggx => DEFAULT_ROUGHNESS,
        () => 0.0,
    };
    let specular = color_or_number(table, "specular")?.unwrap_or(Vec3::splat(default_specular));
    if is_ggx && specular.max_element() > 1.0 {
        let message =
            format!("`{}` is a reflectance here and must be from 0 to 1", table.name_of("specular"));
        return Err(table.error("specular", message));
    }
    let shininess = table.number_where("shininess", "0 or more", |n| n >= 0.0)?;
    if shininess.is_some() && is_ggx {
        return Err(unused(table, "shininess", "\"ggx\" has a `roughness` from 0 to 1 instead"));
    }
    let roughness = table.number_where("roughness", "from 0 to 1", is_share)?;
    if roughness.is_some() && !is_ggx && found.reflection.is_none() {
        return Err(unused(
            table,
            "roughness",
            "it is for model = \"ggx\", or for a surface with `reflection`",
        ));
    }
    let model = if let ModelName::Formula(model) = model { model } else { Model::Lambert };
    let diffuse = table.color("diffuse")?.unwrap_or(Vec3::splat(default_albedo));
    let ambient = color_or_number(table, "ambient")?;
    if ambient.is_some() && !model.is_opengl() {
        return Err(unused(
            table,
            "ambient",
            "it is for model = \"opengl\"; others reflect ambient light by `diffuse`",
        ));
    }
    let emission = table.color("emission")?.unwrap_or(default_emission);
    let opacity = table.number_where("opacity", "from 0 to 1", is_share)?.unwrap_or(1.0);
    let surface = Material::lambert(diffuse);
    Ok(ambient
        .map_or(surface, |ambient| surface.with_ambient(ambient))
        .with_specular(model, specular, shininess.unwrap_or(default_shininess) as f32)
        .with_roughness(roughness.unwrap_or(default_roughness) as f32)
        .with_emission(emission)
        .with_opacity(opacity as f32))
}

/// Keys that would do nothing with this model.
fn check_unused(table: &Table<'_>, model: ModelName, found: &MaterialDescription) -> Result<(), InputError> {
    let is_ggx = model == ModelName::Formula(Model::Ggx);
    match (model, &found.merl) {
        (ModelName::Measured, None) => return Err(table.missing("merl", "\"gold-metallic-paint.binary\"")),
        (ModelName::Formula(_), Some(_)) => {
            return Err(unused(table, "merl", "it needs model = \"merl\""));
        }
        (ModelName::Measured, Some(_)) => {
            for (key, given) in
                [("diffuse_map", found.diffuse_map.is_some()), ("specular_map", found.specular_map.is_some())]
            {
                if given {
                    return Err(unused(table, key, "a measured surface is the same everywhere"));
                }
            }
        }
        (ModelName::Formula(_), None) => {}
    }
    let for_ggx = "it is for model = \"ggx\"";
    let rough = is_ggx || found.reflection.is_some();
    let shiny = matches!(
        model,
        ModelName::Formula(
            Model::NormalizedPhong | Model::NormalizedBlinnPhong | Model::OpenGl | Model::OpenGlPhong
        )
    );
    let needs = [
        ("metallic", found.metallic.is_some(), is_ggx, for_ggx),
        ("metallic_map", found.metallic_map.is_some(), is_ggx, for_ggx),
        ("roughness_map", found.roughness_map.is_some(), rough, for_ggx),
        (
            "shininess_map",
            found.shininess_map.is_some(),
            shiny,
            "it is for \"phong\", \"blinn-phong\" and \"opengl\"",
        ),
        ("specular_map", found.specular_map.is_some(), shiny || is_ggx, "\"lambert\" has no highlight"),
    ];
    match needs.into_iter().find(|&(_, given, used, _)| given && !used) {
        Some((key, .., why)) => Err(unused(table, key, why)),
        None => Ok(()),
    }
}

fn unused(table: &Table<'_>, key: &str, why: &str) -> InputError {
    table.error(key, format!("`{}` does nothing here: {why}", table.name_of(key)))
}

fn color_or_number(table: &mut Table<'_>, key: &'static str) -> Result<Option<Vec3>, InputError> {
    if table.is_number(key) {
        return Ok(table.number_where(key, "0 or more", |n| n >= 0.0)?.map(|n| Vec3::splat(n as f32)));
    }
    table.color(key)
}

fn read_transmission(table: &mut Table<'_>) -> Result<Option<Transmission>, InputError> {
    let color = color_or_number(table, "transmission")?;
    if color.is_some_and(|c| c.max_element() > 1.0) {
        let name = table.name_of("transmission");
        let message = format!("`{name}` must be from 0 to 1: no more light passes than arrives");
        return Err(table.error("transmission", message));
    }
    let index = table.number_where("refraction_index", "more than 0", |n| n > 0.0 && n < 1e6)?;
    match color {
        None if index.is_some() => Err(unused(table, "refraction_index", "it needs `transmission`")),
        None => Ok(None),
        Some(color) => Ok(Some(Transmission { color, index: index.unwrap_or(DEFAULT_INDEX) as f32 })),
    }
}

fn read_surroundings(table: &mut Table<'_>) -> Result<SurroundingsDescription, InputError> {
    Ok(match environment(table, "environment")? {
        None => SurroundingsDescription::Scene,
        Some(found) if found.files.len() == 1 && found.files[0].path == "capture" => {
            SurroundingsDescription::Capture
        }
        Some(found) => SurroundingsDescription::Files(found),
    })
}
