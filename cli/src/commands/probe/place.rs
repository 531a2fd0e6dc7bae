//! `probe place`.

use super::inside::{self, Outcome};
use super::{check_output, failed, overrides, write};
use crate::commands::Report;
use crate::commands::report::name_of_output;
use crate::error::CliError;
use crate::input::name_of;
use crate::input_error::InputError;
use crate::job::Watch;
use crate::memory;
use crate::options::{Inside, PlaceOptions, Strategy};
use crate::probe_io::ProbeFile;
use crate::scene::{self, Mesh, NONE, Scene};
use glam::DVec3;
use pointillist_render::{ChooseOptions, Prepared, Solids, choose_places};
use pointillist_shade::face_normal;
use pointillist_shprobe::place;

/// Height above their surface of probes at vertices, over the scene's diagonal.
const LIFT: f64 = 0.02;

/// Candidates for each probe of `cluster`, if the user does not say where they are.
const CANDIDATES: usize = 8;

pub(in crate::commands) fn run(options: &PlaceOptions) -> Result<(), CliError> {
    let report = Report::new(&options.common)?.writing([&options.output])?;
    check_output(&options.output)?;
    check_memory(options)?;
    let loaded = report.stats.stage("load", || scene::load(&options.scene, &overrides(&options.set)))?;
    loaded.warnings.iter().for_each(|warning| report.warn(warning));
    let scene = loaded.scene;
    if scene.mesh.triangle_count() == 0 && options.low.is_none() {
        let error = InputError::of_file(name_of(&options.scene), "the scene is empty");
        return Err(error.with_help("say which box to fill with --low and --high").into());
    }
    let prepared = Prepared::new(&scene, &report.stats).map_err(failed)?;
    let positions = match options.strategy {
        Strategy::Vertices => above_vertices(&scene, &prepared, options, &report)?,
        _ => settle(&candidates(&scene, options), &prepared, options, &report)?,
    };
    if positions.is_empty() {
        return Err(CliError::Failed("no place is left for a probe: all are inside of solids".to_owned()));
    }
    say_if_fewer(positions.len(), options, &report);
    let positions = match options.strategy {
        Strategy::Cluster => cluster(&prepared, &positions, options, &report)?,
        _ => positions,
    };
    report.stats.count("probes", positions.len() as u64);
    report.stats.stage("write", || write(&options.output, &ProbeFile::of_positions(&positions)))?;
    let seconds = report.stats.elapsed().as_secs_f64();
    report.note(&format!(
        "{}: {} probes in {seconds:.2} s",
        name_of_output(&options.output),
        positions.len()
    ));
    report.finish()
}

/// Refuses more probes than memory can hold.
fn check_memory(options: &PlaceOptions) -> Result<(), CliError> {
    let grid = options.grid.map(|sides| sides.iter().map(|&n| n as u128).product());
    let count = u128::from(options.count);
    let (candidates, bytes): (u128, u128) = match options.strategy {
        // What each sees, and how far it sees in all directions.
        Strategy::Cluster => (grid.unwrap_or(count * CANDIDATES as u128), 4096),
        Strategy::Grid => (grid.unwrap_or(count), 128),
        Strategy::Random | Strategy::Vertices => (count, 128),
    };
    memory::check(candidates * bytes, || format!("{candidates} places (--count, --grid) take"))
        .map_err(|error| CliError::Usage(error.with_help()))
}

fn candidates(scene: &Scene, options: &PlaceOptions) -> Vec<DVec3> {
    let (low, high) = region(scene, options);
    let count = options.count as usize;
    match options.strategy {
        Strategy::Grid => {
            place::grid(low, high, options.grid.unwrap_or_else(|| even_grid(high - low, count)))
        }
        Strategy::Cluster => {
            let all = count.saturating_mul(CANDIDATES);
            place::grid(low, high, options.grid.unwrap_or_else(|| even_grid(high - low, all)))
        }
        Strategy::Random => place::random(low, high, count, options.seed),
        Strategy::Vertices => vec![],
    }
}

/// Places above vertices, as far from one another as can be. Those in solids are replaced by others as long as there are
/// more vertices.
fn above_vertices(
    scene: &Scene,
    prepared: &Prepared<'_>,
    options: &PlaceOptions,
    report: &Report<'_>,
) -> Result<Vec<DVec3>, CliError> {
    let (low, high) = region(scene, options);
    let mesh = scene.mesh.expanded().map_err(|error| CliError::Failed(error.to_string()))?;
    let lifted = lifted_vertices(&mesh, LIFT * (high - low).length());
    let count = options.count as usize;
    let mut tried = count;
    loop {
        let spread = place::spread(&lifted, tried);
        let all_tried = spread.len() < tried;
        let places: Vec<DVec3> = spread.into_iter().map(|i| lifted[i]).collect();
        let solids = Solids::new(prepared);
        let is_left = |&(i, p): &(usize, &DVec3)| {
            !matches!(inside::settle(&solids, i, *p, options.inside), Ok(Outcome::Dropped))
        };
        if all_tried || places.iter().enumerate().filter(is_left).count() >= count {
            let mut left = settle(&places, prepared, options, report)?;
            left.truncate(count);
            return Ok(left);
        }
        tried = tried.saturating_mul(2);
    }
}

