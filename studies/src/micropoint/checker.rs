//! Edges of shadows across texels: a fine checker under slats that the camera does not see.

use std::path::Path;

use glam::{DQuat, DVec3, Vec3, dvec3};
use pointillist_render::Scene;
use pointillist_shade::{self as shade, Source};

use crate::common::against_samples::{CELLS, MORE, Subject, conditions, summary};
use crate::common::line_reference;
use crate::common::ray_reference::sampled_with_shadows;
use crate::common::report::{Outcome, Row, table, write, write_csv};
use crate::common::scenes::{CHECKER, Sketch};

/// Pixels on a side: in the middle of the picture a pixel sees about two texels, or about thirty.
const SIZES: [u32; 2] = [128, 32];

/// Texels on a side.
const TEXELS: u32 = 512;

/// Half a side of the ground.
const HALF: f64 = 4.0;

/// Lines a pixel of the expected pictures, and of those that say how far these are off.
const LINES: [u32; 2] = [192, 128];

/// What casts the shadows.
const SLATS: u32 = 25;

/// How far above the ground the shadows of the expected picture lie: a hundred-thousandth of a pixel.
const LIFT: f64 = 1e-7;

/// What the ground is lit by.
#[derive(Clone, Copy, Debug)]
enum Lit {
    Sun,
    Lamp,
}

/// Measures and writes `micropoint-checker.csv` and `micropoint-checker.md`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let (mut subjects, mut rows) = (vec![], vec![]);
    for (name, lit) in [("sun", Lit::Sun), ("lamp", Lit::Lamp)] {
        for size in SIZES {
            eprintln!("micropoint: checker under shadows, {name}, {size} pixels");
            let truth = with_painted_shadows(lit, size);
            let [expected, coarser] = LINES.map(|lines| line_reference::render(&truth, lines));
            let floor = expected.rmse(&coarser);
            let subject = Subject { name: format!("{name} {size}×{size}"), expected, floor };
            let scene = with_slats(lit, size);
            rows.extend(subject.cells("points", &CELLS, &scene));
            rows.extend(subject.samples(|n| sampled_with_shadows(&scene, n, 1)));
            subjects.push(subject);
        }
    }
    write_csv(out_dir, "micropoint-checker", &MORE, &rows)?;
    write(out_dir, "micropoint-checker.md", &markdown(&subjects, &rows))?;
    Ok(true)
}

fn sketch(lit: Lit, size: u32) -> Sketch {
    let mut s = Sketch::new(dvec3(0.3, 1.6, 2.6), dvec3(0.0, 0.0, 0.2), 40.0, size);
    // Rolled, so that the lines of the reference cross the texels rather than miss them.
    s.scene.camera.up = dvec3(0.35, 1.0, 0.0);
    match lit {
        Lit::Sun => s.sun(dvec3(0.4, -1.0, 0.25)),
        Lit::Lamp => s.lamp(dvec3(-0.7, 6.0, -0.4), 6.0),
    }
    s
}

/// Slats that hang above the camera, five by five, each turned about the vertical and tilted its own way.
fn slats() -> Vec<[DVec3; 4]> {
    let slat = |i: u32| {
        let (k, column, row) = (f64::from(i), f64::from(i % 5), f64::from(i / 5));
        let turn = DQuat::from_rotation_y(0.4 + 0.37 * k) * DQuat::from_rotation_x(0.6 - 0.05 * k);
        let centre = dvec3(-2.2 + 0.6 * column, 3.0, -3.0 + 0.9 * row);
        [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)]
            .map(|(x, z)| centre + turn * dvec3(0.4 * x, 0.0, 0.08 * z))
    };
    (0..SLATS).map(slat).collect()
}

/// What the renderers draw: one quad with a texture, and the slats.
fn with_slats(lit: Lit, size: u32) -> Scene {
    let mut s = sketch(lit, size);
    let map = s.checker(TEXELS);
    let ground = s.material(shade::Material::lambert(Vec3::ONE), Some(map));
    let corner = |x: f64, z: f64| dvec3(HALF * x, 0.0, HALF * z);
    s.textured_quad(&[corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], ground);
    let white = s.matt(1.0, 1.0);
    slats().iter().for_each(|slat| s.polygon(slat, white));
    s.scene
}

/// The same picture without textures and without casters: a quad for every texel, and black ones for the shadows.
fn with_painted_shadows(lit: Lit, size: u32) -> Scene {
    let mut s = sketch(lit, size);
    s.scene.lights[0].shadow = false;
    let source = s.scene.lights[0].light.source(0);
    let greys = CHECKER.map(|v| s.matt(f32::from(v) / 255.0, 1.0));
    s.checker_of_quads(TEXELS, HALF, greys);
    let black = s.matt(0.0, 1.0);
    for slat in slats() {
        s.polygon(&slat.map(|corner| fallen(corner, source) + DVec3::Y * LIFT), black);
    }
    s.scene
}

/// Where the shadow of a point meets the ground.
fn fallen(p: DVec3, source: Source) -> DVec3 {
    let way = match source {
        Source::Direction(way) => way,
        Source::Position(light) => p - light,
        _ => unreachable!("light comes from a point or a direction"),
    };
    p - way * (p.y / way.y)
}

fn markdown(subjects: &[Subject], rows: &[Row]) -> String {
    format!(
        "# Edges of shadows across texels: time against error\n\n{}\n\nA {TEXELS}×{TEXELS} checker under the shadows of {SLATS} slats that the \
         camera does not see, by a sun and by a lamp; of {}×{} pixels each sees about two texels in the middle of the picture, of {}×{} about thirty. The expected pictures share nothing with shadows or textures: each \
         texel is a quad of its own, shadows are black polygons, drawn by {} lines a pixel that are exact along themselves; their own \
         error is less than what {} lines differ by, which is given.\n\n## Beside samples\n\n{}\n## All settings\n\n{}",
        conditions("micropoint checker"),
        SIZES[0],
        SIZES[0],
        SIZES[1],
        SIZES[1],
        LINES[0],
        LINES[1],
        summary(subjects, rows),
        table(&MORE, rows)
    )
}
