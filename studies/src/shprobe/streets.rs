//! Probes as a car would take them: along two crossing streets, all at one height.

use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_sh::Irradiance;
use pointillist_shade::{Light, Material};
use rayon::prelude::*;

use crate::common::picture::Picture;
use crate::common::scenes::Sketch;
use crate::shprobe::canvas::{save, sheet};
use crate::shprobe::layouts::{cell_count, light};
use crate::shprobe::site::{Eye, Ground, Site};
use crate::shprobe::truth::{Truth, normals};

type Fault = Box<dyn std::error::Error + Send + Sync>;

const HALF: f64 = 20.0;
const STREET: f64 = 3.0;
const HEIGHT: f64 = 2.0;
const PIXELS: usize = 96;

/// Four blocks of houses, each of another colour, under sun and sky.
fn site() -> Site {
    let mut sketch = Sketch::new(dvec3(0.0, 30.0, 30.0), DVec3::ZERO, 60.0, 64);
    let colors = [vec3(0.8, 0.2, 0.15), vec3(0.2, 0.7, 0.25), vec3(0.2, 0.3, 0.8), vec3(0.8, 0.7, 0.2)];
    for (i, color) in colors.into_iter().enumerate() {
        let sign = dvec3(if i % 2 == 0 { -1.0 } else { 1.0 }, 1.0, if i / 2 == 0 { -1.0 } else { 1.0 });
        let (a, b) = (dvec3(STREET, 0.0, STREET) * sign, dvec3(HALF, 8.0, HALF) * sign);
        let material = sketch.material(Material::lambert(color), None);
        sketch.cuboid(a.min(b), a.max(b), material);
    }
    let ground = sketch.material(Material::lambert(Vec3::splat(0.4)), None);
    let h = HALF;
    sketch.polygon(&[dvec3(-h, 0.0, h), dvec3(h, 0.0, h), dvec3(h, 0.0, -h), dvec3(-h, 0.0, -h)], ground);
    sketch.light(Light::Directional { direction: dvec3(0.5, -1.0, 0.3), irradiance: Vec3::splat(6.0) });
    sketch.scene.image.background = vec3(0.4, 0.6, 0.9);
    let mut site = Site::basic();
    (site.name, site.eye, site.scene, site.truth_px) = ("streets", Eye::Rays, sketch.scene, 24);
    (site.low, site.high) = (dvec3(-h, 0.1, -h), dvec3(h, 10.0, h));
    site
}

/// The mean over all normals, over π.
fn shown(light: &Irradiance) -> DVec3 {
    let normals = normals();
    let sum: Vec3 = normals.iter().map(|n| light.at(n.as_vec3())).sum();
    sum.as_dvec3() / (normals.len() as f64 * std::f64::consts::PI)
}

/// Draws the plane as probes have it beside the truth; says how far off it is on the streets.
pub(crate) fn picture(folder: &Path) -> Result<String, Fault> {
    eprintln!("shprobe: streets");
    let site = site();
    let ground = Ground::new(&site)?;
    let along = |i: usize| (i as f64 + 0.5) / 10.0 * 2.0 * (HALF - 1.0) - (HALF - 1.0);
    let one = (0..10).map(|i| dvec3(along(i), HEIGHT, 0.0));
    let other = (0..10).map(|i| dvec3(0.0, HEIGHT, along(i)));
    let baked = ground.look(&one.chain(other).collect::<Vec<_>>())?;
    let field = baked.field(false)?;
    let place = |i: usize| {
        let unit = |v: usize| ((2 * v + 1) as f64 / PIXELS as f64 - 1.0) * HALF;
        dvec3(unit(i % PIXELS), HEIGHT, unit(i / PIXELS))
    };
    let places: Vec<DVec3> = (0..PIXELS * PIXELS).map(place).collect();
    let is_street = |p: DVec3| p.x.abs() < STREET || p.z.abs() < STREET;
    let of_probes = places.par_iter().map(|&p| shown(&light(&field, p))).collect();
    let streets: Vec<DVec3> = places.iter().copied().filter(|&p| is_street(p)).collect();
    let truth = Truth::at(&ground, streets)?;
    let mut known = truth.best().iter();
    let true_at =
        |&p: &DVec3| if is_street(p) { known.next().map_or(DVec3::ZERO, shown) } else { DVec3::ZERO };
    let of_truth = places.iter().map(true_at).collect();
    let pictures = [of_probes, of_truth].map(|pixels| enlarged(&Picture { width: PIXELS, pixels }, 4));
    save(&sheet(&pictures, 2), 0.8, &folder.join("streets.png"))?;
    let wrong = truth.wrong(None, |p| light(&field, p));
    let mut text = String::new();
    let _ = writeln!(
        text,
        "\n20 probes in a plane, along two crossing streets: partition of dimension {}, {} cells; error on the streets {:.1} %, order 2 itself {:.1} %.",
        field.partition().dimension(),
        cell_count(&field),
        100.0 * wrong.all,
        100.0 * truth.wrong_of_order_2(None).all
    );
    Ok(text)
}

fn enlarged(picture: &Picture, factor: usize) -> Picture {
    let width = picture.width * factor;
    let height = picture.pixels.len() / picture.width * factor;
    let pixel = |i: usize| picture.pixels[i / width / factor * picture.width + i % width / factor];
    Picture { width, pixels: (0..width * height).map(pixel).collect() }
}
