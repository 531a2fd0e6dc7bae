//! Facts about solved scenes.

use super::check;
use crate::{Scene, SceneOptions, SolveOptions, Surface};

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
