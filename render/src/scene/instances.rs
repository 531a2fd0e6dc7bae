//! Triangles that stand in several places and are stored once.
//!
//! A shape is a mesh in its own space; an instance is a shape in one of its places. Triangles have numbers: those of the mesh itself come
//! first, and then those of each instance, one instance after the other. Everything that asks for a triangle by its number finds where it is
//! stored, and takes it to its place.

use super::error::SceneError;
use super::map_place::MapPlace;
use super::mesh::{Mesh, NONE, Object};
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use std::borrow::Cow;

/// A shape in one of its places.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Instance {
    /// What [`Mesh::add_shape`] gave.
    pub shape: u32,
    /// Takes the shape to its place.
    pub world_from_shape: DAffine3,
    /// Index into [`Mesh::objects`].
    pub object: u32,
    /// Takes normals along, up to their length.
    normals: DMat3,
    mirrors: bool,
}

/// The shapes of a mesh, and where they stand.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Instances {
    shapes: Vec<Mesh>,
    list: Vec<Instance>,
    numbers: Numbers,
}

/// Which triangles instances are, by numbers from 0 that follow those of the mesh itself.
#[derive(Clone, Debug, Default, PartialEq)]
struct Numbers {
    /// Where the numbers of each instance end.
    ends: Vec<u32>,
    /// Where the triangles of each shape begin, if those of all shapes are stored one after the other.
    first_stored: Vec<u32>,
}

/// The instance that a number belongs to, if those of each end at `ends`, and where its own begin.
#[inline]
fn instance_of(ends: &[u32], number: u32) -> (usize, u32) {
    let instance = ends.partition_point(|&end| end <= number);
    (instance, first_of(ends, instance))
}

fn first_of(ends: &[u32], instance: usize) -> u32 {
    if instance == 0 { 0 } else { ends[instance - 1] }
}

/// Where the triangles of a mesh are stored, by their numbers: in lists that begin with its own triangles and go on with those of its shapes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Storage {
    own: u32,
    /// For each instance: where its numbers end, where the triangles of its shape are stored, and whether it is mirrored.
    ends: Vec<u32>,
    placed: Vec<(u32, bool)>,
}

/// Corners of a triangle that is not mirrored, and of one that is.
const fn order(mirrors: bool) -> [usize; 3] {
    if mirrors { [0, 2, 1] } else { [0, 1, 2] }
}

impl Storage {
    /// Of so many triangles that are all stored as they stand.
    #[cfg(test)]
    pub(crate) fn of_own(own: u32) -> Self {
        Self { own, ..Self::default() }
    }

    /// The index of a triangle in lists of stored ones, and the order of its corners there.
    #[inline]
    pub(crate) fn find(&self, triangle: u32) -> (usize, [usize; 3]) {
        if triangle < self.own {
            return (triangle as usize, order(false));
        }
        let number = triangle - self.own;
        let (instance, first) = instance_of(&self.ends, number);
        let (stored, mirrors) = self.placed[instance];
        ((stored + number - first) as usize, order(mirrors))
    }

    /// The index alone.
    #[inline]
    pub(crate) fn index(&self, triangle: u32) -> usize {
        self.find(triangle).0
    }
}

/// A triangle where it is stored.
#[derive(Clone, Copy)]
struct Stored<'a> {
    mesh: &'a Mesh,
    index: usize,
    /// `None` of one that is stored as it stands.
    instance: Option<&'a Instance>,
}

impl Stored<'_> {
    /// A list of three, as the triangle's corners stand.
    fn ordered<T: Copy>(&self, corners: [T; 3]) -> [T; 3] {
        order(self.instance.is_some_and(|i| i.mirrors)).map(|k| corners[k])
    }
}

/// The matrix that takes normals along where positions are taken by `linear`: its inverse transposed, up to a factor. What `linear` mirrors keeps
/// its front in front.
#[must_use]
pub fn normal_matrix(linear: DMat3) -> DMat3 {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    // Cofactors instead of the inverse: no division, and the sign is put right for what is mirrored.
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * linear.determinant().signum()
}

impl Instance {
    fn normal(&self, stored: Vec3) -> Vec3 {
        (self.normals * stored.as_dvec3()).normalize_or_zero().as_vec3()
    }
}

impl Mesh {
    /// Stores a mesh of one object in its own space, for [`Mesh::add_instance`] to put in its places; its index comes back. By itself it
    /// stands nowhere.
    ///
    /// # Errors
    /// [`SceneError::Shape`] if it has not exactly one object, or instances of its own.
    pub fn add_shape(&mut self, shape: Self) -> Result<u32, SceneError> {
        if shape.objects.len() != 1 || !shape.instances.list.is_empty() {
            let (objects, instances) = (shape.objects.len(), shape.instances.list.len());
            return Err(SceneError::Shape { objects, instances });
        }
        let of = &mut self.instances;
        let stored = of.shapes.iter().map(|shape| shape.triangles.len() as u32).sum();
        of.numbers.first_stored.push(stored);
        of.shapes.push(shape);
        Ok(of.shapes.len() as u32 - 1)
    }

