//! `info`.

use super::Report;
use super::report::write_text;
use crate::baked_file::{BakedFile, read_baked};
use crate::cloud_io::{self, CloudOptions, CloudSummary, Pose};
use crate::error::CliError;
use crate::image_io::{ExrFile, read_picture};
use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use crate::json_words;
use crate::memory;
use crate::mesh_io::gltf::read_gltf;
use crate::mesh_io::{FileMesh, read_obj, read_ply};
use crate::options::InfoOptions;
use crate::probe_io::{CaptureEntry, CaptureList, ProbeEntry, ProbeFile, read_captures, read_probes};
use crate::scene::{self, LoadedScene, Material, Overrides, Projection};
use glam::DVec3;
use pointillist_shade::Model;
use serde::Deserialize;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::path::Path;

pub(super) fn run(options: &InfoOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output.path])?;
    let value = report.stats.stage("load", || describe(&options.file))?;
    write_text(&options.output.path, |output| {
        serde_json::to_writer_pretty(&mut *output, &value)?;
        writeln!(output)
    })?;
    report.finish()
}

/// What `probe project` writes.
#[derive(Deserialize)]
struct Harmonics {
    order: usize,
    sh: Vec<[f64; 3]>,
}

fn describe(path: &Path) -> Result<Value, InputError> {
    let name = input::name_of(path);
    let bytes = || input::read(path);
    let extension = input::kind_of(path)?;
    match extension.as_str() {
        "probes" => Ok(of_probes(&read_probes(path)?)),
        "json" => of_json(path, &bytes()?),
        "toml" => Ok(of_scene(&scene::load(path, &Overrides::default())?)),
        "obj" => Ok(of_mesh("obj", &read_obj(&name, &bytes()?)?)),
        "ply" => of_ply(path, &name),
        "gltf" | "glb" => of_gltf(&extension, &name, path, &bytes()?),
        "conf" => of_conf(path),
        "ply.gz" | "gz" | "xyz" | "txt" | "asc" | "pts" | "csv" | "las" | "laz" | "e57" => Ok(of_cloud(&summary(path)?)),
        "exr" => of_exr(&name, &bytes()?),
        "png" | "jpg" | "jpeg" | "hdr" => {
            let picture = read_picture(path)?;
            Ok(json!({ "kind": "image", "format": extension, "size": picture.size }))
        }
        _ => Err(InputError::of_file(&name, "the name does not say what kind of file this is")
            .with_help(
                "known are .toml, .json, .probes, .obj, .ply, .gltf, .glb, .exr, .png, .jpg and .hdr, and of clouds .ply.gz, .xyz, .txt, \
                 .asc, .pts, .csv, .las, .laz, .e57 and .conf",
            )),
    }
}

fn of_scene(loaded: &LoadedScene) -> Value {
    let LoadedScene { scene, warnings, fingerprint, .. } = loaded;
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
        "surfaces": scene.materials.iter().map(of_material).collect::<Vec<_>>(),
        "textures": scene.textures.iter()
            .map(|t| json!({ "path": t.name, "size": [t.width, t.height] }))
            .collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(|light| &light.name).collect::<Vec<_>>(),
        "fingerprint": format!("{:016x}", fingerprint),
        "warnings": warnings,
    })
}

fn of_json(path: &Path, text: &[u8]) -> Result<Value, InputError> {
    match JsonKind::of_text(text) {
        Some(JsonKind::Probes) => Ok(of_probes(&read_probes(path)?)),
        Some(JsonKind::Radiosity) => Ok(of_radiosity(&read_baked(path)?)),
        Some(JsonKind::Harmonics) => of_harmonics(&input::name_of(path), text),
        Some(JsonKind::Captures) => Ok(of_captures(&read_captures(path)?)),
        Some(JsonKind::Scene) | None => Ok(of_scene(&scene::load(path, &Overrides::default())?)),
    }
}

fn of_captures(list: &CaptureList) -> Value {
    let positions: Vec<DVec3> = list.captures.iter().map(CaptureEntry::position).collect();
    json!({
        "kind": "captures",
        "pictures": list.captures.len(),
        "positions": list.brackets().len(),
        "bounds": bounds(&positions),
        "units": { "bounds": "as the scene", "rotate": "degrees about x, then y, then z", "exposure": "stops" },
    })
}

