//! Facts that hold for all functions on the sphere, and for all images, as functions
//! `fn fact(…) -> Result<(), String>`: `Err` says what was found instead.
//!
//! For property testers and fuzzers: the tests of this crate and its fuzz targets call them, and so can those of a
//! crate that builds on it, with the feature `invariants`. Each takes any input at all; what is refused satisfies every
//! fact.
//!
//! ```
//! use pointillist_sh::{Sh, invariants::irradiance_agrees};
//! # use glam::DVec3;
//!
//! let sh = Sh::new((0..9).map(|i| DVec3::splat(f64::from(i))).collect()).unwrap();
//! irradiance_agrees(&sh, DVec3::new(0.6, 0.0, 0.8))?;
//! # Ok::<(), String>(())
//! ```

use crate::{
    Brackets, Channel, CubeMap, CubePoint, CubeProjector, IrradianceMatrix, Lobe, MAX_ORDER, Panorama,
    PanoramaProjector, Product, Response, Sh, SphereQuadrature, Weights, basis, coefficient_count,
    cube_direction, cube_point, gauss_legendre, texel_solid_angle,
};
use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};

/// All weighting rules.
pub const WEIGHTS: [Weights; 3] = [Weights::Gregory, Weights::Exact, Weights::Paper];

/// Bound on rounding errors, relative to the largest number involved.
const ROUNDING: f64 = 1e-12;

fn check(holds: bool, message: impl FnOnce() -> String) -> Result<(), String> {
    if holds { Ok(()) } else { Err(message()) }
}

/// Every two functions up to an order have the product 1 with themselves and 0 with each other, within 1e-12.
///
/// # Errors
/// The first product that is off.
pub fn basis_is_orthonormal(order: usize) -> Result<(), String> {
    if order > MAX_ORDER {
        return Ok(());
    }
    let rule = SphereQuadrature::new(2 * order);
    let count = coefficient_count(order);
    let mut products = vec![0.0; count * count];
    for &(direction, weight) in rule.points() {
        let values = basis(order, direction);
        for (i, row) in products.chunks_exact_mut(count).enumerate() {
            row.iter_mut().zip(&values).for_each(|(sum, y)| *sum += weight * values[i] * y);
        }
    }
    let wanted = |i: usize| if i.is_multiple_of(count + 1) { 1.0 } else { 0.0 };
    let wrong = (0..count * count).find(|&i| (products[i] - wanted(i)).abs() > ROUNDING);
    check(wrong.is_none(), || format!("order {order}: product {wrong:?} is {}", products[wrong.unwrap_or(0)]))
}

/// The largest of all coefficients.
fn largest<T: Channel>(sh: &Sh<T>) -> f64 {
    let channels = |c: &T| (0..T::CHANNELS).fold(0.0, |most: f64, i| most.max(c.channel(i).abs()));
    sh.coefficients().iter().map(channels).fold(0.0, f64::max)
}

/// [`largest`], to divide by.
fn scale_of<T: Channel>(sh: &Sh<T>) -> f64 {
    largest(sh).max(f64::MIN_POSITIVE)
}

/// The largest difference of two functions of the same order, relative to the first.
#[must_use]
pub fn difference<T: Channel>(left: &Sh<T>, right: &Sh<T>) -> f64 {
    left.minus(right).map_or(f64::INFINITY, |rest| largest(&rest) / scale_of(left))
}

