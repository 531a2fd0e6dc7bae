//! `sample`.

use super::Report;
use super::report::{name_of_output, write_text};
use crate::cloud_io::{CloudPoint, PlyEncoding, write_ply};
use crate::error::CliError;
use crate::input::{is_standard, kind_of, name_of};
use crate::input_error::InputError;
use crate::memory;
use crate::options::SampleOptions;
use crate::scene::{self, Overrides, Scene, srgb_from_linear};
use glam::{DVec3, Vec3};
use pointillist_surfel::{Amount, Method, SurfacePoint, SurfelError, sample_with};
use rayon::prelude::*;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

/// Units of the progress bar, and the share of the time that choosing points takes, about; the rest is colours and writing.
const PROGRESS_STEPS: u64 = 1000;
const SAMPLED: f64 = 0.9;

pub(super) fn run(options: &SampleOptions) -> Result<(), CliError> {
    let output = output_path(options);
    let report = Report::new(&options.common)?.writing([&output])?;
    check_output(&output, options)?;
    check_memory(options)?;
    let loaded = report.stats.stage("load", || scene::load(&options.model, &overrides(options)?))?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let mut scene = loaded.scene;
    if scene.materials.iter().any(|m| m.opacity_map.is_some() || m.surface.opacity < 1.0) {
        report.warn("opacity has no place in the cloud: what can be seen through becomes solid");
    }
    if !scene.mesh.instances().is_empty() {
        scene.mesh = scene.mesh.expanded().map_err(|error| CliError::Failed(error.to_string()))?.into_owned();
    }
    let progress = report.progress();
    progress.begin("sample", PROGRESS_STEPS);
    let points = report.stats.stage("sample", || {
        let done = |share| progress.reach(SAMPLED * share);
        sample_with(&scene.mesh.positions, &scene.mesh.triangles, &options.sampler(), &done)
            .map_err(|error| refusal(options, error))
    })?;
    progress.reach(SAMPLED);
    if points.is_empty() {
        report.warn("no ray meets the model; try a smaller --spacing, or --method poisson");
    }
    let cloud: Vec<CloudPoint> =
        report.stats.stage("attributes", || points.par_iter().map(|p| with_attributes(&scene, p)).collect());
    let encoding = if options.ascii { PlyEncoding::Ascii } else { PlyEncoding::Binary };
    report.stats.stage("write", || write_text(&output, |file| write_ply(file, &cloud, encoding)))?;
    report.stats.count("triangles", scene.mesh.triangles.len() as u64);
    report.stats.count("points", cloud.len() as u64);
    progress.finish();
    let seconds = report.stats.elapsed().as_secs_f64();
    report.note(&format!("{}: {} points in {seconds:.2} s", name_of_output(&output), cloud.len()));
    report.finish()
}

/// `bunny.obj` gives `bunny.points.ply`, which cannot be the model itself.
fn output_path(options: &SampleOptions) -> PathBuf {
    let own = || {
        let stem = options.model.file_stem().filter(|_| !is_standard(&options.model));
        let mut name = stem.unwrap_or("model".as_ref()).to_owned();
        name.push(".points.ply");
        PathBuf::from(name)
    };
    options.output.clone().unwrap_or_else(own)
}

/// Refuses names of other formats, and numbers of a binary file on a terminal.
fn check_output(output: &Path, options: &SampleOptions) -> Result<(), CliError> {
    if !is_standard(output) {
        let is_ply = output.extension().is_some_and(|e| e.eq_ignore_ascii_case("ply"));
        let message = || format!("`{}`: a cloud's name ends in .ply", output.display());
        return if is_ply { Ok(()) } else { Err(CliError::Usage(message())) };
    }
    if !options.ascii && std::io::stdout().is_terminal() {
        let message =
            "-o -: a binary PLY is nothing for a terminal; add --ascii, or send it to a file or a pipe";
        return Err(CliError::Usage(message.to_owned()));
    }
    Ok(())
}

/// A mesh alone has no say about shading: it gets smooth normals where its file has none.
fn overrides(options: &SampleOptions) -> Result<Overrides, InputError> {
    let is_mesh = ["obj", "ply", "ply.gz"].contains(&kind_of(&options.model)?.as_str());
    let smooth = is_mesh.then(|| ("sample".to_owned(), "render.shading=phong".to_owned()));
    let given = options.set.iter().map(|assignment| ("--set".to_owned(), assignment.clone()));
    Ok(Overrides { assignments: smooth.into_iter().chain(given).collect() })
}

/// Whether the model or an option is to blame.
fn refusal(options: &SampleOptions, error: SurfelError) -> CliError {
    match (&error, options.spacing) {
        (SurfelError::NoArea { .. }, _) => InputError::of_file(name_of(&options.model), error.to_string())
            .with_help("check that its triangles are not all lines or points")
            .into(),
        (_, Some(spacing)) => {
            CliError::Usage(format!("--spacing {spacing}: {error}; use a larger --spacing"))
        }
        (_, None) => CliError::Usage(format!("--count: {error}; use a smaller --count")),
    }
}

/// Refuses a count that memory cannot hold, before anything is computed.
fn check_memory(options: &SampleOptions) -> Result<(), CliError> {
    // Measured with 362,272 points: 770 and 240 bytes a point at the peak, and room for models with other shapes.
    let (bytes, count) = match options.sampler() {
        s if s.method == Method::Poisson => (1500, s.amount),
        s => (400, s.amount),
    };
    let Amount::Count(count) = count else { return Ok(()) };
    memory::check(count as u128 * bytes, || format!("--count {count} takes"))
        .map_err(|error| CliError::Usage(error.with_help()))
}

fn with_attributes(scene: &Scene, point: &SurfacePoint) -> CloudPoint {
    let normal = normal(scene, point);
    // Normals say which side is outside; triangles may be wound either way.
    let face_normal = if normal.dot(point.normal) < 0.0 { -point.normal } else { point.normal };
    CloudPoint {
        position: point.position,
        normal: normal.as_vec3(),
        face_normal: face_normal.as_vec3(),
        color: color(scene, point).to_array().map(encoded),
        radius: point.radius,
    }
}

/// The interpolated normal, or the triangle's own where there is none.
fn normal(scene: &Scene, point: &SurfacePoint) -> DVec3 {
    let interpolated = |normals: [Vec3; 3]| point.interpolate(normals.map(Vec3::as_dvec3)).try_normalize();
    scene.mesh.corner_normals(point.triangle).and_then(interpolated).unwrap_or(point.normal)
}

/// Linear diffuse colour: the material's, times its map's where it has one.
fn color(scene: &Scene, point: &SurfacePoint) -> Vec3 {
    let material = &scene.materials[scene.mesh.material(point.triangle) as usize];
    match (material.diffuse_map, scene.mesh.map_corners(point.triangle, &material.diffuse_place)) {
        (Some(map), Some(corners)) => {
            let uv = point.interpolate(corners);
            material.surface.diffuse * scene.textures[map].lookup(material.wrap, uv).truncate()
        }
        _ => material.surface.diffuse,
    }
}

fn encoded(linear: f32) -> u8 {
    (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}
