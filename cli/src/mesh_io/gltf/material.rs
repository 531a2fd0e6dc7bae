//! glTF materials, as the file has them.

use super::GltfModel;
use ::gltf::Gltf;
use ::gltf::texture::{Info, Texture, WrappingMode};
use glam::Vec3;
use pointillist_shade::Wrap;

/// A texture as a material refers to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GltfTexture {
    /// Index into [`GltfModel::images`].
    pub image: usize,
    /// Outside the unit square.
    pub wrap: Wrap,
}

/// What the alpha of the base colour means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// There from this value on, not there below it.
    Mask(f32),
    /// Opacity.
    Blend,
}

/// A material of a glTF file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GltfMaterial {
    /// As in the file, made unique; `material3` for one without.
    pub name: String,
    /// Factor on the base colour, linear.
    pub base_color: Vec3,
    /// Factor on its alpha.
    pub alpha: f32,
    /// Base colour, sRGB, and alpha.
    pub base_texture: Option<GltfTexture>,
    /// What alpha means.
    pub alpha_mode: AlphaMode,
    /// Factor on the blue of `metallic_roughness_texture`.
    pub metallic: f32,
    /// Factor on the green of `metallic_roughness_texture`.
    pub roughness: f32,
    /// Roughness in green, metallic in blue.
    pub metallic_roughness_texture: Option<GltfTexture>,
    /// Normals, and the factor on their x and y.
    pub normal_texture: Option<(GltfTexture, f32)>,
    /// Share of ambient light in red, and how much of it counts.
    pub occlusion_texture: Option<(GltfTexture, f32)>,
    /// Radiance, or the factor on `emissive_texture`.
    pub emissive: Vec3,
    /// Radiance, sRGB.
    pub emissive_texture: Option<GltfTexture>,
    /// Reflectance of a dielectric at normal incidence.
    pub reflectance: f32,
    /// Whether the back is drawn.
    pub double_sided: bool,
    /// Shown as it is, whatever the light.
    pub unlit: bool,
}

/// Reads all materials, and after them the one of primitives that name none.
pub(super) fn read_all(gltf: &Gltf, file: &str, model: &mut GltfModel) {
    for material in gltf.materials() {
        let found = read(&material, file, model);
        model.materials.push(found);
    }
    let name = unique("default".to_owned(), model);
    model.materials.push(GltfMaterial {
        name,
        base_color: Vec3::ONE,
        alpha: 1.0,
        metallic: 1.0,
        roughness: 1.0,
        reflectance: pointillist_shade::DIELECTRIC_REFLECTANCE,
        ..GltfMaterial::default()
    });
}

fn read(material: &::gltf::Material<'_>, file: &str, model: &mut GltfModel) -> GltfMaterial {
    let pbr = material.pbr_metallic_roughness();
    let [r, g, b, alpha] = pbr.base_color_factor();
    let name = material.name().map(str::to_owned);
    let name = name.unwrap_or_else(|| format!("material{}", material.index().unwrap_or_default()));
    let mut of =
        |info: Option<Info<'_>>| info.map(|i| texture(&i.texture(), i.tex_coord(), file, &name, model));
    let (base_texture, metallic_roughness_texture) =
        (of(pbr.base_color_texture()), of(pbr.metallic_roughness_texture()));
    let emissive_texture = of(material.emissive_texture());
    let normal = material.normal_texture();
    let occlusion = material.occlusion_texture();
    let ior = material.ior().unwrap_or(1.5);
    GltfMaterial {
        base_color: Vec3::new(r, g, b),
        alpha,
        base_texture,
        alpha_mode: match material.alpha_mode() {
            ::gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
            ::gltf::material::AlphaMode::Mask => AlphaMode::Mask(material.alpha_cutoff().unwrap_or(0.5)),
            ::gltf::material::AlphaMode::Blend => AlphaMode::Blend,
        },
        metallic: pbr.metallic_factor(),
        roughness: pbr.roughness_factor(),
        metallic_roughness_texture,
        normal_texture: normal.map(|n| (texture(&n.texture(), n.tex_coord(), file, &name, model), n.scale())),
        occlusion_texture: occlusion
            .map(|o| (texture(&o.texture(), o.tex_coord(), file, &name, model), o.strength())),
        emissive: Vec3::from_array(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0),
        emissive_texture,
        reflectance: ((ior - 1.0) / (ior + 1.0)).powi(2),
        double_sided: material.double_sided(),
        unlit: material.unlit(),
        name: unique(name, model),
    }
}

fn texture(
    texture: &Texture<'_>,
    coordinates: u32,
    file: &str,
    material: &str,
    model: &mut GltfModel,
) -> GltfTexture {
    if coordinates != 0 {
        model.warnings.push(format!(
            "{file}: material `{material}` uses texture coordinates {coordinates}; those of set 0 are used"
        ));
    }
    let sampler = texture.sampler();
    if sampler.wrap_s() != sampler.wrap_t() {
        model.warnings.push(format!(
            "{file}: a texture of material `{material}` wraps in two ways; that of u is used for both"
        ));
    }
    let wrap = match sampler.wrap_s() {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    };
    GltfTexture { image: texture.source().index(), wrap }
}

/// Scene files name materials, so no two may have one name.
fn unique(name: String, model: &GltfModel) -> String {
    let taken = |name: &str| model.materials.iter().any(|m| m.name == name);
    if !taken(&name) {
        return name;
    }
    (2..).map(|n| format!("{name} {n}")).find(|n| !taken(n)).unwrap_or(name)
}
