//! Lights with an area: as a whole, by points of it, and by samples with a random point each, our own and those of Mitsuba.

use std::path::Path;

use glam::DVec3;
use pointillist_render::Scene;
use pointillist_shade::sees_light;

use crate::common::against_samples::{CELLS, MORE, Subject, conditions, draw_cells, summary};
use crate::common::casters;
use crate::common::draw;
use crate::common::leaves;
use crate::common::peer_scene;
use crate::common::peers;
use crate::common::picture::Picture;
use crate::common::ray_reference::{Tree, random, sampled};
use crate::common::report::{Outcome, Row, table, write, write_csv};
use crate::common::scenes::{SurfaceSample, normal_towards, surface_at};

/// Pixels on a side: few, because the expected picture takes thousands of lights.
const SIZE: u32 = 64;

/// Points of the light in the expected picture: 64 × 64.
const CONVERGED: u32 = 4096;

/// Cells along a side of a pixel in the expected picture.
const CONVERGED_CELLS: u32 = 4;

/// Samples along a side of a pixel that the expected picture is compared with.
const CHECK: u32 = 64;

/// Pixels on a side of the foliage: a few hundred masks between each point and the light.
const FOLIAGE_SIZE: u32 = 32;

/// Samples along a side of its pixels in each half of its expected picture, and points of the light for each, along a side of it.
const FOLIAGE_SAMPLES: [u32; 2] = [32, 4];

/// Names a program that takes scenes as `studies/peers/mitsuba` does.
const MITSUBA: &str = "POINTILLIST_MITSUBA";

/// Its rows.
const SERIES: &str = "Mitsuba";

/// Its samples along a side of a pixel.
const SIDES: [u32; 4] = [4, 8, 16, 32];

/// Measures and writes `shadow-area.csv` and `shadow-area.md`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let (mut subjects, mut rows, mut checks) = (vec![], vec![], String::new());
    for (name, glossy) in [("matt", false), ("glossy", true)] {
        eprintln!("shadow: area light, {name}");
        let converged = casters::area_light(SIZE, CONVERGED, glossy);
        let tree = Tree::new(&converged);
        let rays = sampled(&converged, &tree, &|at| by_one_point(&converged, &tree, at), CHECK, 3);
        let expected = draw_cells(&converged, CONVERGED_CELLS)?;
        checks += &format!(
            " {name}: RMSE {:.1e}, bias {:+.3} %;",
            rays.rmse(&expected),
            100.0 * rays.bias(&expected)
        );
        // What a quarter as many points differ by is more than what is still missing.
        let fewer = casters::area_light(SIZE, CONVERGED / 4, glossy);
        let floor = draw_cells(&fewer, CONVERGED_CELLS)?.rmse(&expected);
        let subject = Subject { name: name.to_owned(), expected, floor };
        rows.extend(of_scene(&subject, &CELLS, &[1, 4, 16, 64, 256], &|points| {
            casters::area_light(SIZE, points, glossy)
        }));
        rows.extend(by_mitsuba(&subject, &converged)?);
        subjects.push(subject);
    }
    eprintln!("shadow: area light, foliage");
    let foliage = |points| leaves::bush_under_area(FOLIAGE_SIZE, points);
    let subject = below_foliage(&foliage(CONVERGED));
    rows.extend(of_scene(&subject, &CELLS[..2], &[1, 4, 16, 64], &foliage));
    subjects.push(subject);
    write_csv(out_dir, "shadow-area", &MORE, &rows)?;
    write(out_dir, "shadow-area.md", &markdown(&subjects, &rows, checks.trim_matches([' ', ';'])))?;
    Ok(true)
}

/// What samples of the light's points agree on.
fn below_foliage(scene: &Scene) -> Subject {
    let tree = Tree::new(scene);
    let [samples, side] = FOLIAGE_SAMPLES;
    let half = |seed| sampled(scene, &tree, &|at| by_points(scene, &tree, at, side), samples, seed);
    Subject::between("foliage", [2, 3].map(half))
}

/// All rows of a scene of which `with_points` makes one whose light is that many points, or whole if they are 0.
fn of_scene(
    subject: &Subject,
    cells: &[u32],
    points: &[u32],
    with_points: &dyn Fn(u32) -> Scene,
) -> Vec<Row> {
    let mut rows = subject.cells("exact", cells, &with_points(0));
    for &points in points {
        let scene = with_points(points);
        let draw = || draw::with_pipeline(&scene).expect("the scene is valid");
        rows.push(subject.row("points of the light", format!("{points} points"), draw));
    }
    let scene = with_points(CONVERGED);
    rows.extend(subject.samples(|n| by_samples(&scene, n)));
    rows
}

