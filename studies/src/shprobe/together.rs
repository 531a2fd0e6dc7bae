//! Whole pictures in light that is sent from surface to surface: by radiosity, and by probes that know what they see, against paths.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use cpu_time::ProcessTime;
use glam::{DVec3, dvec3};
use pointillist_render::{AmbientLight, Lamps, Lightmap, Material, Scene, scene_surfaces, with_lamps};
use pointillist_shade as shade;
use pointillist_shprobe::place;

use crate::common::data::SKIPPED;
use crate::common::draw;
use crate::common::kept::with_sections;
use crate::common::paths;
use crate::common::picture::Picture;
use crate::common::ray_reference::Tree;
use crate::common::report::{Outcome, write};
use crate::radiosity::buildings::{SUN, Sizes, bake};
use crate::shprobe::canvas::{save, sheet};
use crate::shprobe::known::{Counts, Known};
use crate::shprobe::site::{Ground, Site, from_data, lit_by};

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Pixels of pictures.
const SIZE: [u32; 2] = [800, 500];

/// Paths of a pixel, in either half of the reference.
const PATHS: u32 = 16;

/// Numbers of probes.
const PROBES: [usize; 2] = [86, 192];

/// What probes are chosen among and fitted to.
pub(crate) const FIT: Counts = Counts { openings: 200, free: 300, surfaces: 1200 };

/// Patches along the longest side, and how much finer they may become.
const PATCHES: Sizes = (32.0, 16.0);

/// Mean of the picture's light that is shown as this: a grey of 18 %.
const SHOWN: f64 = 0.18;

/// Two stops.
const BRIGHTENED: f64 = 4.0;

/// A picture's error: root mean square over the mean, without the noise of the reference.
pub(crate) struct Error {
    pub(crate) relative: f64,
    /// How much brighter than the reference as a whole.
    pub(crate) bias: f64,
}

/// Two pictures by paths, drawn apart: an error that is the product of differences from either has no noise of theirs in it.
pub(crate) struct Reference {
    halves: [Picture; 2],
    mean: f64,
    seconds: f64,
}

impl Reference {
    /// By so many paths a pixel in either.
    pub(crate) fn new(scene: &Scene, per_pixel: u32) -> Self {
        let start = ProcessTime::now();
        let tree = Tree::new(scene);
        let halves = [1, 2].map(|seed| paths::picture(scene, &tree, per_pixel, seed));
        let count = 6 * halves[0].pixels.len();
        let mean = halves.iter().map(Picture::total).sum::<f64>() / count as f64;
        Self { halves, mean, seconds: start.elapsed().as_secs_f64() }
    }

    pub(crate) fn error(&self, picture: &Picture) -> Error {
        let [a, b] = &self.halves;
        let of = |((p, a), b): ((&DVec3, &DVec3), &DVec3)| (*p - *a).dot(*p - *b);
        let square: f64 = picture.pixels.iter().zip(&a.pixels).zip(&b.pixels).map(of).sum();
        let count = 3 * a.pixels.len();
        let rmse = (square / count as f64).max(0.0).sqrt();
        Error { relative: rmse / self.mean, bias: picture.total() / (count as f64 * self.mean) - 1.0 }
    }

    /// Its own noise, as an error.
    pub(crate) fn noise(&self) -> f64 {
        let [a, b] = &self.halves;
        0.5 * a.rmse(b) / self.mean
    }
}

/// One of [`PARTS`]: two rooms seen from the dark one, or a building, if the data are there.
fn site(part: &str) -> Option<Site> {
    let mut site = match part {
        "rooms" => {
            let mut rooms = Site::thin_wall();
            (rooms.scene.camera.eye, rooms.scene.camera.target) =
                (dvec3(7.7, 2.0, 3.7), dvec3(4.1, 1.0, 1.0));
            Site { name: "Two rooms, from the dark one", ..rooms }
        }
        "sponza" => {
            let camera = "eye = [-11, 2.2, -0.8]\ntarget = [5, 4, 1]";
            let lamp = "[[light]]\ntype = \"point\"\nposition = [-9, 3, 0.5]\nintensity = [16, 13, 9]\n";
            let scene = from_data("scenes/sponza-dabrovic/sponza.obj", 1.0, camera, &format!("{SUN}{lamp}"))?;
            Site { name: "Sponza", scene, candidates: [20, 8, 10], ..Site::sponza()? }
        }
        _ => {
            let camera = "eye = [30, 6, -3]\ntarget = [-5, 4.5, 1]";
            let lights = "[[light]]\ntype = \"directional\"\ndirection = [-0.35, -1, 0.6]\nirradiance = [3.2, 2.9, 2.4]\n\
                 [[light]]\ntype = \"point\"\nposition = [12.5, 8, 2.5]\nintensity = [150, 125, 100]\n";
            let scene = from_data("scenes/sibenik/sibenik.obj", 0.05, camera, lights)?;
            Site { name: "Šibenik", scene, candidates: [20, 8, 10], ..Site::sibenik()? }
        }
    };
    [site.scene.image.width, site.scene.image.height] = SIZE;
    site.probe_px = 24;
    without_maps(&mut site.scene);
    Some(site)
}

/// Leaves diffuse colours alone: the paths know nothing else.
fn without_maps(scene: &mut Scene) {
    for material in &mut scene.materials {
        let surface = shade::Material::lambert(material.surface.diffuse);
        *material = Material::new(&*material.name, surface.with_emission(material.surface.emission));
    }
    scene.render.shading = shade::Interpolation::Flat;
}

