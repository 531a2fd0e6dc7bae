//! Pictures of light from probes, to be looked at: they go where the user says, not into the repository.

use std::path::Path;

use glam::{DVec3, Vec3};
use pointillist_render::Scene;
use pointillist_sh::Panorama;
use pointillist_shprobe::place;

use crate::common::draw;
use crate::common::picture::Picture;
use crate::shprobe::canvas::{save, sheet, sphere};
use crate::shprobe::known::Known;
use crate::shprobe::maps;
use crate::shprobe::site::{Baked, Ground, Site, lit_by};
use crate::shprobe::streets;
use crate::shprobe::together::{FIT, sent_on};
use crate::shprobe::walk::walk;
use crate::shprobe::wall;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Pixels of pictures of rooms, and across spheres.
const SIZE: [u32; 2] = [480, 300];
const SPHERE: usize = 160;

/// Candidates for probes in the hall, and its exposure.
const HALL: [usize; 3] = [20, 8, 10];
pub(crate) const HALL_GAIN: f64 = 1.2;

/// Exposure of the dark room.
const DARK_GAIN: f64 = 5.0;

/// Maps that are shown.
const MAPS: [&str; 3] = ["grace", "uffizi", "studio"];

/// A map as wide as this gives the same irradiance as the whole one, to the eye.
const COARSE: usize = 128;

/// Draws all; returns what was measured on the way.
pub(crate) fn all(folder: &Path) -> Result<String, Fault> {
    std::fs::create_dir_all(folder)?;
    let mut text = String::new();
    room_pictures(&Site { name: "two rooms", ..Site::thin_wall() }, folder, 96, 0.3)?;
    text += &wall::pictures(folder)?;
    match Site::sponza() {
        Some(site) => {
            let site = Site { candidates: HALL, ..site };
            let (ground, known) = room_pictures(&site, folder, 192, HALL_GAIN)?;
            text += &walk(&ground, &known, folder)?;
        }
        None => text += crate::common::data::SKIPPED,
    }
    maps(folder)?;
    text += &streets::picture(folder)?;
    Ok(text)
}

/// Pictures of a site with so many probes, chosen and fitted as `probe place` and `probe bake --fit --indirect` do, by what is known of the site. That is returned.
fn room_pictures<'a>(
    site: &'a Site,
    folder: &Path,
    count: usize,
    gain: f64,
) -> Result<(Ground<'a>, Known), Fault> {
    eprintln!("shprobe: pictures of {}", site.name);
    let ground = Ground::lit(site, Some(sent_on(&site.scene)?.0))?;
    let known = Known::look(&ground, &FIT)?;
    let fitted = |distances| known.adaptive(count, place::BALANCE, distances).map(|[_, fitted]| fitted);
    let probes = [fitted(false)?, fitted(true)?];
    let mut scene = site.scene.clone();
    [scene.image.width, scene.image.height] = SIZE;
    let name = site.name.replace(' ', "-");
    save(&three(&scene, &probes)?, gain, &folder.join(format!("{name}.png")))?;
    if site.dark_from.is_some() {
        // The dark room from inside, where light that leaks shows.
        scene.camera.eye = DVec3::new(7.7, 2.0, 3.7);
        scene.camera.target = DVec3::new(4.1, 1.0, 1.0);
        save(&three(&scene, &probes)?, DARK_GAIN, &folder.join("dark-room.png"))?;
    }
    Ok((ground, known))
}

/// Without ambient light, with that of probes that are blind, with that of probes that see.
fn three(scene: &Scene, [blind, seeing]: &[Baked; 2]) -> Result<Picture, Fault> {
    let pictures = [
        draw::with_pipeline(scene)?,
        draw::with_pipeline(&lit_by(scene, blind, false)?)?,
        draw::with_pipeline(&lit_by(scene, seeing, true)?)?,
    ];
    Ok(sheet(&pictures, 3))
}

/// For each map three spheres: lit by order 2, by the map, and by order 2 and a light.
fn maps(folder: &Path) -> Result<(), Fault> {
    eprintln!("shprobe: pictures of spheres");
    let mut pictures = vec![];
    for (_, path) in maps::files().iter().filter(|(name, _)| MAPS.contains(&name.as_str())) {
        let map = maps::read(path)?;
        let order_4 = maps::projected(&map, 4)?;
        let (order_2, split) = (order_4.with_order(2)?, order_4.split(2)?);
        let sources = maps::sources(&coarse(&map)?);
        let truth = sphere(SPHERE, |n| maps::integrated(&sources, n));
        let brightest = truth.pixels.iter().map(|p| p.max_element()).fold(0.0, f64::max);
        let shown =
            [sphere(SPHERE, |n| order_2.irradiance(n)), truth, sphere(SPHERE, |n| split.irradiance(n))];
        pictures.extend(shown.map(|p| exposed(&p, 0.9 / brightest)));
    }
    if !pictures.is_empty() {
        save(&sheet(&pictures, 3), 1.0, &folder.join("spheres.png"))?;
    }
    Ok(())
}

fn exposed(picture: &Picture, gain: f64) -> Picture {
    Picture { width: picture.width, pixels: picture.pixels.iter().map(|p| *p * gain).collect() }
}

/// Means over blocks of pixels.
fn coarse(map: &Panorama) -> Result<Panorama, Fault> {
    let step = (map.width() / COARSE).max(1);
    let (width, height) = (map.width() / step, map.height() / step);
    let mean = |i: usize, plane: &[f32]| {
        let (x0, y0) = (i % width * step, i / width * step);
        let all = (0..step * step).map(|k| plane[(y0 + k / step) * map.width() + x0 + k % step]);
        all.sum::<f32>() / (step * step) as f32
    };
    let pixel = |i: usize| Vec3::from_array(map.planes().each_ref().map(|p| mean(i, p))).to_array();
    Ok(Panorama::new(width, height, &(0..width * height).map(pixel).collect::<Vec<_>>())?)
}
