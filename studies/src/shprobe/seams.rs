//! Light on surfaces up to their corners, where maps of what probes see are coarsest and light leaks as bright seams.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

use glam::{DVec3, dvec3};
use pointillist_delaunay::Hint;
use pointillist_shprobe::{Field, place};
use rayon::prelude::*;

use crate::common::paths::Random;
use crate::common::ray_reference::Tree;
use crate::common::scenes::normal_towards;
use crate::shprobe::rays::arriving;
use crate::shprobe::site::{Ground, Site};
use crate::shprobe::wall::Rooms;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Places of each kind.
const PLACES: usize = 400;

/// How far at most places by corners are from the next surface, world units.
const CLOSE: f64 = 0.01;

/// Height above a surface of places that are on it.
const HEIGHT: f64 = 2e-4;

/// Rays along a side of the square that is mapped to a hemisphere.
const RAYS: u32 = 40;

/// Light that is added before ratios are taken, over the mean.
const DARK: f64 = 0.01;

/// A ratio from which on light is called wrong.
const WRONG: f64 = 1.5;

/// Places with their normals, and the irradiance there.
struct Places {
    name: &'static str,
    on: Vec<(DVec3, DVec3)>,
    truth: Vec<DVec3>,
}

/// A unit direction, spread evenly.
fn any_way(random: &mut Random) -> DVec3 {
    let y = 2.0 * random.next() - 1.0;
    let (sin, cos) = (TAU * random.next()).sin_cos();
    let r = (1.0 - y * y).sqrt();
    dvec3(r * cos, y, r * sin)
}

/// A place on a surface that is seen from somewhere in the rooms; with `corner` one within [`CLOSE`] of the next surface.
fn place_on(ground: &Ground<'_>, tree: &Tree, corner: bool, random: &mut Random) -> Option<(DVec3, DVec3)> {
    let site = ground.site;
    let from = site.low + (site.high - site.low) * dvec3(random.next(), random.next(), random.next());
    let way = any_way(random);
    if !ground.is_free(from) {
        return None;
    }
    let met = |from: DVec3, way: DVec3| {
        let (triangle, distance) = tree.nearest(from, way, 0.0)?;
        Some((distance, normal_towards(&site.scene, triangle as usize, -way).normalize()))
    };
    let (distance, normal) = met(from, way)?;
    let at = from + way * distance + normal * HEIGHT;
    if !corner {
        return Some((at, normal));
    }
    let along = any_way(random).reject_from_normalized(normal).normalize();
    let (distance, other) = met(at, along)?;
    let back = CLOSE * random.next() / other.dot(-along).max(0.1);
    (distance > back).then(|| (at + along * (distance - back), normal))
}

impl Places {
    fn new(ground: &Ground<'_>, tree: &Tree, name: &'static str, corner: bool, seed: u64) -> Self {
        let mut random = Random(seed);
        let drawn = std::iter::repeat_with(|| place_on(ground, tree, corner, &mut random));
        let on: Vec<(DVec3, DVec3)> = drawn.flatten().take(PLACES).collect();
        let truth = on.par_iter().enumerate().map(|(i, place)| irradiance(ground, tree, *place, i as u64));
        let truth = truth.collect();
        Self { name, on, truth }
    }

    /// RMS error and mean error over the mean, RMS logarithm of the ratio, share of places that are wrong.
    fn errors(&self, field: &Field) -> [f64; 4] {
        let mean = self.truth.iter().map(|t| t.element_sum()).sum::<f64>() / self.truth.len() as f64;
        let mut sums = [0.0; 4];
        for ((p, n), truth) in self.on.iter().zip(&self.truth) {
            let n = n.as_vec3();
            let light = field.irradiance(*p, n, n, &mut Hint::default()).unwrap_or_default();
            let (light, truth) = (light.as_dvec3().element_sum(), truth.element_sum());
            let ratio = (light + DARK * mean) / (truth + DARK * mean);
            let is_wrong = !(1.0 / WRONG..=WRONG).contains(&ratio);
            let parts = [
                ((light - truth) / mean).powi(2),
                (light - truth) / mean,
                ratio.ln().powi(2),
                f64::from(is_wrong),
            ];
            sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
        }
        let [square, bias, ratio, wrong] = sums.map(|sum| sum / self.truth.len() as f64);
        [square.sqrt(), bias, ratio.sqrt(), wrong]
    }
}

/// What arrives at a place, by rays spread by the cosine.
fn irradiance(ground: &Ground<'_>, tree: &Tree, (at, normal): (DVec3, DVec3), seed: u64) -> DVec3 {
    let mut random = Random(seed);
    let (u, v) = normal.any_orthonormal_pair();
    let mut sum = DVec3::ZERO;
    for (i, j) in (0..RAYS).flat_map(|i| (0..RAYS).map(move |j| (i, j))) {
        let [x, y] = [i, j].map(|k| (f64::from(k) + random.next()) / f64::from(RAYS));
        let (sin, cos) = (TAU * y).sin_cos();
        let way = (u * cos + v * sin) * x.sqrt() + normal * (1.0 - x).max(0.0).sqrt();
        sum += arriving(&ground.site.scene, tree, ground.sent_on(), at, way).0;
    }
    sum * (PI / f64::from(RAYS * RAYS))
}

const TEXT: &str = "The two rooms with a wall of 10 cm, probes with distances that are chosen and fitted; irradiance on surfaces anywhere, and within 1 cm of the \
     next surface, against 1600 rays. Light there is that of a radiosity solution. *Wrong*: more than 1.5 times off.\n\n\
     | places | probes | RMS over mean % | bias % | RMS of ln ratio | wrong % |\n| --- | ---: | ---: | ---: | ---: | ---: |\n";

/// The table for these numbers of probes.
pub(crate) fn table(counts: &[usize]) -> Result<String, Fault> {
    eprintln!("shprobe: seams in corners");
    let site = Site::thin_wall();
    let rooms = Rooms::new(&site)?;
    let tree = Tree::new(&site.scene);
    let sets = [("surfaces", false, 31), ("corners", true, 32)]
        .map(|(name, corner, seed)| Places::new(rooms.ground(), &tree, name, corner, seed));
    let mut text = TEXT.to_owned();
    for &count in counts {
        let [_, fitted] = rooms.adaptive(count, place::BALANCE, true)?;
        let field = fitted.field(true)?;
        for set in &sets {
            let [rms, bias, ratio, wrong] = set.errors(&field);
            let (name, [rms, bias, wrong]) = (set.name, [rms, bias, wrong].map(|e| 100.0 * e));
            writeln!(text, "| {name} | {count} | {rms:.1} | {bias:.1} | {ratio:.3} | {wrong:.1} |")?;
        }
    }
    Ok(text)
}
