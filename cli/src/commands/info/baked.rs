//! What was baked: probes, radiosity, harmonics; and lists of panoramas to bake from.

use super::bounds;
use crate::baked_file::BakedFile;
use crate::input_error::InputError;
use crate::json_words;
use crate::probe_io::{CaptureEntry, CaptureList, ProbeEntry, ProbeFile};
use glam::DVec3;
use serde::Deserialize;
use serde_json::{Value, json};
use std::f64::consts::PI;

/// What `probe project` writes.
#[derive(Deserialize)]
struct Harmonics {
    order: usize,
    sh: Vec<[f64; 3]>,
}

pub(super) fn of_probes(file: &ProbeFile) -> Value {
    let count = |f: fn(&ProbeEntry) -> bool| file.probes.iter().filter(|p| f(p)).count();
    json!({
        "kind": "probes",
        "probes": file.probes.len(),
        "baked": count(|p| p.sh.is_some()),
        "in_walls": count(|p| p.buried == Some(true)),
        "with_distances": count(|p| p.distances.is_some()),
        "order": file.order,
        "resolution": file.resolution,
        "what": file.what,
        "bounces": file.bounces,
        "indirect": file.indirect,
        "near": file.near,
        "far": file.far,
        "fit": file.fit,
        "part": file.part,
        "bounds": bounds(file.positions().into_iter()),
        "units": { "bounds": "as the scene", "sh": "radiance, linear RGB, real orthonormal basis" },
        "fingerprint": file.fingerprint,
    })
}

pub(super) fn of_radiosity(file: &BakedFile) -> Value {
    let positions: Vec<DVec3> = file.positions.iter().copied().map(DVec3::from_array).collect();
    json!({
        "kind": "radiosity",
        "surfaces": file.surfaces.len(),
        "patches": file.patches,
        "vertices": file.positions.len(),
        "triangles": file.triangles.len(),
        "error_bound": file.bound,
        "bounds": bounds(positions.iter().copied()),
        "units": { "bounds": "as the scene", "irradiance, radiosity, error_bound": "power per area, linear RGB" },
        "geometry": file.geometry,
        "light": file.light,
    })
}

pub(super) fn of_harmonics(name: &str, text: &[u8]) -> Result<Value, InputError> {
    let help = "harmonics are {\"order\":2,\"sh\":[[r,g,b], …]}, as `pointillist probe project` writes them";
    let file: Harmonics = json_words::parse(name, text, help)?;
    if file.order.checked_add(1).and_then(|n| n.checked_pow(2)) != Some(file.sh.len()) {
        let message = format!(
            "`sh` has {} coefficients, which is not (order + 1)² for order {}",
            file.sh.len(),
            file.order
        );
        return Err(InputError::of_file(name, message).with_help(help));
    }
    // The first function is 1/(2√π) everywhere.
    let mean = file.sh[0].map(|c| c / (2.0 * PI.sqrt()));
    Ok(json!({
        "kind": "harmonics",
        "order": file.order,
        "coefficients": file.sh.len(),
        "mean_radiance": mean,
        "units": { "sh": "radiance, linear RGB, real orthonormal basis" },
    }))
}

pub(super) fn of_captures(list: &CaptureList) -> Value {
    let positions: Vec<DVec3> = list.captures.iter().map(CaptureEntry::position).collect();
    json!({
        "kind": "captures",
        "pictures": list.captures.len(),
        "positions": list.brackets().len(),
        "bounds": bounds(positions.iter().copied()),
        "units": { "bounds": "as the scene", "rotate": "degrees about x, then y, then z", "exposure": "stops" },
    })
}
