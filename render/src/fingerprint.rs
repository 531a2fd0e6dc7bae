//! Hashes of scenes, the same on every machine: equal scenes have equal numbers and draw equal pictures, so that a picture that is
//! there already need not be drawn again.

use crate::scene::{
    AmbientLight, Camera, Details, MapPlace, Material, Mesh, Scene, SkyLight, Texels, Texture,
};
use glam::{DVec2, DVec3, Vec3};
use pointillist_shade::{Falloff, Light, Material as ShadeMaterial};
use pointillist_shadow::Resolution;
use pointillist_view::Projection;
use std::hash::Hasher as _;
use std::ops::Range;
use twox_hash::XxHash3_64;

/// XXH3 (64 bits) of bytes that come a few at a time. The value depends on the bytes alone, not on how they are divided; numbers given as
/// little-endian bytes have the same on every machine.
#[derive(Clone, Default)]
pub struct ByteHash {
    hash: XxHash3_64,
    /// Less than [`BLOCK`] bytes that are not yet hashed.
    waiting: Vec<u8>,
}

/// Bytes that are hashed at once: each call takes as long as some hundred.
const BLOCK: usize = 4096;

impl ByteHash {
    /// Takes some bytes.
    #[inline]
    pub fn write(&mut self, bytes: &[u8]) {
        if self.waiting.len() + bytes.len() >= BLOCK {
            self.write_block(bytes);
        } else {
            self.waiting.extend_from_slice(bytes);
        }
    }

    fn write_block(&mut self, bytes: &[u8]) {
        self.hash.write(&self.waiting);
        self.hash.write(bytes);
        self.waiting.clear();
    }

    /// The hash of all bytes.
    #[must_use]
    pub fn finish(mut self) -> u64 {
        self.write_block(&[]);
        self.hash.finish()
    }
}

/// The hash of a scene or of parts of it.
#[derive(Default)]
struct Fingerprint(ByteHash);

/// The hash of everything that a picture of the scene depends on.
#[must_use]
pub fn of_scene(scene: &Scene) -> u64 {
    of_view(&scene.camera, [scene.image.width, scene.image.height], of_light(scene))
}

/// The hash of everything that a picture depends on, from its camera, its width and height, and [`of_light`] of its scene: where only the
/// camera moves, the rest need not be hashed again.
#[must_use]
pub fn of_view(camera: &Camera, size: [u32; 2], light: u64) -> u64 {
    let mut hash = Fingerprint::default();
    hash.camera_and_image(camera, size);
    hash.int(light);
    hash.0.finish()
}

/// The hash of what light depends on: everything but the camera and the picture's size.
#[must_use]
pub fn of_light(scene: &Scene) -> u64 {
    let mut hash = Fingerprint::default();
    hash.color(scene.image.background);
    hash.option(scene.image.environment);
    hash.int(u64::from(scene.image.hides_environment));
    hash.text(&format!("{:?}", scene.render));
    hash.mesh(&scene.mesh);
    scene.materials.iter().for_each(|material| hash.material(material));
    scene.textures.iter().for_each(|texture| hash.texture(texture));
    for light in &scene.lights {
        hash.text(&light.name);
        hash.light(&light.light);
        if light.ambient != Vec3::ZERO {
            hash.color(light.ambient);
        }
        if let Some(specular) = light.specular {
            hash.text("specular");
            hash.color(specular);
        }
        hash.int(u64::from(light.shadow));
        hash.int(match light.resolution {
            Resolution::Auto => 0,
            Resolution::Cells(n) => u64::from(n),
        });
    }
    match &scene.ambient {
        AmbientLight::Color(color) => hash.color(*color),
        AmbientLight::Sky(SkyLight { sky, ground, up }) => {
            [sky, ground, up].into_iter().for_each(|v| hash.color(*v))
        }
        AmbientLight::Environment => hash.text("environment"),
        AmbientLight::Probes { fingerprint, .. }
        | AmbientLight::Radiosity { fingerprint, .. }
        | AmbientLight::RadiosityAndProbes { fingerprint, .. } => hash.int(*fingerprint),
    }
    hash.0.finish()
}

/// The hash of the triangles alone: what must be the same for light that was baked triangle by triangle.
#[must_use]
pub fn of_geometry(mesh: &Mesh) -> u64 {
    let mut hash = Fingerprint::default();
    for part in std::iter::once(mesh).chain(mesh.shapes()) {
        hash.int(part.positions.len() as u64);
        part.positions.iter().for_each(|&p| hash.vector(p));
        hash.triples(&part.triangles);
        part.object_of.iter().for_each(|n| hash.0.write(&n.to_le_bytes()));
        part.objects.iter().for_each(|object| hash.int(u64::from(object.two_sided)));
    }
    hash.instances(mesh);
    hash.0.finish()
}

/// Triangles of one object whose numbers follow one another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ObjectTriangles {
    /// Their numbers.
    pub triangles: Range<u32>,
    /// The hash of where they stand, in their order. It does not depend on whether they are stored once for several places.
    pub fingerprint: u64,
}

