//! Meshes given to `scan`: sampled as points and joined to the scans.

use super::mesh_points::Needed;
use super::{LoadedScan, POINT_BYTES};
use crate::input;
use crate::input_error::InputError;
use crate::memory;
use crate::scene::{self, Camera, Overrides, Scene};
use glam::DVec3;
use std::path::Path;

/// Most points that all meshes together get: several for each pixel of a large picture.
const MOST_POINTS: f64 = 8e6;

/// How many times too many points are counted on the way to a coarser spacing.
const ENOUGH: f64 = 16.0;

/// Points that are farther apart are fewer than this share of what they were before, unless triangles have one each.
const FEWER: f64 = 0.95;
/// How far apart points may get, as a factor: then every triangle has one.
const COARSEST: f64 = 1e6;

/// A mesh without points.
#[derive(Clone, Debug)]
pub(super) struct LoadedMesh {
    name: String,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    /// Diffuse colours of the triangles.
    colours: Vec<[f32; 3]>,
}

impl LoadedMesh {
    pub(super) fn load(path: &Path) -> Result<Self, InputError> {
        let Scene { mesh, materials, .. } = scene::load(path, &Overrides::default())?.scene;
        let colour = |material: &u32| {
            materials.get(*material as usize).map_or([0.8; 3], |m| m.surface.diffuse.to_array())
        };
        let colours = mesh.material_of.iter().map(colour).collect();
        let name = input::name_of(path);
        Ok(Self { name, positions: mesh.positions, triangles: mesh.triangles, colours })
    }

    /// The mesh, if there is anything to put points on.
    pub(super) fn with_area(self) -> Result<Self, InputError> {
        if self.faces().next().is_some() {
            return Ok(self);
        }
        let error = InputError::of_file(self.name, "has no area to put points on");
        Err(error.with_help("--vertices takes its vertices as points"))
    }

    pub(super) fn into_vertices(self, spacing: Option<f64>) -> LoadedScan {
        LoadedScan { positions: self.positions, name: self.name, spacing, ..LoadedScan::default() }
    }

    /// The vertices that triangles use, as often as they do.
    pub(super) fn corners(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.triangles.iter().flatten().map(|&v| self.positions[v as usize])
    }

    /// Corners and colours of the triangles that have an area.
    fn faces(&self) -> impl Iterator<Item = ([DVec3; 3], [f32; 3])> + '_ {
        let corners = self.triangles.iter().map(|t| t.map(|v| self.positions[v as usize]));
        corners.zip(self.colours.iter().copied()).filter(|([a, b, c], _)| (b - a).cross(c - a) != DVec3::ZERO)
    }

    /// At most `most` points, and a warning if they had to be farther apart than they should.
    pub(super) fn covered(
        &self,
        camera: &Camera,
        size: [u32; 2],
        least: Option<f64>,
        most: f64,
    ) -> (LoadedScan, Option<String>) {
        let (needed, coarser) = self.within(Needed::new(camera, size, least.unwrap_or_default()), most);
        let mut scan = LoadedScan { name: self.name.clone(), ..LoadedScan::default() };
        let mut lengths = 0.0;
        for (corners, colour) in self.faces() {
            needed.pieces(corners, &mut |piece| {
                let before = scan.positions.len();
                piece.fill(&mut scan.positions);
                lengths += piece.spacing * (scan.positions.len() - before) as f64;
            });
            scan.colours.resize(scan.positions.len(), colour);
        }
        let count = scan.positions.len();
        scan.spacing =
            Some(coarser * least.unwrap_or(lengths / count as f64)).filter(|s| *s > 0.0 && s.is_finite());
        if let Some((corners, colour)) = self.faces().next().filter(|_| count == 0) {
            // Nothing is in view: a point that is not in view either.
            (scan.positions, scan.colours) = (vec![corners[0]], vec![colour]);
        }
        let warning = (coarser > 1.0).then(|| {
            let Self { name, .. } = self;
            format!(
                "{name}: gets {count} points, {coarser:.1} times as far apart as asked for, because more would be too many; a larger \
                 --spacing or a smaller --size needs fewer"
            )
        });
        (scan, warning)
    }

    /// Makes points farther apart until they are at most `most`, or one for each triangle; by how much comes back, too.
    fn within(&self, needed: Needed, most: f64) -> (Needed, f64) {
        let (mut coarser, mut before) = (1.0, f64::INFINITY);
        loop {
            let candidate = needed.coarser(coarser);
            let count = self.count(&candidate, ENOUGH * most);
            let is_least = count > FEWER * before && count < ENOUGH * most;
            if count <= most || is_least || coarser > COARSEST {
                return (candidate, coarser);
            }
            coarser *= (count / most).sqrt() * 1.02;
            before = count;
        }
    }

    /// How many points there would be at most; the count ends beyond `enough`.
    fn count(&self, needed: &Needed, enough: f64) -> f64 {
        let mut count = 0.0;
        for (corners, _) in self.faces() {
            needed.pieces(corners, &mut |piece| count += piece.most_points());
            if count > enough {
                break;
            }
        }
        count
    }
}

/// How many points each mesh may have.
pub(super) fn shares(meshes: &[LoadedMesh]) -> Vec<f64> {
    let fits =
        memory::available_bytes().map_or(f64::INFINITY, |bytes| bytes as f64 / (2 * POINT_BYTES) as f64);
    // Evenly: what one mesh leaves over is not worth a second look at all of them.
    vec![MOST_POINTS.min(fits).max(1.0) / meshes.len() as f64; meshes.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Projection;

    #[test]
    fn too_many_points_are_made_fewer_and_told() {
        let mesh = LoadedMesh {
            name: "floor.obj".to_owned(),
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![[0, 1, 2]],
            colours: vec![[0.8; 3]],
        };
        let projection = Projection::Perspective { fov_y_rad: 0.5 };
        let camera = Camera { eye: 4.0 * DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, projection };
        let covered = |most| mesh.covered(&camera, [500, 500], None, most);
        let (all, warning) = covered(1e9);
        assert!(all.positions.len() > 10_000 && warning.is_none(), "{} {warning:?}", all.positions.len());
        let (few, warning) = covered(1000.0);
        assert!((300..=1000).contains(&few.positions.len()), "{}", few.positions.len());
        assert!(few.spacing > all.spacing);
        let warning = warning.expect("it is told");
        assert!(
            warning.starts_with("floor.obj: gets ") && warning.contains("times as far apart"),
            "{warning}"
        );
    }
    #[test]
    fn a_mesh_of_more_triangles_than_points_gets_one_for_each() {
        let strip = |i: u32| DVec3::new(f64::from(i / 2) * 0.01, f64::from(i % 2), 0.0);
        let mesh = LoadedMesh {
            name: "strip.obj".to_owned(),
            positions: (0..102).map(strip).collect(),
            triangles: (0..100).map(|i| [i, i + 1, i + 2]).collect(),
            colours: vec![[0.8; 3]; 100],
        };
        let projection = Projection::Perspective { fov_y_rad: 0.9 };
        let camera = Camera { eye: 4.0 * DVec3::Z, target: DVec3::ZERO, up: DVec3::Y, projection };
        let (scan, warning) = mesh.covered(&camera, [500, 500], None, 10.0);
        assert_eq!(scan.positions.len(), 100);
        assert!(warning.is_some());
    }
}
