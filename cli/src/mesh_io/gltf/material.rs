//! glTF materials, as the file has them.

use super::GltfModel;
use ::gltf::Gltf;
use ::gltf::json::extensions::texture::TextureTransform;
use ::gltf::texture::{Info, Texture, WrappingMode};
use glam::{DAffine2, DMat2, Vec2, Vec3, dvec2};
use pointillist_render::{MapPlace, UvSet};
use pointillist_shade::Wrap;
use serde_json::Value;

/// The extension that says where textures lie.
pub(super) const TRANSFORM: &str = "KHR_texture_transform";

/// A texture as a material refers to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GltfTexture {
    /// Index into [`GltfModel::images`].
    pub image: usize,
    /// Outside the unit square.
    pub wrap: Wrap,
    /// Where it lies on the surface.
    pub place: MapPlace,
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
    let mut reader = TextureReader { file, material: &name, model };
    let mut of = |info: Option<Info<'_>>| info.map(|i| reader.of_info(&i));
    let (base_texture, metallic_roughness_texture) =
        (of(pbr.base_color_texture()), of(pbr.metallic_roughness_texture()));
    let emissive_texture = of(material.emissive_texture());
    let normal_texture = material.normal_texture().map(|n| {
        let transform = reader.transform_of_value(n.extension_value(TRANSFORM));
        (reader.read(&n.texture(), n.tex_coord(), transform), n.scale())
    });
    let occlusion_texture = material.occlusion_texture().map(|o| {
        let transform = reader.transform_of_value(o.extension_value(TRANSFORM));
        (reader.read(&o.texture(), o.tex_coord(), transform), o.strength())
    });
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
        normal_texture,
        occlusion_texture,
        emissive: Vec3::from_array(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0),
        emissive_texture,
        reflectance: ((ior - 1.0) / (ior + 1.0)).powi(2),
        double_sided: material.double_sided(),
        unlit: material.unlit(),
        name: unique(name, model),
    }
}

/// Reads what a material says of its textures.
struct TextureReader<'a> {
    file: &'a str,
    material: &'a str,
    model: &'a mut GltfModel,
}

impl TextureReader<'_> {
    fn warn(&mut self, what: &str) {
        self.model.warnings.push(format!("{}: material `{}` {what}", self.file, self.material));
    }

    fn of_info(&mut self, info: &Info<'_>) -> GltfTexture {
        let transform = info.texture_transform().map(|t| UvTransform {
            offset: t.offset(),
            rotation: t.rotation(),
            scale: t.scale(),
            tex_coord: t.tex_coord(),
        });
        self.read(&info.texture(), info.tex_coord(), transform)
    }

    /// The transform of a normal or an occlusion texture, of which the `gltf` crate only gives the JSON.
    fn transform_of_value(&mut self, value: Option<&Value>) -> Option<UvTransform> {
        let found: TextureTransform = match serde_json::from_value(value?.clone()) {
            Ok(found) => found,
            Err(_) => {
                self.warn("has a KHR_texture_transform that cannot be read; ignored");
                return None;
            }
        };
        let TextureTransform { offset, rotation, scale, tex_coord, .. } = found;
        Some(UvTransform { offset: offset.0, rotation: rotation.0, scale: scale.0, tex_coord })
    }

    fn read(&mut self, texture: &Texture<'_>, tex_coord: u32, transform: Option<UvTransform>) -> GltfTexture {
        let sampler = texture.sampler();
        if sampler.wrap_s() != sampler.wrap_t() {
            self.warn("has a texture that wraps in two ways; that of u is used for both");
        }
        let wrap = match sampler.wrap_s() {
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::Repeat => Wrap::Repeat,
        };
        let tex_coord = transform.and_then(|t| t.tex_coord).unwrap_or(tex_coord);
        let set = match tex_coord {
            0 => UvSet::First,
            1 => UvSet::Second,
            beyond => {
                self.warn(&format!("uses texture coordinates {beyond}; those of set 0 are used"));
                UvSet::First
            }
        };
        let mut map_from_uv = transform.map_or(DAffine2::IDENTITY, UvTransform::upward);
        if !map_from_uv.is_finite() {
            self.warn("has a KHR_texture_transform out of the range of numbers; ignored");
            map_from_uv = DAffine2::IDENTITY;
        }
        GltfTexture { image: texture.source().index(), wrap, place: MapPlace { set, map_from_uv } }
    }
}

/// What `KHR_texture_transform` says.
#[derive(Clone, Copy)]
struct UvTransform {
    offset: [f32; 2],
    rotation: f32,
    scale: [f32; 2],
    tex_coord: Option<u32>,
}

impl UvTransform {
    /// Scale, then rotation, then offset, from coordinates with v upward to such: the file's v runs downward.
    ///
    /// The rotation is counter-clockwise as seen on the picture: u' = u cos + v sin, v' = v cos − u sin in the file's coordinates. The
    /// matrix that the extension prints turns the other way; its words and its sample model say this.
    fn upward(self) -> DAffine2 {
        let (offset, scale) =
            (Vec2::from_array(self.offset).as_dvec2(), Vec2::from_array(self.scale).as_dvec2());
        let turn = DMat2::from_angle(-f64::from(self.rotation));
        let downward = DAffine2::from_mat2_translation(turn * DMat2::from_diagonal(scale), offset);
        let flip = DAffine2::from_mat2_translation(DMat2::from_diagonal(dvec2(1.0, -1.0)), dvec2(0.0, 1.0));
        flip * downward * flip
    }
}

/// Scene files name materials, so no two may have one name.
fn unique(name: String, model: &GltfModel) -> String {
    let taken = |name: &str| model.materials.iter().any(|m| m.name == name);
    if !taken(&name) {
        return name;
    }
    (2..).map(|n| format!("{name} {n}")).find(|n| !taken(n)).unwrap_or(name)
}
