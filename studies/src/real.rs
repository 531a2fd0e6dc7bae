//! `real`: buildings and trees with their textures and masks, against samples in double precision.
//!
//! Surfaces are matt and flat, which is what both ways of drawing agree on: what is left is coverage, occlusion, textures, masks and shadows.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::Path;

use glam::dvec2;
use pointillist_render::{Material, Scene};
use pointillist_shade::{self as shade, Interpolation};
use rayon::prelude::*;

use crate::common::against_samples::{CELLS, MORE, SAMPLES, Subject, draw_cells, same_error};
use crate::common::data;
use crate::common::picture::Picture;
use crate::common::point_sampling::Pinhole;
use crate::common::provenance::provenance;
use crate::common::ray_reference::{Tree, sampled, with_shadows};
use crate::common::report::{Outcome, Row, on_one_thread, scenes, table, write, write_csv};
use crate::common::scene_text::read_text;
use crate::common::timing::{Clock, HOW, timed_by};

/// A scene of the data, and how it is looked at and lit.
struct View {
    name: &'static str,
    mesh: &'static str,
    /// Values of a scene file: `eye`, `target` and `fov` of the camera.
    camera: [&'static str; 3],
    /// `direction` and `irradiance`.
    sun: [&'static str; 2],
    /// `position` and `intensity`.
    lamp: [&'static str; 2],
}

/// The sun of the buildings, and of the trees.
const IRRADIANCE: [&str; 2] = ["[3.2, 2.9, 2.4]", "[3.4, 3.2, 2.8]"];

const VIEWS: [View; 5] = [
    View {
        name: "Crytek's Sponza",
        mesh: "scenes/sponza-crytek/sponza.obj",
        camera: ["[-420, 190, -130]", "[-1400, 260, 60]", "62"],
        sun: ["[0.25, -1, -0.28]", IRRADIANCE[0]],
        lamp: ["[-900, 260, 40]", "[160000, 130000, 90000]"],
    },
    View {
        name: "Dabrovic's Sponza",
        mesh: "scenes/sponza-dabrovic/sponza.obj",
        camera: ["[-11, 3, 1]", "[6, 4.2, -1.5]", "60"],
        sun: ["[0.3, -1, -0.22]", IRRADIANCE[0]],
        lamp: ["[-2.5, 2.5, 0.7]", "[9, 7, 5]"],
    },
    View {
        name: "Šibenik",
        mesh: "scenes/sibenik/sibenik.obj",
        camera: ["[600, 120, -60]", "[-100, 90, 20]", "60"],
        sun: ["[-0.35, -1, 0.6]", IRRADIANCE[0]],
        lamp: ["[250, 160, 50]", "[60000, 50000, 40000]"],
    },
    View {
        name: "oak",
        mesh: "scenes/oaktree/oaktree.obj",
        camera: ["[1.2, 1.3, 3.1]", "[0, 1, 0]", "36"],
        sun: ["[-0.7, -1, -0.8]", IRRADIANCE[1]],
        lamp: ["[1.1, 0.6, 0.9]", "[1.5, 1.2, 0.8]"],
    },
    View {
        name: "pine",
        mesh: "scenes/pine/pine.obj",
        camera: ["[45, 45, 120]", "[0, 37, 0]", "36"],
        sun: ["[-0.7, -1, -0.8]", IRRADIANCE[1]],
        lamp: ["[30, 20, 30]", "[2000, 1600, 1100]"],
    },
];

/// Width and height in pixels.
const SIZE: [u32; 2] = [640, 360];

/// Samples along a side of a pixel: as a method, and in each half of what is expected.
const SIDES: [u32; 4] = [1, 2, 4, 8];
const FINE: u32 = 24;

/// What is less than this share of the reference's own error can't be told from it.
const TOLD: f64 = 0.3;

/// Rays along a side of a pixel by which faces in one place are found.
const FEELERS: u32 = 8;

/// Two faces are in one place that a ray meets within this share of the way to them.
const TOGETHER: f64 = 1e-9;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Measures and writes `real.csv` and `real.md`; without the data it says so and writes nothing.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    let Some(folder) = data::folder() else {
        eprintln!("real: {}", data::SKIPPED);
        return Ok(true);
    };
    if let Some(missing) = VIEWS.iter().map(|view| folder.join(view.mesh)).find(|mesh| !mesh.is_file()) {
        eprintln!("real: skipped, there is no {}", missing.display());
        return Ok(true);
    }
    let (mut measured, mut rows) = (vec![], vec![]);
    for view in &VIEWS {
        eprintln!("real: {}", view.name);
        let scene = view.scene(&folder)?;
        let subject = Measured::new(view.name, &scene);
        rows.extend(subject.rows(&scene)?);
        measured.push(subject);
    }
    write_csv(out_dir, "real", &MORE, &rows)?;
    write(out_dir, "real.md", &markdown(&measured, &rows))?;
    Ok(true)
}

impl View {
    /// The scene, matt, without triangles that are there twice.
    fn scene(&self, folder: &Path) -> Result<Scene, Fault> {
        let mesh = folder.join(self.mesh).canonicalize()?.display().to_string();
        let ([eye, target, fov], [direction, irradiance], [position, intensity]) =
            (self.camera, self.sun, self.lamp);
        let mut scene = read_text(&format!(
            "[camera]\neye = {eye}\ntarget = {target}\nfov = {fov}\n\
             [[light]]\ntype = \"directional\"\ndirection = {direction}\nirradiance = {irradiance}\n\
             [[light]]\ntype = \"point\"\nposition = {position}\nintensity = {intensity}\n\
             [[object]]\nmesh = {mesh:?}\n"
        ))?;
        [scene.image.width, scene.image.height] = SIZE;
        scene.render.shading = Interpolation::Flat;
        scene.materials.iter_mut().for_each(make_matt);
        drop_copies(&mut scene);
        Ok(scene)
    }
}

/// Leaves what both ways of drawing know: the diffuse colour, the opacity, and a texture of each.
fn make_matt(material: &mut Material) {
    let surface = shade::Material::lambert(material.surface.diffuse).with_opacity(material.surface.opacity);
    let mut plain = Material::new(&*material.name, surface);
    (plain.diffuse_map, plain.opacity_map, plain.wrap) =
        (material.diffuse_map, material.opacity_map, material.wrap);
    *material = plain;
}

/// Takes out triangles with the corners of an earlier one: the leaves of the oak are cards back to back, which samples would count twice.
fn drop_copies(scene: &mut Scene) {
    let mesh = &mut scene.mesh;
    let mut seen = HashSet::new();
    let is_new = |triangle: &[u32; 3]| {
        let mut corners = triangle.map(|v| mesh.positions[v as usize].to_array().map(f64::to_bits));
        corners.sort_unstable();
        seen.insert(corners)
    };
    let kept: Vec<bool> = mesh.triangles.iter().map(is_new).collect();
    retain(&mut mesh.triangles, &kept);
    retain(&mut mesh.material_of, &kept);
    retain(&mut mesh.object_of, &kept);
    retain(&mut mesh.normal_of, &kept);
    retain(&mut mesh.uv_of, &kept);
}

/// Keeps what belongs to the triangles that stay, of a list that may be empty.
fn retain<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut of_triangle = kept.iter();
    list.retain(|_| of_triangle.next() == Some(&true));
}

/// A scene with what is expected of it.
struct Measured {
    subject: Subject,
    triangles: usize,
    tree: Tree,
    /// Pixels in which two faces lie in one place: which of them is seen is not defined.
    undefined: Vec<bool>,
}

impl Measured {
    fn new(name: &str, scene: &Scene) -> Self {
        let tree = Tree::new(scene);
        let show = with_shadows(scene, &tree);
        let [a, b] = [2, 3].map(|seed| sampled(scene, &tree, &show, FINE, seed));
        drop(show);
        let undefined = undefined(scene, &tree);
        let b = without(&undefined, b, &a);
        Self {
            subject: Subject::between(name, [a, b]),
            triangles: scene.mesh.triangles.len(),
            tree,
            undefined,
        }
    }

