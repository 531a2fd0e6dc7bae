//! Draws a sphere for every BRDF as a PPM picture: `cargo run --release -p pointillist-shade --example brdf_row > row.ppm`.
//!
//! Left to right: Lambert, Phong, Blinn-Phong, GGX plastic, GGX metal smooth and rough, and the plastic from a MERL table.

use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_shade::{
    CubeMap, Environment, Incident, Light, Material, MerlTable, Model, coat_albedo, mirror,
};
use std::io::Write;

const SIZE: usize = 128;

fn main() -> std::io::Result<()> {
    let red = vec3(0.6, 0.12, 0.08);
    let phong = |model| Material::lambert(red).with_specular(model, Vec3::splat(0.1), 60.0);
    let plastic = Material::metallic_roughness(red, 0.0, 0.3);
    let gold = |roughness| Material::metallic_roughness(vec3(1.0, 0.77, 0.34), 1.0, roughness);
    let row = [phong(Model::Lambert), phong(Model::NormalizedPhong), phong(Model::NormalizedBlinnPhong)];
    let row: Vec<Material> = row.into_iter().chain([plastic, gold(0.1), gold(0.5), plastic]).collect();
    let table = MerlTable::tabulate(|l, v| plastic.brdf(Vec3::Z, l, v));
    // A bright band above the horizon, blue sky above and brown ground below.
    let sky = |d: DVec3| match d.y {
        y if y < 0.0 => vec3(0.12, 0.09, 0.06),
        y if y < 0.2 => Vec3::ONE,
        _ => vec3(0.2, 0.35, 0.7),
    };
    let sky = Environment::sharp(CubeMap::from_function(128, sky)).with_rough_levels().with_irradiance();
    let sun = Light::Directional { direction: dvec3(-1.0, -1.5, -1.0), irradiance: Vec3::splat(2.0) };
    let incident = sun.illuminate(0, DVec3::ZERO);
    let mut out = std::io::stdout().lock();
    writeln!(out, "P6 {} {SIZE} 255", row.len() * SIZE)?;
    let unit = |i: usize| 2.2 * ((i as f32 + 0.5) / SIZE as f32 - 0.5);
    for i in 0..row.len() * SIZE * SIZE {
        let (column, y) = (i % (row.len() * SIZE), -unit(i / (row.len() * SIZE)));
        let (ball, x) = (column / SIZE, unit(column % SIZE));
        let z2 = 1.0 - x * x - y * y;
        let measured = (ball == row.len() - 1).then_some(&table);
        let color = if z2 > 0.0 {
            radiance(&row[ball], measured, &sky, &incident, vec3(x, y, z2.sqrt()))
        } else {
            Vec3::splat(0.02)
        };
        out.write_all(
            &color.clamp(Vec3::ZERO, Vec3::ONE).to_array().map(|c| (255.0 * c.powf(1.0 / 2.2)) as u8),
        )?;
    }
    Ok(())
}

/// Seen from far away along −Z; on a sphere around the origin the normal is the position.
fn radiance(m: &Material, table: Option<&MerlTable>, sky: &Environment, sun: &Incident, n: Vec3) -> Vec3 {
    let direct = table.map_or_else(|| m.reflect(sun, n, Vec3::Z), |table| table.reflect(sun, n, Vec3::Z));
    let diffuse = m.diffuse * sky.irradiance(n) / std::f32::consts::PI;
    if m.model != Model::Ggx {
        return direct + diffuse;
    }
    direct
        + diffuse
        + coat_albedo(m.specular, m.roughness, n.z) * sky.radiance(mirror(Vec3::Z, n), m.roughness)
}
