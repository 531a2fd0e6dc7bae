//! From a parsed description to a [`Scene`]: opens the files that it names and puts everything together.

use super::auto_uv::{self, Lacking};
use super::description::{
    AmbientDescription, Description, FileReference, ObjectDescription, RenderDescription,
};
use super::generated::Generated;
use super::materials::MaterialTable;
use super::motion::{Motion, MovingObject};
use super::texture_files::load_environment;
use super::textures::TextureTable;
use super::{AmbientLight, LightSource, LoadedScene, Mesh, NONE, Object, Scene, SkyLight};
use super::{copies, framing, gltf_scene, no_effect, plain_model, smooth};
use crate::baked_file::read_baked;
use crate::cloud_io::{self, DRAW_CLOUD};
use crate::coordinate::{LARGEST, is_usable};
use crate::input;
use crate::input_error::InputError;
use crate::mesh_io::{FileMesh, read_obj, read_ply};
use crate::probe_io::read_probes;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use pointillist_render::fingerprint;
use pointillist_shade::Interpolation;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

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
    let mut builder = Builder::new(description, folder, is_plain_model);
    if let Some(generated) = generated {
        for (name, purpose, texture) in generated.textures {
            builder.textures.insert(folder.join(name), purpose, texture);
        }
        builder.generated_mesh = generated.mesh;
    }
    for object in &description.objects {
        builder.add(object)?;
    }
    let environment = builder.environment();
    let [width, height] = description.image.size;
    let aspect = f64::from(width) / f64::from(height);
    // A glTF that is the scene brings its camera and its lights.
    let model = is_plain_model.then(|| builder.meshes.values().find_map(|mesh| mesh.gltf.clone())).flatten();
    let mut given = gltf_scene::camera(&description.camera, model.as_deref());
    if let Some(path) = &description.camera_path {
        let (eye, target) = path.at(0);
        (given.eye, given.target) = (eye.or(given.eye), target.or(given.target));
    }
    let camera = framing::place(description, &given, &builder.mesh, aspect)?;
    let shading = description.render.shading.unwrap_or(if builder.mesh.normals.is_empty() {
        Interpolation::Flat
    } else {
        Interpolation::Phong
    });
    let unmatched = builder.materials.unmatched();
    builder.warnings.extend(unmatched.iter().map(InputError::to_string));
    let mut lights = lights(description);
    if is_plain_model && lights.is_empty() {
        lights = model.map(|model| gltf_scene::lights(&model)).unwrap_or_default();
    }
    let no_effect = no_effect::keys(description, builder.has_made_normals);
    builder.warnings.extend(no_effect.iter().map(InputError::to_string));
    // What moves may come before a light later.
    if builder.moving.is_empty() {
        let turned_away = no_effect::turned_away(description, &builder.mesh.positions);
        builder.warnings.extend(turned_away.iter().map(InputError::to_string));
    }
    let mut warnings = builder.warnings;
    let mut scene = Scene::new(camera, description.image.size);
    scene.image.background = description.image.background;
    scene.image.hides_environment = description.image.hides_environment;
    scene.image.environment = environment;
    scene.render.cells_per_pixel = description.render.subpixel;
    scene.render.occlusion = description.render.occlusion;
    scene.render.shading = shading;
    scene.mesh = builder.mesh;
    scene.materials = builder.materials.into_materials();
    scene.textures = builder.textures.into_textures()?;
    scene.lights = lights;
    // A map around the model lights it, if it is asked to.
    let unlit =
        is_plain_model && scene.lights.is_empty() && description.ambient != AmbientDescription::Environment;
    if unlit {
        scene.lights.push(plain_model::key_light(&scene));
    }
    scene.ambient = match description.ambient {
        AmbientDescription::Nothing if unlit => plain_model::fill_light(&scene),
        _ => ambient(description, folder, &scene, &mut warnings)?,
    };
    let light = fingerprint::of_light(&scene);
    let fingerprint = fingerprint::of_view(&scene.camera, description.image.size, light);
    let motion = Motion::new(description, builder.moving);
    Ok(LoadedScene { scene, unmatched, warnings, fingerprint, light, motion, is_lit_from_camera: unlit })
}

/// The file that a key of `[ambient]` names, and a hash of it.
fn ambient_file(
    description: &Description,
    folder: &Path,
    file: &FileReference,
    help: &str,
) -> Result<(PathBuf, u64), InputError> {
    let path = file.path_from(folder);
    if !input::is_standard(&path) && !path.is_file() {
        let message = format!("`{}` is not there", path.display());
        return Err(description.document.error(file.span, message).with_help(help));
    }
    let fingerprint = twox_hash::XxHash3_64::oneshot(&input::read(&path)?);
    Ok((path, fingerprint))
}

