//! Buildings by links that are rays: cost, and error against paths.

use std::fmt::Write as _;
use std::path::Path;

use cpu_time::ProcessTime;
use glam::{DVec3, dvec3};
use pointillist_cli::scene::{Overrides, load_to_bake};
use pointillist_radiosity::invariants::paths::Paths;
use pointillist_radiosity::{
    Baked, Lamp, RayOptions, RayTransport, Rgb, Scene, SceneOptions, SolveOptions, Surface,
};
use pointillist_render::{Lamps, Lightmap, scene_surfaces, with_lamps};
use rayon::prelude::*;

use crate::common::charts::chart_along;
use crate::common::data::{SKIPPED, folder};
use crate::common::report::{Outcome, Row};
use crate::common::timing::Timing;
use crate::radiosity::memory;
use crate::radiosity::paths::{Error, PATHS, POINTS, Reference, room_around, size_of};

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Patches along the longest side, and how much finer they may become.
const ACROSS: f64 = 32.0;
const FINER: f64 = 8.0;

/// The light of the sun, in all buildings.
pub(crate) const SUN: &str =
    "[[light]]\ntype = \"directional\"\ndirection = [0.25, -1.0, -0.28]\nirradiance = [3.2, 2.9, 2.4]\n";
const BUILDINGS: [(&str, &str, &str); 3] = [
    (
        "Dabrovic's Sponza",
        "scenes/sponza-dabrovic/sponza.obj",
        "[[light]]\ntype = \"point\"\nposition = [-9, 3, 0.5]\nintensity = [16, 13, 9]\n",
    ),
    (
        "Šibenik",
        "scenes/sibenik/sibenik.obj",
        "[[light]]\ntype = \"point\"\nposition = [-100, 120, 0]\nintensity = [2e5, 1.8e5, 1.5e5]\n\
         [[light]]\ntype = \"point\"\nposition = [400, 150, 0]\nintensity = [2e5, 2e5, 2.3e5]\n",
    ),
    (
        "Crytek's Sponza",
        "scenes/sponza-crytek/sponza.obj",
        "[[light]]\ntype = \"point\"\nposition = [-900, 260, 40]\nintensity = [160000, 130000, 90000]\n",
    ),
];

/// What one building took.
pub(crate) struct Cost {
    pub(crate) seconds: f64,
    patches: usize,
    links: usize,
    pub(crate) baked: Baked,
    transport: RayTransport,
    gathered: Vec<Rgb>,
}

/// Patches along the longest side, and how much finer they may become.
pub(crate) type Sizes = (f64, f64);

