//! Surfaces before surfaces: no background shows between them.

use glam::{DVec3, dvec3};
use pointillist_ibpr::invariants::{OwnedScan, frame};
use pointillist_ibpr::{Options, Projection, View};

/// Pixels on a side.
const SIZE: u32 = 200;

#[test]
fn a_ball_before_a_wall_lets_nothing_through() {
    let camera = Projection::Orthographic { height: 3.0 };
    let view = View::look_at(DVec3::Z * 5.0, DVec3::ZERO, DVec3::Y, camera, SIZE, SIZE).unwrap();
    let mut options = Options::default();
    options.surface_layers = true;
    for (seed, spacing) in [(1, 0.02), (2, 0.025), (3, 0.03)] {
        let noise = DVec3::Z * (0.25 * spacing);
        let ball = OwnedScan::sphere(DVec3::ZERO, 1.0, spacing, DVec3::Z).jittered(noise, seed);
        let side = (4.0 / spacing) as u32;
        let (right, up) = (DVec3::X * spacing, DVec3::Y * spacing);
        let wall = OwnedScan::plane(dvec3(0.0, 0.0, -2.0), right, up, side, side).jittered(noise, seed + 10);
        let frame = frame(&[ball, wall], &view, &options).unwrap();
        // Points beyond the picture are not drawn, so that the wall ends at its border, with an outline.
        let inside = |i: &usize| {
            [i % frame.width(), i / frame.width()].iter().all(|v| (8..SIZE as usize - 8).contains(v))
        };
        let pixels: Vec<usize> = (0..frame.color().len()).filter(inside).collect();
        let through = pixels.iter().filter(|&&i| frame.color()[i][3] < 0.9999).count();
        assert_eq!(through, 0, "pixels of the background at a spacing of {spacing}");
        assert!(pixels.iter().all(|&i| frame.depth()[i].is_finite() && frame.count()[i] > 0.0));
    }
}