fn ambient(
    description: &Description,
    folder: &Path,
    scene: &Scene,
    warnings: &mut Vec<String>,
) -> Result<AmbientLight, InputError> {
    match &description.ambient {
        AmbientDescription::Nothing => Ok(AmbientLight::Color(Vec3::ZERO)),
        AmbientDescription::Color(color) => Ok(AmbientLight::Color(*color)),
        &AmbientDescription::Sky { sky, ground } => {
            Ok(AmbientLight::Sky(SkyLight { sky, ground, up: Vec3::Y }))
        }
        AmbientDescription::Environment => match description.image.environment {
            Some(_) => Ok(AmbientLight::Environment),
            None => {
                let message = "`ambient.environment` needs `image.environment`, and there is none";
                Err(InputError::of_file(description.document.name(), message)
                    .with_help("name a map: [image] environment = \"sky.hdr\""))
            }
        },
        AmbientDescription::Radiosity(file) => {
            let help = "bake it with `pointillist radiosity`";
            let (path, fingerprint) = ambient_file(description, folder, file, help)?;
            let name = path.display().to_string();
            let baked = read_baked(&path)?;
            if baked.geometry != format!("{:016x}", fingerprint::of_geometry(&scene.mesh)) {
                let message = format!("`{name}` was baked for other triangles than this scene's");
                let help =
                    "objects were moved, added or taken out since: bake again with `pointillist radiosity`";
                let error = description.document.error(file.span, message).with_help(help);
                return Err(InputError { mismatched: true, ..error });
            }
            let sources = fingerprint::of_sources(scene);
            if baked.light != format!("{sources:016x}") {
                warnings.push(format!(
                    "`{name}` was baked with other lights or materials; bake again to see them"
                ));
            }
            let light = Box::new(baked.lightmap(&name, scene.mesh.triangles.len())?);
            Ok(AmbientLight::Radiosity { light, fingerprint })
        }
        AmbientDescription::Probes(file) => {
            let help = "bake it with `pointillist probe bake`";
            let (path, fingerprint) = ambient_file(description, folder, file, help)?;
            let name = path.display().to_string();
            let field = Box::new(read_probes(&path)?.field(&name)?);
            Ok(AmbientLight::Probes { field, fingerprint })
        }
    }
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
    is_plain_model: bool,
    meshes: HashMap<PathBuf, Rc<FileMesh>>,
    /// Where the texture coordinates of each mesh begin.
    first_uvs: HashMap<*const FileMesh, usize>,
    mesh: Mesh,
    materials: MaterialTable<'a>,
    textures: TextureTable,
    warnings: Vec<String>,
    moving: Vec<MovingObject>,
    generated_mesh: fn(&str) -> Option<FileMesh>,
    /// Vertex normals were made for an object whose file has none.
    has_made_normals: bool,
}

/// An object in one of its places.
struct Copy<'a> {
    object: &'a ObjectDescription,
    placement: DAffine3,
    /// If there are copies: which, from 0.
    number: Option<usize>,
    /// If it moves: the positions of its file.
    home: Option<Arc<[DVec3]>>,
}

impl<'a> Builder<'a> {
    fn new(description: &'a Description, folder: &'a Path, is_plain_model: bool) -> Self {
        Self {
            description,
            folder,
            is_plain_model,
            meshes: HashMap::new(),
            first_uvs: HashMap::new(),
            mesh: Mesh::default(),
            materials: MaterialTable::new(description, folder),
            textures: TextureTable::default(),
            warnings: Vec::new(),
            moving: Vec::new(),
            generated_mesh: |_| None,
            has_made_normals: false,
        }
    }

    fn environment(&mut self) -> Option<usize> {
        let reference = self.description.image.environment.as_ref()?;
        Some(load_environment(&mut self.textures, self.description, self.folder, reference))
    }

