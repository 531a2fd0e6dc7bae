//! Probes inside of solids see nothing but backs: they are found, and moved or refused.

use crate::error::CliError;
use crate::options::Inside;
use crate::scene::Scene;
use glam::{DVec3, dvec3};
use pointillist_render::Prepared;
use pointillist_shade::Source;

/// Distances that are tried to get out of a solid, as shares of the scene's diagonal.
const STEPS: [f64; 10] = [0.001, 0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128, 0.256, 0.512];

/// Tells which positions lie in matter.
pub(super) struct Solids<'a> {
    prepared: &'a Prepared<'a>,
    /// Closed components with a light or the camera in them: rooms whose walls have no thickness.
    rooms: Vec<u32>,
    diagonal: f64,
}

/// What became of a probe inside a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    /// It is not in a solid.
    Free,
    /// It was, and this is the nearest free place that was found.
    Moved(DVec3),
    /// It is, and stays or goes as the user wants.
    Kept,
    /// It is left out.
    Dropped,
}

impl<'a> Solids<'a> {
    pub(super) fn new(prepared: &'a Prepared<'a>, scene: &Scene) -> Self {
        let lights = scene.lights.iter().filter_map(|l| match l.light.source(0) {
            Source::Position(p) => Some(p),
            _ => None,
        });
        let inside = lights.chain([scene.camera.eye]);
        let mut rooms: Vec<u32> = inside.flat_map(|p| prepared.geometry().solids_around(p)).collect();
        rooms.sort_unstable();
        rooms.dedup();
        let bounds = prepared.geometry().bounds();
        Self { prepared, rooms, diagonal: (bounds.high - bounds.low).length() }
    }

    /// Whether it lies in no solid.
    pub(super) fn is_free(&self, p: DVec3) -> bool {
        self.prepared.geometry().solids_around(p).iter().all(|solid| self.rooms.contains(solid))
    }

    /// Deals with probe number `index`.
    pub(super) fn settle(&self, index: usize, p: DVec3, inside: Inside) -> Result<Outcome, CliError> {
        if inside == Inside::Keep || self.is_free(p) {
            return Ok(if inside == Inside::Keep { Outcome::Kept } else { Outcome::Free });
        }
        match inside {
            Inside::Drop => Ok(Outcome::Dropped),
            Inside::Move => self.nearest_free(p).map(Outcome::Moved).ok_or_else(|| refusal(index, p)),
            Inside::Refuse | Inside::Keep => Err(refusal(index, p)),
        }
    }

    /// The first free place on ever larger spheres around `p`, and as far again from where it gets free.
    fn nearest_free(&self, p: DVec3) -> Option<DVec3> {
        let steps = STEPS.iter().map(|s| s * self.diagonal);
        let place = |step: f64| directions().map(move |d| p + d * step);
        steps.flat_map(place).find(|&q| self.is_free(q)).map(|q| {
            let further = q + (q - p) * 0.5;
            if self.is_free(further) { further } else { q }
        })
    }
}

fn refusal(index: usize, p: DVec3) -> CliError {
    CliError::Failed(format!(
        "probe {index} at {}, {}, {} is inside of a solid\n  = help: move it, or use --inside drop; \
         if the solid is a room, turn its faces inward or put a light or the camera into it",
        p.x, p.y, p.z
    ))
}

/// To the middles of the faces, edges and corners of a cube, faces first.
fn directions() -> impl Iterator<Item = DVec3> {
    let all = (0..27).map(|i| dvec3(f64::from(i % 3 - 1), f64::from(i / 3 % 3 - 1), f64::from(i / 9 - 1)));
    let mut sorted: Vec<DVec3> = all.filter(|d| *d != DVec3::ZERO).collect();
    sorted.sort_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
    sorted.into_iter().map(DVec3::normalize)
}