    /// Puts a shape in a place, as an object of this name; its index comes back. A place that mirrors keeps fronts in front.
    ///
    /// # Errors
    /// [`SceneError::Index`] for a shape that does not exist, [`SceneError::NotFinite`] for a place that is not finite, and
    /// [`SceneError::TooMany`] if there are more triangles than 32 bits can number.
    pub fn add_instance(
        &mut self,
        shape: u32,
        name: &str,
        world_from_shape: DAffine3,
    ) -> Result<u32, SceneError> {
        let (object, number) = (self.objects.len() as u32, self.instances.list.len());
        let Some(stored) = self.instances.shapes.get(shape as usize) else {
            let count = self.instances.shapes.len();
            return Err(SceneError::Index { list: "instances", triangle: number, index: shape, count });
        };
        if !world_from_shape.is_finite() {
            return Err(SceneError::NotFinite { what: format!("the place of `{name}`") });
        }
        let count = self.triangle_count() + stored.triangles.len();
        if count >= NONE as usize {
            return Err(SceneError::TooMany { list: "triangles", count });
        }
        self.objects.push(Object { name: name.to_owned(), two_sided: stored.objects[0].two_sided });
        self.instances.numbers.ends.push((count - self.triangles.len()) as u32);
        let linear = world_from_shape.matrix3;
        self.instances.list.push(Instance {
            shape,
            world_from_shape,
            object,
            normals: normal_matrix(linear),
            mirrors: linear.determinant() < 0.0,
        });
        Ok(object)
    }

    /// What [`Mesh::add_shape`] has stored.
    #[must_use]
    pub fn shapes(&self) -> &[Self] {
        &self.instances.shapes
    }

    /// The instances, in the order of their triangles.
    #[must_use]
    pub fn instances(&self) -> &[Instance] {
        &self.instances.list
    }