    fn add(&mut self, object: &ObjectDescription) -> Result<(), InputError> {
        let path = object.mesh.path_from(self.folder);
        let file = self.file_mesh(&path, &object.mesh)?;
        let materials =
            self.materials.resolve(object, &file, &path, &mut self.textures, &mut self.warnings)?;
        let placements = copies::placements(object, self.description, self.folder)?;
        let count = placements.len();
        copies::check_memory(object, self.description, file.triangles.len(), count)?;
        self.mesh.positions.reserve(count * file.positions.len());
        self.mesh.triangles.reserve(count * file.triangles.len());
        let home = object.path.is_some().then(|| Arc::from(file.positions.as_slice()));
        for (number, placement) in placements.into_iter().enumerate() {
            let number = object.copies.is_some().then_some(number);
            self.append(&Copy { object, placement, number, home: home.clone() }, &file, &materials)?;
        }
        Ok(())
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

    fn append(&mut self, copy: &Copy<'_>, file: &FileMesh, materials: &[u32]) -> Result<(), InputError> {
        let object = copy.object;
        let mesh = &mut self.mesh;
        let total =
            mesh.positions.len().max(mesh.uvs.len()).max(mesh.normals.len()) + 3 * file.triangles.len();
        if total >= NONE as usize {
            let message = "the scene has more vertices than can be numbered in 32 bits";
            return Err(self.description.document.error(object.mesh.span, message));
        }
        let world = copy.placement * object.world_from_mesh;
        let (first_position, first_normal) = (mesh.positions.len(), mesh.normals.len());
        mesh.positions.extend(file.positions.iter().map(|&p| world.transform_point3(p)));
        if !(file.colors.is_empty() && mesh.colors.is_empty()) {
            mesh.colors.resize(first_position, Vec3::ONE);
            mesh.colors.extend_from_slice(&file.colors);
            mesh.colors.resize(mesh.positions.len(), Vec3::ONE);
        }
        if let Some(index) = mesh.positions[first_position..].iter().position(|p| !is_usable(*p)) {
            let which = copy.number.map_or(String::new(), |number| format!(" of copy {number}"));
            let message = format!(
                "the object's transform takes vertex {index}{which} out of the range of numbers, ±{LARGEST:e}"
            );
            return Err(self.description.document.error(object.mesh.span, message));
        }
        // A mirrored object keeps its front in front.
        let order = if world.matrix3.determinant() < 0.0 { [0, 2, 1] } else { [0, 1, 2] };
        let first_triangle = mesh.triangles.len();
        append_indices(&mut mesh.triangles, &file.triangles, first_position, order);
        append_uvs(mesh, &mut self.first_uvs, file, order);
        let RenderDescription { shading, normals, crease_rad, .. } = self.description.render;
        if shading == Some(Interpolation::Flat) {
            mesh.normal_of.resize(mesh.triangles.len(), [NONE; 3]);
        } else {
            append_indices(&mut mesh.normal_of, &file.normal_of, mesh.normals.len(), order);
            let to_world = normal_matrix(world.matrix3);
            mesh.normals.extend(file.unit_normals().map(|n| turned(to_world, n)));
            if shading.is_some() || self.is_plain_model {
                let crease_rad = crease_rad.or(self.is_plain_model.then_some(plain_model::CREASE_RAD));
                self.has_made_normals |=
                    smooth::fill(mesh, first_triangle, first_position, normals, crease_rad);
            }
        }
        let index = mesh.objects.len() as u32;
        mesh.object_of.resize(mesh.triangles.len(), index);
        mesh.material_of.extend(file.material_of.iter().map(|&m| materials[m as usize]));
        let warnings = &mut self.warnings;
        auto_uv::fill(mesh, file, first_triangle, self.materials.list(), |material, lacking| {
            // The first copy speaks for all.
            if copy.number.is_some_and(|number| number > 0) {
                return;
            }
            let path = &object.mesh.path;
            warnings.push(match lacking {
                Lacking::All => format!(
                    "{path}: material `{material}` has maps, but the mesh has no texture coordinates; those of a box are used \
                     (uv = \"box\" in the material says so without this warning)"
                ),
                Lacking::Second => format!(
                    "{path}: a map of material `{material}` takes the second set of texture coordinates, which the mesh does not have; \
                     the first is used (lightmap = {{ file = …, uv_set = 0 }} says so without this warning)"
                ),
            });
        });
        if let (Some(path), Some(home)) = (&object.path, &copy.home) {
            let fault = self.description.document.error(path.span, "");
            let first = [first_position, first_normal];
            self.moving.push(MovingObject::new(path, copy.placement, home, mesh, first, fault));
        }
        let name = object.name.as_ref().unwrap_or(&object.mesh.path);
        let name = copy.number.map_or_else(|| name.clone(), |number| format!("{name}[{number}]"));
        mesh.objects.push(Object { name, two_sided: object.two_sided });
        Ok(())
    }
}

/// Texture coordinates of the mesh's last triangles. Wherever a file's mesh stands they are the same, and are held once.
fn append_uvs(
    mesh: &mut Mesh,
    first_uvs: &mut HashMap<*const FileMesh, usize>,
    file: &FileMesh,
    order: [usize; 3],
) {
    let first_triangle = mesh.triangles.len() - file.triangles.len();
    let first_uv = *first_uvs.entry(std::ptr::from_ref(file)).or_insert_with(|| {
        let first = mesh.uvs.len();
        mesh.uvs.extend_from_slice(&file.uvs);
        first
    });
    append_indices(&mut mesh.uv_of, &file.uv_of, first_uv, order);
    if !file.second_uv_of.is_empty() {
        mesh.second_uv_of.resize(first_triangle, [NONE; 3]);
        append_indices(&mut mesh.second_uv_of, &file.second_uv_of, first_uv, order);
    } else if !mesh.second_uv_of.is_empty() {
        mesh.second_uv_of.resize(mesh.triangles.len(), [NONE; 3]);
    }
}

fn append_indices(list: &mut Vec<[u32; 3]>, more: &[[u32; 3]], base: usize, order: [usize; 3]) {
    let moved = |index: u32| if index == NONE { NONE } else { index + base as u32 };
    list.extend(more.iter().map(|corners| order.map(|i| moved(corners[i]))));
}

/// The matrix that takes normals along: the inverse transposed, up to a factor.
pub(super) fn normal_matrix(linear: DMat3) -> DMat3 {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    // Cofactors instead of the inverse: no division, and the sign is put right for mirrored objects.
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * linear.determinant().signum()
}

fn turned(matrix: DMat3, normal: Vec3) -> Vec3 {
    (matrix * normal.as_dvec3()).normalize_or_zero().as_vec3()
}
