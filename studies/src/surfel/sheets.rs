//! Two sheets one behind the other: from which distance on nothing of the farther one melts into the nearer.

use std::fmt::Write as _;

use glam::{DVec2, DVec3};
use pointillist_surfel::{Cloud, Frame, Options, Points, Projection, Renderer, SurfelError, View};

use crate::surfel::lens_samples::mixed;

/// Points on a side of a sheet; they are one unit apart.
const SIDE: u32 = 80;

/// How far points are off their lattice, units.
const JITTER: f64 = 0.25;

/// Pixels between points that lie across the view.
const SPACING_PX: f64 = 3.0;

/// Pixels of pictures, of which the middle half of each side is looked at.
const SIZE: u32 = 96;

/// Between the sheets, along the view, in spacings; the least that has no more than this share of the farther sheet is told.
const STEP: f64 = 0.1;
const FARTHEST: f64 = 5.0;
const SHARE: f64 = 0.01;

/// A row of the table for each angle between the view and the sheets' normal.
pub(crate) fn table(slants_deg: &[f64]) -> Result<String, SurfelError> {
    let mut text = format!(
        "Two sheets of points one spacing apart, {SPACING_PX} px where they lie across the view, up to {JITTER} of one off their lattice. \
         *Least distance*: along the view, in spacings, from which on no more than {} % of a pixel's colour is the farther sheet's, in the mean.\n\n\
         | view to normal, ° | least distance | at half of it, % | at a quarter, % |\n| ---: | ---: | ---: | ---: |\n",
        100.0 * SHARE
    );
    for &slant in slants_deg {
        // Not by bisection: the share need not fall all the way.
        let steps = (FARTHEST / STEP) as u32;
        let mut least = FARTHEST;
        for distance in (1..=steps).rev().map(|i| f64::from(i) * STEP) {
            if share_behind(slant, distance)? > SHARE {
                break;
            }
            least = distance;
        }
        let [half, quarter] = [0.5, 0.25].map(|part| share_behind(slant, part * least));
        let _ = writeln!(text, "| {slant} | {least:.2} | {:.1} | {:.1} |", 100.0 * half?, 100.0 * quarter?);
    }
    Ok(text)
}

/// Share of the farther sheet in the picture's middle, `distance` spacings behind the nearer along the view.
fn share_behind(slant_deg: f64, distance: f64) -> Result<f64, SurfelError> {
    let normal = DVec3::new(slant_deg.to_radians().sin(), 0.0, slant_deg.to_radians().cos());
    let along = DVec3::new(normal.z, 0.0, -normal.x);
    let mut positions = vec![];
    for (sheet, behind) in [0.0, distance].into_iter().enumerate() {
        let place = |i: u32| {
            let lattice = DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) - 0.5 * f64::from(SIDE);
            let at = lattice + JITTER * off(i + SIDE * SIDE * sheet as u32);
            at.x * along + at.y * DVec3::Y - behind * DVec3::Z
        };
        positions.extend((0..SIDE * SIDE).map(place));
    }
    let count = (SIDE * SIDE) as usize;
    let colours = [vec![[1.0, 0.0, 0.0]; count], vec![[0.0, 1.0, 0.0]; count]].concat();
    let normals = vec![normal.as_vec3(); 2 * count];
    let radii = vec![std::f32::consts::FRAC_1_SQRT_2; 2 * count];
    let points = Points::new(&positions).with_normals(&normals).with_colors(&colours).with_radii(&radii);
    let cloud = Cloud::new(&points)?;
    let mut options = Options::default();
    options.ambient = 1.0;
    let projection = Projection::Orthographic { height: f64::from(SIZE) / SPACING_PX };
    let view = View::look_at(DVec3::Z * 100.0, DVec3::ZERO, DVec3::Y, projection, SIZE, SIZE)
        .expect("the camera is not at its target");
    let mut frame = Frame::default();
    Renderer::new().draw(&cloud, &view, &options, &mut frame)?;
    let middle = SIZE as usize / 4..SIZE as usize * 3 / 4;
    let rows = frame.color().chunks_exact(frame.width()).skip(middle.start).take(middle.len());
    let (mut nearer, mut farther) = (0.0, 0.0);
    for colour in rows.flat_map(|row| &row[middle.clone()]) {
        nearer += f64::from(colour[0]);
        farther += f64::from(colour[1]);
    }
    Ok(farther / (nearer + farther))
}

/// Two numbers of −1 to 1 that belong to a number.
fn off(i: u32) -> DVec2 {
    let bits = mixed(u64::from(i));
    let number = |bits: u64| (bits as u32) as f64 / f64::from(u32::MAX) * 2.0 - 1.0;
    DVec2::new(number(bits), number(bits >> 32))
}
