//! An object that moves through probes: does its light jump?

use std::f64::consts::TAU;
use std::path::Path;

use glam::{DVec3, Vec3, dvec3};
use pointillist_delaunay::Hint;
use pointillist_sh::Irradiance;
use pointillist_shade::Material;
use pointillist_shprobe::place;

use crate::common::draw;
use crate::common::scenes::Sketch;
use crate::shprobe::canvas::{save, sheet};
use crate::shprobe::known::Known;
use crate::shprobe::layouts::light;
use crate::shprobe::pictures::HALL_GAIN;
use crate::shprobe::site::{Baked, Ground, lit_by};
use crate::shprobe::trilinear::Grid;
use crate::shprobe::truth::{Truth, normals};

type Fault = Box<dyn std::error::Error + Send + Sync>;

const POSITIONS: usize = 60;
const SHOWN: usize = 12;
/// Steps in one, to see whether light jumps.
const FINER: usize = 10;
const FRAME: u32 = 200;
const RADIUS: f64 = 0.35;

/// Of the sphere: in the sun it is nearly white in the picture, and no facet of it is as wide as two pixels.
const ALBEDO: f32 = 0.35;
const FINENESS: u32 = 6;

/// In and out of the colonnades, along the hall.
fn path(count: usize) -> Vec<DVec3> {
    let at = |i: usize| {
        let t = i as f64 / (count - 1) as f64;
        dvec3(-10.0 + 20.0 * t, 1.5, 4.2 * (1.5 * TAU * t).sin())
    };
    (0..count).map(at).collect()
}

/// The table of jumps; draws a strip of positions.
pub(crate) fn walk(ground: &Ground<'_>, known: &Known, folder: &Path) -> Result<String, Fault> {
    eprintln!("shprobe: a walk through {}", ground.site.name);
    let path = path(POSITIONS);
    let truth = Truth::at(ground, path.clone())?;
    let mut text = "A sphere at 60 positions in and out of the colonnades. Changes of irradiance from one position to the next, over the mean \
                    irradiance of the whole path, largest of 26 normals: of the largest step, of the mean step, and of the largest when steps are a \
                    tenth as long: a tenth of it where light does not jump.\n\n\
                    | light | largest % | mean % | largest, a tenth the step % | error % |\n| --- | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    text += &row("true", truth.irradiance(), None);
    let grid = ground.look(&Grid::new(ground, [12, 6, 6]).positions)?;
    text += &probes_row("grid of 432", &grid, false, &truth)?;
    text += &probes_row("grid of 432, distances", &grid, true, &truth)?;
    for distances in [false, true] {
        let [_, baked] = known.adaptive(192, place::BALANCE, distances)?;
        let name = if distances { "192 fitted, distances" } else { "192 fitted" };
        text += &probes_row(name, &baked, distances, &truth)?;
        if distances {
            strip(ground, &baked, &path, folder)?;
        }
    }
    Ok(text)
}

fn probes_row(name: &str, baked: &Baked, distances: bool, truth: &Truth) -> Result<String, Fault> {
    let field = baked.field(distances)?;
    let lights = |positions: &[DVec3]| {
        let mut hint = Hint::START;
        positions
            .iter()
            .map(|&p| Ok(of_normals(&field.light(p, &mut hint)?)))
            .collect::<Result<Vec<_>, Fault>>()
    };
    let wrong = truth.wrong(None, |p| light(&field, p)).all;
    let fine = largest_step(&lights(&path((POSITIONS - 1) * FINER + 1))?);
    Ok(row(name, &lights(&truth.positions)?, Some([fine, wrong])))
}

fn of_normals(light: &Irradiance) -> Vec<DVec3> {
    normals().iter().map(|n| light.at(n.as_vec3()).max(Vec3::ZERO).as_dvec3()).collect()
}

/// The mean change from one position to the next, and the largest.
fn steps(lights: &[Vec<DVec3>]) -> [f64; 2] {
    let all = || lights.iter().flatten();
    let mean = all().map(|e| e.length()).sum::<f64>() / all().count() as f64;
    let step = |pair: &[Vec<DVec3>]| {
        let changes = pair[0].iter().zip(&pair[1]).map(|(a, b)| (*a - *b).length());
        changes.fold(0.0, f64::max) / mean
    };
    let steps: Vec<f64> = lights.windows(2).map(step).collect();
    [steps.iter().sum::<f64>() / steps.len() as f64, steps.iter().copied().fold(0.0, f64::max)]
}

fn largest_step(lights: &[Vec<DVec3>]) -> f64 {
    steps(lights)[1]
}

/// What is known of probes only: the largest change in finer steps, and the error.
fn row(name: &str, lights: &[Vec<DVec3>], of_probes: Option<[f64; 2]>) -> String {
    let [mean, largest] = steps(lights);
    let [fine, error] =
        of_probes.map_or(["–", "–"].map(str::to_owned), |v| v.map(|v| format!("{:.1}", 100.0 * v)));
    format!("| {name} | {:.1} | {:.1} | {fine} | {error} |\n", 100.0 * largest, 100.0 * mean)
}

/// A grey sphere, followed by the camera. Only where the sun shines it is lit by more than probes.
fn strip(ground: &Ground<'_>, baked: &Baked, path: &[DVec3], folder: &Path) -> Result<(), Fault> {
    let mut pictures = vec![];
    for &p in path.iter().step_by(POSITIONS / SHOWN) {
        let mut sketch = Sketch { scene: lit_by(&ground.site.scene, baked, true)? };
        let grey = sketch.material(Material::lambert(Vec3::splat(ALBEDO)), None);
        sketch.sphere(p, RADIUS, FINENESS, grey);
        let camera = &mut sketch.scene.camera;
        // From behind, or from wherever nothing is in between.
        let eye = |angle: f64| p + dvec3(-1.6 * angle.cos(), 0.5, -1.6 * angle.sin());
        let angles = [0.0, 0.6, -0.6, 1.2, -1.2, 2.0, -2.0, 3.0];
        let free = angles.into_iter().map(eye).find(|&e| ground.is_open(e, p));
        (camera.eye, camera.target) = (free.unwrap_or(eye(0.0)), p);
        [sketch.scene.image.width, sketch.scene.image.height] = [FRAME; 2];
        pictures.push(draw::with_pipeline(&sketch.scene)?);
    }
    Ok(save(&sheet(&pictures, 6), HALL_GAIN, &folder.join("walk.png"))?)
}
