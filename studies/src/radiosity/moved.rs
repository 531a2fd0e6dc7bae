//! What a moved object costs: links that are kept, and those that are found anew.

use std::fmt::Write as _;

use cpu_time::ProcessTime;
use glam::{DVec3, dvec3};
use pointillist_radiosity::{Scene, SceneOptions, SolveOptions, Surface, Transport};

use super::boxes::room;
use crate::common::report::Outcome;

/// Patches' longest edge, in a room of 4 × 2.5 × 3.
const PATCH: f64 = 0.26;

/// A room with eight boxes that hang in it; the first is moved by this much.
fn furnished(moved: f64) -> Vec<Surface> {
    let mut surfaces = room(dvec3(4.0, 2.5, 3.0), 0.7, 0.0);
    surfaces[1].emission = [1.0; 3];
    for k in 0..8 {
        let (i, j, l) = (f64::from(k % 4), f64::from(k / 4), f64::from(k % 3));
        let shift = if k == 0 { moved } else { 0.0 };
        let low = dvec3(0.4 + 0.9 * i + shift, 0.5 + 0.5 * l, 0.5 + 1.4 * j);
        let around = room(DVec3::splat(0.25), 0.5, 0.0);
        surfaces.extend(around.into_iter().map(|mut surface| {
            // Rooms look inward, boxes outward.
            surface.vertices.reverse();
            surface.vertices.iter_mut().for_each(|v| *v += low);
            surface
        }));
    }
    surfaces
}

/// The section.
pub(crate) fn compare(text: &mut String) -> Outcome {
    writeln!(
        text,
        "\n## One moved object\n\nA room of 4 × 2.5 × 3 with eight boxes in it, patches of {PATCH}; one box is moved by 0.1. Links of the new scene from nothing, and after those of the \
         old one (`Scene::transport_after`); a solution from nothing. Processor seconds of all threads.\n"
    )?;
    writeln!(
        text,
        "| links | patches | partly hidden | kept | cells sampled | new s | after s | solve s | largest difference of radiosity |"
    )?;
    writeln!(text, "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")?;
    for (name, tolerance) in [("all pairs", None), ("groups, 0.01", Some(0.01))] {
        let options =
            SceneOptions::DEFAULT.with_patch(PATCH).with_smallest_patch(PATCH).with_tolerance(tolerance);
        let scene = |moved: f64| Scene::new(&furnished(moved), &options);
        let before = scene(0.0)?.transport(&[])?;
        let clock = ProcessTime::now();
        let fresh = scene(0.1)?.transport(&[])?;
        let new = clock.elapsed().as_secs_f64();
        let clock = ProcessTime::now();
        let after = scene(0.1)?.transport_after(&before, &[], &|_| ())?;
        let kept = clock.elapsed().as_secs_f64();
        let clock = ProcessTime::now();
        let found = radiosity(&after)?;
        let solved = clock.elapsed().as_secs_f64();
        let exact = radiosity(&fresh)?;
        let apart = found.iter().zip(&exact).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        let (f, a) = (fresh.counts(), after.counts());
        writeln!(
            text,
            "| {name} | {} | {} | {} | {} of {} | {new:.2} | {kept:.2} | {solved:.3} | {apart:.1e} |",
            after.patch_count(),
            f.partly_hidden,
            a.kept,
            a.cells,
            f.cells
        )?;
    }
    Ok(true)
}

fn radiosity(transport: &Transport) -> Result<Vec<f64>, pointillist_radiosity::RadiosityError> {
    Ok(transport.gauss_seidel(&SolveOptions::DEFAULT)?.radiosity.iter().map(|b| b[0]).collect())
}
