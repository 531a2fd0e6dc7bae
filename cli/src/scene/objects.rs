//! From the meshes of files to triangles in the world: every object in its places, what stands in several of them stored once.

use super::auto_uv::{self, Lacking};
use super::description::{Description, ObjectDescription, RenderDescription};
use super::motion::MovingObject;
use super::{Material, Mesh, NONE, Object, copies, plain_model, smooth};
use crate::coordinate::{LARGEST, is_usable};
use crate::input_error::InputError;
use crate::mesh_io::FileMesh;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use pointillist_render::normal_matrix;
use pointillist_shade::Interpolation;
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

/// An object that is read, and where it stands.
pub(super) struct ReadObject<'a> {
    pub(super) object: &'a ObjectDescription,
    pub(super) file: Rc<FileMesh>,
    /// For each material of the file, its number.
    pub(super) materials: Vec<u32>,
    pub(super) placements: Vec<DAffine3>,
}

/// What must be the same for objects to be stored once: mesh, materials, and whether backs are drawn.
type Alike<'a> = (*const FileMesh, &'a [u32], bool);

impl ReadObject<'_> {
    fn alike(&self) -> Alike<'_> {
        (Rc::as_ptr(&self.file), &self.materials, self.object.two_sided)
    }

    fn name(&self, number: usize) -> String {
        let name = self.object.name.as_ref().unwrap_or(&self.object.mesh.path);
        match self.object.copies {
            Some(_) => format!("{name}[{number}]"),
            None => name.clone(),
        }
    }

    /// For messages: which of several copies.
    fn which(&self, number: usize) -> String {
        self.object.copies.as_ref().map_or(String::new(), |_| format!(" of copy {number}"))
    }
}

/// Triangles in the world, object by object.
pub(super) struct Assembly<'a> {
    description: &'a Description,
    is_plain_model: bool,
    materials: &'a [Material],
    pub(super) mesh: Mesh,
    pub(super) moving: Vec<MovingObject>,
    pub(super) warnings: Vec<String>,
    /// Vertex normals were made for an object whose file has none.
    pub(super) has_made_normals: bool,
    /// Where the texture coordinates of a file's mesh begin.
    first_uvs: HashMap<*const FileMesh, usize>,
}

impl<'a> Assembly<'a> {
    pub(super) fn new(description: &'a Description, is_plain_model: bool, materials: &'a [Material]) -> Self {
        Self {
            description,
            is_plain_model,
            materials,
            mesh: Mesh::default(),
            moving: Vec::new(),
            warnings: Vec::new(),
            has_made_normals: false,
            first_uvs: HashMap::new(),
        }
    }

