//! A scene's triangles as surfaces of radiosity: pairs that form a quadrangle joined, albedos averaged over textures.

use crate::scene::{Material, Scene, SceneError, Texture};
use glam::{DVec3, Vec3};
use pointillist_radiosity::Surface;
use std::collections::HashMap;
use std::f64::consts::PI;

/// What shows less than this of itself lets light through.
const OPAQUE: f32 = 0.5;
/// Triangles whose corners are this far off each other's plane, relative to their size, do not form a quadrangle.
const FLAT: f64 = 1e-9;

/// Surfaces, and which triangles each is made of.
#[derive(Clone, Debug, Default)]
pub struct SceneSurfaces {
    /// For `pointillist_radiosity`.
    pub surfaces: Vec<Surface>,
    /// One or two triangles of the scene's mesh for each.
    pub faces: Vec<Vec<u32>>,
    /// Triangles that were left out because they let light through.
    pub translucent: usize,
}

/// The surfaces of a scene.
///
/// # Errors
/// [`SceneError`] if lists do not fit one another, or with the first material whose diffuse albedo is not in 0 to 1.
pub fn scene_surfaces(scene: &Scene) -> Result<SceneSurfaces, SceneError> {
    scene.check()?;
    let mut found = SceneSurfaces::default();
    let mut materials = Vec::with_capacity(scene.materials.len());
    for material in &scene.materials {
        materials.push(light_of(material, scene)?);
    }
    let mesh = &scene.mesh;
    let mut taken = vec![false; mesh.triangles.len()];
    let partners = Partners::new(scene);
    for triangle in 0..mesh.triangles.len() as u32 {
        let look = &materials[mesh.material_of[triangle as usize] as usize];
        if look.opacity < OPAQUE {
            found.translucent += 1;
            continue;
        }
        if std::mem::replace(&mut taken[triangle as usize], true) {
            continue;
        }
        let joined = partners.quadrangle(scene, triangle, &taken);
        let (vertices, faces) = match joined {
            Some((vertices, other)) => {
                taken[other as usize] = true;
                (vertices, vec![triangle, other])
            }
            None => (scene.corners(triangle).to_vec(), vec![triangle]),
        };
        let mut surface = Surface::new(&vertices, look.albedo).emitting(look.exitance);
        surface.two_sided = mesh.objects[mesh.object_of[triangle as usize] as usize].two_sided;
        found.surfaces.push(surface);
        found.faces.push(faces);
    }
    Ok(found)
}

struct Look {
    albedo: [f64; 3],
    exitance: [f64; 3],
    opacity: f32,
}

fn light_of(material: &Material, scene: &Scene) -> Result<Look, SceneError> {
    let mean = |map: Option<usize>| map.map_or(glam::Vec4::ONE, |i| mean_texel(&scene.textures[i]));
    let albedo = material.surface.diffuse * mean(material.diffuse_map).truncate();
    let opacity = material.surface.opacity * mean(material.opacity_map).w;
    let wrong = |value: f32| !(0.0..=1.0).contains(&value);
    if let Some(value) = albedo.to_array().into_iter().find(|v| wrong(*v)) {
        return Err(SceneError::Albedo { material: material.name.clone(), value });
    }
    // Emission is a radiance, and a diffuse emitter of radiance L sends out πL.
    let exitance = material.surface.emission.as_dvec3() * PI;
    Ok(Look { albedo: albedo.as_dvec3().to_array(), exitance: exitance.to_array(), opacity })
}

/// Mean of all texels, linear.
fn mean_texel(texture: &Texture) -> glam::Vec4 {
    let mut sum = glam::DVec4::ZERO;
    for y in 0..texture.height {
        for x in 0..texture.width {
            sum += texture.texel(x, y).as_dvec4();
        }
    }
    (sum / (f64::from(texture.width) * f64::from(texture.height))).as_vec4()
}

/// Triangles by their directed edges.
struct Partners {
    by_edge: HashMap<[[u64; 3]; 2], u32>,
}

fn key(p: DVec3) -> [u64; 3] {
    [p.x + 0.0, p.y + 0.0, p.z + 0.0].map(f64::to_bits)
}

impl Partners {
    fn new(scene: &Scene) -> Self {
        let mut by_edge = HashMap::new();
        for triangle in 0..scene.mesh.triangles.len() as u32 {
            let ring = scene.corners(triangle);
            for i in 0..3 {
                by_edge.entry([key(ring[i]), key(ring[(i + 1) % 3])]).or_insert(triangle);
            }
        }
        Self { by_edge }
    }

    /// The quadrangle that a triangle forms with its neighbour across its longest edge, and that neighbour.
    fn quadrangle(&self, scene: &Scene, triangle: u32, taken: &[bool]) -> Option<(Vec<DVec3>, u32)> {
        let ring = scene.corners(triangle);
        let length = |i: usize| (ring[(i + 1) % 3] - ring[i]).length_squared();
        let longest = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j)))?;
        let [a, b, c] = [0, 1, 2].map(|k| ring[(longest + k) % 3]);
        // The neighbour runs along the edge the other way.
        let other = *self.by_edge.get(&[key(b), key(a)])?;
        let mesh = &scene.mesh;
        let same =
            |list: &[u32]| list.get(triangle as usize) == list.get(other as usize) && other != triangle;
        if taken[other as usize] || !same(&mesh.material_of) || !same(&mesh.object_of) {
            return None;
        }
        let d = scene.corners(other).into_iter().find(|&p| p != a && p != b)?;
        let normal = (b - a).cross(c - a).try_normalize()?;
        if (d - a).dot(normal).abs() > FLAT * length(longest).sqrt() {
            return None;
        }
        // In order: c, a, d, b; convex if both new corners turn left.
        let turns = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - q).dot(normal);
        let least = 1e-9 * length(longest);
        (turns(c, a, d) > least && turns(d, b, c) > least).then(|| (vec![c, a, d, b], other))
    }
}

/// As `f64` bands.
pub(crate) fn bands(color: Vec3) -> [f64; 3] {
    color.as_dvec3().to_array()
}
