//! Facts that hold for every mesh, as functions: property tests and fuzz targets call the same ones.

use crate::neighbours::Places;
use crate::rows::Rows;
use crate::{Amount, MAX_COUNT, Method, SampleOptions, SurfacePoint, areas, normals, radius, sample};
use glam::{DVec3, Vec3};

/// Rounding of a position, relative to its size and the mesh's.
pub const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Points of blue noise are at least this far apart, of the spacing of a lattice of as many: held for squares, cubes and
/// spheres of up to 1500 points. (\[2\] gives 0.65 as what its weights aim at.)
pub const LEAST_DISTANCE: f64 = 0.45;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

/// Every point lies on its triangle, and says so consistently.
///
/// # Errors
/// The first point that does not.
pub fn points_lie_on_their_triangles(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    points: &[SurfacePoint],
) -> Result<(), String> {
    for p in points {
        let [a, b, c] = triangles[p.triangle as usize].map(|v| positions[v as usize]);
        let weights = p.barycentric;
        let sums_to_one = weights.min_element() >= 0.0 && (weights.element_sum() - 1.0).abs() < 1e-14;
        check(sums_to_one, || format!("barycentric {weights}"))?;
        let size = [a, b, c].iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
        let away = p.position.distance(p.interpolate([a, b, c]));
        check(away <= 4.0 * ROUNDING * size, || format!("{} is {away:e} off its triangle", p.position))?;
        let normal = (b - a).cross(c - a).normalize();
        check(normal.distance(p.normal) < 1e-12, || format!("normal {} is not {normal}", p.normal))?;
        check(p.radius >= 0.0 && p.radius.is_finite(), || format!("radius {}", p.radius))?;
    }
    Ok(())
}

/// Blue noise has exactly as many points as asked for.
///
/// # Errors
/// The two numbers.
pub fn counts_are_exact(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    count: usize,
    seed: u64,
) -> Result<(), String> {
    let options = SampleOptions::DEFAULT.with_count(count).with_seed(seed);
    let Ok(points) = sample(positions, triangles, &options) else { return Ok(()) };
    points_lie_on_their_triangles(positions, triangles, &points)?;
    check(points.len() == count, || format!("{} points in the place of {count}", points.len()))
}

/// Any mesh and any options give points or an error, and points are where they should be.
///
/// # Errors
/// What is wrong with a point. Amounts beyond 10,000 points are not tried.
pub fn anything_is_sampled_or_refused(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    options: &SampleOptions,
) -> Result<(), String> {
    if matches!(options.amount, Amount::Count(count) if count > 10_000 && count <= MAX_COUNT) {
        return Ok(());
    }
    match sample(positions, triangles, options) {
        Ok(points) => points_lie_on_their_triangles(positions, triangles, &points),
        Err(error) => check(!error.to_string().is_empty(), || "an error without words".to_owned()),
    }
}

/// The points of [`Method::Ldi`] do not depend on the order of triangles: bit for bit, but for the triangle's number.
///
/// # Errors
/// The first point that differs.
pub fn triangle_order_does_not_matter(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    spacing: f64,
    turn: usize,
) -> Result<(), String> {
    let options = SampleOptions::DEFAULT.with_method(Method::Ldi).with_spacing(spacing);
    let mut turned = triangles.to_vec();
    turned.rotate_left(turn % triangles.len().max(1));
    turned.reverse();
    let pair = (sample(positions, triangles, &options), sample(positions, &turned, &options));
    let (Ok(a), Ok(b)) = pair else { return Ok(()) };
    check(a.len() == b.len(), || format!("{} points and {}", a.len(), b.len()))?;
    let same = |p: &SurfacePoint, q: &SurfacePoint| {
        (p.position, p.normal, p.radius) == (q.position, q.normal, q.radius)
    };
    match a.iter().zip(&b).find(|(p, q)| !same(p, q)) {
        Some((p, q)) => Err(format!("{p:?} and {q:?}")),
        None => Ok(()),
    }
}