/// Rotation keeps the power of each band, and the turned function is the function of the direction turned back. Only what is no rotation is refused.
///
/// # Errors
/// The band or value that differs, or the rotation that is refused.
pub fn rotation_turns(sh: &Sh, rotation: DQuat, direction: DVec3) -> Result<(), String> {
    let turned = match sh.rotated(rotation) {
        Ok(turned) => turned,
        Err(fault) => {
            let is_unit = (rotation.length_squared() - 1.0).abs() < 1e-12;
            return check(!is_unit, || format!("{rotation} is refused: {fault}"));
        }
    };
    let Some(direction) = direction.try_normalize() else { return Ok(()) };
    let scale = scale_of(sh);
    for l in 0..=sh.order() {
        let (before, after) = (sh.band_power(l), turned.band_power(l));
        let error = (before - after).abs().max_element() / (scale * scale);
        check(error <= ROUNDING, || format!("band {l}: power {before} became {after}"))?;
    }
    let [there, back] = [turned.at(rotation * direction), sh.at(direction)];
    let error = (there - back).abs().max_element() / scale;
    check(error <= ROUNDING, || format!("{there} is not {back}, error {error:e}"))
}

/// Two rotations in a row equal the rotation by their product.
///
/// # Errors
/// The largest difference.
pub fn rotations_compose(sh: &Sh, first: DQuat, second: DQuat) -> Result<(), String> {
    let twice = sh.rotated(first).and_then(|turned| turned.rotated(second));
    let (Ok(twice), Ok(once)) = (twice, sh.rotated(second * first)) else { return Ok(()) };
    let error = difference(&once, &twice);
    check(error <= ROUNDING, || format!("error {error:e}"))
}

/// The exact solid angles of the texels of a cube sum to 4π within 1e-13.
///
/// # Errors
/// What they sum to.
pub fn solid_angles_fill_the_sphere(size: usize) -> Result<(), String> {
    let row = |y| (0..size).map(|x| texel_solid_angle(size, x, y)).sum::<f64>();
    let sum = 6.0 * (0..size).map(row).sum::<f64>() / (4.0 * PI);
    check((sum - 1.0).abs() <= 1e-13, || format!("{size}: {sum} of the sphere"))
}

/// A constant sky L gives E = πL in every direction, whatever the weights; of cubes and panoramas.
///
/// # Errors
/// The rule, and what it gives.
pub fn constant_sky_gives_pi(radiance: DVec3, size: usize, normal: DVec3) -> Result<(), String> {
    let Some(normal) = normal.try_normalize() else { return Ok(()) };
    // Rounded to `f32`, as an image stores it.
    let radiance = radiance.as_vec3().as_dvec3();
    let cube = CubeMap::from_fn(size, |_| radiance);
    let panorama = Panorama::from_fn(2 * size, size, |_| radiance);
    let (Ok(cube), Ok(panorama)) = (cube, panorama) else { return Ok(()) };
    for weights in WEIGHTS {
        let text = |e| format!("{weights:?}: {e:?}");
        let of_cube = CubeProjector::new(size, 2, weights).and_then(|p| p.project(&cube)).map_err(text)?;
        let of_panorama =
            PanoramaProjector::new(2 * size, size, 2, weights).and_then(|p| p.project(&panorama));
        for (sh, is_cube) in [(of_cube, true), (of_panorama.map_err(text)?, false)] {
            // Rows of a panorama are not symmetric enough for band 2 to vanish: only Fejér's rule is exact there.
            if is_cube || (weights == Weights::Gregory && size > 2) {
                let error = (sh.irradiance(normal) - PI * radiance).abs().max_element();
                let scale = radiance.abs().max_element().max(f64::MIN_POSITIVE);
                check(error <= ROUNDING * PI * scale, || {
                    format!("{weights:?} {size}: error {:e}", error / scale)
                })?;
            }
        }
    }
    Ok(())
}

