//! Draws a lit sphere as a PPM picture: `cargo run -p pointillist-shade --example lit_sphere > sphere.ppm`.

use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_shade::{Falloff, Light, Material, Model};
use std::io::Write;

const SIZE: usize = 256;

fn main() -> std::io::Result<()> {
    let clay = Material::lambert(vec3(0.7, 0.3, 0.2)).with_specular(
        Model::NormalizedBlinnPhong,
        Vec3::splat(0.06),
        80.0,
    );
    let lights = [
        Light::Point {
            position: dvec3(2.0, 2.0, 3.0),
            intensity: Vec3::splat(40.0),
            falloff: Falloff::InverseSquare,
        },
        Light::Directional { direction: dvec3(1.0, 0.2, -0.3), irradiance: vec3(0.2, 0.3, 0.6) },
    ];
    let pixel = |i: usize| 2.2 * ((i as f64 + 0.5) / SIZE as f64 - 0.5);
    let mut bytes = Vec::with_capacity(3 * SIZE * SIZE);
    for row in 0..SIZE {
        for column in 0..SIZE {
            let (x, y) = (pixel(column), -pixel(row));
            let z2 = 1.0 - x * x - y * y;
            let color = if z2 > 0.0 {
                let point = dvec3(x, y, z2.sqrt());
                radiance(&clay, &lights, point)
            } else {
                Vec3::splat(0.02)
            };
            // Square root: near enough to sRGB for an example.
            bytes.extend(color.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(|c| (255.0 * c.sqrt()) as u8));
        }
    }
    let mut out = std::io::stdout().lock();
    writeln!(out, "P6 {SIZE} {SIZE} 255")?;
    out.write_all(&bytes)
}

/// Seen from far away along −Z; on a sphere around the origin the normal is the position.
fn radiance(material: &Material, lights: &[Light], point: DVec3) -> Vec3 {
    let normal = point.as_vec3();
    lights.iter().map(|light| material.reflect(&light.illuminate(0, point), normal, Vec3::Z)).sum()
}
