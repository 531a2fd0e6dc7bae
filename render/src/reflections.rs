//! What surfaces mirror: maps of the surroundings, made only where a material asks for them.

use crate::error::RenderError;
use crate::monitor::{Monitor, go_on, stage};
use crate::scene::{AmbientLight, Details, Material, Scene, Surroundings, Texture};
use glam::Vec3;
use pointillist_sh::{self as sh, CubeProjector, Panorama, PanoramaProjector, Sh, Weights};
use pointillist_shade::{CubeMap, Environment, Equirectangular, Model, SMALLEST_ROUGHNESS, cube_direction};
use std::cmp::Ordering;
use std::collections::HashMap;
use std::sync::Arc;

/// Texels on a side of a cube's face at most: a degree has 11 of them.
const LARGEST_FACE: u32 = 1024;

/// The maps of a scene. Clones share them.
#[derive(Clone, Default)]
pub(crate) struct Reflections {
    scene: Option<Arc<SceneMap>>,
    textures: HashMap<usize, Arc<Environment>>,
    /// By object and material.
    captured: HashMap<(u32, u32), Arc<Environment>>,
}

/// The scene's own map.
pub(crate) struct SceneMap {
    pub(crate) environment: Environment,
    /// What of it probes hold that see all of it, if there are probes.
    pub(crate) bands: Option<Sh>,
}

/// What a triangle mirrors.
pub(crate) enum Mirrored<'a> {
    /// A map of what is around it.
    Around(&'a Environment),
    /// The scene's own map, as far as it is seen from the triangle.
    Scene(&'a SceneMap),
}

/// Whether a material mirrors or refracts anything.
pub(crate) fn mirrors(material: &Material) -> bool {
    let details = &material.details;
    let refracts = details.transmission.is_some_and(|t| !t.is_straight());
    material.surface.model == Model::Ggx || details.reflection.is_some() || refracts
}

/// Whether what it mirrors is blurred, by its roughness or by bumps that are smaller than a pixel.
fn is_rough(material: &Material) -> bool {
    let bumpy = material.details.bump.is_some() || material.details.normal.is_some();
    let widened = bumpy && material.surface.model == Model::Ggx;
    mirrors(material) && (widened || material.surface.roughness > SMALLEST_ROUGHNESS)
}

impl Reflections {
    /// The maps that are made of textures. A material whose surroundings are captured needs that of the scene, too: other objects
    /// show it in the capture.
    pub(crate) fn new(scene: &Scene, monitor: &dyn Monitor) -> Result<Self, RenderError> {
        let mut maps = Self::default();
        let ambient = matches!(scene.ambient, AmbientLight::Environment);
        let mirrors_scene =
            |m: &&Material| mirrors(m) && !matches!(m.details.surroundings, Surroundings::Texture(_));
        if let Some(texture) = scene.image.environment
            && (ambient || scene.materials.iter().any(|m| mirrors_scene(&m)))
        {
            go_on(monitor)?;
            let rough = scene.materials.iter().filter(mirrors_scene).any(is_rough);
            maps.scene = Some(stage(monitor, "environment", || {
                let map = environment(scene, texture, rough);
                let environment = if ambient { map.with_irradiance() } else { map };
                Arc::new(SceneMap { environment, bands: bands_of_probes(scene, texture) })
            }));
        }
        for material in &scene.materials {
            if let Surroundings::Texture(texture) = material.details.surroundings
                && mirrors(material)
                && !maps.textures.contains_key(&texture)
            {
                go_on(monitor)?;
                let map = stage(monitor, "environment", || environment(scene, texture, true));
                maps.textures.insert(texture, Arc::new(map));
            }
        }
        Ok(maps)
    }

    /// Those that are made of textures, without what was captured.
    pub(crate) fn without_captures(&self) -> Self {
        Self { captured: HashMap::new(), ..self.clone() }
    }

    /// The scene's own map, if anything needs it.
    pub(crate) fn of_scene(&self) -> Option<&Environment> {
        self.scene.as_ref().map(|map| &map.environment)
    }

    /// Adds what an object mirrors with a material that has its surroundings captured.
    pub(crate) fn add_captured(&mut self, object: u32, material: u32, cube: CubeMap, scene: &Scene) {
        let map = Environment::sharp(cube);
        let rough = is_rough(&scene.materials[material as usize]);
        let map = if rough { map.with_rough_levels() } else { map };
        self.captured.insert((object, material), Arc::new(map));
    }

    /// What a triangle mirrors. Captured surroundings that are not there (yet) are those of the scene.
    pub(crate) fn of(&self, scene: &Scene, details: &Details, triangle: u32) -> Option<Mirrored<'_>> {
        let own = match details.surroundings {
            Surroundings::Scene => None,
            Surroundings::Texture(texture) => {
                return self.textures.get(&texture).map(|map| Mirrored::Around(map));
            }
            Surroundings::Capture => {
                let mesh = &scene.mesh;
                self.captured.get(&(mesh.object(triangle), mesh.material(triangle)))
            }
        };
        own.map(|map| Mirrored::Around(map)).or(self.scene.as_deref().map(Mirrored::Scene))
    }
}