/// Irradiance of any order is the integral of radiance times cosine over the hemisphere.
///
/// # Errors
/// Both values.
pub fn irradiance_is_the_integral(sh: &Sh, normal: DVec3) -> Result<(), String> {
    let Some(normal) = normal.try_normalize() else { return Ok(()) };
    let (u, v) = normal.any_orthonormal_pair();
    let columns = sh.order() + 1;
    let mut integral = DVec3::ZERO;
    // z from 0 to 1, where polynomials of one degree more are integrated exactly.
    for (x, weight) in gauss_legendre(sh.order() / 2 + 2) {
        let z = 0.5 * (x + 1.0);
        for column in 0..columns {
            let (sin, cos) = (TAU * column as f64 / columns as f64).sin_cos();
            let direction = normal * z + (u * cos + v * sin) * (1.0 - z * z).sqrt();
            integral += sh.at(direction) * (z * 0.5 * weight * TAU / columns as f64);
        }
    }
    let error = (sh.irradiance(normal) - integral).abs().max_element() / scale_of(sh);
    check(error <= ROUNDING, || format!("error {error:e}"))
}

/// Irradiance is the same by bands, by the matrix and in single precision.
///
/// # Errors
/// The values.
pub fn irradiance_agrees(sh: &Sh, normal: DVec3) -> Result<(), String> {
    let (Ok(sh), Some(normal)) = (sh.with_order(2), normal.try_normalize()) else { return Ok(()) };
    let scale = scale_of(&sh);
    let direct = sh.irradiance(normal);
    let matrix = IrradianceMatrix::new(&sh);
    let error = (matrix.at(normal) - direct).abs().max_element() / scale;
    check(error <= 1e-13, || format!("matrix: error {error:e}"))?;
    let n = normal.extend(1.0);
    let by_matrix = DVec3::from_array([0, 1, 2].map(|c| n.dot(matrix.matrix(c) * n)));
    let error = (by_matrix - direct).abs().max_element() / scale;
    check(error <= 1e-13, || format!("nᵀMn: error {error:e}"))?;
    let single = matrix.to_irradiance().at(normal.as_vec3()).as_dvec3();
    let error = (single - direct).abs().max_element() / scale;
    check(!single.is_finite() || error <= 2e-6, || format!("single precision: error {error:e}"))
}

/// Deringed irradiance is nowhere negative and keeps the mean; so does the split into a light and the rest, together.
///
/// # Errors
/// The value, or by how much the mean changed.
pub fn deringed_is_not_negative(sh: &Sh, normal: DVec3) -> Result<(), String> {
    let Some(normal) = normal.try_normalize() else { return Ok(()) };
    if sh.mean().min_element() <= 0.0 {
        return Ok(());
    }
    let deringed = sh.deringed();
    check(deringed.mean() == sh.mean(), || "the mean has changed".into())?;
    let scale = scale_of(sh);
    let split = sh.split(sh.order().min(2)).map_err(|e| e.to_string())?;
    for (what, sh) in [("deringed", &deringed), ("rest", &split.rest)] {
        for channel in 0..3 {
            let channel = sh.channel(channel).convolved(&Lobe::COSINE);
            let (_, least) = channel.minimum();
            let [least, here] = [least, channel.at(normal)].map(|e| e / scale);
            let is_zero = channel.mean() <= 1e-12 * scale;
            check(is_zero || least.min(here) >= -ROUNDING, || {
                format!("{what}: {least:e}, {here:e} along {normal}")
            })?;
            check(here >= least - ROUNDING, || format!("{what}: {here:e} is below the minimum {least:e}"))?;
        }
    }
    let light = split.light.map_or(DVec3::ZERO, |light| light.irradiance);
    let mean = split.rest.mean() + light / (4.0 * PI);
    let error = (mean - sh.mean()).abs().max_element() / scale;
    check(error <= ROUNDING, || format!("light and rest have another mean, error {error:e}"))
}

/// The minimum is not above the value anywhere.
///
/// # Errors
/// Both values.
pub fn minimum_is_least(sh: &Sh<f64>, direction: DVec3) -> Result<(), String> {
    let Some(direction) = direction.try_normalize() else { return Ok(()) };
    let ((at, least), value) = (sh.minimum(), sh.at(direction));
    check(least <= value + ROUNDING * scale_of(sh), || {
        format!("{value} along {direction}, {least} along {at}")
    })
}