    /// Number of triangles, those of all instances included: numbers of triangles are below it.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len() + self.instances.numbers.ends.last().map_or(0, |&end| end as usize)
    }

    /// The numbers of all triangles.
    pub(crate) fn numbers(&self) -> std::ops::Range<u32> {
        0..self.triangle_count() as u32
    }

    /// The number of the first triangle of an instance.
    pub(crate) fn first_of(&self, instance: usize) -> u32 {
        self.triangles.len() as u32 + first_of(&self.instances.numbers.ends, instance)
    }

    /// What stores triangles: the mesh itself, and its shapes.
    pub(crate) fn stores(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.instances.shapes)
    }

    /// Where triangles are stored.
    pub(crate) fn storage(&self) -> Storage {
        let Instances { list, numbers, .. } = &self.instances;
        let own = self.triangles.len() as u32;
        let placed = |i: &Instance| (own + numbers.first_stored[i.shape as usize], i.mirrors);
        Storage { own, ends: numbers.ends.clone(), placed: list.iter().map(placed).collect() }
    }

    #[inline]
    fn stored(&self, triangle: u32) -> Stored<'_> {
        let own = self.triangles.len() as u32;
        if triangle < own {
            return Stored { mesh: self, index: triangle as usize, instance: None };
        }
        let Instances { shapes, list, numbers } = &self.instances;
        let number = triangle - own;
        let (instance, first) = instance_of(&numbers.ends, number);
        let instance = &list[instance];
        let mesh = &shapes[instance.shape as usize];
        Stored { mesh, index: (number - first) as usize, instance: Some(instance) }
    }

    /// World positions of a triangle's corners.
    ///
    /// # Panics
    /// As the other questions about one triangle: if there is none of this number.
    #[must_use]
    #[inline]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        let stored = self.stored(triangle);
        let corners = stored.mesh.triangles[stored.index].map(|v| stored.mesh.positions[v as usize]);
        match stored.instance {
            None => corners,
            Some(instance) => stored.ordered(corners.map(|p| instance.world_from_shape.transform_point3(p))),
        }
    }

    /// Unit normals at a triangle's corners, if it has them.
    #[must_use]
    pub fn corner_normals(&self, triangle: u32) -> Option<[Vec3; 3]> {
        let stored = self.stored(triangle);
        let of = stored.mesh.normal_of.get(stored.index)?;
        if of.contains(&NONE) {
            return None;
        }
        let normals = of.map(|n| stored.mesh.normals[n as usize]);
        Some(stored.instance.map_or(normals, |i| stored.ordered(normals.map(|n| i.normal(n)))))
    }

    /// Whether any vertex has a colour.
    #[must_use]
    pub fn has_colors(&self) -> bool {
        !self.colors.is_empty() || self.instances.shapes.iter().any(|shape| !shape.colors.is_empty())
    }

    /// Factors on the diffuse albedo at a triangle's corners; 1 where it has none.
    #[must_use]
    pub fn corner_colors(&self, triangle: u32) -> [Vec3; 3] {
        let stored = self.stored(triangle);
        if stored.mesh.colors.is_empty() {
            return [Vec3::ONE; 3];
        }
        stored.ordered(stored.mesh.triangles[stored.index].map(|v| stored.mesh.colors[v as usize]))
    }

    /// Coordinates of a map at the corners of a triangle; `None` where the mesh has none.
    #[must_use]
    pub fn map_corners(&self, triangle: u32, place: &MapPlace) -> Option<[DVec2; 3]> {
        let stored = self.stored(triangle);
        Some(stored.ordered(stored.mesh.own_map_corners(stored.index, place)?))
    }

    /// A triangle's index into [`crate::Scene::materials`].
    #[must_use]
    #[inline]
    pub fn material(&self, triangle: u32) -> u32 {
        let stored = self.stored(triangle);
        stored.mesh.material_of[stored.index]
    }

    /// A triangle's index into [`Mesh::objects`].
    #[must_use]
    #[inline]
    pub fn object(&self, triangle: u32) -> u32 {
        let stored = self.stored(triangle);
        stored.instance.map_or_else(|| self.object_of[stored.index], |instance| instance.object)
    }

    /// The corners of all triangles in the world, with the object of each, in the order of their numbers.
    pub fn world_triangles(&self) -> impl Iterator<Item = (u32, [DVec3; 3])> + '_ {
        let own = self.triangles.iter().zip(&self.object_of);
        let own = own.map(|(t, &object)| (object, t.map(|v| self.positions[v as usize])));
        let placed = self.instances.list.iter().flat_map(|instance| {
            let shape = &self.instances.shapes[instance.shape as usize];
            let (world, order) = (instance.world_from_shape, order(instance.mirrors));
            let corner = move |v: u32| world.transform_point3(shape.positions[v as usize]);
            shape.triangles.iter().map(move |t| (instance.object, order.map(|k| corner(t[k]))))
        });
        own.chain(placed)
    }

    /// World positions of all vertices, those of all instances included.
    pub fn world_positions(&self) -> impl Iterator<Item = DVec3> + '_ {
        let placed = self.instances.list.iter().flat_map(|instance| {
            let positions = &self.instances.shapes[instance.shape as usize].positions;
            positions.iter().map(|&p| instance.world_from_shape.transform_point3(p))
        });
        self.positions.iter().copied().chain(placed)
    }

    /// The same triangles with the same numbers, each stored where it stands.
    ///
    /// # Errors
    /// [`SceneError::TooMany`] if there are more vertices than 32 bits can number.
    pub fn expanded(&self) -> Result<Cow<'_, Self>, SceneError> {
        let Instances { shapes, list, .. } = &self.instances;
        if list.is_empty() {
            return Ok(Cow::Borrowed(self));
        }
        let mut flat = Self { instances: Instances::default(), ..self.clone() };
        for instance in list {
            flat.append(&shapes[instance.shape as usize], instance)?;
        }
        Ok(Cow::Owned(flat))
    }

    fn append(&mut self, shape: &Self, instance: &Instance) -> Result<(), SceneError> {
        let lists = [
            ("positions", self.positions.len() + shape.positions.len()),
            ("normals", self.normals.len() + shape.normals.len()),
            ("uvs", self.uvs.len() + shape.uvs.len()),
        ];
        if let Some(&(list, count)) = lists.iter().find(|(_, count)| *count >= NONE as usize) {
            return Err(SceneError::TooMany { list, count });
        }
        let before = self.triangles.len();
        let total = before + shape.triangles.len();
        let join = |list: &mut Vec<[u32; 3]>, more: &[[u32; 3]], first: usize| {
            if list.is_empty() && more.is_empty() {
                return;
            }
            list.resize(before, [NONE; 3]);
            let moved = |v: u32| if v == NONE { NONE } else { v + first as u32 };
            list.extend(more.iter().map(|corners| order(instance.mirrors).map(|k| moved(corners[k]))));
            list.resize(total, [NONE; 3]);
        };
        join(&mut self.normal_of, &shape.normal_of, self.normals.len());
        join(&mut self.uv_of, &shape.uv_of, self.uvs.len());
        join(&mut self.second_uv_of, &shape.second_uv_of, self.uvs.len());
        join(&mut self.triangles, &shape.triangles, self.positions.len());
        if !(self.colors.is_empty() && shape.colors.is_empty()) {
            self.colors.resize(self.positions.len(), Vec3::ONE);
            self.colors.extend_from_slice(&shape.colors);
        }
        self.positions.extend(shape.positions.iter().map(|&p| instance.world_from_shape.transform_point3(p)));
        if !self.colors.is_empty() {
            self.colors.resize(self.positions.len(), Vec3::ONE);
        }
        self.normals.extend(shape.normals.iter().map(|&n| instance.normal(n)));
        self.uvs.extend_from_slice(&shape.uvs);
        self.material_of.extend_from_slice(&shape.material_of);
        self.object_of.resize(total, instance.object);
        Ok(())
    }
}
