//! From a glTF material to a material of the renderer.

use super::textures::{Purpose, TextureTable, Tone};
use super::{Channel, Details, Map, Material};
use crate::input_error::InputError;
use crate::mesh_io::gltf::{AlphaMode, GltfBytes, GltfMaterial, GltfModel, GltfTexture};
use glam::Vec3;
use pointillist_shade::{self as shade, Wrap};
use std::path::Path;

/// Builds a material of the model in the file `path`.
pub(super) fn build(
    material: &GltfMaterial,
    model: &GltfModel,
    path: &Path,
    textures: &mut TextureTable,
) -> Result<Material, InputError> {
    let mut pictures = Pictures { model, path, textures, material: &material.name };
    let color = Purpose::Color { srgb: true };
    let number = Purpose::Color { srgb: false };
    let base = pictures.optional(material.base_texture, color)?;
    let mut details = Details::default();
    details.one_sided = !material.double_sided;
    let reflectance = Vec3::splat(material.reflectance);
    let opacity = if material.alpha_mode == AlphaMode::Blend { material.alpha } else { 1.0 };
    let mut surface = shade::Material::ggx(material.base_color, reflectance, material.roughness)
        .with_opacity(opacity)
        .with_emission(material.emissive);
    if material.unlit {
        // Seen as it is: the base colour is what it sends out.
        surface =
            shade::Material::lambert(Vec3::ZERO).with_emission(material.base_color).with_opacity(opacity);
        details.emission_map = pictures.map(material.base_texture, color, Channel::Mean)?;
    } else {
        details.metallic = Some(material.metallic);
        details.roughness_map = pictures.map(material.metallic_roughness_texture, number, Channel::Green)?;
        details.metallic_map = pictures.map(material.metallic_roughness_texture, number, Channel::Blue)?;
        details.emission_map = pictures.map(material.emissive_texture, color, Channel::Mean)?;
        if let Some((texture, strength)) = material.occlusion_texture {
            let map = pictures.map(Some(texture), number, Channel::Red)?;
            details.occlusion = map.map(|map| (map, strength));
        }
        if let Some((texture, scale)) = material.normal_texture {
            details.normal = pictures.map(Some(texture), number, Channel::Mean)?.map(|map| (map, scale));
        }
    }
    let opacity_map = pictures.opacity(material)?;
    let wrap = material.base_texture.map_or(Wrap::Repeat, |t| t.wrap);
    let diffuse_map = base.filter(|_| !material.unlit);
    let mut made = Material::new(&material.name, surface).with_details(details);
    (made.diffuse_map, made.opacity_map, made.wrap) = (diffuse_map, opacity_map, wrap);
    // Colour and alpha are of one picture.
    let place = material.base_texture.map(|t| t.place).unwrap_or_default();
    (made.diffuse_place, made.opacity_place) = (place, place);
    Ok(made)
}

/// The pictures of a model, decoded as they are needed.
struct Pictures<'a> {
    model: &'a GltfModel,
    path: &'a Path,
    textures: &'a mut TextureTable,
    material: &'a str,
}

impl Pictures<'_> {
    fn load(&mut self, image: usize, purpose: Purpose) -> Result<usize, InputError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let fault = || {
            let name = self.path.display().to_string();
            let message = format!("image {image}, used by material `{}`, ", self.material);
            InputError::of_file(name, message).with_help("PNG and JPEG pictures can be part of a glTF")
        };
        match &self.model.images[image] {
            GltfBytes::File(name) => Ok(self.textures.load(&folder.join(name), purpose, Tone::PLAIN, fault)),
            GltfBytes::Embedded(bytes) => {
                let place = format!("{}#image{image}", self.path.display());
                self.textures.load_embedded(Path::new(&place), bytes, purpose).map_err(|reason| {
                    let mut fault = fault();
                    fault.message.push_str(&reason);
                    fault
                })
            }
        }
    }

    fn optional(
        &mut self,
        texture: Option<GltfTexture>,
        purpose: Purpose,
    ) -> Result<Option<usize>, InputError> {
        texture.map(|t| self.load(t.image, purpose)).transpose()
    }

    fn map(
        &mut self,
        texture: Option<GltfTexture>,
        purpose: Purpose,
        channel: Channel,
    ) -> Result<Option<Map>, InputError> {
        let Some(found) = texture else { return Ok(None) };
        let texture = self.load(found.image, purpose)?;
        Ok(Some(Map { wrap: found.wrap, channel, place: found.place, ..Map::new(texture) }))
    }

    /// The alpha of the base colour, unless it hides nothing anywhere.
    fn opacity(&mut self, material: &GltfMaterial) -> Result<Option<usize>, InputError> {
        let purpose = match material.alpha_mode {
            AlphaMode::Opaque => return Ok(None),
            AlphaMode::Blend => Purpose::Alpha,
            // alpha · factor ≥ cutoff, with alpha in 255ths; beyond 255 nothing is there.
            AlphaMode::Mask(cutoff) => {
                Purpose::Mask((255.0 * cutoff / material.alpha).ceil().clamp(0.0, 256.0) as u16)
            }
        };
        let Some(texture) = material.base_texture else { return Ok(None) };
        let number = self.load(texture.image, purpose)?;
        let texture = self.textures.decoded(number)?;
        let opaque = texture.is_constant() && texture.texel(0, 0).w == 1.0;
        Ok((!opaque).then_some(number))
    }
}
