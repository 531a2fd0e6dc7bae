//! `info`.

use super::Report;
use super::report::write_text;
use crate::error::CliError;
use crate::image_io::{ExrFile, read_picture};
use crate::input_error::InputError;
use crate::mesh_io::{FileMesh, read_obj, read_ply};
use crate::options::InfoOptions;
use crate::scene::{self, Overrides, Projection, Scene};
use glam::DVec3;
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn run(options: &InfoOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?;
    let value = report.stats.stage("load", || describe(&options.file))?;
    write_text(&options.output.path, |output| {
        serde_json::to_writer_pretty(&mut *output, &value)?;
        writeln!(output)
    })?;
    report.finish()
}

fn describe(path: &Path) -> Result<Value, InputError> {
    let name = path.display().to_string();
    let bytes =
        || std::fs::read(path).map_err(|e| InputError::of_file(&name, format!("cannot be read: {e}")));
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "toml" | "json" => Ok(of_scene(&scene::load(path, &Overrides::default())?)),
        "obj" => Ok(of_mesh("obj", &read_obj(&name, &bytes()?)?)),
        "ply" => Ok(of_mesh("ply", &read_ply(&name, &bytes()?)?)),
        "exr" => of_exr(&name, &bytes()?),
        "png" | "jpg" | "jpeg" | "hdr" => {
            let picture = read_picture(path)?;
            Ok(json!({ "kind": "image", "format": extension, "size": picture.size }))
        }
        _ => Err(InputError::of_file(&name, "the name does not say what kind of file this is")
            .with_help("known are .toml, .json, .obj, .ply, .exr, .png, .jpg and .hdr")),
    }
}

fn of_scene(scene: &Scene) -> Value {
    let camera = &scene.camera;
    let mut view = json!({
        "eye": camera.eye.to_array(),
        "target": camera.target.to_array(),
        "up": camera.up.to_array(),
    });
    match camera.projection {
        Projection::Perspective { fov_y_rad } => view["fov"] = json!(fov_y_rad.to_degrees()),
        Projection::Orthographic { height } => view["height"] = json!(height),
    }
    json!({
        "kind": "scene",
        "size": [scene.image.width, scene.image.height],
        "camera": view,
        "objects": scene.mesh.objects.iter().map(|object| &object.name).collect::<Vec<_>>(),
        "triangles": scene.mesh.triangles.len(),
        "vertices": scene.mesh.positions.len(),
        "bounds": bounds(&scene.mesh.positions),
        "materials": scene.materials.iter().map(|material| &material.name).collect::<Vec<_>>(),
        "textures": scene.textures.iter()
            .map(|t| json!({ "path": t.path.display().to_string(), "size": [t.width, t.height] }))
            .collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(|light| &light.name).collect::<Vec<_>>(),
        "fingerprint": format!("{:016x}", scene.fingerprint),
        "warnings": scene.warnings,
    })
}

fn of_mesh(format: &str, mesh: &FileMesh) -> Value {
    json!({
        "kind": if mesh.triangles.is_empty() { "cloud" } else { "mesh" },
        "format": format,
        "vertices": mesh.positions.len(),
        "triangles": mesh.triangles.len(),
        "normals": mesh.normals.len(),
        "texture_coordinates": mesh.uvs.len(),
        "materials": mesh.material_names.iter().filter(|name| !name.is_empty()).collect::<Vec<_>>(),
        "material_files": mesh.material_files,
        "bounds": bounds(&mesh.positions),
    })
}

fn of_exr(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let file = ExrFile::read(bytes)
        .map_err(|error| InputError::of_file(name, format!("cannot be decoded: {error}")))?;
    let window = file.window;
    let mut value = json!({
        "kind": "image",
        "format": "exr",
        "size": file.size,
        "window": [window.x0, window.y0, window.x1, window.y1],
        "channels": file.channels.iter().map(|channel| &channel.name).collect::<Vec<_>>(),
    });
    if let Some(stamp) = &file.stamp {
        value["version"] = json!(stamp.version);
        value["fingerprint"] = json!(format!("{:016x}", stamp.fingerprint));
        value["tile"] = json!(stamp.tile);
    }
    Ok(value)
}

/// Lowest and highest coordinates; `null` for nothing.
fn bounds(positions: &[DVec3]) -> Value {
    let low = positions.iter().copied().reduce(DVec3::min);
    let high = positions.iter().copied().reduce(DVec3::max);
    json!(low.zip(high).map(|(low, high)| [low.to_array(), high.to_array()]))
}
