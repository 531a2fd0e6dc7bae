//! From the keys of an MTL material to a material of the renderer.
//!
//! `illum` decides which of them count: 0 and 1 are matt, 2 (or none) has the highlight of `Ks` and `Ns`, 3 and above
//! mirror their surroundings by `Ks`, too, and 4, 6, 7 and 9 let light through by `Tf` if that is given, 6 and 7 by `Ni`, too. `Pr` or `Pm` make
//! the surface GGX whatever `illum` says.

use super::mtl_library::Library;
use super::textures::{Purpose, TextureTable};
use super::{Bump, BumpHeight, Channel, Details, Map, Material, Surroundings, Transmission};
use crate::input_error::InputError;
use crate::mesh_io::{MtlMap, MtlMaterial};
use glam::Vec3;
use pointillist_shade::{self as shade, DIELECTRIC_REFLECTANCE, Model, Wrap};
use std::path::Path;

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
    let mut load = |keyword: &str, purpose: Purpose| {
        material.map(keyword).map(|map| texture(library, map, purpose, textures))
    };
    let color = Purpose::Color { srgb: true };
    let diffuse_map = load("map_Kd", color);
    let opacity_map = load("map_d", Purpose::Opacity);
    let mut map = |keyword: &str, purpose: Purpose| {
        let wrap = wrap(material.map(keyword));
        load(keyword, purpose).map(|texture| Map { texture, wrap, channel: Channel::Mean })
    };
    let number = Purpose::Color { srgb: false };
    let bump = map("map_bump", number).map(|map| Bump { map, height: bump_height(material) });
    let mut details = Details::default();
    details.specular_map = map("map_Ks", color);
    details.shininess_map = map("map_Ns", number);
    details.emission_map = map("map_Ke", color);
    details.roughness_map = map("map_Pr", number);
    details.metallic_map = map("map_Pm", number);
    details.normal = map("norm", number).map(|map| (map, 1.0));
    details.bump = bump;
    let surface = surface(material, &mut details);
    surroundings(library, material, &mut details, &mut load, warnings);
    let wrap = wrap(material.map("map_Kd"));
    let mut made = Material::new(&material.name, surface).with_details(details);
    (made.diffuse_map, made.opacity_map, made.wrap) = (diffuse_map, opacity_map, wrap);
    made
}

fn wrap(map: Option<&MtlMap>) -> Wrap {
    if map.is_some_and(|map| map.clamp) { Wrap::Clamp } else { Wrap::Repeat }
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
    load: &mut impl FnMut(&str, Purpose) -> Option<usize>,
    warnings: &mut Vec<String>,
) {
    let Some(map) = material.map("refl") else { return };
    if map.kind.as_deref().is_some_and(|kind| kind != "sphere") {
        let (file, name) = (library.path.display(), &material.name);
        warnings.push(format!("{file}: `refl` of material `{name}` is not of -type sphere; ignored"));
        return;
    }
    if let Some(texture) = load("refl", Purpose::Color { srgb: true }) {
        details.surroundings = Surroundings::Texture(texture);
        let own = material.specular.filter(|&s| s != Vec3::ZERO);
        details.reflection = details.reflection.or(own).or(Some(Vec3::ONE));
    }
}

fn texture(library: &Library, map: &MtlMap, purpose: Purpose, textures: &mut TextureTable) -> usize {
    let folder = library.path.parent().unwrap_or(Path::new(""));
    let mut path = folder.join(&map.file);
    if !path.exists() {
        // Written on Windows, as many are.
        path = folder.join(map.file.replace('\\', "/"));
    }
    textures.load(&path, purpose, || {
        let name = library.path.display().to_string();
        let message = format!("texture `{}` ", path.display());
        InputError::in_line(&name, &library.bytes, map.line, message)
            .with_help("paths are relative to the MTL; PNG, JPEG, HDR and EXR can be read")
    })
}
