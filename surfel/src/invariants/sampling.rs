//! Samples of meshes.

use super::check;
use crate::rows::Rows;
use crate::{Amount, MAX_COUNT, Method, SampleOptions, SurfacePoint, sample};
use glam::DVec3;

/// Rounding of a position, relative to its size and the mesh's.
pub const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Points of blue noise are at least this far apart, of the spacing of a lattice of as many: held for squares, cubes
/// and spheres of 100 to 1500 points. (Of ten, two may be nearer: there are only fifty to choose from.) (\[2\] gives
/// 0.65 as what its weights aim at.)
pub const LEAST_DISTANCE: f64 = 0.45;

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

/// Seen along its normal, every place of every triangle is covered by a disc about a point of a surface that faces the
/// same way, to within `slack` of the radius. `probes` is how many places are tried along an edge.
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
