//! What the eye sees through clear materials: of each colour another share of what is behind.
//!
//! A surface of opacity α that lets the share t of a colour pass hides α (1 − t) of what is behind it, as it does in shadows
//! ([`crate::casters`]). Visibility is therefore found once for each colour that passes differently ([`Sight`]), and only in tiles where such a
//! surface is seen.

use crate::casters::Casters;
use crate::scene::Scene;
use glam::Vec3;
use pointillist_micropoint::{Geometry, MicropointError, Tile};
use std::sync::Arc;

/// What a surface hides at least, over its opacity. One that hides nothing has no visible share, and its highlights would be lost.
const LEAST_HIDDEN: f32 = 1.0 / 1_048_576.0;

/// The geometry as the eye sees it in some colours.
pub(crate) struct Sight {
    /// 1 for the channels that it counts for, 0 for the others.
    pub(crate) channels: Vec3,
    pub(crate) geometry: Arc<Geometry>,
    /// For each material, what light from the surface itself counts over what the surface hides; empty if nothing is clear.
    pub(crate) own_light: Vec<f64>,
}

/// One sight for all colours if they pass alike, more if they do not. Geometry that `casters` have already is shared with them.
pub(crate) fn sights(
    scene: &Scene,
    geometry: &Arc<Geometry>,
    casters: &[Casters],
) -> Result<Vec<Sight>, MicropointError> {
    let passes: Vec<Vec3> = scene.materials.iter().map(|m| m.details.passes_straight()).collect();
    if passes.iter().all(|&share| share == Vec3::ZERO) {
        let (channels, geometry) = (Vec3::ONE, geometry.clone());
        return Ok(vec![Sight { channels, geometry, own_light: vec![] }]);
    }
    let alike = |a: usize, b: usize| passes.iter().all(|share| share[a] == share[b]);
    let mut sights = vec![];
    for first in (0..3).filter(|&channel| !(0..channel).any(|before| alike(before, channel))) {
        let channels = Vec3::from_array([0, 1, 2].map(|channel| f32::from(u8::from(alike(channel, first)))));
        let hidden = |share: &Vec3| (1.0 - share[first]).max(LEAST_HIDDEN);
        let own_light = passes.iter().map(|share| 1.0 / f64::from(hidden(share))).collect();
        let surfaces = geometry.surfaces();
        // Each material has two surfaces.
        let opacity = |surface: usize| surfaces[surface].opacity * hidden(&passes[surface / 2]);
        let same = |c: &&Casters| {
            let found = c.geometry.surfaces();
            (0..found.len()).all(|surface| found[surface].opacity == opacity(surface))
        };
        let geometry = match casters.iter().find(same) {
            Some(casters) => casters.geometry.clone(),
            None => Arc::new(geometry.with_opacities(opacity)?),
        };
        sights.push(Sight { channels, geometry, own_light });
    }
    Ok(sights)
}

/// Whether a tile shows anything that lets colours pass differently.
pub(crate) fn shows_tint(scene: &Scene, tile: &Tile) -> bool {
    let tinted = |material: u32| {
        let passes = scene.materials[material as usize].details.passes_straight();
        passes != Vec3::splat(passes.x)
    };
    let mut of_point = tile.points().iter().map(|m| tile.faces()[m.face as usize].id);
    of_point.any(|triangle| tinted(scene.mesh.material(triangle)))
}
