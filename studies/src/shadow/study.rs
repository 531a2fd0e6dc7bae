//! `shadow`: run time against error of shadows, beside a shadow map.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use glam::DVec3;
use pointillist_micropoint::{MicropointOptions, Occlusion, PlainOpacity, Renderer, Tile};
use pointillist_render::Scene;
use pointillist_shade::Source;
use pointillist_shadow::{Emitter, Receivers, Resolution, ShadowLight, ShadowOptions, ShadowScratch, Viewer};

use crate::common::casters;
use crate::common::charts::chart;
use crate::common::closed_form;
use crate::common::draw;
use crate::common::picture::Picture;
use crate::common::provenance::provenance;
use crate::common::ray_reference::{self, Tree, with_shadows};
use crate::common::report::{Outcome, Row, on_one_thread, table, time_ratio, write, write_csv};
use crate::common::scenes::{SurfaceSample, radiance};
use crate::common::timing::{Clock, HOW, Timing, timed_part};
use crate::shadow::shadow_map::ShadowMap;

/// Pixels on a side.
const SIZE: u32 = 192;

/// Rays a side of a pixel at an edge in reference pictures.
const FINE: u32 = 24;

/// A scene with one light and what it must look like.
struct Case {
    name: &'static str,
    scene: Scene,
    expected: Picture,
    /// How far the expected picture may itself be off; 0 for a closed form.
    floor: f64,
    /// The scene without any shadow.
    bright: Picture,
    /// A plain shadow map has an answer.
    opaque: bool,
}

/// Measures and writes `shadow.csv`, `shadow.md` and `shadow.svg`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let mut rows = vec![];
    let cases = cases();
    for case in &cases {
        eprintln!("shadow: {}", case.name);
        on_one_thread(|| {
            rows.extend(ours(case));
            if case.opaque {
                rows.extend(maps(case));
            }
        });
    }
    write_csv(out_dir, "shadow", &MORE, &rows)?;
    chart(out_dir, "shadow", &rows)?;
    write(out_dir, "shadow.md", &markdown(&cases, &rows))?;
    Ok(true)
}

/// Columns of the tables beyond the usual.
const MORE: [&str; 2] = ["acne pixels", "leak pixels"];

fn cases() -> Vec<Case> {
    let edge = casters::half_plane(SIZE);
    let (line, lit) = casters::half_plane_edge();
    let expected = closed_form::half_plane(&edge, line, lit, casters::half_plane_color());
    let bright = without_shadow(&edge);
    let mut cases =
        vec![Case { name: "half-plane", scene: edge, expected, floor: 0.0, bright, opaque: true }];
    let by_rays = |name, scene: Scene, opaque| {
        let tree = Tree::new(&scene);
        let show = with_shadows(&scene, &tree);
        let [a, b] = [1, 2].map(|seed| ray_reference::render(&scene, &tree, &show, FINE, seed));
        // Two independent halves: their mean is off by half of what they differ.
        let floor = 0.5 * a.rmse(&b);
        let expected = a.mean(&b);
        let bright = without_shadow(&scene);
        Case { name, scene: scene.clone(), expected, floor, bright, opaque }
    };
    cases.push(by_rays("spheres", casters::spheres(SIZE), true));
    cases.push(by_rays("fence", casters::fence(SIZE), true));
    cases.push(by_rays("fence in the sun", casters::fence_in_the_sun(SIZE), true));
    cases.push(by_rays("cage, spot light", casters::cage(SIZE), true));
    cases.push(by_rays("terrain, 5° light", casters::terrain(SIZE), true));
    cases.push(by_rays("translucent panes", casters::panes(SIZE), false));
    cases
}

/// Finds how much light the micropoints of a tile get.
type FindLit<'a> = dyn FnMut(&Tile, &mut Vec<f64>) + 'a;

/// Draws a scene of one light from its micropoints; seconds are those that `find_lit` took.
fn draw_lit(scene: &Scene, cells: u32, find_lit: &mut FindLit<'_>) -> (Picture, f64) {
    let geometry = draw::geometry(scene).expect("the scene is valid");
    let view = draw::view(scene).expect("the camera is valid");
    let options = MicropointOptions::DEFAULT.with_cells_per_pixel(cells);
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, options).expect("the options are valid");
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    let (mut tile, mut lit, mut seconds) = (Tile::default(), vec![], 0.0);
    for rect in renderer.picture().tiles(draw::TILE_SIZE) {
        renderer.render(rect, &mut tile);
        let start = Instant::now();
        find_lit(&tile, &mut lit);
        seconds += start.elapsed().as_secs_f64();
        for (i, m) in tile.points().iter().enumerate() {
            let color = radiance(scene, &sample(scene, &tile, i), &|_, _, _| lit[i]);
            picture.pixels[m.y as usize * picture.width + m.x as usize] += m.weight * color;
        }
    }
    (picture, seconds)
}

