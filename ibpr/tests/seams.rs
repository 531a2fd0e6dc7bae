//! Where surfaces are not to end: before other surfaces, and at the border of the picture.

use glam::{DVec3, dvec3};
use pointillist_ibpr::invariants::{OwnedScan, frame};
use pointillist_ibpr::{Options, Projection, Scale, Translucency, View};

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
        let through = frame.color().iter().filter(|c| c[3] < 0.9999).count();
        assert_eq!(through, 0, "pixels of the background at a spacing of {spacing}");
        assert!((0..frame.color().len()).all(|i| frame.depth()[i].is_finite() && frame.count()[i] > 0.0));
    }
}

/// What lies beyond the picture is as much a part of the surfaces in it as if the picture were larger.
#[test]
fn a_picture_is_the_middle_of_a_larger_one() {
    /// Pixels that the larger one has more on each side: whole buffer pixels.
    const MORE: u32 = 60;
    let view = |size: u32| {
        let camera = Projection::Orthographic { height: 0.01 * f64::from(size) };
        View::look_at(dvec3(1.0, 2.0, 5.0), DVec3::ZERO, DVec3::Y, camera, size, size).unwrap()
    };
    let ball = OwnedScan::sphere(DVec3::ZERO, 1.3, 0.01, DVec3::Z).jittered(DVec3::splat(0.003), 1);
    for (scale, translucency) in [(2.5, None), (4.0, None), (2.5, Some(Translucency::new(0.5)))] {
        let mut options = Options::default();
        (options.surface_layers, options.translucency) = (true, translucency);
        options.scale = Scale::Fixed(scale);
        let [small, large] = [SIZE, SIZE + 2 * MORE]
            .map(|size| frame(std::slice::from_ref(&ball), &view(size), &options).unwrap());
        let mut worst = 0.0f32;
        for i in 0..small.color().len() {
            let (column, row) = (i % SIZE as usize + MORE as usize, i / SIZE as usize + MORE as usize);
            let j = row * large.width() + column;
            let apart = |c: usize| (small.color()[i][c] - large.color()[j][c]).abs();
            let most = (0..4).map(apart).fold(0.0, f32::max);
            worst = worst.max(most);
        }
        println!("S = {scale}, {translucency:?}: {worst}");
        assert!(worst < 1e-3, "S = {scale}, {translucency:?}: colors differ by {worst}");
    }
}
