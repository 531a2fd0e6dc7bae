//! What lighting costs once probes are baked.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::hint::black_box;

use glam::{DVec3, Vec3, dvec3};
use pointillist_sh::{Irradiance, Sh, ShError};
use pointillist_shprobe::{DistanceMap, Field, LitObject, ProbeError, place};

use crate::common::report::{Limit, on_one_thread, on_threads, verdict};
use crate::common::timing::{Clock, least_seconds};
use crate::shprobe::site::directions;

const OBJECTS: usize = 10_000;
const PROBES: usize = 432;

/// Coefficients without meaning, but all different.
fn some_light(i: usize) -> Result<Sh, ShError> {
    let wave = |k: usize| (0.7 * i as f64 + 1.3 * k as f64).sin() * if k == 0 { 0.0 } else { 0.2 };
    Sh::new(
        (0..9).map(|k| dvec3(wave(k), wave(k + 20), wave(k + 40)) + if k == 0 { 3.0 } else { 0.0 }).collect(),
    )
}

/// Nanoseconds of E(n), from coefficients to colour.
fn evaluation_ns() -> Result<f64, ProbeError> {
    let normals: Vec<Vec3> = directions(4096).map(|d| d.as_vec3()).collect();
    let light = Irradiance::new(&some_light(1)?);
    let seconds = on_one_thread(|| {
        least_seconds(Clock::Processor, 50, 0.0, || {
            let light = black_box(&light);
            for n in &normals {
                black_box(light.at(*black_box(n)));
            }
            Ok::<(), ProbeError>(())
        })
    })?;
    Ok(1e9 * seconds / normals.len() as f64)
}

/// Milliseconds a frame: objects on circles, moved a little from frame to frame.
fn frame_ms(field: &Field, threads: usize) -> Result<f64, ProbeError> {
    let centres = place::random(DVec3::splat(0.1), DVec3::splat(0.9), OBJECTS, 3);
    let mut objects: Vec<LitObject> = centres.iter().map(|c| LitObject::at(*c)).collect();
    let mut frame = 0.0;
    let clock = if threads == 1 { Clock::Processor } else { Clock::Wall };
    let seconds = on_threads(threads, || {
        let mut best = f64::INFINITY;
        for _ in 0..60 {
            frame += 1.0 / 120.0;
            for (i, (object, centre)) in objects.iter_mut().zip(&centres).enumerate() {
                let angle = TAU * frame + i as f64;
                object.position = *centre + dvec3(angle.cos(), (2.0 * angle).sin(), angle.sin()) * 0.08;
            }
            best = least_seconds(clock, 1, 0.0, || field.light_objects(&mut objects))?.min(best);
        }
        Ok::<f64, ProbeError>(best)
    })?;
    Ok(1e3 * seconds)
}

/// The table, and lines about goals.
pub(crate) fn table() -> Result<[String; 2], ProbeError> {
    let positions = place::random(DVec3::ZERO, DVec3::ONE, PROBES, 17);
    let radiance: Vec<Sh> = (0..PROBES).map(some_light).collect::<Result<_, _>>()?;
    let plain = Field::new(&positions, &radiance)?;
    let map = DistanceMap::new(16, &[[3.0, 0.1]; 289])?;
    let seeing = plain.clone().with_distances(vec![map; PROBES])?;
    let evaluation = evaluation_ns()?;
    let mut text = "| what | found |\n| --- | ---: |\n".to_owned();
    let _ = writeln!(text, "| E(n) of a normal, ns, one thread | {evaluation:.1} |");
    let mut goals = format!(
        "| E(n), ns | ≤ 10 | {evaluation:.1} | {} |\n",
        verdict(Limit::AtMost(10.0).is_kept_by(evaluation))
    );
    for (what, field) in [("", &plain), (" and distances", &seeing)] {
        for threads in [1, 2] {
            let ms = frame_ms(field, threads)?;
            let _ = writeln!(
                text,
                "| {OBJECTS} moving objects among {PROBES} probes with coefficients{what}, ms, threads: {threads} | {ms:.2} |"
            );
            if threads == 2 {
                let word = verdict(Limit::AtMost(2.0).is_kept_by(ms));
                let _ =
                    writeln!(goals, "| {OBJECTS} objects{what}, ms, two threads | ≤ 2 | {ms:.2} | {word} |");
            }
        }
    }
    Ok([text, goals])
}
