//! One probe at each position, with all bounces: where they come from, against paths of rays. And what one probe takes.

use std::fmt::Write as _;

use cpu_time::ThreadTime;
use glam::DVec3;
use pointillist_render::{
    Ambient, BakeOptions, IndirectOptions, Prepared, ProbeBake, Scene, Solids, bake_probes, bake_probes_in,
    solve_indirect,
};
use pointillist_sh::Irradiance;
use pointillist_shade::{Falloff, Light};
use rayon::prelude::*;

use crate::common::paths::{Random, irradiance};
use crate::common::ray_reference::Tree;
use crate::common::rooms::{WALL, two_rooms};
use crate::shprobe::site::{Ground, Site};
use crate::shprobe::truth::normals;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Positions, paths from each in either half of the reference, and pixels on a side of what probes see.
const PLACES: usize = 60;
const PATHS: u32 = 8_192;
const RESOLUTION: u32 = 64;
/// Bounces between probes, if light goes from probe to probe.
const BOUNCES: u32 = 12;
/// Probes of a whole grid, for bounces between more of them.
const GRID: [usize; 3] = [12, 6, 6];

/// What may be wrong.
pub(crate) const LIMIT: f64 = 0.02;

/// The table, the error of probes in the light of a radiosity solution, and the time of a default bake over that of a thorough one.
pub(crate) struct Found {
    pub(crate) text: String,
    pub(crate) error: f64,
    pub(crate) time: f64,
}

pub(crate) fn measure(quick: bool) -> Result<Found, Fault> {
    eprintln!("shprobe: bounces");
    let (mut text, error) = errors(if quick { PATHS / 16 } else { PATHS })?;
    let (table, time) = times()?;
    text += &table;
    Ok(Found { text, error, time })
}

/// Irradiance at each position for each normal.
type Arriving = Vec<Vec<DVec3>>;

fn errors(paths: u32) -> Result<(String, f64), Fault> {
    let site = Site::two_rooms();
    let ground = Ground::new(&site)?;
    let places = ground.random(PLACES, 11);
    let [a, b] = [1, 2].map(|seed| reference(&site.scene, &places, paths, seed));
    let truth: Arriving =
        a.iter().zip(&b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| 0.5 * (*a + *b)).collect()).collect();
    let table = Table { places: &places, truth: &truth };
    let mut text = format!(
        "The two rooms, {PLACES} positions, 26 normals: irradiance with all bounces, against {} paths of rays from each. Probes at the positions \
         themselves, {RESOLUTION}² a face: nothing is interpolated but, where light bounces from probe to probe, the light of surfaces.\n\n\
         | surfaces are lit by | error % | lit room: error %, mean off % | dark room: error %, mean off % |\n| --- | ---: | ---: | ---: |\n",
        2 * paths
    );
    // Half of the difference of two halves is what their mean is off by.
    let half: Arriving =
        a.iter().zip(&truth).map(|(a, t)| a.iter().zip(t).map(|(a, t)| *a - *t).collect()).collect();
    let noise: Arriving =
        half.iter().zip(&truth).map(|(h, t)| h.iter().zip(t).map(|(h, t)| *h + *t).collect()).collect();
    text += &table.row("(noise of the paths)", &noise);
    let prepared = &ground.prepared;
    let solids = Solids::new(prepared);
    let options = BakeOptions::DEFAULT.with_resolution(RESOLUTION).with_bounces(BOUNCES).with_until(1e-4);
    let own = bake_probes(prepared, &solids, &places, &options, &())?;
    text += &table.row("these probes, bounce after bounce", &light_of(&own));
    let grid = pointillist_shprobe::place::grid(site.low, site.high, GRID);
    let grid: Vec<DVec3> = grid.into_iter().filter_map(|p| ground.settled(p)).collect();
    let many = bake_probes(prepared, &solids, &[&places[..], &grid].concat(), &options, &())?;
    let some = ProbeBake { probes: many.probes[..PLACES].to_vec(), changes: vec![] };
    let name = format!("these and a grid of {} probes, bounce after bounce", grid.len());
    text += &table.row(&name, &light_of(&some));
    let mut error = f64::INFINITY;
    for patches in [16.0, 32.0, 64.0] {
        let light = solve_indirect(&site.scene, &IndirectOptions::DEFAULT.with_patches_across(patches), &())?;
        let options = options.with_bounces(0);
        let bake = |options: &BakeOptions| {
            bake_probes_in(prepared, &solids, &places, Ambient::Radiosity(&light), options, &())
        };
        let seen = light_of(&bake(&options)?);
        text += &table.row(&format!("radiosity, {patches} patches across"), &seen);
        if patches == IndirectOptions::DEFAULT.patches_across {
            error = table.error(&seen, |_| true).0;
            let high: Arriving = bake(&options.with_order(6))?
                .probes
                .iter()
                .map(|p| normals().iter().map(|&n| p.seen.radiance.irradiance(n)).collect())
                .collect();
            text += &table.row("the same, harmonics of order 6", &high);
        }
    }
    text.push('\n');
    Ok((text, error))
}