    /// Adds all objects of a scene.
    ///
    /// # Errors
    /// An object that leaves the range of numbers, or more than there is memory for.
    pub(super) fn add(&mut self, objects: &[ReadObject<'_>]) -> Result<(), InputError> {
        let mut counts: HashMap<Alike<'_>, usize> = HashMap::new();
        for object in objects.iter().filter(|o| o.object.path.is_none()) {
            *counts.entry(object.alike()).or_default() += object.placements.len();
        }
        let mut shapes = HashMap::new();
        for read in objects {
            let is_repeated = read.object.path.is_none() && counts[&read.alike()] > 1;
            let worlds: Vec<DAffine3> =
                read.placements.iter().map(|&placement| placement * read.object.world_from_mesh).collect();
            let is_instance =
                |world: &DAffine3| is_repeated && (!self.makes_normals(&read.file) || keeps_angles(world));
            let instances: Vec<bool> = worlds.iter().map(is_instance).collect();
            let by_itself = instances.iter().filter(|&&is_instance| !is_instance).count();
            copies::check_memory(
                read.object,
                self.description,
                read.file.triangles.len(),
                [by_itself, instances.len() - by_itself],
            )?;
            for (number, (world, is_instance)) in worlds.into_iter().zip(instances).enumerate() {
                if !is_instance {
                    self.append(read, number, world)?;
                    continue;
                }
                let shape = match shapes.get(&read.alike()) {
                    Some(&shape) => shape,
                    None => {
                        let shape = self.store(read)?;
                        shapes.insert(read.alike(), shape);
                        shape
                    }
                };
                self.place(read, number, shape, world)?;
            }
        }
        Ok(())
    }

    /// Whether a mesh gets vertex normals: those depend on angles where it stands.
    fn makes_normals(&self, file: &FileMesh) -> bool {
        let shading = self.description.render.shading;
        shading != Some(Interpolation::Flat)
            && (shading.is_some() || self.is_plain_model)
            && file.normal_of.contains(&[NONE; 3])
    }

    fn refuse(&self, read: &ReadObject<'_>, message: impl Into<String>) -> InputError {
        self.description.document.error(read.object.mesh.span, message.into())
    }

    /// Stores a mesh that stands in several places.
    fn store(&mut self, read: &ReadObject<'_>) -> Result<u32, InputError> {
        let mut shape = Mesh::default();
        shape.uvs.extend_from_slice(&read.file.uvs);
        self.fill(&mut shape, read, DAffine3::IDENTITY, 0, true);
        shape.objects.push(Object { name: String::new(), two_sided: read.object.two_sided });
        self.mesh.add_shape(shape).map_err(|error| self.refuse(read, error.to_string()))
    }

    fn place(
        &mut self,
        read: &ReadObject<'_>,
        number: usize,
        shape: u32,
        world: DAffine3,
    ) -> Result<(), InputError> {
        self.check_range(read, number, read.file.positions.iter().map(|&p| world.transform_point3(p)))?;
        let placed = self.mesh.add_instance(shape, &read.name(number), world);
        placed.map(|_| ()).map_err(|error| self.refuse(read, error.to_string()))
    }

    fn check_range(
        &self,
        read: &ReadObject<'_>,
        number: usize,
        mut positions: impl Iterator<Item = DVec3>,
    ) -> Result<(), InputError> {
        let Some(index) = positions.position(|p| !is_usable(p)) else { return Ok(()) };
        let which = read.which(number);
        let message = format!(
            "the object's transform takes vertex {index}{which} out of the range of numbers, ±{LARGEST:e}"
        );
        Err(self.refuse(read, message))
    }

    /// Adds an object in one place, as triangles of its own.
    fn append(&mut self, read: &ReadObject<'_>, number: usize, world: DAffine3) -> Result<(), InputError> {
        let (object, file) = (read.object, &*read.file);
        let mut mesh = std::mem::take(&mut self.mesh);
        let total =
            mesh.positions.len().max(mesh.uvs.len()).max(mesh.normals.len()) + 3 * file.triangles.len();
        if total >= NONE as usize {
            return Err(self.refuse(read, "the scene has more vertices than can be numbered in 32 bits"));
        }
        let (first_position, first_normal) = (mesh.positions.len(), mesh.normals.len());
        // Wherever a file's mesh stands, its texture coordinates are the same, and are held once.
        let first_uv = *self.first_uvs.entry(std::ptr::from_ref(file)).or_insert_with(|| {
            let first = mesh.uvs.len();
            mesh.uvs.extend_from_slice(&file.uvs);
            first
        });
        // The first copy speaks for all.
        self.fill(&mut mesh, read, world, first_uv, number == 0);
        self.check_range(read, number, mesh.positions[first_position..].iter().copied())?;
        if let Some(path) = &object.path {
            let fault = self.description.document.error(path.span, "");
            let home: Arc<[DVec3]> = Arc::from(file.positions.as_slice());
            let first = [first_position, first_normal];
            self.moving.push(MovingObject::new(path, read.placements[number], &home, &mesh, first, fault));
        }
        mesh.objects.push(Object { name: read.name(number), two_sided: object.two_sided });
        self.mesh = mesh;
        Ok(())
    }

    /// Adds the triangles of a file's mesh, whose texture coordinates begin at `first_uv`, to another mesh.
    fn fill(
        &mut self,
        mesh: &mut Mesh,
        read: &ReadObject<'_>,
        world: DAffine3,
        first_uv: usize,
        warns: bool,
    ) {
        let file = &*read.file;
        let (first_position, first_triangle) = (mesh.positions.len(), mesh.triangles.len());
        mesh.positions.extend(file.positions.iter().map(|&p| world.transform_point3(p)));
        if !(file.colors.is_empty() && mesh.colors.is_empty()) {
            mesh.colors.resize(first_position, Vec3::ONE);
            mesh.colors.extend_from_slice(&file.colors);
            mesh.colors.resize(mesh.positions.len(), Vec3::ONE);
        }
        // A mirrored object keeps its front in front.
        let order = if world.matrix3.determinant() < 0.0 { [0, 2, 1] } else { [0, 1, 2] };
        append_indices(&mut mesh.triangles, &file.triangles, first_position, order);
        append_uvs(mesh, file, first_uv, order);
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
        mesh.material_of.extend(file.material_of.iter().map(|&m| read.materials[m as usize]));
        let (path, warnings) = (&read.object.mesh.path, &mut self.warnings);
        auto_uv::fill(mesh, file, first_triangle, self.materials, |material, lacking| {
            if warns {
                warnings.push(made_coordinates(path, material, lacking));
            }
        });
    }
}

/// The warning about texture coordinates that a mesh does not have.
fn made_coordinates(path: &str, material: &str, lacking: Lacking) -> String {
    match lacking {
        Lacking::All => format!(
            "{path}: material `{material}` has maps, but the mesh has no texture coordinates; those of a box are used \
             (uv = \"box\" in the material says so without this warning)"
        ),
        Lacking::Second => format!(
            "{path}: a map of material `{material}` takes the second set of texture coordinates, which the mesh does not have; \
             the first is used (lightmap = {{ file = …, uv_set = 0 }} says so without this warning)"
        ),
    }
}

/// Whether a transform turns, moves, mirrors and scales evenly: then angles stay what they are.
fn keeps_angles(world: &DAffine3) -> bool {
    let m = world.matrix3;
    let lengths = [m.x_axis, m.y_axis, m.z_axis].map(DVec3::length_squared);
    let products = [m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis)];
    let slack = 1e-9 * lengths[0];
    lengths.iter().all(|l| (l - lengths[0]).abs() <= slack) && products.iter().all(|p| p.abs() <= slack)
}

/// Texture coordinates of the mesh's last triangles.
fn append_uvs(mesh: &mut Mesh, file: &FileMesh, first_uv: usize, order: [usize; 3]) {
    let first_triangle = mesh.triangles.len() - file.triangles.len();
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

fn turned(matrix: DMat3, normal: Vec3) -> Vec3 {
    (matrix * normal.as_dvec3()).normalize_or_zero().as_vec3()
}