/// A product with all its bands is the product of the values.
///
/// # Errors
/// Both values.
pub fn product_multiplies(left: &Sh, right: &Sh<f64>, direction: DVec3) -> Result<(), String> {
    let Some(direction) = direction.try_normalize() else { return Ok(()) };
    let Ok(product) = Product::new(left.order(), right.order(), left.order() + right.order()) else {
        return Ok(());
    };
    let product = product.of(left, right).map_err(|e| e.to_string())?;
    let error = (product.at(direction) - left.at(direction) * right.at(direction)).abs().max_element();
    let error = error / (scale_of(left) * scale_of(right));
    check(error <= 100.0 * ROUNDING, || format!("error {error:e}"))
}

/// The vector to a point of a face leads back to that point; across an edge, to the same point in space.
///
/// # Errors
/// Where it leads.
pub fn cube_points_come_back(point: CubePoint) -> Result<(), String> {
    let way = cube_direction(point);
    let Some(back) = cube_point(way) else {
        return check(!way.is_finite(), || format!("{way} leads nowhere"));
    };
    let again = cube_direction(back);
    let scaled = way / way.abs().max_element();
    check((again - scaled).abs().max_element() <= 1e-15, || format!("{point:?} came back as {back:?}"))?;
    check(back.s.abs() <= 1.0 && back.t.abs() <= 1.0, || format!("{back:?} is beyond the face"))?;
    let inside = point.s.abs() < 1.0 && point.t.abs() < 1.0;
    check(!inside || back.face == point.face, || format!("{point:?} came back on face {}", back.face))
}

/// What a cube map of a function holds is the function, as far as its texels and weights go: the error relative to the
/// largest coefficient, with texels in single precision.
///
/// # Errors
/// What the crate refused.
pub fn reconstruction_error(sh: &Sh, size: usize, weights: Weights) -> Result<f64, String> {
    let text = |e: crate::ShError| e.to_string();
    let cube = CubeMap::from_fn(size, |direction| sh.at(direction)).map_err(text)?;
    let back = CubeProjector::new(size, sh.order(), weights).and_then(|p| p.project(&cube)).map_err(text)?;
    Ok(difference(sh, &back))
}

/// Photographs of one scene at several exposures, merged: each channel is at least the least and at most the largest radiance that any of
/// them stands for there, whichever of them comes first.
///
/// # Errors
/// The first channel that is outside.
pub fn brackets_stay_within(photographs: &[(Vec<[u8; 3]>, f32)]) -> Result<(), String> {
    let response = Response::srgb();
    let (mut merged, mut turned) = (Brackets::new(), Brackets::new());
    let mut bounds = vec![];
    for (pixels, exposure) in photographs {
        if merged.add_photograph(pixels, &response, *exposure).is_err() {
            return Ok(());
        }
        bounds.resize(pixels.len(), [(f32::INFINITY, f32::NEG_INFINITY); 3]);
        for (bounds, pixel) in bounds.iter_mut().zip(pixels) {
            for (bound, &level) in bounds.iter_mut().zip(pixel) {
                let radiance = response.radiance(level, *exposure);
                *bound = (bound.0.min(radiance), bound.1.max(radiance));
            }
        }
    }
    for (pixels, exposure) in photographs.iter().rev() {
        turned.add_photograph(pixels, &response, *exposure).map_err(|e| e.to_string())?;
    }
    let ((merged, _), (turned, _)) = (merged.merged(), turned.merged());
    let all = merged.iter().flatten().zip(turned.iter().flatten()).zip(bounds.iter().flatten());
    for (i, ((&value, &other), &(least, most))) in all.enumerate() {
        let slack = 1e-6 * most.abs();
        check(value >= least - slack && value <= most + slack, || {
            format!("channel {i} is {value}, not {least} to {most}")
        })?;
        check((value - other).abs() <= slack, || format!("channel {i} is {value}, or {other} by order"))?;
    }
    Ok(())
}
