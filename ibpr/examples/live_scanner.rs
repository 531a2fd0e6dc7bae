//! Adds scans of a sphere to a picture one by one, as a scanner delivers them, and takes the first away again; says what each step takes,
//! and writes `live_scanner.ppm`.
//!
//! `cargo run --release -p pointillist-ibpr --example live_scanner`

use glam::{DVec3, Vec3, dvec3};
use pointillist_ibpr::{Cloud, Frame, Options, Projection, Renderer, Scan, View};
use std::time::Instant;

const SIZE: u32 = 512;
const SCANS: u32 = 12;
/// Distance of the scanner's rays; the sphere's radius is 1.
const SPACING: f64 = 0.008;

/// Parallel rays that meet the sphere at up to 75°.
fn scan(towards: DVec3) -> Vec<DVec3> {
    let (right, up) = towards.any_orthonormal_pair();
    let steps = (75f64.to_radians().sin() / SPACING) as i32;
    let rays = (-steps..=steps).flat_map(|i| (-steps..=steps).map(move |j| (f64::from(i), f64::from(j))));
    rays.map(|(i, j)| SPACING * (i * right + j * up))
        .filter(|flat| flat.length() <= f64::from(steps) * SPACING)
        .map(|flat| flat + (1.0 - flat.length_squared()).sqrt() * towards)
        .collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let camera = Projection::Perspective { fov_y_rad: 0.6 };
    let view = View::look_at(dvec3(1.0, 1.5, 4.0), DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE)?;
    let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
    let mut show = |cloud: &Cloud, added: f64, what: &str| {
        let start = Instant::now();
        renderer.draw(cloud, &view, &Options::default(), &mut frame)?;
        let covered = frame.color().iter().filter(|color| color[3] > 0.5).count();
        let drawn = start.elapsed().as_secs_f64();
        println!("{what}: {:.1} ms, drawn in {:.1} ms, {covered} pixels covered", 1e3 * added, 1e3 * drawn);
        Ok::<(), pointillist_ibpr::IbprError>(())
    };
    let directions: Vec<DVec3> = (0..SCANS)
        .map(|k| {
            let (x, z) = (std::f64::consts::TAU * f64::from(k) / f64::from(SCANS)).sin_cos();
            dvec3(x, 0.0, z)
        })
        .collect();
    let scans: Vec<Vec<DVec3>> = directions.iter().map(|towards| scan(*towards)).collect();
    let as_scan = |k: usize| Scan::new(&scans[k]).with_scanner(directions[k]);
    let mut cloud = Cloud::new(&[as_scan(0)], Vec3::splat(0.8))?;
    for k in 1..scans.len() {
        let start = Instant::now();
        cloud.push(&as_scan(k))?;
        show(&cloud, start.elapsed().as_secs_f64(), &format!("scan {k} added"))?;
    }
    let start = Instant::now();
    cloud.remove(cloud.scans()[0])?;
    show(&cloud, start.elapsed().as_secs_f64(), "the first removed")?;
    let start = Instant::now();
    Cloud::new(&(0..scans.len()).map(as_scan).collect::<Vec<_>>(), Vec3::splat(0.8))?;
    println!("all at once: {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    let pixels =
        frame.color().iter().flat_map(|c| [c[0], c[1], c[2]].map(|v| (255.0 * v.sqrt()).round() as u8));
    std::fs::write(
        "live_scanner.ppm",
        [format!("P6 {SIZE} {SIZE} 255\n").into_bytes(), pixels.collect()].concat(),
    )?;
    Ok(())
}