/// The point in the middle of a micropoint.
fn sample(scene: &Scene, tile: &Tile, point: usize) -> SurfaceSample {
    let m = &tile.points()[point];
    let at = tile.surface_point(m.face, m.grid);
    let relative = tile.position(m.grid, at.nearness);
    let triangle = tile.faces()[m.face as usize].id;
    SurfaceSample { triangle, position: scene.camera.eye + relative, to_eye: -relative }
}

fn without_shadow(scene: &Scene) -> Picture {
    let mut all_lit = |tile: &Tile, lit: &mut Vec<f64>| {
        lit.clear();
        lit.resize(tile.points().len(), 1.0);
    };
    draw_lit(scene, 1, &mut all_lit).0
}

fn ours(case: &Case) -> Vec<Row> {
    let geometry = draw::geometry(&case.scene).expect("the scene is valid");
    let emitter = match case.scene.lights[0].light.source(0) {
        Source::Direction(direction) => Emitter::Directional { direction },
        Source::Position(position) => Emitter::Point { position, axis: DVec3::NEG_Y },
        _ => unreachable!("light comes from a point or a direction"),
    };
    let mut rows = vec![];
    for (rule, name) in [(Occlusion::Correlated, "correlated"), (Occlusion::Paper, "paper")] {
        for cells in [0, 64, 256, 1024, 4096] {
            let resolution = if cells == 0 { Resolution::Auto } else { Resolution::Cells(cells) };
            let options = ShadowOptions::default().with_occlusion(rule).with_resolution(resolution);
            let (time, picture) = timed_part(Clock::Wall, || {
                let start = Instant::now();
                let light =
                    ShadowLight::new(&geometry, &PlainOpacity, emitter, options).expect("a valid light");
                let set_up = start.elapsed().as_secs_f64();
                let mut scratch = Scratch::default();
                let found = draw_lit(&case.scene, 1, &mut |tile, lit| scratch.find(&light, tile, lit));
                (set_up + found.1, found.0)
            });
            let setting = if cells == 0 { "auto".to_owned() } else { format!("{cells} cells") };
            rows.push(row(case, name, setting, time, &picture));
        }
    }
    rows
}

/// Memory of a shadow pass.
#[derive(Default)]
struct Scratch {
    receivers: Receivers,
    shadow: ShadowScratch,
    lit: Vec<f64>,
}

impl Scratch {
    /// Lit fractions of a tile's micropoints.
    fn find(&mut self, light: &ShadowLight<'_>, tile: &Tile, lit: &mut Vec<f64>) {
        self.receivers.clear();
        self.receivers.push_tile(tile);
        let viewer = Viewer { lens: tile.lens(), faces: tile.faces() };
        light.lit(viewer, &self.receivers, &mut self.shadow, &mut self.lit);
        lit.clear();
        let mut next = 0;
        for m in tile.points() {
            let fragments = tile.fragments(m);
            let (mut sum, mut total) = (0.0, 0.0);
            for f in fragments {
                sum += f.weight * self.lit[next];
                total += f.weight;
                next += 1;
            }
            lit.push(if total > 0.0 { sum / total } else { 0.0 });
        }
    }
}

fn maps(case: &Case) -> Vec<Row> {
    let scene = &case.scene;
    let source = scene.lights[0].light.source(0);
    let mut rows = vec![];
    let all = [256, 512, 1024, 2048, 4096];
    for (cells, lookups, kernels, sides) in
        [(1, "1 lookup", &[1, 3, 5][..], &all[..]), (4, "16 lookups", &[1, 3], &[1024, 4096])]
    {
        for &kernel in kernels {
            for &side in sides {
                let (time, picture) = timed_part(Clock::Wall, || {
                    let start = Instant::now();
                    let map = ShadowMap::new(scene, source, side, kernel);
                    let set_up = start.elapsed().as_secs_f64();
                    let (picture, found) =
                        draw_lit(scene, cells, &mut |tile, lit| look_up(scene, &map, tile, lit));
                    (set_up + found, picture)
                });
                let series = format!("map {kernel}×{kernel}, {lookups}");
                rows.push(row(case, &series, format!("{side} texels"), time, &picture));
            }
        }
    }
    rows
}

