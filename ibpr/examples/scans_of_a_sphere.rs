//! Scans a sphere from six sides with a noisy scanner, draws the raw points, and writes `scans_of_a_sphere.ppm`.
//!
//! `cargo run --release -p pointillist-ibpr --example scans_of_a_sphere`

use glam::{DVec3, Vec3, dvec3};
use pointillist_ibpr::{Cloud, Frame, Light, Options, Projection, Renderer, Scan, View};

const SIZE: u32 = 512;
/// Distance of the scanner's rays; the sphere's radius is 1.
const SPACING: f64 = 0.01;
/// Largest error of a depth, in spacings.
const NOISE: f64 = 0.5;

/// Parallel rays that meet the sphere at up to 75°.
fn scan(towards: DVec3, seed: &mut u32) -> Vec<DVec3> {
    let (right, up) = towards.any_orthonormal_pair();
    let steps = (75f64.to_radians().sin() / SPACING) as i32;
    let mut points = vec![];
    for (i, j) in (-steps..=steps).flat_map(|i| (-steps..=steps).map(move |j| (i, j))) {
        let flat = SPACING * (f64::from(i) * right + f64::from(j) * up);
        if flat.length() <= f64::from(steps) * SPACING {
            *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let error = NOISE * SPACING * (f64::from(*seed >> 8) / f64::from(1 << 23) - 1.0);
            points.push(flat + ((1.0 - flat.length_squared()).sqrt() + error) * towards);
        }
    }
    points
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let directions = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|d| [d, -d]);
    let mut seed = 1;
    let scans: Vec<_> = directions.map(|d| (d, scan(d, &mut seed))).collect();
    let scans: Vec<_> = scans.iter().map(|(d, points)| Scan::new(points).with_scanner(*d)).collect();
    let cloud = Cloud::new(&scans, Vec3::splat(0.8))?;

    let camera = Projection::Perspective { fov_y_rad: 0.6 };
    let view = View::look_at(dvec3(1.0, 1.5, 4.0), DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE)?;
    let mut options = Options::default();
    options.light = Light::Towards(dvec3(-1.0, 2.0, 2.0));
    let mut frame = Frame::default();
    Renderer::new().draw(&cloud, &view, &options, &mut frame)?;

    let mut file = format!("P6 {SIZE} {SIZE} 255\n").into_bytes();
    // A square root is near enough to what screens do.
    file.extend(
        frame.color().iter().flat_map(|c| [c[0], c[1], c[2]].map(|v| (255.0 * v.sqrt()).round() as u8)),
    );
    std::fs::write("scans_of_a_sphere.ppm", file)?;
    println!("{} points, {:.2} pixels per buffer pixel", cloud.len(), frame.counts().scale);
    Ok(())
}
