//! What all micropoints of a face have in common, found once for each face of a tile.

use crate::scene;
use crate::shader::{Glow, Shader};
use glam::Vec3;
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
    /// Whether it looks the same from everywhere in any light: it glows, or is black.
    pub(crate) is_constant: bool,
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
        FaceLook {
            normal: if face.front { normal } else { -normal }.as_vec3(),
            material,
            varies_by_corner: self.scene.mesh.has_colors()
                || (!is_flat && self.corner_normals(face).is_some()),
            is_constant: self.surfaces.details(face.id).is_none()
                && material.diffuse == Vec3::ZERO
                && material.ambient_albedo() == Vec3::ZERO
                && material.specular == Vec3::ZERO,
        }
    }

    /// The material of a face.
    pub(crate) fn described(&self, face: &Face) -> &scene::Material {
        &self.scene.materials[self.scene.mesh.material(face.id) as usize]
    }
}
