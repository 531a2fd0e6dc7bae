//! From a parsed description to a [`Scene`]: opens the files that it names and puts everything together.

use super::description::{AmbientDescription, Description, FileReference, ObjectDescription};
use super::generated::Generated;
use super::materials::MaterialTable;
use super::motion::Motion;
use super::objects::{Assembly, ReadObject};
use super::texture_files::load_environment;
use super::textures::TextureTable;
use super::{Camera, LightSource, LoadedScene, Mesh, Scene};
use super::{ambient, copies, framing, gltf_scene, no_effect, plain_model};
use crate::cloud_io::{self, DRAW_CLOUD};
use crate::input;
use crate::input_error::InputError;
use crate::mesh_io::gltf::GltfModel;
use crate::mesh_io::{FileMesh, read_obj, read_ply};
use pointillist_render::fingerprint;
use pointillist_shade::Interpolation;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Builds the scene of a description whose paths are relative to `folder`. `is_plain_model`: a model alone, which
/// gets light and smooth normals if it brings none.
///
/// # Errors
///
/// A file that is missing or wrong, a material that is not defined, a camera without a direction.
pub(super) fn resolve(
    description: &Description,
    folder: &Path,
    is_plain_model: bool,
    generated: Option<Generated>,
) -> Result<LoadedScene, InputError> {
    let mut builder = Builder::new(description, folder);
    if let Some(generated) = generated {
        for (name, purpose, texture) in generated.textures {
            builder.textures.insert(folder.join(name), purpose, texture);
        }
        builder.generated_mesh = generated.mesh;
    }
    let read: Vec<ReadObject<'_>> =
        description.objects.iter().map(|object| builder.read(object)).collect::<Result<_, _>>()?;
    let mut assembly = Assembly::new(description, is_plain_model, builder.materials.list());
    assembly.add(&read)?;
    let Assembly { mesh, moving, warnings, has_made_normals, .. } = assembly;
    builder.warnings.extend(warnings);
    let environment = builder.environment();
    // A glTF that is the scene brings its camera and its lights.
    let model = is_plain_model.then(|| builder.meshes.values().find_map(|mesh| mesh.gltf.clone())).flatten();
    let camera = camera(description, model.as_deref(), &mesh)?;
    let unmatched = builder.materials.unmatched();
    let mut told = unmatched.clone();
    told.extend(no_effect::keys(description, has_made_normals));
    // What moves may come before a light later.
    if moving.is_empty() {
        told.extend(no_effect::turned_away(description, &mesh));
    }
    builder.warnings.extend(told.iter().map(InputError::to_string));
    let mut warnings = builder.warnings;
    let mut scene = empty(description, camera, has_normals(&mesh));
    scene.image.environment = environment;
    scene.mesh = mesh;
    scene.materials = builder.materials.into_materials();
    scene.textures = builder.textures.into_textures()?;
    scene.lights = lights(description);
    if is_plain_model && scene.lights.is_empty() {
        scene.lights = model.map(|model| gltf_scene::lights(&model)).unwrap_or_default();
    }
    // A map around the model lights it, if it is asked to.
    let unlit =
        is_plain_model && scene.lights.is_empty() && description.ambient != AmbientDescription::Environment;
    if unlit {
        scene.lights.push(plain_model::key_light(&scene));
    }
    scene.ambient = match description.ambient {
        AmbientDescription::Nothing if unlit => plain_model::fill_light(&scene),
        _ => ambient::ambient(description, folder, &scene, &mut warnings)?,
    };
    let light = fingerprint::of_light(&scene);
    let fingerprint = fingerprint::of_view(&scene.camera, description.image.size, light);
    let motion = Motion::new(description, moving);
    Ok(LoadedScene { scene, unmatched, warnings, fingerprint, light, motion, is_lit_from_camera: unlit })
}

/// What a description says of the picture and how to draw it.
fn empty(description: &Description, camera: Camera, has_normals: bool) -> Scene {
    let mut scene = Scene::new(camera, description.image.size);
    scene.image.background = description.image.background;
    scene.image.hides_environment = description.image.hides_environment;
    scene.render.cells_per_pixel = description.render.subpixel;
    scene.render.occlusion = description.render.occlusion;
    let own = if has_normals { Interpolation::Phong } else { Interpolation::Flat };
    scene.render.shading = description.render.shading.unwrap_or(own);
    scene
}

