//! What casts shadows: all that is seen, but what is clear lets light pass, of each colour its own share.

use crate::scene::Scene;
use glam::Vec3;
use pointillist_micropoint::{Geometry, MicropointError};

/// The geometry that casts the shadows of some colours of light.
pub(crate) struct Casters {
    /// 1 for the channels that it counts for, 0 for the others.
    pub(crate) channels: Vec3,
    pub(crate) geometry: Geometry,
}

/// The casters of a scene with clear materials, for each colour that passes them differently; nothing for one without.
///
/// A material of opacity α and transmission t takes α (1 − t) of the light at each of its surfaces. Light goes straight through: it is neither
/// bent nor mirrored on the way.
pub(crate) fn clear_casters(scene: &Scene, geometry: &Geometry) -> Result<Vec<Casters>, MicropointError> {
    let passes = |channel: usize| -> Vec<f32> {
        let of = |details: &crate::scene::Details| details.transmission.map_or(0.0, |t| t.color[channel]);
        scene.materials.iter().map(|material| of(&material.details)).collect()
    };
    let by_channel = [0, 1, 2].map(passes);
    if by_channel.iter().flatten().all(|&share| share == 0.0) {
        return Ok(vec![]);
    }
    let mut casters = vec![];
    for (first, passes) in by_channel.iter().enumerate() {
        let alike = |channel: usize| by_channel[channel] == *passes;
        if (0..first).any(alike) {
            continue;
        }
        let channels = Vec3::from_array([0, 1, 2].map(|channel| f32::from(u8::from(alike(channel)))));
        let surfaces = geometry.surfaces();
        // Each material has two surfaces.
        let opacity = |surface: usize| surfaces[surface].opacity * (1.0 - passes[surface / 2]);
        casters.push(Casters { channels, geometry: geometry.with_opacities(opacity)? });
    }
    Ok(casters)
}