fn of_radiosity(file: &BakedFile) -> Value {
    let positions: Vec<DVec3> = file.positions.iter().copied().map(DVec3::from_array).collect();
    json!({
        "kind": "radiosity",
        "surfaces": file.surfaces.len(),
        "patches": file.patches,
        "vertices": file.positions.len(),
        "triangles": file.triangles.len(),
        "error_bound": file.bound,
        "bounds": bounds(&positions),
        "units": { "bounds": "as the scene", "irradiance, radiosity, error_bound": "power per area, linear RGB" },
        "geometry": file.geometry,
        "light": file.light,
    })
}

fn of_harmonics(name: &str, text: &[u8]) -> Result<Value, InputError> {
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

fn of_probes(file: &ProbeFile) -> Value {
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
        "bounds": bounds(&file.positions()),
        "units": { "bounds": "as the scene", "sh": "radiance, linear RGB, real orthonormal basis" },
        "fingerprint": file.fingerprint,
    })
}

/// What a material reflects by, and which maps it has.
fn of_material(material: &Material) -> Value {
    let d = &material.details;
    let maps = [
        ("diffuse", material.diffuse_map.is_some()),
        ("opacity", material.opacity_map.is_some()),
        ("specular", d.specular_map.is_some()),
        ("shininess", d.shininess_map.is_some()),
        ("roughness", d.roughness_map.is_some()),
        ("metallic", d.metallic_map.is_some()),
        ("emission", d.emission_map.is_some()),
        ("occlusion", d.occlusion.is_some()),
        ("bump", d.bump.is_some()),
        ("normal", d.normal.is_some()),
    ];
    let model = match material.surface.model {
        _ if d.measured.is_some() => "merl",
        Model::Lambert => "lambert",
        Model::NormalizedPhong => "phong",
        Model::NormalizedBlinnPhong => "blinn-phong",
        Model::Ggx => "ggx",
        Model::Phong => "phong, not normalised",
        Model::BlinnPhong => "blinn-phong, not normalised",
        _ => "another",
    };
    json!({
        "name": material.name,
        "model": model,
        "maps": maps.iter().filter(|(_, there)| *there).map(|(name, _)| name).collect::<Vec<_>>(),
        "mirrors": d.reflection.is_some() || material.surface.model == Model::Ggx,
        "transmits": d.transmission.is_some(),
    })
}

fn of_mesh(format: &str, mesh: &FileMesh) -> Value {
    json!({
        "kind": "mesh",
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

fn of_gltf(format: &str, name: &str, path: &Path, bytes: &[u8]) -> Result<Value, InputError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let open =
        |file: &str| memory::read(&folder.join(file)).map_err(|error| format!("cannot be read: {error}"));
    let mesh = read_gltf(name, bytes, &open)?;
    let mut value = of_mesh(format, &mesh);
    if let Some(model) = &mesh.gltf {
        value["images"] = json!(model.images.len());
        value["cameras"] = json!(model.cameras.len());
        value["lights"] = json!(model.lights.len());
        value["warnings"] = json!(model.warnings);
    }
    Ok(value)
}

/// A mesh if it has faces, a cloud otherwise.
fn of_ply(path: &Path, name: &str) -> Result<Value, InputError> {
    let summary = summary(path)?;
    if summary.faces == 0 {
        return Ok(of_cloud(&summary));
    }
    Ok(of_mesh("ply", &read_ply(name, &input::read(path)?)?))
}

/// Broken points are counted and not an error: this command is for looking at files.
fn summary(path: &Path) -> Result<CloudSummary, InputError> {
    let options = CloudOptions::default().with_drop_invalid(true);
    cloud_io::read_cloud(path, &options, &mut |_| Ok(()))
}

fn of_cloud(summary: &CloudSummary) -> Value {
    let mut value = json!({
        "kind": "cloud",
        "format": summary.format.as_str(),
        "points": summary.points,
        "invalid": summary.dropped,
        "colours": summary.has_colours,
        "normals": summary.has_normals,
        "radii": summary.has_radii,
        "bounds": summary.bounds.map(|corner| corner.to_array()),
        "units": { "bounds": "as the file; clouds do not say their unit" },
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
fn of_conf(path: &Path) -> Result<Value, InputError> {
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
        let mut value = of_cloud(&summary);
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
