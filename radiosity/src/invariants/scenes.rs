//! Facts about solved scenes.

use super::check;
use crate::{RayOptions, Scene, SceneOptions, SolveOptions, Surface};

/// Whatever the surfaces, they are refused or solved: radiosity is finite and not negative, and the two solvers agree within their
/// bounds.
pub fn is_refused_or_solved(surfaces: &[Surface], options: &SceneOptions) -> Result<(), String> {
    let Ok(scene) = Scene::new(surfaces, options) else { return Ok(()) };
    let Ok(transport) = scene.transport(&[]) else { return Ok(()) };
    let solving = SolveOptions::DEFAULT.with_max_sweeps(12);
    let Ok(solved) = transport.gauss_seidel(&solving) else { return Ok(()) };
    for value in solved.radiosity.iter().flatten() {
        check(value.is_finite() && *value >= -solved.bound, || format!("a radiosity of {value}"))?;
    }
    let shot = transport.progressive(&[], &solving).map_err(|e| e.to_string())?;
    let apart = solved.radiosity.iter().flatten().zip(shot.radiosity.iter().flatten());
    let apart = apart.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    let largest = solved.radiosity.iter().flatten().fold(0.0, |m: f64, v| m.max(*v));
    check(apart <= solved.bound + shot.bound + 1e-9 * largest, || {
        format!("solvers are {apart:e} apart, bounds {:e} and {:e}", solved.bound, shot.bound)
    })?;
    let baked = solved.bake();
    check(baked.vertices.iter().all(|v| v.irradiance.iter().all(|x| x.is_finite() && *x >= 0.0)), || {
        "a baked irradiance is negative or not finite".to_owned()
    })
}

/// Whatever the surfaces, links by rays are refused or solved: rows add up to 1 at most, and light is finite and not negative.
pub fn is_refused_or_solved_by_rays(surfaces: &[Surface], options: &SceneOptions) -> Result<(), String> {
    let Ok(scene) = Scene::new(surfaces, options) else { return Ok(()) };
    let rays = RayOptions::DEFAULT.with_links(16).with_most_rays(128);
    let Ok(transport) = scene.transport_by_rays(&[], &rays, &|_| ()) else { return Ok(()) };
    let mut sums = vec![0.0; transport.counts().patches];
    transport.factors(|from, _, factor| sums[from] += factor);
    check(sums.iter().all(|&s| s <= 1.0 + 1e-12), || "a row adds up to more than 1".to_owned())?;
    let Ok(solved) = transport.solve(&SolveOptions::DEFAULT.with_max_sweeps(12)) else { return Ok(()) };
    check(solved.radiosity.iter().flatten().all(|v| v.is_finite() && *v >= 0.0), || {
        "a radiosity is negative or not finite".to_owned()
    })?;
    let baked = solved.bake();
    check(baked.vertices.iter().all(|v| v.irradiance.iter().all(|x| x.is_finite() && *x >= 0.0)), || {
        "a baked irradiance is negative or not finite".to_owned()
    })
}