/// What is the same in all sections.
fn head() -> String {
    format!(
        "# Light between surfaces, in whole pictures\n\n`cargo run --release -p studies -- together`; `together DIR` draws, too, and `together DIR PART…` does some of `rooms`, `sponza` and `sibenik` \
         alone. Each section says on what it was measured.\n\n\
         {} × {} pixels, direct light by `render` in all of them. *Radiosity*: patches of a {}nd of the longest side, \
         divided down to a {}th of that for drawing. Probes know what they see, are chosen among a grid, places about openings, and fitted to free places and surfaces; what they see is lit by that solution. \
         The reference is two pictures of {PATHS} paths a pixel each, drawn apart: the mean of the product of the differences from either, over the mean of the picture. Materials are diffuse and without maps.\n\n{SEEN}",
        SIZE[0], SIZE[1], PATCHES.0, PATCHES.1
    )
}

/// Names of the sites on the command line.
const PARTS: [&str; 3] = ["rooms", "sponza", "sibenik"];

/// Measures all and writes `together.md`.
pub(crate) fn run(out_dir: &Path) -> Outcome {
    run_parts(out_dir, None, &PARTS)
}

/// Measures some sites, and puts their sections in the place of those of the same name; draws the pictures to `folder`, too, if one is given.
pub(crate) fn run_parts(out_dir: &Path, folder: Option<&Path>, parts: &[&str]) -> Outcome {
    if let Some(unknown) = parts.iter().find(|part| !PARTS.contains(part)) {
        return Err(format!("no part `{unknown}`: there are {}", PARTS.join(", ")).into());
    }
    if let Some(folder) = folder {
        std::fs::create_dir_all(folder)?;
    }
    let before = std::fs::read_to_string(out_dir.join("together.md")).unwrap_or_default();
    let mut whole = with_sections(&head(), &before, "");
    for part in if parts.is_empty() { &PARTS } else { parts } {
        let Some(site) = site(part) else {
            eprintln!("{SKIPPED}");
            continue;
        };
        eprintln!("together: {}", site.name);
        let mut text = format!(
            "\n## {}\n\n| light by | error % | brighter % | processor seconds |\n| --- | ---: | ---: | ---: |\n",
            site.name
        );
        building(&site, folder, &mut text)?;
        whole = with_sections(&head(), &whole, &text);
        write(out_dir, "together.md", &whole)?;
    }
    Ok(true)
}

/// What a person saw in the pictures when they were looked at last.
const SEEN: &str = "\
     The pictures: [two rooms](../../docs/together-rooms.jpg), [Sponza](../../docs/together-sponza.jpg), \
     [Šibenik](../../docs/together-sibenik.jpg), each by paths, by radiosity, by 86 and by 192 probes. What is to be seen in them at full size, \
     plain and brightened by two stops: in the two rooms, by probes, nothing but soft brighter and darker places beside the foot of the doorway; by 192 probes the underside of the foremost capital \
     of Sponza and the reveal and foot of the door on the left are too bright, since probes metres away see them, but not what stands close around them (ARCHITECTURE.md says what was tried); and in Šibenik, by probes, some specks at ledges of the left wall, and all of it too dark.\n";

/// The light that surfaces send on, by radiosity, and the processor seconds of solving for it.
pub(crate) fn sent_on(scene: &Scene) -> Result<(Lightmap, f64), Fault> {
    let found = scene_surfaces(scene)?;
    let cost = with_lamps(&Lamps::new(scene), |lamps| bake(&found.surfaces, lamps, PATCHES))?;
    Ok((Lightmap::of_baked(&cost.baked, &found.faces, scene.mesh.triangles.len())?, cost.seconds))
}

fn building(site: &Site, folder: Option<&Path>, text: &mut String) -> Result<(), Fault> {
    let reference = Reference::new(&site.scene, PATHS);
    let mut row = |name: &str, error: &Error, seconds: f64| -> Result<(), Fault> {
        let Error { relative, bias } = *error;
        let line = format!("| {name} | {:.1} | {:+.1} | {seconds:.0} |", 100.0 * relative, 100.0 * bias);
        eprintln!("    {line}");
        Ok(writeln!(text, "{line}")?)
    };
    let noise = Error { relative: reference.noise(), bias: 0.0 };
    row("(noise of the paths)", &noise, reference.seconds)?;
    let mut shown = vec![reference.halves[0].mean(&reference.halves[1])];

    let plain = draw::with_pipeline(&site.scene)?;
    row("nothing else than lamps", &reference.error(&plain), 0.0)?;

    let (map, seconds) = sent_on(&site.scene)?;
    let mut lit = site.scene.clone();
    lit.ambient = AmbientLight::Radiosity { light: Box::new(map.clone()), fingerprint: 0 };
    let picture = draw::with_pipeline(&lit)?;
    row("radiosity", &reference.error(&picture), seconds)?;
    shown.push(picture);

    let ground = Ground::lit(site, Some(map))?;
    let start = Instant::now();
    let known = Known::look(&ground, &FIT)?;
    eprintln!("    candidates in {:.0} s", start.elapsed().as_secs_f64());
    for count in PROBES {
        let start = ProcessTime::now();
        let [_, fitted] = known.adaptive(count, place::BALANCE, true)?;
        let seconds = start.elapsed().as_secs_f64();
        let picture = draw::with_pipeline(&lit_by(&site.scene, &fitted, true)?)?;
        row(&format!("{count} probes"), &reference.error(&picture), seconds)?;
        shown.push(picture);
    }
    if let Some(folder) = folder {
        let name = site.name.split(',').next().unwrap_or(site.name).to_lowercase().replace(' ', "-");
        let gain = SHOWN / reference.mean;
        for (word, gain) in [("", gain), ("-bright", BRIGHTENED * gain)] {
            save(&sheet(&shown, 2), gain, &folder.join(format!("together-{name}{word}.png")))?;
        }
    }
    Ok(())
}
