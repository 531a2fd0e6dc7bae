//! From the keys of an MTL material to a material of the renderer.
//!
//! `illum` decides which of them count: 0 and 1 are matt, 2 (or none) has the highlight of `Ks` and `Ns`, 3 and above
//! mirror their surroundings by `Ks`, too, and 4, 6, 7 and 9 let light through by `Tf` if that is given, 6 and 7 by `Ni`, too. `Pr` or `Pm` make
//! the surface GGX whatever `illum` says.

use super::mtl_library::Library;
use super::textures::{Purpose, TextureTable, Tone};
use super::{Bump, BumpHeight, Details, Map, MapPlace, Material, Surroundings, Transmission, UvSet};
use crate::input_error::InputError;
use crate::mesh_io::{MtlMap, MtlMaterial};
use glam::{DAffine2, Vec3};
use pointillist_shade::{self as shade, DIELECTRIC_REFLECTANCE, Model, Wrap};
use std::path::{Path, PathBuf};

/// `illum` of a material that does not say.
const HIGHLIGHT: u8 = 2;

/// Height of a bump map's white, as a share of what the texture spans, with `-bm 1`. MTL gives heights no unit. Chosen by eye: the
/// stones of Sponza's walls and the mane of its lion then look as deep as their colour says.
const BUMP_OF_TEXTURE: f32 = 0.03;

/// Refraction index where `Ni` is missing or means nothing.
const GLASS: f32 = 1.5;

pub(super) fn build(
    library: &Library,
    material: &MtlMaterial,
    textures: &mut TextureTable,
    warnings: &mut Vec<String>,
) -> Material {
    let color = Purpose::Color { srgb: true };
    let number = Purpose::Color { srgb: false };
    let mut map = |keyword: &str, purpose: Purpose| {
        let map = material.map(keyword)?;
        let texture = texture(library, map, purpose, textures);
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        Some(Map { texture, wrap, channel: map.channel, place: place(map) })
    };
    let diffuse = map("map_Kd", color);
    let opacity = map("map_d", Purpose::Opacity);
    let mut details = Details::default();
    details.specular_map = map("map_Ks", color);
    details.shininess_map = map("map_Ns", number);
    details.emission_map = map("map_Ke", color);
    details.roughness_map = map("map_Pr", number);
    details.metallic_map = map("map_Pm", number);
    details.normal = map("norm", number).map(|map| (map, 1.0));
    details.bump = map("map_bump", number).map(|map| Bump { map, height: bump_height(material) });
    let surface = surface(material, &mut details);
    surroundings(library, material, &mut details, textures, warnings);
    let mut made = Material::new(&material.name, surface).with_details(details);
    made.diffuse_map = diffuse.map(|map| map.texture);
    made.opacity_map = opacity.map(|map| map.texture);
    made.wrap = diffuse.or(opacity).map_or(Wrap::Repeat, |map| map.wrap);
    let place = |map: Option<Map>| map.map(|map| map.place).unwrap_or_default();
    (made.diffuse_place, made.opacity_place) = (place(diffuse), place(opacity));
    made
}

fn place(map: &MtlMap) -> MapPlace {
    let map_from_uv = DAffine2::from_scale_angle_translation(map.scale, 0.0, map.offset);
    MapPlace { set: UvSet::First, map_from_uv }
}

fn bump_height(material: &MtlMaterial) -> BumpHeight {
    let multiplier = material.map("map_bump").and_then(|map| map.bump_multiplier).unwrap_or(1.0);
    BumpHeight::OfTexture(BUMP_OF_TEXTURE * multiplier)
}

/// Model and constants; what mirrors is put into `details`.
fn surface(material: &MtlMaterial, details: &mut Details) -> shade::Material {
    let has_color = material.map("map_Kd").is_some();
    let default_albedo = if has_color { 1.0 } else { super::description::DEFAULT_ALBEDO };
    // A map without its constant stands for itself.
    let or_map =
        |constant: Option<Vec3>, map: bool| constant.unwrap_or(if map { Vec3::ONE } else { Vec3::ZERO });
    let specular = or_map(material.specular, details.specular_map.is_some());
    let shininess = material.shininess.unwrap_or(0.0);
    let illumination = material.illumination.unwrap_or(HIGHLIGHT);
    let highlight = illumination >= HIGHLIGHT && specular != Vec3::ZERO && shininess > 0.0;
    let model = if highlight { Model::NormalizedBlinnPhong } else { Model::Lambert };
    let mut surface = shade::Material::lambert(material.diffuse.unwrap_or(Vec3::splat(default_albedo)))
        .with_specular(model, specular, shininess)
        // Of what it mirrors, if it does.
        .with_roughness(0.0)
        .with_emission(or_map(material.emission, details.emission_map.is_some()))
        .with_opacity(material.opacity.unwrap_or(1.0));
    let physical = material.roughness.is_some()
        || material.metallic.is_some()
        || details.roughness_map.is_some()
        || details.metallic_map.is_some();
    if physical {
        surface.model = Model::Ggx;
        surface.roughness = material.roughness.unwrap_or(1.0);
        surface.specular = Vec3::splat(DIELECTRIC_REFLECTANCE);
        details.metallic =
            Some(material.metallic.unwrap_or(f32::from(u8::from(details.metallic_map.is_some()))));
        return surface;
    }
    if illumination >= 3 {
        details.reflection = Some(specular).filter(|&s| s != Vec3::ZERO);
    }
    details.transmission = transmission(material, illumination);
    surface
}

