//! Where the outside of a surface is, and whether it has one.
//!
//! From a place on a closed smooth surface half of all directions look into what it encloses: the solid angle of the surface,
//! seen from there, is half of the whole sphere, ½, and −½ if its normals stand on the inner side. Of a plane it is 0, and of half a sphere ¼ to
//! 0.35. (The same that winding numbers are made of: A. Jacobson, L. Kavan, O. Sorkine-Hornung, *Robust inside-outside segmentation using generalized
//! winding numbers*, SIGGRAPH 2013.) It is summed up for some places of each surface, from the areas of all its points.

use crate::neighbours::Places;
use crate::orient::Orientation;
use glam::DVec3;
use pointillist_parallel as parallel;
use std::f64::consts::PI;

/// From how many parts of a surface it is looked at.
const LOOKS: usize = 128;

/// Neighbouring places that look together: by noise, each is off the surface and sees too much of its other neighbours, or too little.
const LOOKERS: usize = 8;

/// A surface of fewer places is not said to be closed.
const FEWEST: usize = 64;

/// How far the solid angle of a closed surface may be from ½: what spacing and noise do to it.
const TOLERANCE: f64 = 0.15;

/// The share of looks that may find another one: those beside holes.
const BESIDE_HOLES: f64 = 0.1;

/// Solid angles nearer to 0 than this do not say which side is outside.
const FLAT: f64 = 0.02;

/// Places that are summed up as one for those who look from afar.
const RUN: usize = 32;

/// From how many radii of a run on.
const AFAR: f64 = 4.0;

/// A part of a surface: its area times its normal, and where it is.
#[derive(Clone, Copy)]
struct Patch {
    way: DVec3,
    centre: DVec3,
}

impl Patch {
    /// Its solid angle from a place, in parts of the sphere.
    fn seen_from(&self, place: DVec3) -> f64 {
        let offset = self.centre - place;
        let distance2 = offset.length_squared();
        let angle = offset.dot(self.way) / (4.0 * PI * distance2 * distance2.sqrt());
        // The place itself has none, and neither has what is too near for squares of its distance.
        if angle.is_finite() { angle } else { 0.0 }
    }
}

/// Neighbouring places.
struct Run<'a> {
    sum: Patch,
    radius: f64,
    places: &'a [Patch],
}

impl<'a> Run<'a> {
    fn new(places: &'a [Patch]) -> Self {
        let centre = places.iter().map(|p| p.centre).sum::<DVec3>() / places.len() as f64;
        let radius = places.iter().map(|p| p.centre.distance(centre)).fold(0.0, f64::max);
        let way = places.iter().map(|p| p.way).sum();
        Self { sum: Patch { way, centre }, radius, places }
    }

    fn seen_from(&self, place: DVec3) -> f64 {
        if self.sum.centre.distance(place) > AFAR * self.radius {
            self.sum.seen_from(place)
        } else {
            self.places.iter().map(|p| p.seen_from(place)).sum()
        }
    }
}

/// Turns the normals of each surface to its outside, if it has one: a closed surface has, and a bent one, more or less; the others
/// get the side on which most of the surface faces along the axis that it faces most. Says of each place whether it is on the outside of a closed surface beyond
/// dispute.
/// `areas` are those of the places.
pub(crate) fn face_outwards(
    places: &Places,
    normals: &mut [DVec3],
    areas: &[f64],
    orientation: &Orientation,
) -> Vec<bool> {
    normals.iter_mut().zip(&orientation.turned).filter(|(_, turned)| **turned).for_each(|(n, _)| *n = -*n);
    // Surface by surface, each in the order of places: neighbours follow one another.
    let mut order: Vec<u32> = (0..places.len() as u32).collect();
    order.sort_by_key(|&place| orientation.surfaces[place as usize]);
    let mut has_outside = vec![false; places.len()];
    for surface in
        order.chunk_by(|&a, &b| orientation.surfaces[a as usize] == orientation.surfaces[b as usize])
    {
        let patch = |&i: &u32| {
            let i = i as usize;
            Patch { way: normals[i] * areas[i], centre: places.at(i) }
        };
        let patches: Vec<Patch> = surface.iter().map(patch).collect();
        let (sign, closed) = outside(&patches);
        for &place in surface {
            normals[place as usize] *= sign;
            has_outside[place as usize] = closed && !orientation.disputed[place as usize];
        }
    }
    has_outside
}

/// By which sign normals are to be multiplied, and whether the surface is closed.
fn outside(patches: &[Patch]) -> (f64, bool) {
    let runs: Vec<Run<'_>> = patches.chunks(RUN).map(Run::new).collect();
    let count = patches.len().div_ceil(LOOKERS).min(LOOKS);
    let angles = parallel::map_heavy(count, |look| {
        let first = look * patches.len() / count;
        let lookers = &patches[first..patches.len().min(first + LOOKERS)];
        let seen = |looker: &Patch| runs.iter().map(|run| run.seen_from(looker.centre)).sum::<f64>();
        lookers.iter().map(seen).sum::<f64>() / lookers.len() as f64
    });
    let mean = angles.iter().sum::<f64>() / count as f64;
    let facing: DVec3 = patches.iter().map(|p| p.way).sum();
    let most = facing[facing.abs().max_position()];
    let sign = if mean.abs() > FLAT {
        mean.signum()
    } else if most < 0.0 {
        -1.0
    } else {
        1.0
    };
    let misses = angles.iter().filter(|angle| (*angle * sign - 0.5).abs() > TOLERANCE).count();
    (sign, patches.len() >= FEWEST && misses as f64 <= BESIDE_HOLES * count as f64)
}
