//! A clear sky with a sun, seen as nine coefficients: how much light surfaces get that face up, sideways and down,
//! against the integral over the image; and how much nearer it gets with the sun apart.
//!
//! `cargo run --release -p pointillist-sh --example irradiance_of_a_sky`

use glam::{DVec3, dvec3};
use pointillist_sh::{CubeMap, CubeProjector, ShError, Weights};

const SIZE: usize = 128;

/// Blue above, brown below, and a sun of 6 degrees.
fn sky(direction: DVec3) -> DVec3 {
    let sun = dvec3(0.48, 0.64, 0.6);
    if direction.dot(sun) > 0.9986 {
        return dvec3(300.0, 280.0, 240.0);
    }
    let height = direction.y;
    if height > 0.0 { dvec3(0.5, 0.8, 1.2).lerp(dvec3(0.2, 0.4, 1.0), height) } else { dvec3(0.3, 0.2, 0.1) }
}

/// Irradiance as the sum over all texels.
fn integral(map: &CubeMap, weights: &[f64], normal: DVec3) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for (i, weight) in weights.iter().enumerate() {
        for face in 0..6 {
            let (x, y) = (i % SIZE, i / SIZE);
            let texel = map.texel(face, x, y).unwrap_or_default().map(f64::from);
            sum += DVec3::from(texel) * (weight * map.texel_direction(face, x, y).dot(normal).max(0.0));
        }
    }
    sum
}

fn main() -> Result<(), ShError> {
    let map = CubeMap::from_fn(SIZE, sky)?;
    let weights = Weights::default();
    let of_texels = weights.of_face(SIZE)?;
    let nine = CubeProjector::new(SIZE, 2, weights)?.project(&map)?;
    // Higher bands show how sharp the sun is, and are then left out.
    let split = CubeProjector::new(SIZE, 4, weights)?.project(&map)?.split(2)?;
    println!("normal            integral             9 coefficients       with the sun apart");
    for (name, normal) in [("up", DVec3::Y), ("east", DVec3::X), ("west", -DVec3::X), ("down", -DVec3::Y)] {
        let all = [integral(&map, &of_texels, normal), nine.irradiance(normal), split.irradiance(normal)];
        let texts = all.map(|e| format!("{:6.3} {:6.3} {:6.3}", e.x, e.y, e.z));
        println!("{name:<16} {}", texts.join("  "));
    }
    Ok(())
}
