//! Buildings by links that are rays: cost, and error against paths.

use std::fmt::Write as _;

use cpu_time::ProcessTime;
use glam::{DVec3, dvec3};
use pointillist_cli::scene::{Overrides, load_to_bake};
use pointillist_radiosity::invariants::paths::Paths;
use pointillist_radiosity::{Baked, Lamp, RayOptions, Scene, SceneOptions, SolveOptions, Surface};
use pointillist_render::{Lamps, Lightmap, scene_surfaces, with_lamps};
use rayon::prelude::*;

use crate::common::data::{SKIPPED, folder};
use crate::common::ray_reference::random;

type Written = Result<(), Box<dyn std::error::Error + Send + Sync>>;

/// Points at which light is compared.
const POINTS: usize = 500;
/// Paths of each.
const PATHS: usize = 4096;
/// Points darker than this share of the mean are left out: most are inside walls.
const DARK: f64 = 0.02;
/// So are points that another surface covers at less than this share of the scene's size.
const COVERED: f64 = 1e-4;
/// Patches along the longest side, and how much finer they may become.
const ACROSS: f64 = 32.0;
const FINER: f64 = 8.0;

const SUN: &str =
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
        "[[light]]\ntype = \"point\"\nposition = [-560, 120, 0]\nintensity = [2e5, 1.8e5, 1.5e5]\n\
         [[light]]\ntype = \"point\"\nposition = [400, 150, 0]\nintensity = [2e5, 2e5, 2.3e5]\n",
    ),
    (
        "Crytek's Sponza",
        "scenes/sponza-crytek/sponza.obj",
        "[[light]]\ntype = \"point\"\nposition = [-900, 260, 40]\nintensity = [160000, 130000, 90000]\n",
    ),
];

/// What one building took.
struct Cost {
    seconds: f64,
    patches: usize,
    links: usize,
    baked: Baked,
}

