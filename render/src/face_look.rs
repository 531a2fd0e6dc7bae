//! What all micropoints of a face have in common, found once for each face of a tile.

use crate::ambient::Spot;
use crate::scene;
use crate::shader::{Glow, Shader};
use glam::{DVec3, Vec3};
use pointillist_delaunay::Hint;
use pointillist_micropoint::Face;
use pointillist_shade::{Interpolation, Material, face_normal};

/// A face as its material describes it, before maps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceLook {
    /// Unit normal, on the eye's side.
    pub(crate) normal: Vec3,
    /// With the emission that is seen.
    pub(crate) material: Material,
    /// Whether normals or colours are interpolated between the corners.
    pub(crate) varies_by_corner: bool,
    /// Whether anything asks where the eye is.
    pub(crate) depends_on_view: bool,
    /// How far it stands for a part of a smooth surface, 0 to 1: see [`smoothness`].
    smoothness: f32,
    /// Whether it looks the same from everywhere in any light: it glows, or is black.
    pub(crate) is_constant: bool,
    /// What all of it reflects of ambient light, if that, the normal and the material are the same everywhere on it.
    pub(crate) even_indirect: Option<Vec3>,
    /// Whether its colour varies.
    pub(crate) has_color: bool,
    /// Whether its material has anything beyond colour and opacity.
    pub(crate) has_details: bool,
}

impl FaceLook {
    /// Unit normal of the surface that the face stands for, where `interpolated` is what the corners say: without bumps, on the side that is seen.
    pub(crate) fn side(&self, interpolated: Vec3) -> Vec3 {
        match self.smoothness {
            0.0 => self.normal,
            share => self.normal.lerp(interpolated, share).normalize_or(self.normal),
        }
    }
}

/// Cosines of the largest angle between a face's normal and those of its corners: up to the first (30°) the face stands for a part of a smooth
/// surface, from the second on (45°) its corners' normals are averages over edges.
const SMOOTH: f32 = 0.866;
const EDGED: f32 = 0.707;

/// How far a face stands for a part of a smooth surface. Between faces of a box whose corners have averaged normals are edges all the same: light
/// does not come around them.
fn smoothness(normal: Vec3, corners: [Vec3; 3]) -> f32 {
    let cosines = Vec3::from_array(corners.map(|corner| corner.dot(normal)));
    // Normals may point to either side, but all to one.
    let least = cosines.min_element().max(-cosines.max_element());
    ((least - EDGED) / (SMOOTH - EDGED)).clamp(0.0, 1.0)
}

/// The looks of a tile's faces that were asked for. Memory is reused from tile to tile.
#[derive(Default)]
pub(crate) struct FaceLooks {
    of_face: Vec<Option<FaceLook>>,
}

impl FaceLooks {
    /// Forgets the faces of the last tile; the next has this many.
    pub(crate) fn start(&mut self, faces: usize) {
        self.of_face.clear();
        self.of_face.resize(faces, None);
    }

    pub(crate) fn of(&mut self, face: u32, make: impl FnOnce() -> FaceLook) -> &FaceLook {
        self.of_face[face as usize].get_or_insert_with(make)
    }
}

impl Shader<'_> {
    pub(crate) fn face_look(&self, face: &Face) -> FaceLook {
        let [a, b, c] = self.scene.corners(face.id);
        let normal = face_normal(a, b, c);
        let described = self.described(face);
        let glows = match self.glow {
            Glow::Nothing => false,
            Glow::OtherThanLights => !described.details.emits,
            Glow::Everything => true,
        };
        let mut material = described.surface;
        if !glows {
            material.emission = Vec3::ZERO;
        }
        // Coloured glass takes up what of a colour does not pass; it does not diffuse it.
        material.diffuse *= 1.0 - described.details.passes_straight().max_element();
        let is_flat = self.scene.render.shading == Interpolation::Flat;
        let normal = if face.front { normal } else { -normal }.as_vec3();
        let corners = if is_flat { None } else { self.corner_normals(face) };
        let has_details = self.surfaces.details(face.id).is_some();
        let varies_by_corner = self.scene.mesh.has_colors() || corners.is_some();
        let has_color = self.surfaces.has_color(face.id);
        // By OpenGL's formula lamps add ambient light that depends on the place.
        let is_even = !has_details && !varies_by_corner && !has_color && !material.model.is_opengl();
        FaceLook {
            normal,
            material,
            varies_by_corner,
            depends_on_view: material.depends_on_view()
                || varies_by_corner
                || has_details
                || described.details.measured.is_some(),
            smoothness: corners.map_or(0.0, |corners| smoothness(normal, corners)),
            is_constant: !has_details
                && material.diffuse == Vec3::ZERO
                && material.ambient_albedo() == Vec3::ZERO
                && material.specular == Vec3::ZERO,
            even_indirect: is_even.then(|| self.even_indirect(face, normal, &material)).flatten(),
            has_color,
            has_details,
        }
    }

    /// What a face with this normal and material reflects of ambient light, if that is the same everywhere on it.
    fn even_indirect(&self, face: &Face, normal: Vec3, material: &Material) -> Option<Vec3> {
        let albedo = material.ambient_albedo();
        if albedo == Vec3::ZERO {
            // What reflects nothing needs no light.
            return Some(Vec3::ZERO);
        }
        let anywhere =
            Spot { position: DVec3::ZERO, triangle: face.id, front: face.front, side: normal, normal };
        let is_even = !self.ambient.depends_on_place();
        is_even.then(|| self.ambient.at(&anywhere, &mut Hint::default()) * albedo)
    }

    /// The material of a face.
    pub(crate) fn described(&self, face: &Face) -> &scene::Material {
        &self.scene.materials[self.scene.mesh.material(face.id) as usize]
    }
}