/// The triangles of a mesh, object by object in the order of their numbers: what is known of an object is known of an equal one in a scene in which
/// there are others, too.
#[must_use]
pub fn of_objects(mesh: &Mesh) -> Vec<ObjectTriangles> {
    let mut list = vec![];
    let mut triangles = mesh.world_triangles().enumerate().peekable();
    while let Some(&(first, (object, _))) = triangles.peek() {
        let mut hash = Fingerprint::default();
        hash.int(u64::from(mesh.objects.get(object as usize).is_some_and(|object| object.two_sided)));
        let mut end = first as u32;
        while let Some((_, (_, corners))) = triangles.next_if(|&(_, (of, _))| of == object) {
            corners.into_iter().for_each(|p| hash.vector(p));
            end += 1;
        }
        list.push(ObjectTriangles { triangles: first as u32..end, fingerprint: hash.0.finish() });
    }
    list
}

/// The hash of what baked light depends on besides the triangles: their materials and colours, textures and lights.
///
/// # Panics
/// If a triangle or a material names something that is not there: [`Scene::check`] tells.
#[must_use]
pub fn of_sources(scene: &Scene) -> u64 {
    of_sources_for(scene, scene.mesh.numbers())
}

/// The same for light of some triangles: what is only on others does not count.
///
/// # Panics
/// As [`of_sources`], and if there is no triangle of such a number.
#[must_use]
pub fn of_sources_for(scene: &Scene, triangles: impl IntoIterator<Item = u32>) -> u64 {
    let mut hash = Fingerprint::default();
    // Materials count in the order in which they are met.
    let (mut materials, mut textures) = (vec![], vec![]);
    let mut number_of = vec![None; scene.materials.len()];
    for triangle in triangles {
        let material = scene.mesh.material(triangle) as usize;
        let number = *number_of[material].get_or_insert_with(|| {
            materials.push(material);
            materials.len() as u32
        });
        hash.0.write(&number.to_le_bytes());
        let colors = scene.mesh.corner_colors(triangle);
        if colors != [Vec3::ONE; 3] {
            colors.into_iter().for_each(|color| hash.color(color));
        }
    }
    for material in materials.into_iter().map(|m| &scene.materials[m]) {
        hash.material(material);
        let new: Vec<usize> = material.textures().filter(|t| !textures.contains(t)).collect();
        new.iter().for_each(|&texture| hash.texture(&scene.textures[texture]));
        textures.extend(new);
    }
    for light in &scene.lights {
        hash.light(&light.light);
        hash.int(u64::from(light.shadow));
    }
    hash.0.finish()
}

impl Fingerprint {
    fn int(&mut self, n: u64) {
        self.0.write(&n.to_le_bytes());
    }

    fn float(&mut self, n: f64) {
        self.int(n.to_bits());
    }

    fn vector(&mut self, v: DVec3) {
        v.to_array().into_iter().for_each(|n| self.float(n));
    }

    fn color(&mut self, c: Vec3) {
        c.to_array().into_iter().for_each(|n| self.0.write(&n.to_le_bytes()));
    }

    fn text(&mut self, text: &str) {
        self.int(text.len() as u64);
        self.0.write(text.as_bytes());
    }

    fn option(&mut self, index: Option<usize>) {
        self.int(index.map_or(0, |index| index as u64 + 1));
    }

    fn triples(&mut self, list: &[[u32; 3]]) {
        self.int(list.len() as u64);
        list.iter().flatten().for_each(|n| self.0.write(&n.to_le_bytes()));
    }

    fn camera_and_image(&mut self, camera: &Camera, size: [u32; 2]) {
        [camera.eye, camera.target, camera.up].into_iter().for_each(|v| self.vector(v));
        match camera.projection {
            Projection::Perspective { fov_y_rad } => {
                self.int(0);
                self.float(fov_y_rad);
            }
            Projection::Orthographic { height } => {
                self.int(1);
                self.float(height);
            }
        }
        size.into_iter().for_each(|n| self.int(u64::from(n)));
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.int(mesh.positions.len() as u64);
        mesh.positions.iter().for_each(|&p| self.vector(p));
        mesh.normals.iter().chain(&mesh.colors).for_each(|&n| self.color(n));
        mesh.uvs.iter().for_each(|&DVec2 { x, y }| [x, y].into_iter().for_each(|n| self.float(n)));
        let lists = [&mesh.triangles, &mesh.normal_of, &mesh.uv_of, &mesh.second_uv_of];
        lists.into_iter().for_each(|list| self.triples(list));
        mesh.material_of.iter().chain(&mesh.object_of).for_each(|n| self.0.write(&n.to_le_bytes()));
        mesh.objects.iter().for_each(|object| self.int(u64::from(object.two_sided)));
        mesh.shapes().iter().for_each(|shape| self.mesh(shape));
        self.instances(mesh);
    }

