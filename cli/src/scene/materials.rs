//! Which material each name in a mesh stands for.

use super::description::{Description, MaterialDescription, ObjectDescription};
use super::resolve::{load_texture, read_file};
use super::textures::{Purpose, TextureTable};
use super::{Material, NONE};
use crate::input_error::InputError;
use crate::mesh_io::{FileMesh, MtlMaterial, read_mtl};
use glam::Vec3;
use pointillist_shade::{self as shade, Model, Wrap};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// The materials of a scene, made when they are first needed.
pub(super) struct MaterialTable<'a> {
    description: &'a Description,
    folder: &'a Path,
    list: Vec<Material>,
    of_scene: HashMap<&'a str, u32>,
    of_mtl: HashMap<(PathBuf, String), u32>,
    default: Option<u32>,
}

/// An MTL, read.
struct Library {
    path: PathBuf,
    bytes: Vec<u8>,
    materials: Vec<MtlMaterial>,
}

impl<'a> MaterialTable<'a> {
    pub(super) fn new(description: &'a Description, folder: &'a Path) -> Self {
        Self {
            description,
            folder,
            list: Vec::new(),
            of_scene: HashMap::new(),
            of_mtl: HashMap::new(),
            default: None,
        }
    }

    pub(super) fn into_materials(self) -> Vec<Material> {
        self.list
    }

    /// For each material name of `file`, the number of its material; `NONE` for one that no face has.
    pub(super) fn resolve(
        &mut self,
        object: &ObjectDescription,
        file: &FileMesh,
        path: &Path,
        textures: &mut TextureTable,
        warnings: &mut Vec<String>,
    ) -> Result<Vec<u32>, InputError> {
        let mut used = vec![false; file.material_names.len()];
        file.material_of.iter().for_each(|&m| used[m as usize] = true);
        let libraries = read_libraries(file, path, warnings)?;
        if let Some((name, span)) = &object.material {
            let number = self.of_scene(name, textures)?;
            let number = match number {
                Some(number) => Some(number),
                None => self.of_libraries(name, &libraries, textures, warnings)?,
            };
            let number = number.ok_or_else(|| self.undefined(name, *span))?;
            return Ok(vec![number; used.len()]);
        }
        let mut numbers = Vec::with_capacity(used.len());
        for (name, used) in file.material_names.iter().zip(used) {
            if !used {
                numbers.push(NONE);
                continue;
            }
            let mut number = self.of_scene(name, textures)?;
            if number.is_none() {
                number = self.of_libraries(name, &libraries, textures, warnings)?;
            }
            if number.is_none() && !name.is_empty() {
                warnings.push(format!(
                    "{}: material `{name}` is not defined; a grey one is used",
                    path.display()
                ));
            }
            numbers.push(number.unwrap_or_else(|| self.default()));
        }
        Ok(numbers)
    }

    fn undefined(&self, name: &str, span: super::text::Span) -> InputError {
        let known: Vec<&str> = self.description.materials.iter().map(|(name, _)| name.as_str()).collect();
        let error = self.description.document.error(span, format!("there is no material `{name}`"));
        error.with_help(if known.is_empty() {
            format!("define it in a section [material.{name}]")
        } else {
            format!("defined are: {}", known.join(", "))
        })
    }

    fn add(&mut self, material: Material) -> u32 {
        self.list.push(material);
        self.list.len() as u32 - 1
    }

    fn default(&mut self) -> u32 {
        if let Some(number) = self.default {
            return number;
        }
        let number = self.add(Material {
            name: "default".to_owned(),
            surface: shade::Material::default(),
            diffuse_map: None,
            opacity_map: None,
            wrap: Wrap::Repeat,
        });
        self.default = Some(number);
        number
    }

    fn of_scene(&mut self, name: &str, textures: &mut TextureTable) -> Result<Option<u32>, InputError> {
        if let Some(&number) = self.of_scene.get(name) {
            return Ok(Some(number));
        }
        let description = self.description;
        let Some((name, found)) = description.materials.iter().find(|(known, _)| known == name) else {
            return Ok(None);
        };
        let material = self.build(name, found, textures)?;
        let number = self.add(material);
        self.of_scene.insert(name, number);
        Ok(Some(number))
    }

    fn build(
        &self,
        name: &str,
        found: &MaterialDescription,
        textures: &mut TextureTable,
    ) -> Result<Material, InputError> {
        let mut texture = |reference: &Option<_>, opacity: bool| {
            let Some(reference): &Option<super::description::TextureReference> = reference else {
                return Ok(None);
            };
            let purpose = if opacity { Purpose::Opacity } else { Purpose::Color { srgb: reference.srgb } };
            load_texture(textures, self.description, self.folder, reference, purpose).map(Some)
        };
        Ok(Material {
            name: name.to_owned(),
            surface: found.surface,
            diffuse_map: texture(&found.diffuse_map, false)?,
            opacity_map: texture(&found.opacity_map, true)?,
            wrap: found.wrap,
        })
    }

