//! What casts shadows: all that is seen, but what is clear lets light pass, of each colour its own share.

use crate::scene::Scene;
use crate::shaft::{Box3, Shaft};
use glam::{DVec3, Vec3};
use pointillist_micropoint::{Geometry, MicropointError};
use std::sync::Arc;

/// The geometry that casts the shadows of some colours of light.
pub(crate) struct Casters {
    /// 1 for the channels that it counts for, 0 for the others.
    pub(crate) channels: Vec3,
    pub(crate) geometry: Arc<Geometry>,
}

/// For which tiles some casters are asked, where something clear lets colours pass differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Occasion {
    /// All colours meet the same casters.
    Always,
    /// Nothing clear may stand between the light and the tile: the casters of one colour serve all.
    Untinted,
    /// Something clear may.
    Tinted,
}

/// Triangles of clear materials that share a box.
const TRIANGLES_A_BOX: usize = 16;

/// Where what is clear stands.
#[derive(Default)]
pub(crate) struct ClearBoxes {
    list: Vec<Box3>,
    /// Longer than the way through the scene.
    reach: f64,
}

/// Where light comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Origin {
    /// A lamp is within this box.
    Within(Box3),
    /// The way that the light travels.
    Direction(DVec3),
}

impl ClearBoxes {
    pub(crate) fn new(scene: &Scene) -> Self {
        let mesh = &scene.mesh;
        let is_clear = |&t: &u32| {
            let material = &scene.materials[mesh.material(t) as usize];
            material.details.transmission.is_some_and(|t| t.color != Vec3::ZERO)
        };
        let around = |triangles: &[u32]| {
            let corners = triangles.iter().flat_map(|&t| scene.corners(t));
            corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
        };
        let clear: Vec<u32> = mesh.numbers().filter(is_clear).collect();
        let list = clear.chunks(TRIANGLES_A_BOX).map(around).collect();
        let (low, high) = mesh
            .world_positions()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        Self { list, reach: 2.0 * (high - low).length() }
    }

    /// Whether something clear may stand between a light and what is in a box.
    pub(crate) fn may_tint(&self, origin: Origin, receivers: Box3) -> bool {
        let light = match origin {
            Origin::Within(around) => around,
            Origin::Direction(direction) => {
                let back = direction.normalize_or_zero() * self.reach;
                (receivers.0 - back, receivers.1 - back)
            }
        };
        let shaft = Shaft::new(light, receivers);
        self.list.iter().any(|&clear| shaft.may_hold(clear))
    }
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
        casters.push(Casters { channels, geometry: Arc::new(geometry.with_opacities(opacity)?) });
    }
    Ok(casters)
}