/// None if the program is not there, or the scene has what it does not know.
fn by_mitsuba(subject: &Subject, scene: &Scene) -> std::io::Result<Vec<Row>> {
    let text = peer_scene::written(scene, peer_scene::Lights::Rectangles);
    let (Some(program), Some(text)) = (peers::find(MITSUBA, "mitsuba"), text) else { return Ok(vec![]) };
    let drawn = peers::draw(&program, &text, [SIZE, SIZE], &SIDES)?.into_iter();
    let row =
        |(side, (time, picture))| subject.row_of(SERIES, format!("{side}×{side} samples"), time, &picture);
    Ok(SIDES.into_iter().zip(drawn).map(row).collect())
}

/// The whole light beside Mitsuba, as a section.
fn beside_mitsuba(rows: &[Row]) -> String {
    let title = "## Beside Mitsuba\n\n";
    let own: Vec<&Row> = rows.iter().filter(|row| row.series == SERIES).collect();
    let Some(ours) =
        rows.iter().find(|row| row.series == "exact" && row.scene == "matt").filter(|_| !own.is_empty())
    else {
        return format!("{title}{}\n\n", peers::skipped("Mitsuba", MITSUBA));
    };
    let mut text = format!(
        "{title}`studies/peers/mitsuba`: version 3 on one thread, its direct light by multi-jittered samples with a point of the light each, vectorised for this \
         processor. Seconds are its processor's, without reading, writing and compiling its kernels. The matt scene; ours with one cell: RMSE {:.2e}, {} s.\n\n\
         | samples | RMSE | bias % | seconds | its RMSE in ours | its seconds in ours |\n| --- | ---: | ---: | ---: | ---: | ---: |\n",
        ours.rmse, ours.time
    );
    for row in own {
        let (error, time) = (row.rmse / ours.rmse, row.time.seconds / ours.time.seconds);
        let more = row.more.join(" | ");
        text += &format!(
            "| {} | {:.2e} | {more} | {} | {error:.1} | {time:.1} |\n",
            row.setting, row.rmse, row.time
        );
    }
    text + "\n"
}

fn by_samples(scene: &Scene, n: u32) -> Picture {
    let tree = Tree::new(scene);
    sampled(scene, &tree, &|at| by_one_point(scene, &tree, at), n, 1)
}

/// The light of the area, estimated from one of its points that the position picks at random.
fn by_one_point(scene: &Scene, tree: &Tree, at: &SurfaceSample) -> DVec3 {
    by_points(scene, tree, at, 1)
}

/// The same from `side` × `side` points: one at random in each of as many equal parts of their list.
fn by_points(scene: &Scene, tree: &Tree, at: &SurfaceSample, side: u32) -> DVec3 {
    let [x, y, z] = at.position.to_array().map(f64::to_bits);
    let mut state = (x ^ y.rotate_left(21) ^ z.rotate_left(42)).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    random(&mut state);
    let light = &scene.lights[0].light;
    let (count, parts) = (f64::from(light.samples()), side * side);
    let (normal, surface) =
        (normal_towards(scene, at.triangle as usize, at.to_eye).as_vec3(), surface_at(scene, at));
    let to_eye = at.to_eye.normalize().as_vec3();
    let sum: DVec3 = (0..parts)
        .map(|part| {
            let place = (f64::from(part) + random(&mut state)) / f64::from(parts);
            let incident = light.illuminate((place * count) as u32, at.position);
            if incident.is_dark() || !sees_light(normal, incident.to_light) {
                return DVec3::ZERO;
            }
            let reflected = surface.reflect(&incident, normal, to_eye).as_dvec3();
            reflected * (count * tree.transmittance(at, incident.source))
        })
        .sum();
    sum / f64::from(parts)
}

fn markdown(subjects: &[Subject], rows: &[Row], checks: &str) -> String {
    format!(
        "# Lights with an area: time against error\n\n{}\n\nTwo spheres and a board under a rectangular light, {SIZE}×{SIZE} pixels, all matt or all \
         glossy (GGX). *Exact* takes the light as a whole, *points of the light* are as many shadow passes, *samples* send one shadow \
         ray each to a point of the light chosen at random. The expected picture has {CONVERGED} points of the light and \
         {CONVERGED_CELLS}×{CONVERGED_CELLS} cells a pixel; its own error is less than what a quarter as many points differ by, which is given. Pictures of {CHECK}×{CHECK} samples differ from \
         it by ({checks}), most of it noise of the samples.\n\nFoliage is a bush of {} cards with a mask, flat and matt, above the ground, under a light twice as wide; {FOLIAGE_SIZE}×{FOLIAGE_SIZE} \
         pixels. Its expected picture has 2 × {} samples a pixel with {} points of the light each, and is off by half of what the halves differ by.\n\n## Beside samples\n\n{}\n{}## All settings\n\n{}",
        conditions("shadow area"),
        leaves::CARDS,
        FOLIAGE_SAMPLES[0].pow(2),
        FOLIAGE_SAMPLES[1].pow(2),
        summary(subjects, rows),
        beside_mitsuba(rows),
        table(&MORE, rows)
    )
}