/// Says that there are fewer places than were asked for, and what gives more.
fn say_if_fewer(found: usize, options: &PlaceOptions, report: &Report<'_>) {
    let count = options.count;
    if found >= count as usize {
        return;
    }
    match options.strategy {
        Strategy::Vertices => report.warn(&format!(
            "--count {count}, but the scene has only {found} different vertices outside of solids; \
             --strategy grid, random and cluster place more"
        )),
        Strategy::Random => report.warn(&format!(
            "--count {count}, but {found} places are left outside of solids; --inside move keeps the others, too"
        )),
        Strategy::Grid | Strategy::Cluster => {}
    }
}

fn region(scene: &Scene, options: &PlaceOptions) -> (DVec3, DVec3) {
    if let (Some(a), Some(b)) = (options.low, options.high) {
        let (a, b) = (DVec3::from_array(a.0), DVec3::from_array(b.0));
        return (a.min(b), a.max(b));
    }
    let infinite = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    scene.mesh.world_positions().fold(infinite, |(l, h), p| (l.min(p), h.max(p)))
}

/// About `count` probes in boxes as near to cubes as may be; at least two along an axis with any extent to speak of.
fn even_grid(extent: DVec3, count: usize) -> [usize; 3] {
    let longest = extent.max_element();
    let thick = extent.to_array().map(|e| e > longest * 1e-3);
    let axes = thick.iter().filter(|&&t| t).count().max(1) as f64;
    let volume: f64 = extent.to_array().iter().zip(thick).filter(|(_, t)| *t).map(|(e, _)| e).product();
    let side = (volume / count as f64).powf(1.0 / axes);
    let along =
        |axis: usize| ((extent[axis] / side).round() as usize).clamp(if count >= 8 { 2 } else { 1 }, count);
    [0, 1, 2].map(|axis| if thick[axis] { along(axis) } else { 1 })
}

/// Every used vertex, lifted off the first of its triangles that has an area.
fn lifted_vertices(mesh: &Mesh, height: f64) -> Vec<DVec3> {
    let mut lifted = vec![None; mesh.positions.len()];
    for (triangle, normals) in
        mesh.triangles.iter().zip(mesh.normal_of.iter().map(Some).chain(std::iter::repeat(None)))
    {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        let face = face_normal(a, b, c);
        for (k, &vertex) in triangle.iter().enumerate() {
            let own =
                normals.map(|n| n[k]).filter(|&n| n != NONE).map(|n| mesh.normals[n as usize].as_dvec3());
            let normal = own.unwrap_or(face);
            if normal != DVec3::ZERO && lifted[vertex as usize].is_none() {
                lifted[vertex as usize] = Some(mesh.positions[vertex as usize] + normal * height);
            }
        }
    }
    lifted.into_iter().flatten().collect()
}

/// Positions outside of solids.
fn settle(
    positions: &[DVec3],
    prepared: &Prepared<'_>,
    options: &PlaceOptions,
    report: &Report<'_>,
) -> Result<Vec<DVec3>, CliError> {
    let solids = Solids::new(prepared);
    let (mut free, mut inside) = (vec![], 0);
    for (i, &p) in positions.iter().enumerate() {
        let outcome = inside::settle(&solids, i, p, options.inside)?;
        inside += usize::from(matches!(outcome, Outcome::Moved(_) | Outcome::Dropped));
        match outcome {
            Outcome::Free | Outcome::Kept => free.push(p),
            Outcome::Moved(to) => free.push(to),
            Outcome::Dropped => {}
        }
    }
    if inside > 0 {
        report.warn(&format!("{inside} of {} places were inside of solids", positions.len()));
    }
    Ok(free)
}

/// The candidates between which light is interpolated best, by what they see with light reflected once.
fn cluster(
    prepared: &Prepared<'_>,
    candidates: &[DVec3],
    options: &PlaceOptions,
    report: &Report<'_>,
) -> Result<Vec<DVec3>, CliError> {
    let choose = ChooseOptions::DEFAULT
        .with_resolution(options.resolution)
        .with_max_count(options.count as usize)
        .with_max_error(options.error)
        .with_keep_buried(options.inside == Inside::Keep);
    let (progress, stats) = (report.progress(), &report.stats);
    let watch = Watch { task: "look", progress: &progress, stats };
    let chosen = choose_places(prepared, candidates, &choose, &watch).map_err(failed)?;
    progress.finish();
    let free = chosen.candidates;
    stats.skip("candidates_in_walls", chosen.buried as u64);
    stats.count("candidates", free as u64);
    stats.figure("error", chosen.error);
    report.note(&format!(
        "{} of {free} candidates; irradiance between them is off by {:.2} % (RMS)",
        chosen.positions.len(),
        chosen.error * 100.0
    ));
    Ok(chosen.positions)
}
