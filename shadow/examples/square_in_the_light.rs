//! How much of a lamp's light a square keeps from the ground: 1 × 1 at half the lamp's height shades 2 × 2.
//!
//! `cargo run -p pointillist-shadow --example square_in_the_light`

use glam::{DVec3, dvec3};
use pointillist_micropoint::{
    Geometry, MicropointOptions, PlainOpacity, Projection, Renderer, SurfaceOpacity, Tile, View,
};
use pointillist_shadow::{Emitter, Receivers, ShadowLight, ShadowOptions, ShadowScratch, Viewer};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let square = |half: f64, y: f64| {
        [(-half, half), (half, half), (half, -half), (-half, -half)].map(|(x, z)| dvec3(x, y, z))
    };
    let corners = [square(10.0, 0.0), square(0.5, 1.0)].concat();
    let triangles = [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let geometry = Geometry::new(&corners, &triangles, &[0; 4], &[SurfaceOpacity::default()])?;

    // The viewer looks down from below the square: 4 × 4 units of ground, 8 × 8 pixels.
    let camera = Projection::Orthographic { height: 4.0 };
    let view = View::look_at(DVec3::Y * 0.9, DVec3::ZERO, DVec3::NEG_Z, camera, 8, 8)?;
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::DEFAULT)?;
    let mut tile = Tile::default();
    renderer.render(renderer.picture(), &mut tile);

    let lamp = Emitter::Point { position: dvec3(0.2, 2.0, 0.1), axis: DVec3::NEG_Y };
    let light = ShadowLight::new(&geometry, &PlainOpacity, lamp, ShadowOptions::default())?;
    let (mut receivers, mut lit) = (Receivers::default(), vec![]);
    receivers.push_tile(&tile);
    light.lit(
        Viewer { lens: tile.lens(), faces: tile.faces() },
        &receivers,
        &mut ShadowScratch::default(),
        &mut lit,
    );

    // Fragments and fractions come in the same order.
    let fragments = tile.points().iter().flat_map(|p| tile.fragments(p).iter().map(move |f| (p, f.weight)));
    let mut rows = [[0.0; 8]; 8];
    for ((p, weight), lit) in fragments.zip(lit) {
        rows[p.y as usize][p.x as usize] += weight * lit;
    }
    for row in rows {
        println!("{}", row.map(|v| format!("{v:.3}")).join(" "));
    }
    let dark: f64 = rows.iter().flatten().map(|v| (1.0 - v) * 0.25).sum();
    println!("shadow: {dark} square units");
    Ok(())
}
