//! What is estimated for clouds that come with positions alone.

use super::check;
use crate::neighbours::Places;
use crate::{areas, normals, radius};
use glam::{DVec3, Vec3};

/// What is estimated for a cloud of positions: each list in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimates {
    /// Unit normals, those of one surface on one side.
    pub normals: Vec<Vec3>,
    /// Which of them stand on the outside of a closed surface.
    pub have_outside: Vec<bool>,
    /// Radii of discs, the cloud's unit.
    pub radii: Vec<f32>,
    /// Shares of the surface, the square of the cloud's unit.
    pub areas: Vec<f32>,
}

/// Normals, radii and areas of finite positions.
#[must_use]
pub fn estimates(positions: &[DVec3]) -> Estimates {
    let places = Places::new(positions);
    let (normals, have_outside): (Vec<Vec3>, Vec<bool>) =
        normals::estimate(&places).into_iter().map(|n| (n.way, n.has_outside)).unzip();
    let radii = radius::of_cloud(&places, &normals, true, None);
    let areas = areas::of_cloud(&places, &normals, &radii, true);
    Estimates { normals, have_outside, radii, areas }
}

/// Any finite positions have unit normals, and radii and areas that are normal numbers, the same ones in any order.
///
/// # Errors
/// The first point for which that does not hold.
pub fn estimates_are_sound(positions: &[DVec3]) -> Result<(), String> {
    let own = estimates(positions);
    let Estimates { normals, radii, areas, .. } = &own;
    for (i, normal) in normals.iter().enumerate() {
        check((normal.length() - 1.0).abs() < 1e-6, || format!("normal {normal}"))?;
        let (radius, area) = (radii[i], areas[i]);
        check(radius.is_normal() && radius > 0.0, || format!("radius {radius:e}"))?;
        check(area.is_normal() && area > 0.0, || format!("area {area:e}"))?;
    }
    let mut backwards = positions.to_vec();
    backwards.reverse();
    let mut other = estimates(&backwards);
    other.normals.reverse();
    other.have_outside.reverse();
    other.radii.reverse();
    other.areas.reverse();
    check(other == own, || "the order matters".to_owned())
}

/// All estimated normals are on the side of these vectors, one for each point, and have an outside exactly if `closed`; where the vectors say nothing
/// of the outside (a flat surface), all are on their side or none is.
///
/// # Errors
/// How many are not.
pub fn sides_are_found(positions: &[DVec3], outwards: &[DVec3], closed: bool) -> Result<(), String> {
    let Estimates { normals, have_outside, .. } = estimates(positions);
    let wrong = normals.iter().zip(outwards).filter(|(n, out)| n.as_dvec3().dot(**out) <= 0.0).count();
    let is_right = wrong == 0 || !closed && wrong == positions.len();
    check(is_right, || format!("{wrong} of {} normals are on the wrong side", positions.len()))?;
    let count = have_outside.iter().filter(|has| **has).count();
    let wanted = if closed { positions.len() } else { 0 };
    check(count == wanted, || format!("{count} of {} points have an outside", positions.len()))
}

/// Areas of points with normals and radii: where a normal has a front and a back, and where it has not.
#[must_use]
pub fn areas_by_sides(positions: &[DVec3], normals: &[Vec3], radii: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let places = Places::new(positions);
    let by = |two_sided| areas::of_cloud(&places, normals, radii, two_sided);
    (by(false), by(true))
}

/// Given normals and radii of any size give areas that are normal numbers, on surfaces with sides and without.
///
/// # Errors
/// The first area that is none.
pub fn areas_are_sound(positions: &[DVec3], normals: &[Vec3], radii: &[f32]) -> Result<(), String> {
    let places = Places::new(positions);
    let (one, two) = areas_by_sides(positions, normals, radii);
    for area in one.into_iter().chain(two) {
        check(area.is_normal() && area > 0.0, || format!("area {area:e}"))?;
    }
    for two_sided in [false, true] {
        for radius in radius::of_cloud(&places, normals, two_sided, None) {
            check(radius.is_normal() && radius > 0.0, || format!("radius {radius:e}"))?;
        }
    }
    Ok(())
}

/// Mean and deviation, over some places of a surface, of the sum of kernels that have the areas of the points around.
#[must_use]
pub fn kernel_sum(positions: &[DVec3], estimates: &Estimates, probes: &[DVec3]) -> (f64, f64) {
    let sums: Vec<f64> = probes.iter().map(|&probe| kernel_sum_at(positions, estimates, probe)).collect();
    let mean = sums.iter().sum::<f64>() / sums.len() as f64;
    let variance = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / sums.len() as f64;
    (mean, variance.sqrt())
}

fn kernel_sum_at(positions: &[DVec3], estimates: &Estimates, probe: DVec3) -> f64 {
    let of_point = |(i, p): (usize, &DVec3)| {
        let radius = 2.0 * areas::SIGMA_PER_RADIUS * f64::from(estimates.radii[i]);
        let offset = probe - p;
        let height = offset.dot(estimates.normals[i].as_dvec3());
        let share = (offset.length_squared() - height * height) / (radius * radius);
        // Nearer than a few radii: not the other side of the thing.
        let counts = share < 1.0 && height.abs() < 2.0 * radius;
        let kernel = (1.0 - share).powi(2) / (std::f64::consts::PI * radius * radius / 3.0);
        if counts { f64::from(estimates.areas[i]) * kernel } else { 0.0 }
    };
    positions.iter().enumerate().map(of_point).sum()
}

/// The kernel sum at places of a surface is near 1: its mean to within `off`, its deviation at most `ripple`.
///
/// # Errors
/// Mean and deviation.
pub fn areas_reproduce_constants(
    positions: &[DVec3],
    probes: &[DVec3],
    off: f64,
    ripple: f64,
) -> Result<(), String> {
    let (mean, deviation) = kernel_sum(positions, &estimates(positions), probes);
    let holds = (mean - 1.0).abs() <= off && deviation <= ripple;
    check(holds, || format!("kernels add up to {mean:.4} ± {deviation:.4}"))
}
