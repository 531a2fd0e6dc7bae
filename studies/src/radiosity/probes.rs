//! Probes against radiosity: irradiance at free places in the same closed box, found in two ways that share no code.

use std::fmt::Write as _;
use std::time::Instant;

use glam::{DVec3, Vec3, dvec3};
use pointillist_delaunay::Hint;
use pointillist_radiosity::{Scene as Patches, SceneOptions, Solution, SolveOptions};
use pointillist_render::{
    Ambient, CaptureOptions, Lamps, Lightmap, LookOptions, Prepared, Seen, Unbaked, look_all, scene_surfaces,
    with_lamps,
};
use pointillist_sh::{Irradiance, Sh};
use pointillist_shprobe::{Field, place};

use crate::common::rooms::{BOX, closed_box};
use crate::shprobe::truth::normals;

type Fault = Box<dyn std::error::Error + Send + Sync>;

const PLACES: usize = 100;
const GRID: [usize; 3] = [8, 6, 8];
const RESOLUTION: u32 = 64;
const BOUNCES: usize = 10;
/// Bounces after which the error is told.
const TOLD: [usize; 5] = [0, 1, 2, 5, 10];

/// The section.
pub(crate) fn compare(text: &mut String) -> Result<(), Fault> {
    let scene = closed_box();
    let surfaces = scene_surfaces(&scene)?;
    let start = Instant::now();
    let mut patches = Patches::new(&surfaces.surfaces, &SceneOptions::DEFAULT.with_patch(0.25))?;
    let direct = with_lamps(&Lamps::new(&scene), |lamps| patches.direct(lamps))?;
    let transport = patches.transport(&direct)?;
    let solution = transport.gauss_seidel(&SolveOptions::DEFAULT)?;
    let seconds = start.elapsed().as_secs_f64();
    let places = place::random(BOX * 0.05, BOX * 0.95, PLACES, 5);
    let truth = exact(&solution, &places)?;
    writeln!(
        text,
        "\n## Probes and radiosity\n\nA closed box of {} × {} × {} with coloured ends and a lamp. Irradiance for 26 normals at {PLACES} places: of probes, of \
         order 2, against exact irradiance from {} patches (solved in {seconds:.1} s). The probes' grid is {} × {} × {}, {RESOLUTION}² a face. *Baked*: probes at \
         the places themselves see the box as `render` draws it with the baked file.\n\n| light | root mean square of the error % |\n| --- | ---: |",
        BOX.x,
        BOX.y,
        BOX.z,
        transport.patch_count(),
        GRID[0],
        GRID[1],
        GRID[2]
    )?;
    let prepared = Prepared::new(&scene, &())?;
    let grid = place::grid(DVec3::ZERO, BOX, GRID);
    let mut seen = look(&prepared, &grid, Ambient::Color(Vec3::ZERO))?;
    for bounce in 0..=BOUNCES {
        let field = Field::new(&grid, &radiance(&seen))?;
        if TOLD.contains(&bounce) {
            let light = |i: usize| field.light(places[i], &mut Hint::default()).unwrap_or(Irradiance::DARK);
            writeln!(text, "| probes, {bounce} bounces | {:.2} |", 100.0 * error(&truth, light))?;
        }
        seen = look(&prepared, &grid, Ambient::Probes(&field, &Unbaked::NONE))?;
    }
    let baked = Lightmap::of_baked(&solution.bake(), &surfaces.faces, scene.mesh.triangles.len())?;
    let seen = radiance(&look(&prepared, &places, Ambient::Radiosity(&baked))?);
    writeln!(text, "| baked | {:.2} |", 100.0 * error(&truth, |i| Irradiance::new(&seen[i])))?;
    Ok(())
}

fn radiance(seen: &[Seen]) -> Vec<Sh> {
    seen.iter().map(|s| s.radiance.clone()).collect()
}

fn look(prepared: &Prepared<'_>, at: &[DVec3], ambient: Ambient<'_>) -> Result<Vec<Seen>, Fault> {
    let capture =
        CaptureOptions { resolution: RESOLUTION, emission: true, thorough: true, ..CaptureOptions::DEFAULT };
    let options = LookOptions { capture, order: 2, distances: 0 };
    Ok(look_all(prepared, at, options, ambient, &())?)
}

/// For each place and normal.
fn exact(solution: &Solution<'_>, places: &[DVec3]) -> Result<Vec<Vec<DVec3>>, Fault> {
    let normals = normals();
    let one = |p: &DVec3, n: &DVec3| {
        let [r, g, b] = solution.irradiance(*p, *n, false)?;
        Ok(dvec3(r, g, b))
    };
    places.iter().map(|p| normals.iter().map(|n| one(p, n)).collect()).collect()
}

/// Over the root mean square of what is true.
fn error(truth: &[Vec<DVec3>], light: impl Fn(usize) -> Irradiance) -> f64 {
    let (mut off, mut all) = (0.0, 0.0);
    for (i, truth) in truth.iter().enumerate() {
        let light = light(i);
        for (n, truth) in normals().iter().zip(truth) {
            off += (light.at(n.as_vec3()).as_dvec3() - truth).length_squared();
            all += truth.length_squared();
        }
    }
    (off / all).sqrt()
}
