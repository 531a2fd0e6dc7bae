//! What a ray loses at a triangle: the constant of its material times the texel of its mask.

use glam::DVec2;
use pointillist_render::{NONE, Scene, Texture};
use pointillist_shade::Wrap;

use crate::common::scenes::opacity;

/// The opacities of a scene's triangles, by their numbers.
pub(crate) struct Opacities {
    constants: Vec<f64>,
    masks: Vec<Option<Mask>>,
    textures: Vec<Texture>,
    /// All of them are 1 everywhere.
    pub(crate) all_opaque: bool,
}

/// The texture whose alpha is the opacity of a triangle.
struct Mask {
    texture: usize,
    wrap: Wrap,
    uv: [DVec2; 3],
}

impl Opacities {
    pub(crate) fn new(scene: &Scene) -> Self {
        let count = scene.mesh.triangles.len();
        let constants: Vec<f64> = (0..count).map(|t| opacity(scene, t)).collect();
        let masks: Vec<Option<Mask>> = (0..count).map(|t| mask(scene, t)).collect();
        let all_opaque = constants.iter().all(|&o| o >= 1.0) && masks.iter().all(Option::is_none);
        // Clones share their texels.
        Self { constants, masks, textures: scene.textures.clone(), all_opaque }
    }

    /// The opacity of a triangle where its second and third corner have these barycentric coordinates.
    pub(crate) fn at(&self, triangle: u32, [second, third]: [f64; 2]) -> f64 {
        let constant = self.constants[triangle as usize];
        let Some(mask) = &self.masks[triangle as usize] else { return constant };
        let [a, b, c] = mask.uv;
        let uv = a + (b - a) * second + (c - a) * third;
        constant * f64::from(self.textures[mask.texture].lookup(mask.wrap, uv).w)
    }
}

fn mask(scene: &Scene, triangle: usize) -> Option<Mask> {
    let mesh = &scene.mesh;
    let material = &scene.materials[mesh.material_of[triangle] as usize];
    let texture = material.opacity_map?;
    let of = mesh.uv_of.get(triangle).filter(|of| !of.contains(&NONE))?;
    Some(Mask { texture, wrap: material.wrap, uv: of.map(|i| mesh.uvs[i as usize]) })
}
