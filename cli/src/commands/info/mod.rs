//! `info`.

mod baked;
mod cloud;
mod mesh;
mod picture;
mod ply;
mod scene;
mod survey;
mod tables;

use super::Report;
use super::report::write_text;
use crate::baked_file::read_baked;
use crate::error::CliError;
use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use crate::mesh_io::read_obj;
use crate::options::InfoOptions;
use crate::probe_io::{read_captures, read_probes};
use crate::scene::{Overrides, load};
use baked::{of_captures, of_harmonics, of_probes, of_radiosity};
use cloud::of_conf;
use glam::DVec3;
use mesh::{of_gltf, of_mesh, of_ply};
use picture::{of_exr, of_picture};
use scene::of_scene;
use serde_json::{Value, json};
use std::path::Path;
use survey::Survey;
use tables::{of_comparison, of_job, of_json_lines, of_merl, of_mtl, of_raw, of_stats, of_text, of_yaml};

pub(super) fn run(options: &InfoOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output.path])?;
    let value = report.stats.stage("load", || describe(&options.file))?;
    write_text(&options.output.path, |output| {
        serde_json::to_writer_pretty(&mut *output, &value)?;
        writeln!(output)
    })?;
    report.finish()
}

fn describe(path: &Path) -> Result<Value, InputError> {
    let name = input::name_of(path);
    let bytes = || input::read(path);
    let extension = input::kind_of(path)?;
    let scene = || Ok(of_scene(&load(path, &Overrides::default())?));
    match extension.as_str() {
        "probes" => Ok(of_probes(&read_probes(path)?)),
        "json" => of_json(path, &bytes()?),
        "jsonl" | "ndjson" => of_json_lines(&name, &bytes()?),
        "toml" => scene(),
        "obj" => Ok(of_mesh("obj", &read_obj(&name, &bytes()?)?)),
        "ply" | "ply.gz" => of_ply(path, &name),
        "gltf" | "glb" => of_gltf(&extension, &name, path, &bytes()?),
        "mtl" => of_mtl(&name, &bytes()?),
        "conf" => of_conf(path),
        "xyz" | "txt" | "asc" | "pts" | "csv" => match of_text(&bytes()?) {
            Some(value) => Ok(value),
            None => Ok(Survey::of(path)?.to_json()),
        },
        "gz" | "las" | "laz" | "e57" => Ok(Survey::of(path)?.to_json()),
        "bin" => of_raw(&name, &bytes()?),
        "binary" => of_merl(&name, &bytes()?),
        "yaml" | "yml" => of_yaml(&name, &bytes()?),
        "exr" => of_exr(&name, &bytes()?),
        "png" | "jpg" | "jpeg" | "hdr" => of_picture(&extension, path),
        _ => Err(InputError::of_file(&name, "the name does not say what kind of file this is").with_help(
            "known are scenes (.toml, .json), meshes (.obj, .ply, .gltf, .glb) and .mtl, clouds (.ply, .ply.gz, .xyz, .txt, .asc, \
             .pts, .csv, .las, .laz, .e57, .conf), pictures (.exr, .png, .jpg, .hdr), what was baked (.json, .probes), and lists \
             (.txt, .bin, .jsonl, .csv, .binary, .yaml)",
        )),
    }
}

fn of_json(path: &Path, text: &[u8]) -> Result<Value, InputError> {
    let name = input::name_of(path);
    match JsonKind::of_text(text) {
        Some(JsonKind::Probes) => Ok(of_probes(&read_probes(path)?)),
        Some(JsonKind::Radiosity) => Ok(of_radiosity(&read_baked(path)?)),
        Some(JsonKind::Harmonics) => of_harmonics(&name, text),
        Some(JsonKind::Captures) => Ok(of_captures(&read_captures(path)?)),
        Some(JsonKind::Statistics) => of_stats(&name, text),
        Some(JsonKind::Comparison) => of_comparison(&name, text),
        Some(JsonKind::Job) => of_job(&name, text),
        Some(JsonKind::Scene) | None => Ok(of_scene(&load(path, &Overrides::default())?)),
    }
}

/// Lowest and highest coordinates; `null` for nothing.
fn bounds(positions: impl Iterator<Item = DVec3>) -> Value {
    let box_of = positions.map(|p| (p, p)).reduce(|(low, high), (p, _)| (low.min(p), high.max(p)));
    json!(box_of.map(|(low, high)| [low.to_array(), high.to_array()]))
}
