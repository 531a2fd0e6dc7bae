//! Clouds of points.

use crate::cloud_io::{self, CloudOptions, CloudSummary, Pose};
use crate::input_error::InputError;
use glam::DVec3;
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn of_summary(summary: &CloudSummary) -> Value {
    let mut value = json!({
        "kind": "cloud",
        "format": summary.format.as_str(),
        "points": summary.points,
        "invalid": summary.dropped,
        "colours": summary.has_colours,
        "opacities": summary.has_opacities,
        "normals": summary.has_normals,
        "face_normals": summary.has_face_normals,
        "radii": summary.has_radii,
        "bounds": summary.bounds.map(|corner| corner.to_array()),
        "warnings": summary.warnings,
    });
    if let Some(grid) = summary.grid {
        value["grid"] = json!({
            "columns": grid.cols, "rows": grid.rows, "filled": grid.filled, "spacing": grid.spacing,
        });
    }
    value
}

/// All scans of a `.conf`, with the box of their points in the world.
pub(super) fn of_conf(path: &Path) -> Result<Value, InputError> {
    let conf = cloud_io::read_conf(path)?;
    let options = CloudOptions::default().with_drop_invalid(true);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let mut points = 0;
    let mut scans = Vec::new();
    for scan in &conf.scans {
        let summary = cloud_io::read_cloud::<InputError>(&scan.path, &options, &mut |block| {
            for &position in block.positions {
                let world = scan.pose.to_world(position);
                low = low.min(world);
                high = high.max(world);
            }
            Ok(())
        })?;
        points += summary.points;
        let mut value = of_summary(&summary);
        value["path"] = json!(scan.path.display().to_string());
        value["pose"] = of_pose(&scan.pose);
        scans.push(value);
    }
    Ok(json!({
        "kind": "scans",
        "format": "conf",
        "points": points,
        "bounds": [low.to_array(), high.to_array()],
        "camera": conf.camera.as_ref().map(of_pose),
        "scans": scans,
        "warnings": conf.warnings,
    }))
}

/// World from scan, the quaternion as x, y, z, w.
fn of_pose(pose: &Pose) -> Value {
    json!({ "rotation": pose.rotation.to_array(), "translation": pose.translation.to_array() })
}