/// `Tf`, where `illum` asks for glass: 4 and 9 are passed straight, 6 and 7 refract. Some programs write `illum 4` and `Tf 1 1 1` for every
/// material, and mean that `d` alone says what passes.
fn transmission(material: &MtlMaterial, illumination: u8) -> Option<Transmission> {
    let color = material.transmission?.clamp(Vec3::ZERO, Vec3::ONE);
    match illumination {
        4 | 9 if color != Vec3::ONE => Some(Transmission { color, index: 1.0 }),
        6 | 7 => {
            let index = material.refraction_index.filter(|&n| n > 0.0).unwrap_or(GLASS);
            Some(Transmission { color, index })
        }
        _ => None,
    }
}

/// `refl`: a map of the surroundings of the material's own.
fn surroundings(
    library: &Library,
    material: &MtlMaterial,
    details: &mut Details,
    textures: &mut TextureTable,
    warnings: &mut Vec<String>,
) {
    let Some(map) = material.map("refl") else { return };
    let (file, name) = (library.path.display(), &material.name);
    let texture = match map.kind.as_deref() {
        None | Some("sphere") => texture(library, map, Purpose::Surroundings, textures),
        Some(kind) if CUBE_FACES.contains(&kind) => match cube(library, material, textures) {
            Ok(texture) => texture,
            Err(missing) => {
                warnings.push(format!(
                    "{file}: `refl` of material `{name}` has faces of a cube, but no -type {missing}; ignored"
                ));
                return;
            }
        },
        Some(kind) => {
            warnings.push(format!(
                "{file}: `refl` of material `{name}` is of -type {kind}, not sphere or cube_…; ignored"
            ));
            return;
        }
    };
    details.surroundings = Surroundings::Texture(texture);
    let own = material.specular.filter(|&s| s != Vec3::ZERO);
    details.reflection = details.reflection.or(own).or(Some(Vec3::ONE));
}

/// Faces of a reflection map in the order +X −X +Y −Y +Z −Z. The format does not say which axis is which: as in a picture of the world, x runs to
/// the right, y upward and z to the front.
const CUBE_FACES: [&str; 6] =
    ["cube_right", "cube_left", "cube_top", "cube_bottom", "cube_front", "cube_back"];

/// The six `refl` of a material as one texture, or the kind that is missing.
fn cube(
    library: &Library,
    material: &MtlMaterial,
    textures: &mut TextureTable,
) -> Result<usize, &'static str> {
    let face = |kind: &'static str| {
        let mut maps = material.maps.iter().filter(|map| map.keyword == "refl");
        maps.rfind(|map| map.kind.as_deref() == Some(kind)).ok_or(kind)
    };
    let faces: Vec<&MtlMap> = CUBE_FACES.into_iter().map(face).collect::<Result<_, _>>()?;
    let files = faces.iter().map(|map| located(library, map)).collect();
    // One tone for all: a cube has no seams.
    Ok(textures.load_cube(files, tone(faces[0])))
}

fn texture(library: &Library, map: &MtlMap, purpose: Purpose, textures: &mut TextureTable) -> usize {
    let (path, fault) = located(library, map);
    textures.load(&path, purpose, tone(map), || fault)
}

fn tone(map: &MtlMap) -> Tone {
    let [base, gain] = map.base_and_gain;
    Tone { base, gain }
}

/// A map's file, and the beginning of the error if it cannot be used.
fn located(library: &Library, map: &MtlMap) -> (PathBuf, InputError) {
    let folder = library.path.parent().unwrap_or(Path::new(""));
    let mut path = folder.join(&map.file);
    if !path.exists() {
        // Written on Windows, as many are.
        path = folder.join(map.file.replace('\\', "/"));
    }
    let name = library.path.display().to_string();
    let message = format!("texture `{}` ", path.display());
    let fault = InputError::in_line(&name, &library.bytes, map.line, message)
        .with_help("paths are relative to the MTL; PNG, JPEG, HDR and EXR can be read");
    (path, fault)
}
