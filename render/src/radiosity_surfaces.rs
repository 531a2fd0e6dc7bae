//! A scene's triangles as surfaces of radiosity.
//!
//! Two triangles that form a convex quadrangle become one surface. A surface has the mean albedo and the mean exitance of its
//! material: constants times the means of whole textures times the mean of its vertices' colours.
//!
//! What a light map holds is all that arrives, but for lamps: its surfaces send out what they reflect of its mean over them, and
//! reflect no more.

use crate::mapped_light::MappedLight;
use crate::scene::{Details, Map, Material, Mesh, Scene, SceneError, Texture};
use crate::split_surfaces::split_where_they_cross;
use glam::{DVec3, DVec4, Vec3, Vec4};
use pointillist_radiosity::Surface;
use std::cell::OnceCell;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Mean opacity below which a triangle is left out, as if light passed it.
const OPAQUE: f32 = 0.5;
/// Triangles whose corners are this far off each other's plane, relative to their size, do not form a quadrangle.
const FLAT: f64 = 1e-9;

/// Surfaces, and which triangles each is made of.
#[derive(Clone, Debug, Default)]
pub struct SceneSurfaces {
    /// For `pointillist_radiosity`.
    pub surfaces: Vec<Surface>,
    /// One or two triangles of the scene's mesh for each; pieces of one surface follow one another and have the same.
    pub faces: Vec<Vec<u32>>,
    /// Triangles that were left out because they let light through.
    pub translucent: usize,
    /// Triangles whose light is known, from a map, so that they reflect nothing of what is solved for.
    pub light_mapped: usize,
}

/// The surfaces of a scene, cut where they run through each other: no patch is then half inside of a wall.
///
/// # Errors
/// [`SceneError`] if lists do not fit one another, or with the first material whose diffuse albedo, maps and vertices' colours included, is not in 0 to 1.
pub fn scene_surfaces(scene: &Scene) -> Result<SceneSurfaces, SceneError> {
    scene.check()?;
    let mut found = SceneSurfaces::default();
    let means: Vec<OnceCell<Vec4>> = vec![OnceCell::new(); scene.textures.len()];
    let mean = |i: usize| *means[i].get_or_init(|| mean_texel(&scene.textures[i]));
    let looks: Vec<Look> = scene.materials.iter().map(|material| look_of(material, &mean)).collect();
    let mesh = &scene.mesh;
    let mapped = MappedLight::of_materials(scene)?;
    let mut taken = vec![false; mesh.triangle_count()];
    let partners = Partners::new(scene);
    for triangle in mesh.numbers() {
        let material = mesh.material(triangle) as usize;
        let look = &looks[material];
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
        let albedo = look.albedo * mean_color(mesh, &faces);
        if let Some(value) = albedo.to_array().into_iter().find(|v| !(0.0..=1.0).contains(v)) {
            return Err(SceneError::Albedo { material: scene.materials[material].name.clone(), value });
        }
        // What lights others directly is a lamp.
        let emits = scene.materials[material].details.emits;
        let own = if emits { Vec3::ZERO } else { look.radiance };
        let (reflectance, known) = match &mapped[material] {
            Some(light) => {
                found.light_mapped += faces.len();
                (Vec3::ZERO, albedo * light.mean(scene, &faces))
            }
            None => (albedo, Vec3::ZERO),
        };
        let exitance = bands(own + known).map(|radiance| radiance * PI);
        let mut surface = Surface::new(&vertices, bands(reflectance)).emitting(exitance);
        surface.two_sided = mesh.objects[mesh.object(triangle) as usize].two_sided
            && !scene.materials[material].details.one_sided;
        found.surfaces.push(surface);
        found.faces.push(faces);
    }
    split_where_they_cross(&mut found);
    Ok(found)
}

/// What each material sends out that lights others directly, by the means of its whole maps; 0 for others.
pub(crate) fn direct_radiances(scene: &Scene) -> Vec<Vec3> {
    let of = |material: &Material| {
        if !material.details.emits {
            return Vec3::ZERO;
        }
        let look = look_of(material, &|i| mean_texel(&scene.textures[i]));
        look.radiance * look.opacity
    };
    scene.materials.iter().map(of).collect()
}

/// Means over a material's textures.
struct Look {
    albedo: Vec3,
    /// What it sends out by itself: a diffuse emitter of radiance L has an exitance of πL.
    radiance: Vec3,
    opacity: f32,
}

fn look_of(material: &Material, mean: &dyn Fn(usize) -> Vec4) -> Look {
    let Details { metallic, metallic_map, emission_map, .. } = &material.details;
    let whole = |map: Option<usize>| map.map_or(Vec4::ONE, mean);
    let part = |map: Option<Map>| map.map_or(1.0, |map| map.channel.of(mean(map.texture)));
    let metallic = metallic.map_or(0.0, |m| (m * part(*metallic_map)).clamp(0.0, 1.0));
    let passes = material.details.passes_straight();
    Look {
        albedo: material.surface.diffuse
            * whole(material.diffuse_map).truncate()
            * ((1.0 - metallic) * (1.0 - passes.max_element())),
        radiance: material.surface.emission * whole(emission_map.map(|map| map.texture)).truncate(),
        opacity: material.surface.opacity
            * (1.0 - passes.element_sum() / 3.0)
            * whole(material.opacity_map).w,
    }
}

/// Mean of the vertices' colours over triangles, by area.
fn mean_color(mesh: &Mesh, triangles: &[u32]) -> Vec3 {
    if !mesh.has_colors() {
        return Vec3::ONE;
    }
    let (mut sum, mut areas) = (DVec3::ZERO, 0.0);
    for &t in triangles {
        let [a, b, c] = mesh.corners(t);
        // A triangle without area counts a little, so that the mean of no area at all is a mean, too.
        let area = (b - a).cross(c - a).length().max(f64::MIN_POSITIVE);
        let colors: DVec3 = mesh.corner_colors(t).iter().map(|color| color.as_dvec3()).sum();
        sum += colors / 3.0 * area;
        areas += area;
    }
    (sum / areas).as_vec3()
}

/// Mean of all texels, linear.
fn mean_texel(texture: &Texture) -> Vec4 {
    let mut sum = DVec4::ZERO;
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
        for triangle in scene.mesh.numbers() {
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
        let of = |t: u32| (mesh.material(t), mesh.object(t));
        if taken[other as usize] || other == triangle || of(other) != of(triangle) {
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