    fn instances(&mut self, mesh: &Mesh) {
        for instance in mesh.instances() {
            self.int(u64::from(instance.shape) << 32 | u64::from(instance.object));
            instance.world_from_shape.to_cols_array().into_iter().for_each(|n| self.float(n));
        }
    }

    fn material(&mut self, material: &Material) {
        let ShadeMaterial {
            model, diffuse, ambient, specular, shininess, roughness, emission, opacity, ..
        } = material.surface;
        self.text(&format!("{model:?} {:?}", material.wrap));
        [diffuse, specular, emission, Vec3::new(shininess, opacity, roughness)]
            .into_iter()
            .for_each(|c| self.color(c));
        if let Some(ambient) = ambient {
            self.color(ambient);
        }
        self.option(material.diffuse_map);
        self.option(material.opacity_map);
        let places = [material.diffuse_place, material.opacity_place];
        if places != [MapPlace::default(); 2] {
            self.text(&format!("{places:?}"));
        }
        if material.details != Details::default() {
            self.text(&format!("{:?}", material.details));
        }
    }

    fn texture(&mut self, texture: &Texture) {
        self.int(u64::from(texture.width));
        self.int(u64::from(texture.height));
        match &texture.texels {
            Texels::Srgb8(texels) => self.0.write(texels.as_flattened()),
            Texels::OpaqueSrgb8(texels) => self.opaque(texels, |texel| *texel),
            Texels::Linear8(texels) => {
                self.int(1);
                self.0.write(texels.as_flattened());
            }
            Texels::OpaqueLinear8(texels) => {
                self.int(1);
                self.opaque(texels, |texel| *texel);
            }
            Texels::Gray8(texels) => {
                self.int(1);
                self.opaque(texels, |&[gray]| [gray; 3]);
            }
            Texels::Opacity8(texels) => self.0.write(texels.as_flattened()),
            Texels::Float(texels) => texels.iter().flatten().for_each(|c| self.0.write(&c.to_le_bytes())),
        }
    }

    /// How opaque texels are stored does not count: they are taken as with an alpha of 255.
    fn opaque<T>(&mut self, texels: &[T], rgb: impl Fn(&T) -> [u8; 3]) {
        let mut block = [u8::MAX; BLOCK];
        let slots = block.as_chunks_mut::<4>().0;
        for some in texels.chunks(slots.len()) {
            for (slot, texel) in slots.iter_mut().zip(some) {
                slot[..3].copy_from_slice(&rgb(texel));
            }
            self.0.write(slots[..some.len()].as_flattened());
        }
    }

    fn light(&mut self, light: &Light) {
        self.color(light.color());
        let mut falloff = Falloff::InverseSquare;
        match *light {
            Light::Directional { direction, .. } => self.vector(direction),
            Light::Point { position, falloff: f, .. } => {
                self.vector(position);
                falloff = f;
            }
            Light::Spot { position, direction, beam_rad, cutoff_rad, exponent, falloff: f, .. } => {
                [position, direction, DVec3::new(beam_rad, cutoff_rad, exponent)]
                    .into_iter()
                    .for_each(|v| self.vector(v));
                falloff = f;
            }
            Light::Rect { corner, edge_u, edge_v, samples, falloff: f, .. } => {
                [corner, edge_u, edge_v].into_iter().for_each(|v| self.vector(v));
                self.int(samples.map_or(0, |n| u64::from(n.get())));
                falloff = f;
            }
            Light::Polygon { outline, two_sided, samples, falloff: f, .. } => {
                self.text("polygon");
                self.int(outline.vertices().len() as u64);
                outline.vertices().iter().for_each(|&v| self.vector(v));
                self.int(u64::from(two_sided));
                self.int(samples.map_or(0, |n| u64::from(n.get())));
                falloff = f;
            }
            Light::Line { from, to, samples, falloff: f, .. } => {
                self.text("line");
                [from, to].into_iter().for_each(|v| self.vector(v));
                self.int(samples.map_or(0, |n| u64::from(n.get())));
                falloff = f;
            }
            // A light that this version cannot read from a file.
            _ => self.text(&format!("{light:?}")),
        }
        self.text(&format!("{falloff:?}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_does_not_depend_on_how_bytes_are_divided() {
        let bytes: Vec<u8> = (0..3 * BLOCK).map(|i| (i * i / 7) as u8).collect();
        for size in [1, 3, 8, BLOCK - 1, BLOCK, BLOCK + 1, bytes.len()] {
            let mut hash = ByteHash::default();
            bytes.chunks(size).for_each(|some| hash.write(some));
            assert_eq!(hash.finish(), XxHash3_64::oneshot(&bytes), "{size} at a time");
        }
        assert_eq!(ByteHash::default().finish(), XxHash3_64::oneshot(&[]));
    }

    /// `ShadeMaterial` can gain fields without an error here: the fingerprint must then take them in.
    #[test]
    fn every_field_of_a_surface_is_in_the_fingerprint() {
        let text = format!("{:?}", ShadeMaterial::default());
        assert_eq!(text.matches(": ").count(), 8, "{text}");
    }
}