/// Points on one side of a surface are at least so far apart.
///
/// # Errors
/// Two that are not.
pub fn points_keep_apart(points: &[SurfacePoint], least: f64) -> Result<(), String> {
    let rows = Rows::new(points.len(), least, |i| points[i].position);
    for (place, &i) in rows.order().iter().enumerate() {
        let mut nearest = f64::INFINITY;
        rows.near(rows.at(place), least, |other, distance2| {
            let facing = points[rows.order()[other] as usize].normal.dot(points[i as usize].normal) > 0.0;
            if other != place && facing {
                nearest = nearest.min(distance2.sqrt());
            }
        });
        check(nearest >= least, || {
            format!("{} has a neighbour {nearest:e} away, less than {least:e}", points[i as usize].position)
        })?;
    }
    Ok(())
}

/// Seen along its normal, every place of every triangle is covered by a disc about a point of a surface that faces the same way, to
/// within `slack` of the radius. `probes` is how many places are tried along an edge.
///
/// # Errors
/// How much of the places is bare, and one of them.
pub fn discs_leave_no_gap(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    points: &[SurfacePoint],
    probes: u32,
    slack: f64,
) -> Result<(), String> {
    let reach = 2.0 * points.iter().map(|p| f64::from(p.radius)).fold(0.0, f64::max);
    let rows = Rows::new(points.len(), reach, |i| points[i].position);
    let (mut bare, mut all, mut example) = (0, 0, DVec3::ZERO);
    for t in triangles {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal == DVec3::ZERO {
            continue;
        }
        let places = (0..=probes).flat_map(|i| (0..=probes - i).map(move |j| (i, j)));
        for (i, j) in places {
            let place = a + ((b - a) * f64::from(i) + (c - a) * f64::from(j)) / f64::from(probes);
            let mut covered = false;
            rows.near(rows.turned(place), reach, |other, _| {
                let p = &points[rows.order()[other] as usize];
                let offset = place - p.position;
                let across = offset - p.normal * p.normal.dot(offset);
                let radius = f64::from(p.radius) * (1.0 + slack);
                covered |= p.normal.dot(normal) > 0.5 && across.length() <= radius;
            });
            all += 1;
            if !covered {
                bare += 1;
                example = place;
            }
        }
    }
    check(bare == 0, || format!("{bare} of {all} places are bare, such as {example}"))
}

// Clouds that come with positions alone.

/// What is estimated for a cloud of positions: each list in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimates {
    /// Unit normals, signs arbitrary.
    pub normals: Vec<Vec3>,
    /// Radii of discs, the cloud's unit.
    pub radii: Vec<f32>,
    /// Shares of the surface, the square of the cloud's unit.
    pub areas: Vec<f32>,
}

/// Normals, radii and areas of finite positions.
#[must_use]
pub fn estimates(positions: &[DVec3]) -> Estimates {
    let places = Places::new(positions);
    let normals = normals::estimate(&places);
    let radii = radius::of_cloud(&places, &normals, true);
    let areas = areas::of_cloud(&places, &normals, &radii, true);
    Estimates { normals, radii, areas }
}

/// Any finite positions have unit normals, radii and areas that are normal numbers, the same ones in any order and the same ones for
/// points that coincide.
///
/// # Errors
/// The first point for which that does not hold.
pub fn estimates_are_sound(positions: &[DVec3]) -> Result<(), String> {
    let Estimates { normals, radii, areas } = estimates(positions);
    for (i, normal) in normals.iter().enumerate() {
        check((normal.length() - 1.0).abs() < 1e-6, || format!("normal {normal}"))?;
        let largest = normal.abs().max_element();
        check(normal.max_element() >= largest - 1e-6, || format!("normal {normal} has the other sign"))?;
        let (radius, area) = (radii[i], areas[i]);
        check(radius.is_normal() && radius > 0.0, || format!("radius {radius:e}"))?;
        check(area.is_normal() && area > 0.0, || format!("area {area:e}"))?;
    }
    let mut backwards = positions.to_vec();
    backwards.reverse();
    let mut other = estimates(&backwards);
    other.normals.reverse();
    other.radii.reverse();
    other.areas.reverse();
    check(other == Estimates { normals: normals.clone(), radii, areas }, || "the order matters".to_owned())
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
        for radius in radius::of_cloud(&places, normals, two_sided) {
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