/// What probes hold of a texture of all directions where all of it is seen.
fn bands_of_probes(scene: &Scene, texture: usize) -> Option<Sh> {
    let field = scene.ambient.field()?;
    let t = &scene.textures[texture];
    let pixels: Vec<[f32; 3]> = colors(t).into_iter().map(|color| color.to_array()).collect();
    let (width, height) = (t.width as usize, t.height as usize);
    if t.is_cube() {
        let map = sh::CubeMap::from_texels(width, &pixels).ok()?;
        return CubeProjector::new(width, field.order(), Weights::Exact).ok()?.project(&map).ok();
    }
    let map = Panorama::new(width, height, &pixels).ok()?;
    PanoramaProjector::new(width, height, field.order(), Weights::Exact).ok()?.project(&map).ok()
}

fn colors(t: &Texture) -> Vec<Vec3> {
    (0..t.height).flat_map(|y| (0..t.width).map(move |x| t.texel(x, y).truncate())).collect()
}

/// A texture of all directions as a cube with about as many texels to a degree.
fn environment(scene: &Scene, texture: usize, rough: bool) -> Environment {
    let t = &scene.textures[texture];
    let texels = colors(t);
    let map = Environment::sharp(if t.is_cube() {
        of_cube(t.width, &texels)
    } else {
        let map = Equirectangular::new(&texels, t.width, t.height).expect("a texture has all its texels");
        let size = (t.width / 4).clamp(16, LARGEST_FACE).next_power_of_two();
        CubeMap::from_function(size, |d| map.sample(d))
    });
    if rough { map.with_rough_levels() } else { map }
}

/// A cube's own texels, unless it is too large or cannot be halved down to one texel, as blurred levels want it.
fn of_cube(size: u32, texels: &[Vec3]) -> CubeMap {
    let map = CubeMap::new(size, texels).expect("a texture has all its texels");
    let wanted = size.next_power_of_two().min(LARGEST_FACE);
    match wanted.cmp(&size) {
        Ordering::Equal => map,
        Ordering::Greater => CubeMap::from_function(wanted, |d| map.sample(d)),
        // One sample in each texel would miss what lies between: the texels that a texel covers are averaged.
        Ordering::Less => averaged(&map, wanted),
    }
}

/// Means over as many samples in each texel as the larger map has texels there.
fn averaged(map: &CubeMap, size: u32) -> CubeMap {
    let steps = map.size().div_ceil(size);
    let (n, k) = (f64::from(size), f64::from(steps));
    let place = |i: u32, step: u32| 2.0 * (f64::from(i) + (f64::from(step) + 0.5) / k) / n - 1.0;
    let mut texels = Vec::with_capacity(6 * size as usize * size as usize);
    for (face, y, x) in (0..6).flat_map(|f| (0..size).flat_map(move |y| (0..size).map(move |x| (f, y, x)))) {
        let of_row = |dy: u32| {
            (0..steps)
                .map(move |dx| map.sample(cube_direction(face, place(x, dx), place(y, dy))))
                .sum::<Vec3>()
        };
        texels.push((0..steps).map(of_row).sum::<Vec3>() / (steps * steps) as f32);
    }
    CubeMap::new(size, &texels).expect("each texel was made")
}
