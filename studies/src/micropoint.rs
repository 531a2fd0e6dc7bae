//! `micropoint`: run time against error of pictures, beside plain point sampling.

mod bumps;
pub(crate) mod checker;
mod embree;
pub(crate) mod foliage;
mod growth;

use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, dvec3};
use pointillist_micropoint::{MicropointOptions, Occlusion};
use pointillist_render::Scene;

use crate::common::charts::chart;
use crate::common::closed_form;
use crate::common::data;
use crate::common::draw;
use crate::common::line_reference;
use crate::common::picture::Picture;
use crate::common::point_sampling;
use crate::common::provenance::provenance;
use crate::common::ray_reference::Tree;
use crate::common::report::{Outcome, Row, on_one_thread, scenes, table, time_ratio, write, write_csv};
use crate::common::timing::{HOW, Timing, timed};

/// Pixels on a side.
const SIZE: u32 = 256;

/// Lines a pixel of the reference pictures.
const LINES: u32 = 192;

/// The same for a trial: their own error is then up to 5e-4.
const QUICK_LINES: u32 = 32;

/// A scene and what it must look like.
struct Case {
    name: String,
    scene: Scene,
    expected: Picture,
    /// Whether its micropoints alone give the picture; otherwise the whole pipeline draws it.
    emissive: bool,
    /// Whether it has closed opaque parts.
    solid: bool,
}

/// Measures and writes `micropoint.csv`, `micropoint.md` and `micropoint.svg`, and the tables of the parts.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let cases = cases(LINES);
    let mut rows = vec![];
    for case in &cases {
        eprintln!("micropoint: {}", case.name);
        on_one_thread(|| {
            rows.extend(ours(case));
            rows.extend(points(case));
            rows.extend(embree::rows(case)?);
            Ok::<(), std::io::Error>(())
        })?;
    }
    write_csv(out_dir, "micropoint", &[], &rows)?;
    chart(out_dir, "micropoint", &rows)?;
    write(
        out_dir,
        "micropoint.md",
        &(markdown(&rows) + &growth::section(&growth::COUNTS) + &bumps::section(bumps::SAMPLES)),
    )?;
    Ok(foliage::run(out_dir)? && checker::run(out_dir)?)
}

/// A trial of a minute: pictures by the default rule alone.
pub(crate) fn run_quick(out_dir: &Path) -> Outcome {
    let mut text = format!(
        "# Pictures: a trial\n\n`studies -- micropoint quick` made this ({}).\n\n| scene | setting | RMSE | largest error | seconds |\n\
         | --- | --- | ---: | ---: | ---: |\n",
        provenance()
    );
    for case in cases(QUICK_LINES) {
        let rows =
            on_one_thread(|| [1, 2, 4].map(|cells| our_row(&case, Occlusion::Correlated, true, cells)));
        for Row { scene, setting, rmse, largest, time, .. } in rows {
            let _ = writeln!(text, "| {scene} | {setting} | {rmse:.2e} | {largest:.2e} | {time} |");
        }
    }
    text += &(growth::section(growth::FEW) + &bumps::section(bumps::FEW_SAMPLES));
    print!("{text}");
    write(out_dir, "micropoint.md", &text)?;
    Ok(true)
}

/// Scenes with pictures of so many lines a pixel, if they are not closed forms.
fn cases(lines: u32) -> Vec<Case> {
    let by_lines = |name: &str, scene: Scene, solid: bool| {
        let expected = line_reference::render(&scene, lines);
        Case { name: name.to_owned(), scene, expected, emissive: true, solid }
    };
    let edge = crate::common::scenes::lone_edge(SIZE);
    let line = [dvec3(-0.3, -9.0, 0.0), dvec3(0.5, 9.0, 0.0)];
    let expected = closed_form::half_plane(&edge, line, DVec3::X, DVec3::ONE);
    let mut cases = vec![
        Case { name: "lone edge".to_owned(), scene: edge, expected, emissive: true, solid: false },
        by_lines("quads", crate::common::scenes::quads(SIZE), false),
        by_lines("stacked spheres", crate::common::scenes::spheres(SIZE), true),
        by_lines("wires", crate::common::scenes::wires(SIZE), true),
        by_lines("stripes to the horizon", crate::common::scenes::stripes(SIZE, 800), false),
        by_lines("translucent layers", crate::common::scenes::layers(SIZE), false),
        Case {
            emissive: false,
            ..by_lines("spheres, matt", crate::common::scenes::lit_spheres(SIZE), false)
        },
        Case {
            name: "checker 512×512".to_owned(),
            scene: crate::common::scenes::checker_ground(SIZE, false),
            expected: line_reference::render(&crate::common::scenes::checker_ground(SIZE, true), lines),
            emissive: false,
            solid: false,
        },
    ];
    cases.extend(data::references().into_iter().map(|r| Case {
        name: format!("reference {}", r.name),
        scene: r.scene,
        expected: r.picture,
        emissive: false,
        solid: false,
    }));
    cases
}