pub(crate) fn bake(
    surfaces: &[Surface],
    lamps: &[Lamp<'_>],
    (across, finer): Sizes,
) -> Result<Cost, pointillist_radiosity::RadiosityError> {
    let start = ProcessTime::now();
    let tell = |what: &str| eprintln!("    {:6.1} s {what}", start.elapsed().as_secs_f64());
    let patch = size_of(surfaces) / across;
    let options = SceneOptions::for_rays(patch);
    let mut scene = Scene::new(surfaces, &options)?;
    tell("divided");
    let direct = scene.direct(lamps)?;
    tell("direct light");
    let options = RayOptions::DEFAULT.with_finest(patch / finer);
    let transport = scene.transport_by_rays(&direct, &options, &|_| ())?;
    tell("links");
    let solution = transport.solve(&SolveOptions::DEFAULT.with_tolerance(1e-4))?;
    tell("solution");
    let baked = solution.bake();
    tell("vertices");
    let counts = transport.counts();
    let seconds = start.elapsed().as_secs_f64();
    let gathered = solution.gathered().to_vec();
    Ok(Cost { seconds, patches: counts.patches, links: counts.links, baked, transport, gathered })
}

/// Time, memory and error of the buildings among the large data.
pub(crate) fn solve(text: &mut String) -> Outcome {
    writeln!(
        text,
        "\n## Buildings\n\nLinks by rays, patches of a {ACROSS}nd of the longest side, for drawing divided down to an {FINER}th of that; direct light, links, solution and \
         vertices together, in processor seconds of all threads; memory is the most that the process had meanwhile, the scene with its pictures included. Error: of the baked \
         irradiance without the lamps' own, as `render` reads it, at {POINTS} points of surfaces, spread by area, mean of the bands: root mean square over that of the paths' \
         light (in brackets over its mean). The reference is two halves of {PATHS} paths a point each, drawn apart: the mean of the product of the differences from \
         either has no noise of theirs in it. Its own noise is that of both halves together. ± is the standard error over ten groups of points. \
         *At the points themselves*: by rays from there into the solution, without vertices between which light is interpolated.\n"
    )?;
    let Some(folder) = folder() else {
        writeln!(text, "{SKIPPED}")?;
        return Ok(true);
    };
    writeln!(
        text,
        "| building | surfaces | patches | links | vertices | processor seconds | MiB | error % | without the worst twentieth % | at the points themselves % | noise of the paths % | points |"
    )?;
    writeln!(text, "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")?;
    let mut around = vec![];
    for (name, mesh, lights) in BUILDINGS {
        eprintln!("  {name}");
        around.push(building(text, name, &folder.join(mesh), lights)?);
    }
    writeln!(text, "\nAround the lamps: {}.", around.join("; "))?;
    text.push_str(WORST);
    text.push_str(TIME);
    Ok(true)
}

/// What was found where the error was largest, point by point, and what was tried.
const WORST: &str = "\nWhat errs most. Before patches were divided at the edges of shadows, six of the 500 points made 74 % of the squared error in Dabrovic's Sponza, and five made 65 % in Šibenik; the halves of the \
    reference agree within some per cent there. They were of three kinds: points near a patch that is half in the sun, which was taken for evenly lit; long, narrow triangles about arches, of which one corner is within \
    centimetres of a bright moulding (6.7 times the mean light, 1.8 times in the middle); and places in gaps of centimetres. Sponza, by what is done about them (processor seconds beside much other work, 78 for the first): \
    nothing 8.5 ± 1.5 % (5.3 % at the points themselves); vertices where light changes over a tenth in the place of a quarter of the distance from which it comes, 8.5; patches a quarter as large at edges of shadows, and \
    vertices there, too, 5.6 ± 0.6 (2.9), 98 s; the same without vertices there, 7.3 ± 1.5 (2.9), 87 s; and long triangles divided by their length, 4.5 ± 0.6 (2.9), 105 s at a higher load, with a third more vertices. That \
    is what is done; Šibenik errs by 8.2 ± 1.2 % then (2.0), from 10.2 ± 1.9 (3.3).\n";

/// What takes the time, and what was tried.
const TIME: &str = "\nWhat takes the time: of 71 s for the vertices of Dabrovic's Sponza (in the sun alone, beside other work; a profiler, and counters that are not in the code, said so) rays took 65 %, what neighbours have seen 9 %, and finding neighbours 6 %. A seventh of the vertices take two thirds of the 94 million \
    rays, because they reach the most that a vertex may have, 1024. With at most 512 it was 56 s, but streaks showed in the vaults when brightened by two stops. Rays by 36 or 64 parts of the hemisphere in the place of 16 are as many, for the \
    same errors. What has helped: neighbours found without a list of all that are near (86 to 71 s), two triangles in the leaves of the tree in the place of four (5 %), and not to take the error of many rays, which are spread evenly, for that of independent ones (a tenth of the rays).\n";

/// The scene of a building in the sun and in the light of some lamps.
fn load(mesh: &Path, lights: &str) -> Result<pointillist_render::Scene, Fault> {
    let toml =
        format!("[camera]\neye = [0, 0, 0]\ntarget = [1, 0, 0]\n[[object]]\nmesh = {mesh:?}\n{SUN}{lights}");
    let file = std::env::temp_dir().join(format!("pointillist-building-{}.toml", std::process::id()));
    std::fs::write(&file, toml)?;
    let scene = load_to_bake(&file, &Overrides::default());
    std::fs::remove_file(&file)?;
    Ok(scene?.scene)
}

/// One row of the table; returns what is around the lamps.
fn building(text: &mut String, name: &str, mesh: &Path, lights: &str) -> Result<String, Fault> {
    let scene = load(mesh, lights)?;
    let found = scene_surfaces(&scene)?;
    let lamps = Lamps::new(&scene);
    with_lamps(&lamps, |lamps| {
        memory::forget_peak();
        let cost = bake(&found.surfaces, lamps, (ACROSS, FINER))?;
        let megabytes = memory::peak_mebibytes().map_or("–".to_owned(), |m| format!("{m:.0}"));
        let map = Lightmap::of_baked(&cost.baked, &found.faces, scene.mesh.triangles.len())?;
        let reference = Reference::new(&found.surfaces, &Paths::new(&found.surfaces, lamps));
        eprintln!("    reference of {} points", reference.points.len());
        let error = reference.error(&|surface, front, position| {
            let face = |&f: &u32| map.irradiance(f, front, position).as_dvec3().element_sum() / 3.0;
            found.faces[surface].first().map_or(0.0, face)
        });
        let at_points = itself(&cost, &reference)?;
        let row = format!(
            "| {name} | {} | {} | {} | {} | {:.0} | {megabytes} | {:.1} ± {:.1} ({:.1}) | {:.1} | {:.1} ± {:.1} | {:.1} | {} |",
            found.surfaces.len(),
            cost.patches,
            cost.links,
            cost.baked.vertices.len(),
            cost.seconds,
            100.0 * error.relative,
            100.0 * error.doubt,
            100.0 * error.to_mean,
            100.0 * error.without_worst,
            100.0 * at_points.relative,
            100.0 * at_points.doubt,
            100.0 * error.noise,
            reference.points.len(),
        );
        eprintln!("    {row}");
        writeln!(text, "{row}")?;
        Ok(format!("{name}: {}", room_around(&found.surfaces, lamps)))
    })
}

/// Sizes of patches: cost and error of the first building.
pub(crate) fn sizes(text: &mut String) -> Outcome {
    const TRIED: [Sizes; 5] = [(32.0, 1.0), (32.0, 4.0), (32.0, 8.0), (32.0, 16.0), (64.0, 4.0)];
    let (name, mesh, lights) = BUILDINGS[0];
    writeln!(
        text,
        "\n## Error against the size of patches\n\n{name} as above: patches along the longest side, and how much finer those for drawing may become.\n"
    )?;
    let Some(folder) = folder() else {
        writeln!(text, "{SKIPPED}")?;
        return Ok(true);
    };
    writeln!(
        text,
        "| patches | finer | vertices | processor seconds | error % | without the worst twentieth % |\n| ---: | ---: | ---: | ---: | ---: | ---: |"
    )?;
    let scene = load(&folder.join(mesh), lights)?;
    let found = scene_surfaces(&scene)?;
    let lamps = Lamps::new(&scene);
    with_lamps(&lamps, |lamps| {
        let reference = Reference::new(&found.surfaces, &Paths::new(&found.surfaces, lamps));
        for (across, finer) in TRIED {
            let cost = bake(&found.surfaces, lamps, (across, finer))?;
            let map = Lightmap::of_baked(&cost.baked, &found.faces, scene.mesh.triangles.len())?;
            let error = reference.error(&|surface, front, position| {
                let face = |&f: &u32| map.irradiance(f, front, position).as_dvec3().element_sum() / 3.0;
                found.faces[surface].first().map_or(0.0, face)
            });
            let row = format!(
                "| {across} | {finer} | {} | {:.0} | {:.1} ± {:.1} | {:.1} |",
                cost.baked.vertices.len(),
                cost.seconds,
                100.0 * error.relative,
                100.0 * error.doubt,
                100.0 * error.without_worst
            );
            eprintln!("    {row}");
            writeln!(text, "{row}")?;
        }
        Ok(true)
    })
}

/// The error of the solution where light is gathered at the points themselves, by as many rays as its own noise asks for.
fn itself(cost: &Cost, reference: &Reference) -> Result<Error, Fault> {
    /// Times that a point is asked, each a hair beside it, which takes other rays.
    const TIMES: usize = 16;
    let solution =
        cost.transport.solve_from(cost.gathered.clone(), &SolveOptions::DEFAULT.with_tolerance(1e-4))?;
    let lights = reference
        .points
        .par_iter()
        .map(|p| {
            (1..=TIMES).try_fold(0.0, |sum, k| {
                let beside = p.at + p.normal * (p.at.abs().max_element() * 1e-12 * k as f64 + reference.lift);
                Ok(sum + solution.irradiance(beside, p.normal)?.iter().sum::<f64>() / (3 * TIMES) as f64)
            })
        })
        .collect::<Vec<Result<f64, pointillist_radiosity::RadiosityError>>>();
    let lights: Vec<f64> = lights.into_iter().collect::<Result<_, _>>()?;
    Ok(reference.error_of(&lights))
}

/// How cost grows with the number of surfaces: halls of columns, each of 24 sides. Draws `radiosity-growth.svg`.
pub(crate) fn growth(text: &mut String, out_dir: &Path) -> Outcome {
    writeln!(
        text,
        "\n## Cost against the number of surfaces\n\nHalls of columns of 24 sides under a lamp, of the same size, as above (`radiosity-growth.svg`).\n"
    )?;
    writeln!(
        text,
        "| columns | surfaces | patches | vertices | processor seconds |\n| ---: | ---: | ---: | ---: | ---: |"
    )?;
    let mut rows = vec![];
    for side in [8, 16, 32, 64] {
        let surfaces = hall(side);
        eprintln!("  {} surfaces", surfaces.len());
        let position = dvec3(5.03, 5.1, 2.2);
        let irradiance = |p: DVec3, n: DVec3| {
            let way = position - p;
            [10.0 * way.dot(n).max(0.0) / way.length().powi(3); 3]
        };
        let lamps = [Lamp::Point { position, irradiance: &irradiance, shadow: true }];
        let cost = bake(&surfaces, &lamps, (ACROSS, FINER))?;
        let vertices = cost.baked.vertices.len();
        writeln!(
            text,
            "| {} | {} | {} | {vertices} | {:.1} |",
            side * side,
            surfaces.len(),
            cost.patches,
            cost.seconds
        )?;
        let count = surfaces.len() as f64;
        let row = |series: &str, seconds: f64, value: f64| Row {
            scene: "halls of columns".to_owned(),
            series: series.to_owned(),
            setting: side.to_string(),
            time: Timing::exactly(seconds),
            rmse: value,
            largest: value,
            more: vec![],
        };
        rows.push(row("processor seconds", count, cost.seconds));
    }
    let points: Vec<(f64, f64)> = rows.iter().map(|r| (r.time.seconds.ln(), r.rmse.ln())).collect();
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x) * (p.0 - x));
    let last = points.len() - 1;
    let end = (points[last].1 - points[last - 1].1) / (points[last].0 - points[last - 1].0);
    writeln!(
        text,
        "\nFitted: seconds grow with the power {slope:.2} of the number of surfaces; over the last step, {end:.2}."
    )?;
    chart_along(out_dir, "radiosity-growth", ["surfaces", "processor seconds"], &rows)?;
    Ok(true)
}

/// A closed hall of 10 × 10 × 2.5 with `side` × `side` columns.
fn hall(side: usize) -> Vec<Surface> {
    const SIDES: usize = 24;
    let mut surfaces = super::boxes::room(dvec3(10.0, 10.0, 2.5), 0.6, 0.0);
    let step = 10.0 / side as f64;
    for i in 0..side * side {
        let middle = dvec3((0.5 + (i % side) as f64) * step, (0.5 + (i / side) as f64) * step, 0.0);
        let rim = |k: usize, z: f64| {
            let (sine, cosine) = (std::f64::consts::TAU * k as f64 / SIDES as f64).sin_cos();
            middle + dvec3(0.2 * step * cosine, 0.2 * step * sine, z)
        };
        surfaces.extend(
            (0..SIDES).map(|k| {
                Surface::new(&[rim(k, 0.0), rim(k + 1, 0.0), rim(k + 1, 2.5), rim(k, 2.5)], [0.6; 3])
            }),
        );
    }
    surfaces
}
