//! Places to whose light probes are fitted: anywhere between them, and on the surfaces around.

use crate::prepared::Prepared;
use crate::solids::Solids;
use glam::DVec3;
use pointillist_shprobe::place;

/// Tries for each place that is wanted: most may be in solids.
const TRIES: usize = 8;

/// Of the random places.
const SEED: u64 = 1;

/// How far beyond the box that the probes span surfaces count, over its diagonal: walls are a little outside.
const MARGIN: f64 = 0.15;

/// Height above the surface at which its light is looked at, over the diagonal of that box: the surface itself is not in
/// front, and the light is the same as on it.
const HEIGHT: f64 = 5e-4;

/// Places, and the unit normal of the surface that each is on; 0 in free space.
#[derive(Default)]
pub(crate) struct FitPlaces {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) normals: Vec<DVec3>,
}

/// `count` free places: half of them anywhere in the box that the probes span, half on surfaces in and about it, by area;
/// fewer where few are free.
pub(crate) fn fit_places(
    probes: &[DVec3],
    count: usize,
    prepared: &Prepared<'_>,
    solids: &Solids<'_>,
) -> FitPlaces {
    if probes.is_empty() || count == 0 {
        return FitPlaces::default();
    }
    let on_surfaces = on_surfaces(probes, count / 2, prepared, solids);
    let (low, high) = box_of(probes);
    let tries = place::random(low, high, count.saturating_mul(TRIES), SEED);
    let between = tries.into_iter().filter(|&p| solids.is_free(p)).take(count - on_surfaces.len());
    let mut places = FitPlaces { positions: between.collect(), normals: vec![] };
    places.normals = vec![DVec3::ZERO; places.positions.len()];
    for (position, normal) in on_surfaces {
        places.positions.push(position);
        places.normals.push(normal);
    }
    places
}

fn box_of(positions: &[DVec3]) -> (DVec3, DVec3) {
    let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    positions.iter().fold(infinite, |(l, h), &p| (l.min(p), h.max(p)))
}

/// Up to `count` places just above triangles in and about the box of the probes, on the side that they face, and that
/// side's normal.
pub(crate) fn on_surfaces(
    probes: &[DVec3],
    count: usize,
    prepared: &Prepared<'_>,
    solids: &Solids<'_>,
) -> Vec<(DVec3, DVec3)> {
    let mesh = &prepared.scene.mesh;
    let (low, high) = box_of(probes);
    let diagonal = (high - low).length();
    let (low, high) = (low - MARGIN * diagonal, high + MARGIN * diagonal);
    let mut sum = 0.0;
    let areas: Vec<f64> = mesh
        .numbers()
        .map(|t| {
            let [a, b, c] = mesh.corners(t);
            // What is far beyond the box would take all the places, and is refused below.
            let is_near = a.min(b).min(c).cmple(high).all() && a.max(b).max(c).cmpge(low).all();
            sum += if is_near { 0.5 * (b - a).cross(c - a).length() } else { 0.0 };
            sum
        })
        .collect();
    if !(sum > 0.0 && sum.is_finite()) {
        return vec![];
    }
    let place = |r: DVec3| {
        let index = areas.partition_point(|a| *a <= r.x * sum).min(areas.len() - 1);
        let [a, b, c] = mesh.corners(index as u32);
        // Uniform on the triangle: what is beyond the diagonal of the parallelogram is folded back.
        let (u, v) = if r.y + r.z > 1.0 { (1.0 - r.y, 1.0 - r.z) } else { (r.y, r.z) };
        let normal = (b - a).cross(c - a).normalize_or_zero();
        (a + (b - a) * u + (c - a) * v + normal * (HEIGHT * diagonal), normal)
    };
    let is_good = |(p, normal): &(DVec3, DVec3)| {
        *normal != DVec3::ZERO && p.cmpge(low).all() && p.cmple(high).all() && solids.is_free(*p)
    };
    let tries = place::random(DVec3::ZERO, DVec3::ONE, count.saturating_mul(TRIES), SEED + 1);
    tries.into_iter().map(place).filter(is_good).take(count).collect()
}