fn bake(surfaces: &[Surface], lamps: &[Lamp<'_>]) -> Result<Cost, pointillist_radiosity::RadiosityError> {
    let start = ProcessTime::now();
    let patch = size_of(surfaces) / ACROSS;
    let options = SceneOptions::DEFAULT.with_squarer(false).with_patch(patch).with_smallest_patch(patch);
    let mut scene = Scene::new(surfaces, &options)?;
    let direct = scene.direct(lamps)?;
    let options = RayOptions::DEFAULT.with_finest(patch / FINER);
    let transport = scene.transport_by_rays(&direct, &options, &|_| ())?;
    let solution = transport.solve(&SolveOptions::DEFAULT.with_tolerance(1e-4))?;
    let baked = solution.bake();
    let counts = transport.counts();
    let seconds = start.elapsed().as_secs_f64();
    Ok(Cost { seconds, patches: counts.patches, links: counts.links, baked })
}

fn size_of(surfaces: &[Surface]) -> f64 {
    let all = surfaces.iter().flat_map(|s| &s.vertices);
    let (low, high) = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
    (high - low).max_element()
}

/// Time and error of the buildings among the large data.
pub(crate) fn solve(text: &mut String) -> Written {
    writeln!(
        text,
        "\n## Buildings\n\nLinks by rays, patches of a {ACROSS}nd of the longest side, for drawing divided down to an {FINER}th of that; direct light, links, solution and \
         vertices together. Error: of the baked irradiance without the lamps' own, as `render` reads it, root mean square over {POINTS} points of surfaces of the mean of \
         the bands, relative to that of the paths' (in brackets relative to their mean); {PATHS} paths a point. Points darker than {DARK} of the mean or \
         covered by another surface are left out.\n"
    )?;
    let Some(folder) = folder() else {
        writeln!(text, "{SKIPPED}")?;
        return Ok(());
    };
    writeln!(
        text,
        "| building | surfaces | patches | links | vertices | processor seconds | error % | noise of the paths % |"
    )?;
    writeln!(text, "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")?;
    for (name, mesh, lights) in BUILDINGS {
        let toml = format!(
            "[camera]\neye = [0, 0, 0]\ntarget = [1, 0, 0]\n[[object]]\nmesh = {:?}\n{SUN}{lights}",
            folder.join(mesh)
        );
        let file = std::env::temp_dir().join(format!("pointillist-building-{}.toml", std::process::id()));
        std::fs::write(&file, toml)?;
        let scene = load_to_bake(&file, &Overrides::default());
        std::fs::remove_file(&file)?;
        let scene = scene?.scene;
        let found = scene_surfaces(&scene)?;
        let lamps = Lamps::new(&scene);
        with_lamps(&lamps, |lamps| -> Written {
            let cost = bake(&found.surfaces, lamps)?;
            let map = Lightmap::of_baked(&cost.baked, &found.faces, scene.mesh.triangles.len())?;
            let error = compare(&found.surfaces, lamps, &|surface, front, position| {
                let face = |&f: &u32| map.irradiance(f, front, position).as_dvec3().element_sum() / 3.0;
                found.faces[surface].first().map_or(0.0, face)
            });
            writeln!(
                text,
                "| {name} | {} | {} | {} | {} | {:.0} | {:.1} ({:.1}) | {:.1} |",
                found.surfaces.len(),
                cost.patches,
                cost.links,
                cost.baked.vertices.len(),
                cost.seconds,
                100.0 * error.relative,
                100.0 * error.to_mean,
                100.0 * error.noise
            )?;
            Ok(())
        })?;
    }
    Ok(())
}

struct Error {
    relative: f64,
    to_mean: f64,
    noise: f64,
}

/// Compares with paths at points that are spread over all sides of surfaces by area; `light` is told surface, whether in front, and where.
fn compare(
    surfaces: &[Surface],
    lamps: &[Lamp<'_>],
    light: &(dyn Fn(usize, bool, DVec3) -> f64 + Sync),
) -> Error {
    let paths = Paths::new(surfaces, lamps);
    let area = |s: &Surface| (1..s.vertices.len() - 1).map(|i| cross(&s.vertices, i).length()).sum::<f64>();
    let mut sums = vec![];
    let mut whole = 0.0;
    for surface in surfaces {
        whole += area(surface);
        sums.push(whole);
    }
    let mut state = 0x1234_5678_9abc_def1;
    let candidates: Vec<(usize, bool, DVec3, DVec3)> = (0..20 * POINTS)
        .map(|_| {
            let wanted = random(&mut state) * whole;
            let surface = sums.partition_point(|&s| s < wanted).min(sums.len() - 1);
            let ring = &surfaces[surface].vertices;
            let i = 1 + (random(&mut state) * (ring.len() - 2) as f64) as usize;
            let (x, y) = (random(&mut state).sqrt(), random(&mut state));
            let at = ring[0] * (1.0 - x) + ring[i] * (x * (1.0 - y)) + ring[i + 1] * (x * y);
            let front = !surfaces[surface].two_sided || random(&mut state) < 0.5;
            let normal = cross(ring, i).normalize_or_zero() * if front { 1.0 } else { -1.0 };
            (surface, front, at, normal)
        })
        .collect();
    let mean = |v: [f64; 3]| v.iter().sum::<f64>() / 3.0;
    let pilot: Vec<f64> =
        candidates.par_iter().map(|&(.., at, normal)| mean(paths.irradiance(at, normal, 49, 1).0)).collect();
    let usual = pilot.iter().sum::<f64>() / pilot.len() as f64;
    let lit = |&&(k, &(.., at, normal)): &&(usize, &(usize, bool, DVec3, DVec3))| {
        pilot[k] > DARK * usual && paths.clearance(at, normal) > COVERED
    };
    let list: Vec<_> = candidates.iter().enumerate().collect();
    let chosen: Vec<_> = list.iter().filter(lit).take(POINTS).collect();
    let sums = chosen.par_iter().map(|&&(k, &(surface, front, at, normal))| {
        let (exact, noise) = paths.irradiance(at, normal, PATHS, k as u64 + 7);
        let (exact, noise) = (mean(exact), mean(noise));
        let off = light(surface, front, at) - exact;
        [off * off, exact * exact, exact, noise * noise]
    });
    let sums: Vec<[f64; 4]> = sums.collect();
    let [off, squares, total, noise] = sums.iter().fold([0.0; 4], |m, s| [0, 1, 2, 3].map(|i| m[i] + s[i]));
    let count = sums.len() as f64;
    Error {
        relative: (off / squares).sqrt(),
        to_mean: (off / count).sqrt() / (total / count),
        noise: (noise / squares).sqrt(),
    }
}

fn cross(ring: &[DVec3], i: usize) -> DVec3 {
    (ring[i] - ring[0]).cross(ring[i + 1] - ring[0])
}

/// How cost grows with the number of surfaces: halls of columns, each of 24 sides.
pub(crate) fn growth(text: &mut String) -> Written {
    writeln!(
        text,
        "\n## Cost against the number of surfaces\n\nHalls of columns of 24 sides under a lamp, of the same size, as above.\n"
    )?;
    writeln!(text, "| columns | surfaces | processor seconds |\n| ---: | ---: | ---: |")?;
    let mut points = vec![];
    for side in [8, 16, 32, 64] {
        let surfaces = hall(side);
        let position = dvec3(5.03, 5.1, 2.2);
        let irradiance = |p: DVec3, n: DVec3| {
            let way = position - p;
            [10.0 * way.dot(n).max(0.0) / way.length().powi(3); 3]
        };
        let lamps = [Lamp::Point { position, irradiance: &irradiance, shadow: true }];
        let cost = bake(&surfaces, &lamps)?;
        writeln!(text, "| {} | {} | {:.1} |", side * side, surfaces.len(), cost.seconds)?;
        points.push(((surfaces.len() as f64).ln(), cost.seconds.ln()));
    }
    let mean = |f: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let slope = mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x) * (p.0 - x));
    writeln!(text, "\nFitted: seconds grow with the power {slope:.2} of the number of surfaces.")?;
    Ok(())
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
