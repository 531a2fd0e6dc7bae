//! Draws a ball before a plane by coverage alone, one shade per surface, and writes `half_covered_pixels.pgm`.
//!
//! `cargo run --release -p pointillist-micropoint --example half_covered_pixels`

use glam::{DVec3, dvec3};
use pointillist_micropoint::{
    Geometry, MicropointOptions, PlainOpacity, Projection, Renderer, SurfaceOpacity, Tile, View,
};

const SIZE: u32 = 256;
/// Grey of each surface: an octahedron, glass, the ground.
const SHADES: [f64; 3] = [230.0, 140.0, 70.0];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corners = [
        // An octahedron,
        DVec3::X,
        DVec3::NEG_X,
        DVec3::Y,
        DVec3::NEG_Y,
        DVec3::Z,
        DVec3::NEG_Z,
        // a pane of glass through it,
        dvec3(-1.5, -0.6, 0.9),
        dvec3(1.5, -0.6, -0.3),
        dvec3(0.2, 1.4, 0.4),
        // and the ground to the horizon.
        dvec3(-1e3, -1.0, 1e3),
        dvec3(1e3, -1.0, 1e3),
        dvec3(0.0, -1.0, -1e4),
    ];
    let triangles = [
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
        [6, 7, 8],
        [9, 10, 11],
    ];
    let surface_of = [0, 0, 0, 0, 0, 0, 0, 0, 1, 2];
    let surfaces = [1.0, 0.4, 1.0].map(|opacity| SurfaceOpacity { opacity, ..SurfaceOpacity::default() });
    let geometry = Geometry::new(&corners, &triangles, &surface_of, &surfaces)?;
    let camera = Projection::Perspective { fov_y_rad: 0.8 };
    let view = View::look_at(dvec3(1.0, 0.8, 4.0), DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE)?;
    let renderer = Renderer::new(&geometry, &PlainOpacity, view, MicropointOptions::DEFAULT)?;
    let mut picture = vec![0.0; (SIZE * SIZE) as usize];
    let mut tile = Tile::default();
    for rect in renderer.picture().tiles(16) {
        renderer.render(rect, &mut tile);
        for p in tile.points() {
            let surface = tile.faces()[p.face as usize].surface;
            picture[(p.y * SIZE + p.x) as usize] += p.weight * SHADES[surface as usize];
        }
    }
    let mut file = format!("P5 {SIZE} {SIZE} 255\n").into_bytes();
    file.extend(picture.iter().map(|&v| v.round() as u8));
    std::fs::write("half_covered_pixels.pgm", file)?;
    Ok(())
}