/// The camera of frame 0, from which what it leaves open is in view.
fn camera(description: &Description, model: Option<&GltfModel>, mesh: &Mesh) -> Result<Camera, InputError> {
    let [width, height] = description.image.size;
    let mut given = gltf_scene::camera(&description.camera, model);
    if let Some(path) = &description.camera_path {
        let (eye, target) = path.at(0);
        (given.eye, given.target) = (eye.or(given.eye), target.or(given.target));
    }
    framing::place(description, &given, mesh, f64::from(width) / f64::from(height))
}

fn has_normals(mesh: &Mesh) -> bool {
    !mesh.normals.is_empty() || mesh.shapes().iter().any(|shape| !shape.normals.is_empty())
}

fn lights(description: &Description) -> Vec<LightSource> {
    let source = |light: &super::description::LightDescription| {
        let source = LightSource::new(&light.name, light.light);
        let source = source.with_ambient(light.ambient).with_specular(light.specular);
        source.with_shadow(light.shadow).with_resolution(light.resolution)
    };
    description.lights.iter().map(source).collect()
}

struct Builder<'a> {
    description: &'a Description,
    folder: &'a Path,
    meshes: HashMap<PathBuf, Rc<FileMesh>>,
    /// Where the texture coordinates of each mesh begin.
    materials: MaterialTable<'a>,
    textures: TextureTable,
    warnings: Vec<String>,
    generated_mesh: fn(&str) -> Option<FileMesh>,
}

impl<'a> Builder<'a> {
    fn new(description: &'a Description, folder: &'a Path) -> Self {
        Self {
            description,
            folder,
            meshes: HashMap::new(),
            materials: MaterialTable::new(description, folder),
            textures: TextureTable::default(),
            warnings: Vec::new(),
            generated_mesh: |_| None,
        }
    }

    fn environment(&mut self) -> Option<usize> {
        let reference = self.description.image.environment.as_ref()?;
        Some(load_environment(&mut self.textures, self.description, self.folder, reference))
    }

    fn read(&mut self, object: &'a ObjectDescription) -> Result<ReadObject<'a>, InputError> {
        let path = object.mesh.path_from(self.folder);
        let file = self.file_mesh(&path, &object.mesh)?;
        let materials =
            self.materials.resolve(object, &file, &path, &mut self.textures, &mut self.warnings)?;
        let placements = copies::placements(object, self.description, self.folder)?;
        Ok(ReadObject { object, file, materials, placements })
    }

    fn file_mesh(&mut self, path: &Path, reference: &FileReference) -> Result<Rc<FileMesh>, InputError> {
        if let Some(mesh) = self.meshes.get(path) {
            return Ok(Rc::clone(mesh));
        }
        if let Some(mesh) = (self.generated_mesh)(&reference.path) {
            let mesh = Rc::new(mesh);
            self.meshes.insert(path.to_path_buf(), Rc::clone(&mesh));
            return Ok(mesh);
        }
        let document = &self.description.document;
        let name = input::name_of(path);
        let extension = input::kind_of(path)?;
        if !["obj", "ply", "ply.gz", "gltf", "glb"].contains(&extension.as_str()) {
            let message = format!("`{}` is not a kind of mesh that can be read", reference.path);
            let error = document.error(reference.span, message);
            return Err(error.with_help("meshes end in .obj, .ply, .gltf or .glb"));
        }
        let bytes = input::read(path).map_err(|error| {
            let message = format!("mesh `{name}` {}", error.message);
            document.error(reference.span, message).with_help(reference.relative_to())
        })?;
        let mesh = match extension.as_str() {
            "obj" => read_obj(&name, &bytes)?,
            "ply" => read_ply(&name, &bytes)?,
            "ply.gz" => read_ply(&name, &cloud_io::unpack(&name, &bytes)?)?,
            _ => gltf_scene::read(path, &bytes)?,
        };
        if let Some(model) = &mesh.gltf {
            self.warnings.extend_from_slice(&model.warnings);
        }
        if mesh.triangles.is_empty() {
            let points = mesh.positions.len();
            return Err(if extension.starts_with("ply") && points > 0 {
                InputError::of_file(
                    name,
                    format!("this is a cloud of {points} points, not a mesh: it has no faces"),
                )
                .with_help(DRAW_CLOUD)
            } else {
                InputError::of_file(name, "the mesh has no faces")
                    .with_help("a mesh needs at least one triangle")
            });
        }
        let mesh = Rc::new(mesh);
        self.meshes.insert(path.to_path_buf(), Rc::clone(&mesh));
        Ok(mesh)
    }
}
