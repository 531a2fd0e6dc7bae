//! Captures of the scene for the objects that mirror it.

use crate::capture::CaptureOptions;
use crate::error::RenderError;
use crate::monitor::{Monitor, Part};
use crate::prepared::{Prepared, PreparedMaps};
use crate::reflections::{Reflections, mirrors};
use crate::scene::{Scene, Surroundings};
use crate::shader::Glow;
use glam::{DVec3, Vec3};
use pointillist_shade::CubeMap;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Pixels on a side of the six pictures: a third of a degree each.
const RESOLUTION: u32 = 256;

/// An object and a material that mirrors its surroundings, with the box of what has both.
type Mirrors = BTreeMap<(u32, u32), (DVec3, DVec3)>;

fn find(scene: &Scene) -> Mirrors {
    let captures: Vec<bool> = scene
        .materials
        .iter()
        .map(|m| m.details.surroundings == Surroundings::Capture && mirrors(m))
        .collect();
    let mut found = Mirrors::new();
    if !captures.contains(&true) {
        return found;
    }
    let mesh = &scene.mesh;
    for t in mesh.numbers() {
        let material = mesh.material(t);
        if captures[material as usize] {
            let key = (mesh.object(t), material);
            let around = found.entry(key).or_insert((DVec3::INFINITY, DVec3::NEG_INFINITY));
            for p in mesh.corners(t) {
                *around = (around.0.min(p), around.1.max(p));
            }
        }
    }
    found
}

impl<'a> Prepared<'a> {
    /// Prepares a scene for any number of pictures and captures: textures are summed up, geometry is sorted into clusters, and
    /// what mirrors that ask for it ([`Surroundings::Capture`]) show is drawn.
    ///
    /// # Errors
    /// [`RenderError`] if the scene, its geometry or a texture is refused, or the monitor cancels.
    pub fn new(scene: &'a Scene, monitor: &dyn Monitor) -> Result<Self, RenderError> {
        let mut prepared = Self::without_captures(scene, None, monitor)?;
        prepared.capture_mirrors(&Part(monitor))?;
        Ok(prepared)
    }

    /// As [`Prepared::new`], for a scene that differs from the one before in the positions and normals of its mesh, in its camera, its picture and
    /// its lights only: textures stay summed up. Pictures are those of [`Prepared::new`], to the last bit.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    ///
    /// # Panics
    /// If the scene has another number of triangles, materials or textures.
    pub fn with_maps(
        scene: &'a Scene,
        maps: &PreparedMaps,
        monitor: &dyn Monitor,
    ) -> Result<Self, RenderError> {
        maps.check(scene);
        let mut prepared = Self::without_captures(scene, Some(maps), monitor)?;
        prepared.capture_mirrors(&Part(monitor))?;
        Ok(prepared)
    }

    /// Looks around from the middle of every object that mirrors the scene, with the object itself away. Other such objects
    /// show the scene's environment there: light is mirrored once.
    fn capture_mirrors(&mut self, monitor: &dyn Monitor) -> Result<(), RenderError> {
        let found = find(self.scene);
        if found.is_empty() {
            return Ok(());
        }
        let mut captured = Reflections::clone(&self.reflections);
        for ((object, material), (low, high)) in found {
            let geometry = self.surfaces.geometry_without(self.scene, object)?;
            let others = self.with_geometry(geometry)?;
            let options = CaptureOptions {
                resolution: RESOLUTION,
                emission: true,
                thorough: true,
                ..CaptureOptions::DEFAULT
            };
            let middle = low + 0.5 * (high - low);
            let capture = others.look_around(middle, options, others.ambient(), Glow::Everything, monitor)?;
            let [r, g, b] = &capture.radiance;
            let texels: Vec<Vec3> = (0..r.len()).map(|i| Vec3::new(r[i], g[i], b[i])).collect();
            let cube = CubeMap::new(RESOLUTION, &texels).expect("a capture has all its texels");
            captured.add_captured(object, material, cube, self.scene);
            monitor.count("mirrors_captured", 1);
        }
        self.reflections = Arc::new(captured);
        Ok(())
    }
}
