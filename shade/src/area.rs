//! Light from a polygon that is seen from a point, by quadrature: what a BRDF that is no constant makes of it.
//!
//! 1. The polygon is divided into quadrangles, and these into cells, until a cell is small against its distance and, as seen from the
//!    point, against the width of the BRDF's lobe or its distance from the lobe's axis, whichever is larger.
//! 2. Each cell gets 1, 2 × 2 or 3 × 3 Gauss points, by how small it is.

use crate::light::{direction_and_length, scaled};
use crate::{Falloff, Incident, Source};
use glam::{DVec3, Vec3};

/// Largest cell, relative to its distance and to the scale of the lobe. Found by experiment: 3 × 3 points then give a GGX lobe of any
/// roughness to 1e-3 of its value (`tests/area.rs`).
const LARGEST_CELL: f64 = 1.0;

/// Lobes wider than this count as this wide, in radians: cosines and distances change, too.
const WIDEST: f64 = 0.7;

/// Cells up to this part of [`LARGEST_CELL`] need 2 × 2 points.
const FOUR_POINTS: f64 = 0.4;

/// Cells up to this part of [`LARGEST_CELL`] need one point.
const ONE_POINT: f64 = 0.08;

/// How often a quadrangle is divided into four at most.
const MOST_DIVISIONS: u32 = 10;

/// A lobe of a BRDF for one direction to the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Unit vector towards the largest value.
    pub axis: Vec3,
    /// Angle over which the BRDF changes by about its own size near the axis, in radians.
    pub width_rad: f32,
}

/// A polygonal light's own quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Unit normal of the side that shines.
    pub front: DVec3,
    /// Radiance of that side.
    pub radiance: Vec3,
    /// How each point of it weakens with distance.
    pub falloff: Falloff,
}

/// The sum of `reflect` over what arrives from a convex planar polygon, whose vertices are relative to the point.
///
/// `reflect` gets light as from [`crate::Light::illuminate`] and returns what the surface makes of it, as [`crate::Material::reflect`]
/// does. Error: about 1e-3 of the lobe's part where the lobe's width is right; a few tens of calls for a lobe wider than the light.
pub fn integrate_polygon(
    ring: &[DVec3],
    emission: &Emission,
    lobe: &Lobe,
    mut reflect: impl FnMut(&Incident) -> Vec3,
) -> Vec3 {
    let Some((&first, rest)) = ring.split_first() else { return Vec3::ZERO };
    let mut sum = DVec3::ZERO;
    let mut i = 0;
    while i + 1 < rest.len() {
        let last = rest.get(i + 2).copied();
        let quad = [first, rest[i], rest[i + 1], last.unwrap_or(first)];
        cell(&quad, MOST_DIVISIONS, emission, lobe, &mut reflect, &mut sum);
        i += 2;
    }
    sum.as_vec3()
}

/// As [`integrate_polygon`], from a line between two points relative to the point; [`Emission::radiance`] is the intensity per length, and
/// [`Emission::front`] does not matter. Parts are halved as cells are divided.
pub fn integrate_line(
    ends: [DVec3; 2],
    emission: &Emission,
    lobe: &Lobe,
    mut reflect: impl FnMut(&Incident) -> Vec3,
) -> Vec3 {
    let mut sum = DVec3::ZERO;
    line(ends, MOST_DIVISIONS, emission, lobe, &mut reflect, &mut sum);
    sum.as_vec3()
}

fn line(
    [a, b]: [DVec3; 2],
    divisions: u32,
    emission: &Emission,
    lobe: &Lobe,
    reflect: &mut impl FnMut(&Incident) -> Vec3,
    sum: &mut DVec3,
) {
    let middle = 0.5 * (a + b);
    let relative = relative_size(middle, a.distance(b), lobe);
    if relative > 1.0 && divisions > 0 {
        line([a, middle], divisions - 1, emission, lobe, reflect, sum);
        line([middle, b], divisions - 1, emission, lobe, reflect, sum);
        return;
    }
    for &(t, weight) in nodes(relative) {
        let position = a + (b - a) * t;
        let (to_light, distance) = direction_and_length(position);
        let irradiance = scaled(emission.radiance, a.distance(b) * emission.falloff.at(distance));
        if irradiance != Vec3::ZERO {
            let source = Source::Position(position);
            let incident = Incident { to_light: to_light.as_vec3(), irradiance, source };
            *sum += reflect(&incident).as_dvec3() * weight;
        }
    }
}

/// Size of a cell, relative to the largest that one set of points is enough for.
fn relative_size(centre: DVec3, size: f64, lobe: &Lobe) -> f64 {
    let (towards, distance) = direction_and_length(centre);
    let angle = size / distance.max(f64::MIN_POSITIVE);
    let axis = lobe.axis.as_dvec3();
    let away = axis.cross(towards).length().atan2(axis.dot(towards));
    let scale = f64::from(lobe.width_rad).max(away - 0.5 * angle).min(WIDEST);
    angle / (scale * LARGEST_CELL)
}

/// Step 2.
fn nodes(relative: f64) -> &'static [(f64, f64)] {
    if relative > FOUR_POINTS {
        &GAUSS_3
    } else if relative > ONE_POINT {
        &GAUSS_2
    } else {
        &GAUSS_1
    }
}

/// Step 1.
fn cell(
    quad: &[DVec3; 4],
    divisions: u32,
    emission: &Emission,
    lobe: &Lobe,
    reflect: &mut impl FnMut(&Incident) -> Vec3,
    sum: &mut DVec3,
) {
    let [a, b, c, d] = *quad;
    let centre = 0.25 * (a + b + c + d);
    let size = a.distance(c).max(b.distance(d)).max(a.distance(b)).max(c.distance(d));
    let relative = relative_size(centre, size, lobe);
    if relative > 1.0 && divisions > 0 {
        let (ab, bc, cd, da) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d), 0.5 * (d + a));
        for part in [[a, ab, centre, da], [ab, b, bc, centre], [centre, bc, c, cd], [da, centre, cd, d]] {
            cell(&part, divisions - 1, emission, lobe, reflect, sum);
        }
        return;
    }
    let nodes = nodes(relative);
    for &(u, wu) in nodes {
        for &(v, wv) in nodes {
            *sum += point(quad, u, v, emission, reflect).as_dvec3() * (wu * wv);
        }
    }
}

/// Points and weights on [0, 1].
const GAUSS_1: [(f64, f64); 1] = [(0.5, 1.0)];
const GAUSS_2: [(f64, f64); 2] = [(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)];
const GAUSS_3: [(f64, f64); 3] =
    [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];

/// What the surface makes of the light from around one point of a quadrangle, per unit of u and v.
fn point(
    quad: &[DVec3; 4],
    u: f64,
    v: f64,
    emission: &Emission,
    reflect: &mut impl FnMut(&Incident) -> Vec3,
) -> Vec3 {
    let [a, b, c, d] = *quad;
    let (low, high) = (a + (b - a) * u, d + (c - d) * u);
    let along = (b - a) * (1.0 - v) + (c - d) * v;
    let position = low + (high - low) * v;
    let area = along.cross(high - low).length();
    let (to_light, distance) = direction_and_length(position);
    let cos_light = emission.front.dot(-to_light).max(0.0);
    let strength = area * cos_light * emission.falloff.at(distance);
    let irradiance = scaled(emission.radiance, strength);
    if irradiance == Vec3::ZERO {
        return Vec3::ZERO;
    }
    reflect(&Incident { to_light: to_light.as_vec3(), irradiance, source: Source::Position(position) })
}