    fn of_libraries(
        &mut self,
        name: &str,
        libraries: &[Library],
        textures: &mut TextureTable,
        warnings: &mut Vec<String>,
    ) -> Result<Option<u32>, InputError> {
        // The last definition counts, as when the files are read one after another.
        let mut found =
            libraries.iter().flat_map(|library| library.materials.iter().map(move |m| (library, m)));
        let Some((library, material)) = found.rfind(|(_, material)| material.name == name) else {
            return Ok(None);
        };
        let key = (library.path.clone(), name.to_owned());
        if let Some(&number) = self.of_mtl.get(&key) {
            return Ok(Some(number));
        }
        for ignored in &material.ignored {
            let file = library.path.display();
            warnings.push(format!(
                "{file}: `{ignored}` of material `{name}` is not in this version yet; ignored"
            ));
        }
        let material = Material {
            name: name.to_owned(),
            surface: surface(material),
            diffuse_map: mtl_texture(
                library,
                &material.diffuse_map,
                Purpose::Color { srgb: true },
                textures,
            )?,
            opacity_map: mtl_texture(library, &material.opacity_map, Purpose::Opacity, textures)?,
            wrap: if material.clamp { Wrap::Clamp } else { Wrap::Repeat },
        };
        let number = self.add(material);
        self.of_mtl.insert(key, number);
        Ok(Some(number))
    }
}

/// Lambert, and a highlight where the MTL asks for one: `illum` 2 or more (or none), with `Ks` and `Ns`.
fn surface(material: &MtlMaterial) -> shade::Material {
    let default_albedo =
        if material.diffuse_map.is_some() { 1.0 } else { super::description::DEFAULT_ALBEDO };
    let specular = material.specular.unwrap_or(Vec3::ZERO);
    let shininess = material.shininess.unwrap_or(0.0);
    let highlight = material.illumination.unwrap_or(2) >= 2 && specular != Vec3::ZERO && shininess > 0.0;
    shade::Material {
        model: if highlight { Model::NormalizedBlinnPhong } else { Model::Lambert },
        diffuse: material.diffuse.unwrap_or(Vec3::splat(default_albedo)),
        specular,
        shininess,
        roughness: 1.0,
        emission: material.emission.unwrap_or(Vec3::ZERO),
        opacity: material.opacity.unwrap_or(1.0),
    }
}

fn mtl_texture(
    library: &Library,
    map: &Option<(String, usize)>,
    purpose: Purpose,
    textures: &mut TextureTable,
) -> Result<Option<usize>, InputError> {
    let Some((file, line)) = map else { return Ok(None) };
    let folder = library.path.parent().unwrap_or(Path::new(""));
    let mut path = folder.join(file);
    if !path.exists() {
        // Written on Windows, as many are.
        path = folder.join(file.replace('\\', "/"));
    }
    textures.load(&path, purpose).map(Some).map_err(|fault| {
        let name = library.path.display().to_string();
        let message = format!("texture `{}` {fault}", path.display());
        InputError::in_line(&name, &library.bytes, *line, message)
            .with_help("paths are relative to the MTL; PNG, JPEG, HDR and EXR can be read")
    })
}

/// The MTL files of a mesh; one that is not there is a warning.
fn read_libraries(
    file: &FileMesh,
    mesh: &Path,
    warnings: &mut Vec<String>,
) -> Result<Vec<Library>, InputError> {
    let folder = mesh.parent().unwrap_or(Path::new(""));
    // By path, so that a library that is named in front of every group is read once.
    let mut libraries: BTreeMap<PathBuf, Library> = BTreeMap::new();
    for names in &file.material_files {
        // `mtllib a b` may be two files or one with a space in its name.
        let whole = folder.join(names);
        let paths = if whole.exists() {
            vec![whole]
        } else {
            names.split_whitespace().map(|name| folder.join(name.replace('\\', "/"))).collect()
        };
        for path in paths {
            if libraries.contains_key(&path) {
                continue;
            }
            if !path.exists() {
                let message = format!("{}: `{}` is not there", mesh.display(), path.display());
                if !warnings.contains(&message) {
                    warnings.push(message);
                }
                continue;
            }
            let bytes = read_file(&path)?;
            let materials = read_mtl(&path.display().to_string(), &bytes)?;
            libraries.insert(path.clone(), Library { path, bytes, materials });
        }
    }
    Ok(libraries.into_values().collect())
}