fn look_up(scene: &Scene, map: &ShadowMap, tile: &Tile, lit: &mut Vec<f64>) {
    lit.clear();
    for i in 0..tile.points().len() {
        let at = sample(scene, tile, i);
        let to_light = match scene.lights[0].light.source(0) {
            Source::Position(p) => p - at.position,
            Source::Direction(d) => -d,
            _ => unreachable!("light comes from a point or a direction"),
        };
        lit.push(map.lit(scene, &at, to_light));
    }
}

fn row(case: &Case, series: &str, setting: String, time: Timing, picture: &Picture) -> Row {
    let (acne, leak) = wrong_pixels(case, picture);
    Row {
        scene: case.name.to_owned(),
        series: series.to_owned(),
        setting,
        time,
        rmse: picture.rmse(&case.expected),
        largest: picture.largest_error(&case.expected),
        more: vec![acne.to_string(), leak.to_string()],
    }
}

/// Fully lit pixels that come out darker, and dark ones that come out lit, by more than a twentieth.
fn wrong_pixels(case: &Case, picture: &Picture) -> (usize, usize) {
    let (mut acne, mut leak) = (0, 0);
    let sum = |p: &DVec3| p.element_sum();
    for ((got, expected), bright) in picture.pixels.iter().zip(&case.expected.pixels).zip(&case.bright.pixels)
    {
        let (got, expected, bright) = (sum(got), sum(expected), sum(bright));
        if bright > 1e-3 {
            acne += usize::from(expected >= 0.995 * bright && got < 0.95 * bright);
            leak += usize::from(expected <= 1e-9 && got > 0.05 * bright);
        }
    }
    (acne, leak)
}

fn markdown(cases: &[Case], rows: &[Row]) -> String {
    let mut text = format!(
        "# Shadows: time against error\n\n`cargo run --release -p studies -- shadow` made this, on one thread ({}). \
         {SIZE}×{SIZE} pixels. Seconds are those of the shadow pass alone: everybody sees the same micropoints. \
         {HOW} Errors are of linear radiance, where a white surface in full light has about 1.\n\nThe half-plane \
         has a closed form. The other expected pictures are by rays, 2 × {} a pixel at edges; the error that they have \
         themselves is the *floor*. *Acne* pixels are in full light and came out darker by 5 % or more, *leak* pixels are \
         in full shadow and got 5 % of the light or more. The shadow map covers the whole scene, its lookups are \
         moved along the normal as far as the kernel and the slope ask for; with 16 lookups it is asked at the \
         micropoints of 4×4 cells a pixel. It has no answer for translucent panes.\n\n\
         ## Default beside the best shadow maps\n\n| scene | floor | RMSE | seconds | acne | leak | smallest RMSE of a map | which | seconds | acne | leak | fastest map of that error |\n\
         | --- | ---: | ---: | ---: | ---: | ---: | ---: | --- | ---: | ---: | ---: | --- |\n",
        provenance(),
        FINE * FINE
    );
    for case in cases {
        let of_scene: Vec<&Row> = rows.iter().filter(|r| r.scene == case.name).collect();
        let ours = of_scene[0];
        let _ = write!(
            text,
            "| {} | {:.1e} | {:.2e} | {} | {} | {} |",
            case.name, case.floor, ours.rmse, ours.time, ours.more[0], ours.more[1]
        );
        let maps: Vec<&Row> = of_scene.iter().copied().filter(|r| r.series.starts_with("map")).collect();
        match maps.iter().min_by(|a, b| a.rmse.total_cmp(&b.rmse)) {
            None => text += " – | – | – | – | – | – |\n",
            Some(best) => {
                let reached = time_ratio(ours, &maps)
                    .map_or_else(|| "none gets there".to_owned(), |r| format!("{r:.1}× our time"));
                let _ = writeln!(
                    text,
                    " {:.2e} | {}, {} | {} | {} | {} | {reached} |",
                    best.rmse, best.series, best.setting, best.time, best.more[0], best.more[1]
                );
            }
        }
    }
    let _ = write!(text, "\n## All settings\n\n{}", table(&MORE, rows));
    text
}
