//! Panoramas of the reference data: irradiance against direct integration.

use std::fmt::Write as _;
use std::path::Path;

use glam::{DVec3, dvec3};
use pointillist_cli::image_io::read_picture;
use pointillist_sh::{Panorama, PanoramaProjector, Sh, Weights};
use rayon::prelude::*;

use crate::common::data;
use crate::shprobe::site::directions;

type Fault = Box<dyn std::error::Error + Send + Sync>;

/// Normals that are compared, and directions in which light is looked for that is negative.
const NORMALS: u32 = 200;
const DENSE: u32 = 4000;

/// A picture file as a panorama.
pub(crate) fn read(path: &Path) -> Result<Panorama, Fault> {
    let picture = read_picture(path)?;
    let pixels: Vec<[f32; 3]> = picture.color.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    Ok(Panorama::new(picture.size[0] as usize, picture.size[1] as usize, &pixels)?)
}

/// All maps that are there, by name.
pub(crate) fn files() -> Vec<(String, std::path::PathBuf)> {
    let Some(entries) = data::folder().and_then(|f| std::fs::read_dir(f.join("env")).ok()) else {
        return vec![];
    };
    let name = |p: &Path| p.file_stem().map_or(String::new(), |s| s.to_string_lossy().into_owned());
    let mut list: Vec<_> = entries.filter_map(|e| e.ok().map(|e| e.path())).map(|p| (name(&p), p)).collect();
    list.sort();
    list
}

/// A panorama as directions with the light that comes from each.
pub(crate) fn sources(map: &Panorama) -> Vec<(DVec3, DVec3)> {
    let [r, g, b] = map.planes();
    let source = |i: usize| {
        let (x, y) = (i % map.width(), i / map.width());
        let light = dvec3(r[i].into(), g[i].into(), b[i].into());
        (map.pixel_direction(x, y), light * map.solid_angle(y))
    };
    (0..map.width() * map.height()).map(source).collect()
}

/// ∫ L max(n·ω, 0) dω, pixel by pixel.
pub(crate) fn integrated(sources: &[(DVec3, DVec3)], normal: DVec3) -> DVec3 {
    sources.iter().map(|(way, light)| *light * normal.dot(*way).max(0.0)).sum()
}

/// Coefficients of a map.
pub(crate) fn projected(map: &Panorama, order: usize) -> Result<Sh, Fault> {
    Ok(PanoramaProjector::new(map.width(), map.height(), order, Weights::Gregory)?.project(map)?)
}

/// The table; `None` if there are no maps.
pub(crate) fn table(most: usize) -> Result<Option<String>, Fault> {
    let files = files();
    if files.is_empty() {
        return Ok(None);
    }
    let mut text = "| map | order 2 | order 2, deringed | order 4 | order 2 and a light, from order 4 | \
                    negative directions % | after deringing % | of light and rest % |\n\
                    | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        .to_owned();
    let mut sums = [0.0; 7];
    let chosen: Vec<_> = files.iter().take(most).collect();
    for (name, path) in &chosen {
        let values = measured(&read(path)?)?;
        sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v / chosen.len() as f64);
        text += &line(name, values);
    }
    text += &line("**mean**", sums);
    Ok(Some(text))
}

fn line(name: &str, values: [f64; 7]) -> String {
    let mut text = format!("| {name} |");
    values.iter().for_each(|v| {
        let _ = write!(text, " {v:.2} |");
    });
    text + "\n"
}

/// Four errors and three shares, in per cent.
fn measured(map: &Panorama) -> Result<[f64; 7], Fault> {
    let order_4 = projected(map, 4)?;
    let order_2 = order_4.with_order(2)?;
    let (deringed, split) = (order_2.deringed(), order_4.split(2)?);
    let sources = sources(map);
    let normals: Vec<DVec3> = directions(NORMALS).collect();
    let truth: Vec<DVec3> = normals.par_iter().map(|n| integrated(&sources, *n)).collect();
    let power: f64 = truth.iter().map(|e| e.length_squared()).sum();
    let error = |light: &dyn Fn(DVec3) -> DVec3| {
        let square = |(n, e): (&DVec3, &DVec3)| (light(*n) - *e).length_squared();
        100.0 * (normals.iter().zip(&truth).map(square).sum::<f64>() / power).sqrt()
    };
    let negative = |light: &dyn Fn(DVec3) -> DVec3| {
        // Rounding is not negative light.
        let least = -1e-9 * order_2.mean().max_element();
        let count = directions(DENSE).filter(|d| light(*d).min_element() < least).count();
        100.0 * count as f64 / f64::from(DENSE)
    };
    Ok([
        error(&|n| order_2.irradiance(n)),
        error(&|n| deringed.irradiance(n)),
        error(&|n| order_4.irradiance(n)),
        error(&|n| split.irradiance(n)),
        negative(&|n| order_2.irradiance(n)),
        negative(&|n| deringed.irradiance(n)),
        negative(&|n| split.irradiance(n)),
    ])
}
