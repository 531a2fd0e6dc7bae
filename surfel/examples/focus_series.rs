//! Samples a ring of beads, draws it focused near, in the middle and far, and writes `focus_0.ppm` to `focus_2.ppm`.
//!
//! `cargo run --release -p pointillist-surfel --example focus_series`

use glam::{DVec3, dvec3};
use pointillist_surfel::{
    Cloud, Focus, Frame, Options, Points, Projection, Renderer, SampleOptions, View, sample,
};
use std::f64::consts::TAU;

const SIZE: u32 = 512;
const BEADS: u32 = 12;

/// A bead of eight triangles about `centre`.
fn bead(centre: DVec3, positions: &mut Vec<DVec3>, triangles: &mut Vec<[u32; 3]>) {
    let first = positions.len() as u32;
    positions.extend(DVec3::AXES.iter().flat_map(|axis| [*axis, -*axis]).map(|axis| centre + 0.22 * axis));
    for octant in 0..8 {
        let corner = |axis: u32| first + 2 * axis + (octant >> axis & 1);
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        // An odd number of mirrors turns the corners' order around.
        triangles.push(if u32::count_ones(octant) % 2 == 0 { [a, b, c] } else { [a, c, b] });
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mut positions, mut triangles) = (vec![], vec![]);
    for i in 0..BEADS {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(BEADS)).sin_cos();
        bead(dvec3(cos, 0.0, sin), &mut positions, &mut triangles);
    }
    let points = sample(&positions, &triangles, &SampleOptions::DEFAULT.with_count(60_000))?;
    let places: Vec<_> = points.iter().map(|p| p.position).collect();
    let normals: Vec<_> = points.iter().map(|p| p.normal.as_vec3()).collect();
    let radii: Vec<_> = points.iter().map(|p| p.radius).collect();
    // Red in front, blue behind.
    let colors: Vec<_> =
        places.iter().map(|p| [0.5 + 0.4 * p.z as f32, 0.4, 0.5 - 0.4 * p.z as f32]).collect();
    let all = Points::new(&places).with_normals(&normals).with_radii(&radii).with_colors(&colors);
    let cloud = Cloud::new(&all)?;

    let eye = dvec3(0.0, 1.3, 3.0);
    let camera = Projection::Perspective { fov_y_rad: 0.75 };
    let view = View::look_at(eye, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE)?;
    let (mut renderer, mut frame, mut options) = (Renderer::new(), Frame::default(), Options::default());
    for (i, focus) in [2.2, 3.2, 4.2].into_iter().enumerate() {
        options.focus = Focus::Lens { aperture: 0.12, focus };
        renderer.draw(&cloud, &view, &options, &mut frame)?;
        let mut file = format!("P6 {SIZE} {SIZE} 255\n").into_bytes();
        // A square root is near enough to what screens do.
        let bytes = |c: &[f32; 4]| [c[0], c[1], c[2]].map(|v| (255.0 * v.sqrt()).round() as u8);
        file.extend(frame.color().iter().flat_map(bytes));
        std::fs::write(format!("focus_{i}.ppm"), file)?;
        println!("focus at {focus}: {} discs drawn of {}", frame.counts().points, cloud.len());
    }
    Ok(())
}
