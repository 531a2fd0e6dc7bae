//! The triangles of a scene.

use super::error::SceneError;
use super::instances::Instances;
use glam::{DVec2, DVec3, Vec3};

/// No normal, no texture coordinate: the value of an index that refers to nothing.
pub const NONE: u32 = u32::MAX;

/// Triangles of all objects, concatenated, in world space. [`Mesh::add`] puts one together part by part. What stands in several places can be
/// stored once ([`Mesh::add_shape`], [`Mesh::add_instance`]): the lists below then hold the other triangles only, and [`Mesh::corners`],
/// [`Mesh::material`] and the like answer for all.
///
/// `material_of` and `object_of` are as long as `triangles`; `normal_of`, `uv_of` and `second_uv_of` too, or empty. The latter three
/// hold [`NONE`] at all three corners of a triangle that has no normals or coordinates.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Mesh {
    /// World positions, all finite.
    pub positions: Vec<DVec3>,
    /// Linear factors on the diffuse albedo: none, or one for each position.
    pub colors: Vec<Vec3>,
    /// Corners, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals; empty with flat shading.
    pub normals: Vec<Vec3>,
    /// Indices into `normals`, corner by corner.
    pub normal_of: Vec<[u32; 3]>,
    /// Texture coordinates; v grows upward, (0, 0) is the lower left corner of a texture.
    pub uvs: Vec<DVec2>,
    /// Indices into `uvs`, corner by corner.
    pub uv_of: Vec<[u32; 3]>,
    /// Further indices into `uvs`, for maps that lie on the surface in another way, as light maps do.
    pub second_uv_of: Vec<[u32; 3]>,
    /// Index into [`super::Scene::materials`].
    pub material_of: Vec<u32>,
    /// Index into `objects`.
    pub object_of: Vec<u32>,
    /// What each object is called and how it is treated.
    pub objects: Vec<Object>,
    pub(super) instances: Instances,
}

/// What is said of one object as a whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// For messages.
    pub name: String,
    /// Whether its back is drawn, too.
    pub two_sided: bool,
}

/// The triangles of one object, as slices: what [`Mesh::add`] takes.
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    name: &'a str,
    positions: &'a [DVec3],
    triangles: &'a [[u32; 3]],
    normals: &'a [Vec3],
    uvs: &'a [DVec2],
    material: u32,
    two_sided: bool,
}

impl<'a> Part<'a> {
    /// Triangles between world positions, counter-clockwise seen from the front; two-sided, of material 0, with flat shading.
    #[must_use]
    pub fn new(name: &'a str, positions: &'a [DVec3], triangles: &'a [[u32; 3]]) -> Self {
        Self { name, positions, triangles, normals: &[], uvs: &[], material: 0, two_sided: true }
    }

    /// The same with a unit normal at each position.
    #[must_use]
    pub fn with_normals(mut self, normals: &'a [Vec3]) -> Self {
        self.normals = normals;
        self
    }

    /// The same with texture coordinates at each position, v upward.
    #[must_use]
    pub fn with_uvs(mut self, uvs: &'a [DVec2]) -> Self {
        self.uvs = uvs;
        self
    }

    /// The same of another material, by what [`super::Scene::add_material`] gave.
    #[must_use]
    pub fn with_material(mut self, material: u32) -> Self {
        self.material = material;
        self
    }

    /// The same, its backs drawn or not.
    #[must_use]
    pub fn with_two_sided(mut self, two_sided: bool) -> Self {
        self.two_sided = two_sided;
        self
    }
}

impl Mesh {
    /// Adds an object; its index comes back.
    ///
    /// # Errors
    /// [`SceneError::Length`] if normals or coordinates are neither empty nor one for each position, [`SceneError::Corner`] for a
    /// triangle beyond the positions, [`SceneError::TooMany`] if there are more vertices than 32 bits can number.
    pub fn add(&mut self, part: &Part<'_>) -> Result<u32, SceneError> {
        let count = part.positions.len();
        for (list, length) in [("normals", part.normals.len()), ("uvs", part.uvs.len())] {
            if length != 0 && length != count {
                return Err(SceneError::Length { list, length, expected: count });
            }
        }
        if let Some(triangle) = part.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= count)) {
            return Err(SceneError::Corner { list: "triangles", triangle, count });
        }
        let total = self.positions.len().max(self.normals.len()).max(self.uvs.len()) + count;
        if total >= NONE as usize {
            return Err(SceneError::TooMany { list: "positions", count: total });
        }
        let object = self.objects.len() as u32;
        self.objects.push(Object { name: part.name.to_owned(), two_sided: part.two_sided });
        append(
            &mut self.normal_of,
            self.triangles.len(),
            part.triangles,
            self.normals.len(),
            part.normals.is_empty(),
        );
        append(&mut self.uv_of, self.triangles.len(), part.triangles, self.uvs.len(), part.uvs.is_empty());
        if !self.second_uv_of.is_empty() {
            self.second_uv_of.resize(self.uv_of.len(), [NONE; 3]);
        }
        let first = self.positions.len() as u32;
        self.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + first)));
        self.positions.extend_from_slice(part.positions);
        if !self.colors.is_empty() {
            self.colors.resize(self.positions.len(), Vec3::ONE);
        }
        self.normals.extend_from_slice(part.normals);
        self.uvs.extend_from_slice(part.uvs);
        self.material_of.resize(self.triangles.len(), part.material);
        self.object_of.resize(self.triangles.len(), object);
        Ok(object)
    }
}

/// Adds the corners of a part to a list of corner indices that may not have been needed for the `before` triangles so far.
fn append(list: &mut Vec<[u32; 3]>, before: usize, triangles: &[[u32; 3]], first: usize, is_absent: bool) {
    list.resize(before, [NONE; 3]);
    list.extend(triangles.iter().map(|t| if is_absent { [NONE; 3] } else { t.map(|v| v + first as u32) }));
}