fn reference(scene: &Scene, places: &[DVec3], paths: u32, seed: u64) -> Arriving {
    let tree = Tree::new(scene);
    let normals = normals();
    let one = |(i, &p): (usize, &DVec3)| {
        irradiance(scene, &tree, p, &normals, paths, &mut Random(seed << 32 | i as u64))
    };
    places.par_iter().enumerate().map(one).collect()
}

fn light_of(bake: &ProbeBake) -> Arriving {
    let one = |radiance: &pointillist_sh::Sh| {
        let light = Irradiance::new(radiance);
        normals().iter().map(|n| light.at(n.as_vec3()).as_dvec3()).collect()
    };
    bake.probes.iter().map(|p| one(&p.seen.radiance)).collect()
}

struct Table<'a> {
    places: &'a [DVec3],
    truth: &'a Arriving,
}

impl Table<'_> {
    /// Root mean square of the error over that of the light, and how far off the mean is.
    fn error(&self, light: &Arriving, counts: impl Fn(DVec3) -> bool) -> (f64, f64) {
        let (mut squares, mut all, mut sum, mut whole) = (0.0, 0.0, 0.0, 0.0);
        for (i, truth) in self.truth.iter().enumerate().filter(|(i, _)| counts(self.places[*i])) {
            for (found, truth) in light[i].iter().zip(truth) {
                squares += (*found - *truth).length_squared();
                all += truth.length_squared();
                sum += (*found - *truth).element_sum();
                whole += truth.element_sum();
            }
        }
        ((squares / all).sqrt(), sum / whole)
    }

    fn row(&self, name: &str, light: &Arriving) -> String {
        let all = self.error(light, |_| true).0;
        let rooms = [false, true].map(|dark| self.error(light, |p| (p.x > WALL[1]) == dark));
        let [(lit, lit_mean), (dark, dark_mean)] = rooms.map(|(e, m)| (100.0 * e, 100.0 * m));
        format!("| {name} | {:.2} | {lit:.2}, {lit_mean:+.2} | {dark:.2}, {dark_mean:+.2} |\n", 100.0 * all)
    }
}

/// Seconds of one probe of 128² a face, as `probe bake` has it by default and thoroughly.
fn times() -> Result<(String, f64), Fault> {
    let mut text = "One probe of 128² a face with one bounce, processor time on one thread, and the error of irradiance against the thorough one:\n\n\
         | two rooms with | default, s | thorough, s | default in thorough | error |\n| --- | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let bulb = two_rooms();
    let mut panel = two_rooms();
    let (corner, radiance) = (DVec3::new(1.5, 2.9, 1.5), glam::Vec3::splat(10.0));
    panel.lights[0].light = Light::Rect {
        corner,
        edge_u: DVec3::X,
        edge_v: DVec3::Z,
        radiance,
        samples: None,
        falloff: Falloff::InverseSquare,
    };
    let mut worst = 0.0_f64;
    for (name, scene) in [("a lamp of one point", &bulb), ("a rectangular lamp", &panel)] {
        let prepared = Prepared::new(scene, &())?;
        let solids = Solids::new(&prepared);
        let place = [DVec3::new(2.7, 1.3, 1.1)];
        let mut best = [f64::INFINITY; 2];
        let mut lights = [vec![], vec![]];
        // In turn, so that both have the same neighbours on the machine.
        for _ in 0..5 {
            for (i, thorough) in [false, true].into_iter().enumerate() {
                let options = BakeOptions::DEFAULT.with_thorough(thorough);
                let (seconds, bake) = pool.install(|| {
                    let start = ThreadTime::now();
                    let bake = bake_probes(&prepared, &solids, &place, &options, &());
                    (start.elapsed().as_secs_f64(), bake)
                });
                best[i] = best[i].min(seconds);
                lights[i] = light_of(&bake?);
            }
        }
        let table = Table { places: &place, truth: &lights[1] };
        let error = table.error(&lights[0], |_| true).0;
        let ratio = best[0] / best[1];
        worst = worst.max(ratio);
        writeln!(text, "| {name} | {:.3} | {:.3} | {ratio:.2} | {error:.1e} |", best[0], best[1])?;
    }
    text.push('\n');
    Ok((text, worst))
}
