//! Cones that hold the normals of a block.

use glam::{Mat3, Vec3};

/// All normals of a block lie within `half_angle` of `axis`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cone {
    pub(crate) axis: Vec3,
    /// Radians, the safety margin included.
    pub(crate) half_angle: f32,
}

/// Neighbours lie within this many spacings: about 28 points of a regular scan.
const REACH: f32 = 3.0;

/// The same where fewer are found: a scan that meets its surface at a slant has points several times
/// farther apart in one direction.
const WIDER: [f32; 3] = [REACH, 2.0 * REACH, 4.0 * REACH];

/// Fewest neighbours from which a normal is estimated.
const LEAST_NEIGHBOURS: usize = 6;

/// A neighbourhood is a surface if it is this much thinner than wide (ratio of the standard deviations).
const FLATNESS: f32 = 0.35;

/// Radians added for what a plane fit misses of the surface's own normals: with it, no point of a surface whose radius
/// of curvature is above 2γ is dropped while it can touch a pixel of the visible side (see
/// `culling_changes_nothing_on_a_sphere` in the tests).
const MARGIN_RAD: f32 = 0.35;

/// Cosine between a normal and the direction to the scanner below which the normal cannot be told from its opposite.
const MOST_INCIDENCE_COS: f32 = 0.1;

/// The cone of the normals of a block, or none where they cannot be trusted: neighbourhoods that are
/// no surface, or too steep to know the side that was seen.
pub(crate) fn of_points(offsets: [&[f32]; 3], spacing: f64, towards_scanner: Vec3) -> Option<Cone> {
    let count = offsets[0].len();
    let at = |i: usize| Vec3::new(offsets[0][i], offsets[1][i], offsets[2][i]);
    let mut near = Vec::with_capacity(count);
    let mut normals = Vec::new();
    // Every point lies within reach of one that has a plane. With a plane at every n-th point only, steep parts of a
    // scan, where points lie far apart, would be missed.
    let mut is_covered = vec![false; count];
    for i in 0..count {
        if is_covered[i] {
            continue;
        }
        let centre = at(i);
        for reach in WIDER {
            let reach2 = (reach * spacing as f32).powi(2);
            near.clear();
            near.extend((0..count).filter(|&j| at(j).distance_squared(centre) <= reach2));
            if reach == REACH {
                near.iter().for_each(|&j| is_covered[j] = true);
            }
            if near.len() >= LEAST_NEIGHBOURS {
                break;
            }
        }
        if near.len() < LEAST_NEIGHBOURS {
            // An outlier, or a strip of the surface that continues in another block: its normal is unknown.
            return None;
        }
        normals.push(normal(near.iter().map(|&j| at(j)), towards_scanner)?);
    }
    let axis = normals.iter().sum::<Vec3>().try_normalize()?;
    let widest = normals.iter().map(|n| n.dot(axis)).fold(1.0, f32::min);
    Some(Cone { axis, half_angle: widest.clamp(-1.0, 1.0).acos() + MARGIN_RAD })
}

/// Normal of the least-squares plane, on the scanner's side.
fn normal(points: impl Iterator<Item = Vec3> + Clone, towards_scanner: Vec3) -> Option<Vec3> {
    let mean = points.clone().sum::<Vec3>() / points.clone().count() as f32;
    let mut scatter = Mat3::ZERO;
    for p in points {
        let d = p - mean;
        scatter += Mat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let (n, least, middle) = least_axis(scatter)?;
    let flat = least <= FLATNESS * FLATNESS * middle;
    let side = n.dot(towards_scanner);
    (flat && side.abs() >= MOST_INCIDENCE_COS).then(|| n * side.signum())
}

/// Unit eigenvector of the least eigenvalue, that eigenvalue and the middle one.
fn least_axis(m: Mat3) -> Option<(Vec3, f32, f32)> {
    // The trigonometric form of the roots of a symmetric 3×3 matrix's characteristic polynomial.
    let trace = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let shifted = m - Mat3::from_diagonal(Vec3::splat(trace));
    let p2 =
        (shifted.x_axis.length_squared() + shifted.y_axis.length_squared() + shifted.z_axis.length_squared())
            / 6.0;
    let p = p2.sqrt();
    if !(p > 0.0 && p.is_finite()) {
        return None;
    }
    let r = 0.5 * (shifted * (1.0 / p)).determinant();
    let phi = r.clamp(-1.0, 1.0).acos() / 3.0;
    let root = |k: f32| trace + 2.0 * p * (phi + k * std::f32::consts::TAU / 3.0).cos();
    let (most, least) = (root(0.0), root(1.0));
    let middle = 3.0 * trace - most - least;
    let s = m - Mat3::from_diagonal(Vec3::splat(least));
    // The rows span the plane that the eigenvector is normal to: take the longest cross product.
    let crosses = [s.x_axis.cross(s.y_axis), s.y_axis.cross(s.z_axis), s.z_axis.cross(s.x_axis)];
    let best = crosses.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    Some((best.try_normalize()?, least.max(0.0), middle))
}
