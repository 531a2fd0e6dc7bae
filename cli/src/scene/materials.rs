//! Resolves the names of materials in a mesh.

use super::description::{
    Description, FileReference, MaterialDescription, ObjectDescription, SurroundingsDescription,
    TextureReference,
};
use super::measured::MeasuredTable;
use super::mtl_library::{Library, read_libraries};
use super::text::nearest;
use super::texture_files::{load_environment, load_texture};
use super::textures::{Purpose, TextureTable};
use super::{
    Bump, BumpHeight, Details, Map, Material, MeasuredBrdf, NONE, Surroundings, gltf_materials, mtl_materials,
};
use crate::input_error::InputError;
use crate::mesh_io::FileMesh;
use crate::mesh_io::gltf::GltfModel;
use pointillist_shade as shade;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

/// The materials of a scene, made when they are first needed.
pub(super) struct MaterialTable<'a> {
    description: &'a Description,
    folder: &'a Path,
    list: Vec<Material>,
    of_scene: HashMap<&'a str, u32>,
    of_mtl: HashMap<(PathBuf, String), u32>,
    default: Option<u32>,
    measured: MeasuredTable,
    /// Names that faces of meshes have, where the scene does not replace them.
    of_meshes: BTreeSet<String>,
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
            measured: MeasuredTable::default(),
            of_meshes: BTreeSet::new(),
        }
    }

    /// The materials so far.
    pub(super) fn list(&self) -> &[Material] {
        &self.list
    }

    pub(super) fn into_materials(self) -> Vec<Material> {
        self.list
    }

    /// Materials that the scene describes and nothing has, once all objects are resolved.
    pub(super) fn unmatched(&self) -> Vec<InputError> {
        let names: Vec<&str> = self.of_meshes.iter().map(String::as_str).filter(|n| !n.is_empty()).collect();
        let help = |name: &str| match nearest(name, &names) {
            Some(near) => format!("did you mean `{near}`?"),
            None if names.is_empty() => {
                format!("faces without a material get it by `material = \"{name}\"` in [[object]]")
            }
            None => format!("materials of the meshes are {}", names.join(", ")),
        };
        let unmatched = |(name, found): &(String, MaterialDescription)| {
            let message = format!("`material.{name}` matches no material of the scene's meshes");
            self.description.document.error(found.span, message).with_help(help(name))
        };
        let all = self.description.materials.iter();
        all.filter(|(name, _)| !self.of_scene.contains_key(name.as_str())).map(unmatched).collect()
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
            self.of_meshes.insert(name.clone());
            let mut number = self.of_scene(name, textures)?;
            if number.is_none() {
                number = self.of_libraries(name, &libraries, textures, warnings)?;
            }
            if number.is_none()
                && let Some(model) = &file.gltf
            {
                number = self.of_gltf(name, model, path, textures)?;
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

    /// Materials of a glTF are its own, told apart by its path.
    fn of_gltf(
        &mut self,
        name: &str,
        model: &GltfModel,
        path: &Path,
        textures: &mut TextureTable,
    ) -> Result<Option<u32>, InputError> {
        let key = (path.to_path_buf(), name.to_owned());
        if let Some(&number) = self.of_mtl.get(&key) {
            return Ok(Some(number));
        }
        let Some(found) = model.materials.iter().find(|m| m.name == name) else { return Ok(None) };
        let material = gltf_materials::build(found, model, path, textures)?;
        let number = self.add(material);
        self.of_mtl.insert(key, number);
        Ok(Some(number))
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
        let number = self.add(Material::new("default", shade::Material::default()));
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
        &mut self,
        name: &str,
        found: &MaterialDescription,
        textures: &mut TextureTable,
    ) -> Result<Material, InputError> {
        let details = self.details(found, textures)?;
        let mut surface = found.surface;
        if let Some(measured) = &details.measured {
            // What stands for the table in ambient light.
            surface.diffuse = measured.table.albedo();
        }
        let mut load = |map: &Option<TextureReference>, purpose: fn(&TextureReference) -> Purpose| {
            let map = map.as_ref()?;
            Some(load_texture(textures, self.description, self.folder, map, purpose(map)))
        };
        let mut made = Material::new(name, surface).with_details(details);
        made.diffuse_map = load(&found.diffuse_map, |map| Purpose::Color { srgb: map.srgb });
        made.opacity_map = load(&found.opacity_map, |_| Purpose::Opacity);
        let place = |map: &Option<TextureReference>| map.as_ref().map(|map| map.place).unwrap_or_default();
        (made.diffuse_place, made.opacity_place) = (place(&found.diffuse_map), place(&found.opacity_map));
        made.wrap = found.wrap;
        Ok(made)
    }

    fn details(
        &mut self,
        found: &MaterialDescription,
        textures: &mut TextureTable,
    ) -> Result<Details, InputError> {
        let mut details = Details::default();
        let mut map = |reference: &Option<TextureReference>, is_color: bool| {
            let reference = reference.as_ref()?;
            // Numbers are no colours, and never decoded.
            let purpose = Purpose::Color { srgb: is_color && reference.srgb };
            let texture = load_texture(textures, self.description, self.folder, reference, purpose);
            Some(Map { wrap: found.wrap, place: reference.place, ..Map::new(texture) })
        };
        details.specular_map = map(&found.specular_map, true);
        details.emission_map = map(&found.emission_map, true);
        details.reflection_map = map(&found.reflection_map, true);
        details.light_map = map(&found.light_map, true);
        details.shininess_map = map(&found.shininess_map, false);
        details.roughness_map = map(&found.roughness_map, false);
        details.metallic_map = map(&found.metallic_map, false);
        details.bump =
            map(&found.bump_map, false).map(|map| Bump { map, height: BumpHeight::World(found.bump_scale) });
        details.normal = map(&found.normal_map, false).map(|map| (map, 1.0));
        details.surroundings = match &found.surroundings {
            SurroundingsDescription::Scene => Surroundings::Scene,
            SurroundingsDescription::Capture => Surroundings::Capture,
            SurroundingsDescription::Files(files) => {
                Surroundings::Texture(load_environment(textures, self.description, self.folder, files))
            }
        };
        details.metallic = found.metallic;
        details.measured = found.merl.as_ref().map(|file| self.measured_of(file)).transpose()?;
        details.reflection = found.reflection;
        details.transmission = found.transmission;
        details.mirrors_by_normal = found.mirrors_by_normal;
        details.uv = found.uv;
        details.emits = found.emits;
        Ok(details)
    }

    fn measured_of(&mut self, file: &FileReference) -> Result<MeasuredBrdf, InputError> {
        let path = file.path_from(self.folder);
        self.measured.load(&path).map_err(|fault| {
            let message = format!("measured BRDF `{}` {fault}", path.display());
            let error = self.description.document.error(file.span, message);
            error.with_help(format!("{}; MERL's binary format can be read", file.relative_to()))
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
            warnings.push(format!("{file}: `{ignored}` of material `{name}` is not understood; ignored"));
        }
        let material = mtl_materials::build(library, material, textures, warnings);
        let number = self.add(material);
        self.of_mtl.insert(key, number);
        Ok(Some(number))
    }
}
