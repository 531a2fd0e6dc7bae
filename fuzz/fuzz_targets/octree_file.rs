//! Any bytes are read as the file of an octree, or refused; what is changed in a sound one is found; any points are in their tree once,
//! and the regions of a view hold each of those that it needs once.
#![no_main]

use arbitrary::Arbitrary;
use glam::DVec3;
use libfuzzer_sys::fuzz_target;
use pointillist_octree::{CutOptions, invariants};
use pointillist_view::{Projection, View};

#[derive(Arbitrary, Debug)]
struct Input {
    points: Vec<[f32; 3]>,
    in_memory: u8,
    at: u16,
    change: u8,
    bytes: Vec<u8>,
    eye: [i8; 3],
    spacing: u8,
    most: u16,
}

/// A view of the unit cube, where many of the points lie, from anywhere in and around it.
fn view(eye: [i8; 3]) -> Option<View> {
    let eye = DVec3::from_array(eye.map(|c| f64::from(c) / 32.0));
    let lens = Projection::Perspective { fov_y_rad: 0.8 };
    View::look_at(eye, DVec3::splat(0.4), DVec3::new(0.1, 0.9, 0.3), lens, 300, 200).ok()
}

fuzz_target!(|input: Input| {
    let points: Vec<DVec3> = input.points.iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
    let names: Vec<u32> = (0..points.len() as u32).collect();
    let in_memory = u64::from(input.in_memory);
    invariants::any_file_can_be_read(&input.bytes).unwrap();
    invariants::every_point_is_there_once(&points, in_memory).unwrap();
    if let Ok(file) = invariants::file_of(&points, &names, in_memory) {
        invariants::any_file_can_be_read(&file[..usize::from(input.at) % file.len()]).unwrap();
        invariants::changes_are_found(&file, input.at.into(), input.change).unwrap();
    }
    if let Some(view) = view(input.eye) {
        let options = CutOptions::default()
            .with_spacing_px(f64::from(input.spacing) / 16.0 + 0.1)
            .with_most_points(input.most.into());
        invariants::regions_have_every_point_once(&points, &view, &options).unwrap();
    }
});