    fn rows(&self, scene: &Scene) -> Result<Vec<Row>, Fault> {
        let mut rows = vec![];
        for cells in CELLS {
            rows.push(self.row("points", format!("{cells}×{cells}"), || draw_cells(scene, cells))?);
        }
        let show = with_shadows(scene, &self.tree);
        for n in SIDES {
            let draw = || Ok::<_, Fault>(sampled(scene, &self.tree, &show, n, 1));
            rows.push(self.row(SAMPLES, format!("{n}×{n}"), draw)?);
        }
        Ok(rows)
    }

    /// One picture on one thread.
    fn row<E: Send>(
        &self,
        series: &str,
        setting: String,
        draw: impl FnMut() -> Result<Picture, E> + Send,
    ) -> Result<Row, E> {
        let (time, picture) = on_one_thread(|| timed_by(Clock::Processor, draw));
        let picture = without(&self.undefined, picture?, &self.subject.expected);
        let mut row = self.subject.row_of(series, setting, time, &picture);
        // Squares of independent errors add up.
        let floor = self.subject.floor;
        row.rmse = (row.rmse.powi(2) - floor.powi(2)).max((TOLD * floor).powi(2)).sqrt();
        eprintln!(
            "real: {}: {series}, {}: {:.2e} in {} s",
            self.subject.name, row.setting, row.rmse, row.time
        );
        Ok(row)
    }
}

/// The picture with these pixels from another one.
fn without(undefined: &[bool], mut picture: Picture, other: &Picture) -> Picture {
    for ((pixel, of_other), undefined) in picture.pixels.iter_mut().zip(&other.pixels).zip(undefined) {
        if *undefined {
            *pixel = *of_other;
        }
    }
    picture
}

/// The pixels in which a ray meets two faces at once.
fn undefined(scene: &Scene, tree: &Tree) -> Vec<bool> {
    let camera = Pinhole::new(scene);
    let [width, height] = [scene.image.width, scene.image.height].map(|pixels| pixels as usize);
    let meets_two = |x: usize, y: usize, k: u32| {
        let at = dvec2(f64::from(k % FEELERS), f64::from(k / FEELERS)) + 0.5;
        let ray = camera.direction(dvec2(x as f64, y as f64) + at / f64::from(FEELERS));
        // Edges that two triangles share belong to both of them; these rays meet none but by chance.
        let near = |t: f64| [t * (1.0 - TOGETHER), t * (1.0 + TOGETHER)];
        tree.nearest(camera.eye, ray, 0.0).is_some_and(|(_, t)| tree.count(camera.eye, ray, near(t)) > 1)
    };
    (0..width * height)
        .into_par_iter()
        .map(|i| (0..FEELERS * FEELERS).any(|k| meets_two(i % width, i / width, k)))
        .collect()
}

fn markdown(measured: &[Measured], rows: &[Row]) -> String {
    let mut text = format!(
        "# Buildings and trees: time against error\n\n`cargo run --release -p studies -- real` made this, on one thread ({}). Processor seconds, with everything that depends on \
         the geometry and the textures, without reading files. {HOW} Errors are of linear radiance; the bias is the light of the whole picture against that of the expected one, in per cent.\n\n\
         Models with their textures and masks, in a sun and the light of a lamp, both with shadows; {}×{} pixels; every surface matt, flat shading; of triangles with the same corners one \
         is kept. Samples go one into each stratum of the pixel, with shadow rays, through a tree of boxes in double precision and without an offset from surfaces: their errors are those of any \
         ray tracer, their times are not those of the fastest. Expected pictures: 2 × {} samples a pixel; their own error is half of what the halves differ by, and is taken out of all RMSE (the \
         root of the difference of squares; what is less than {TOLD} times it counts as that). Where faces lie in one place, which of them is seen is not defined: pixels in which one of {} rays \
         meets two at once are left out.\n\n\
         | scene | triangles | pixels left out | error of what is expected |\n| --- | ---: | ---: | ---: |\n",
        provenance(),
        SIZE[0],
        SIZE[1],
        FINE * FINE,
        FEELERS * FEELERS,
    );
    for Measured { subject, triangles, undefined, .. } in measured {
        let left_out = undefined.iter().filter(|undefined| **undefined).count();
        let _ = writeln!(text, "| {} | {triangles} | {left_out} | {:.1e} |", subject.name, subject.floor);
    }
    text += &beside_samples(rows);
    let _ = write!(text, "\n## All settings\n\n{}", table(&MORE, rows));
    text
}

/// Every row of ours beside the most samples, and the time that samples need for the same error.
fn beside_samples(rows: &[Row]) -> String {
    let mut text = "\n## Beside samples\n\n\
         | scene | cells | RMSE | bias % | seconds | 64 samples: RMSE | seconds | same error by samples |\n\
         | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    for scene in scenes(rows) {
        let of_scene = || rows.iter().filter(|r| r.scene == scene);
        let samples: Vec<&Row> = of_scene().filter(|r| r.series == SAMPLES).collect();
        let most = samples[samples.len() - 1];
        for ours in of_scene().filter(|r| r.series != SAMPLES) {
            let ratio = same_error(ours, &samples);
            let _ = writeln!(
                text,
                "| {scene} | {} | {:.2e} | {} | {} | {:.2e} | {} | {ratio} |",
                ours.setting, ours.rmse, ours.more[0], ours.time, most.rmse, most.time
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, dvec3};

    use super::*;
    use crate::common::scenes::Sketch;

    #[test]
    fn faces_in_one_place_are_found_and_copies_dropped() {
        let mut sketch = Sketch::new(dvec3(0.0, 0.0, 5.0), DVec3::ZERO, 40.0, 16);
        let white = sketch.matt(0.8, 1.0);
        let square =
            [dvec3(-9.0, -9.0, 0.0), dvec3(0.1, -9.0, 0.0), dvec3(0.1, 9.0, 0.0), dvec3(-9.0, 9.0, 0.0)];
        sketch.polygon(&square, white);
        sketch.textured_back(&square, white);
        let mut scene = sketch.scene;
        let shown = undefined(&scene, &Tree::new(&scene));
        assert!(shown[..7].iter().all(|both| *both) && !shown[15]);
        drop_copies(&mut scene);
        assert_eq!(scene.mesh.triangles.len(), 2);
        assert_eq!(scene.mesh.material_of.len(), 2);
        assert!(!undefined(&scene, &Tree::new(&scene)).contains(&true));
    }
}