fn ours(case: &Case) -> Vec<Row> {
    let mut rows = vec![];
    for (rule, rule_name) in [(Occlusion::Correlated, "correlated"), (Occlusion::Paper, "paper")] {
        for cull in if case.solid { &[true, false][..] } else { &[true] } {
            for cells in [1, 2, 4] {
                let series = if *cull { rule_name.to_owned() } else { format!("{rule_name}, backs kept") };
                rows.push(Row { series, ..our_row(case, rule, *cull, cells) });
            }
        }
    }
    rows
}

fn our_row(case: &Case, rule: Occlusion, cull: bool, cells: u32) -> Row {
    let (time, picture) = timed(|| draw_ours(case, rule, cull, cells));
    row(case, String::new(), format!("{cells}×{cells} cells"), time, &picture)
}

fn draw_ours(case: &Case, rule: Occlusion, cull: bool, cells: u32) -> Picture {
    if case.emissive {
        let options = MicropointOptions::DEFAULT.with_cells_per_pixel(cells).with_occlusion(rule);
        return draw::emissive(&case.scene, options.with_cull_solids(cull)).expect("the scene is valid");
    }
    let mut scene = case.scene.clone();
    scene.render.cells_per_pixel = Some(cells);
    scene.render.occlusion = Some(rule);
    draw::with_pipeline(&scene).expect("the scene is valid")
}

fn points(case: &Case) -> Vec<Row> {
    let casts = case.scene.lights.iter().any(|l| l.shadow);
    // With shadow rays, 16 × 16 would take minutes.
    let sides: &[u32] = if casts { &[1, 2, 4, 8] } else { &[1, 2, 4, 8, 16] };
    let measure = |&n: &u32| {
        let (time, picture) = timed(|| {
            if !casts {
                return point_sampling::render(&case.scene, n, &|_, _, _| 1.0);
            }
            let tree = Tree::new(&case.scene);
            let lights = &case.scene.lights;
            let visible =
                |at: &_, light: usize, sample| tree.transmittance(at, lights[light].light.source(sample));
            point_sampling::render(&case.scene, n, &visible)
        });
        row(case, "point samples".to_owned(), format!("{n}×{n}"), time, &picture)
    };
    sides.iter().map(measure).collect()
}

fn row(case: &Case, series: String, setting: String, time: Timing, picture: &Picture) -> Row {
    let (rmse, largest) = (picture.rmse(&case.expected), picture.largest_error(&case.expected));
    Row { scene: case.name.clone(), series, setting, time, rmse, largest, more: vec![] }
}

fn markdown(rows: &[Row]) -> String {
    let mut text = format!(
        "# Pictures: time against error\n\n`cargo run --release -p studies -- micropoint` made this, on one thread \
         ({}). {SIZE}×{SIZE} pixels, linear colour. {HOW} Building the geometry is included. Expected pictures: a closed form for the lone edge; lines that are exact \
         along themselves, {LINES} a pixel, for the other scenes made by code (each texel a quad of its own for the \
         checker); the pictures that come with the reference scenes. Point samples go through a z-buffer, with a \
         shadow ray through a tree of boxes where a light casts shadows. *Backs kept*: back faces of closed opaque \
         parts are not culled.\n\n## Defaults against point samples\n\n\
         | scene | RMSE | seconds | 4×4 points: RMSE | seconds | most points: RMSE | seconds | same error by points |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
        provenance()
    );
    for scene in scenes(rows) {
        let of = |series: &str| -> Vec<&Row> {
            rows.iter().filter(|r| r.scene == scene && r.series == series).collect()
        };
        let points = of("point samples");
        let ours = of("correlated")[0];
        let (four, most) = (points[2], points[points.len() - 1]);
        let ratio = time_ratio(ours, &points).map_or_else(
            || format!("not reached in {:.1}× our time", most.time.seconds / ours.time.seconds),
            |r| format!("{r:.1}× our time"),
        );
        let _ = writeln!(
            text,
            "| {scene} | {:.2e} | {} | {:.2e} | {} | {:.2e} | {} | {ratio} |",
            ours.rmse, ours.time, four.rmse, four.time, most.rmse, most.time
        );
    }
    let skipped = if data::folder().is_none() { format!("\n{}\n", data::SKIPPED) } else { String::new() };
    text += &skipped;
    text += &embree::section(rows);
    let _ = write!(text, "\n## All settings\n\n{}{skipped}", table(&[], rows));
    text
}
