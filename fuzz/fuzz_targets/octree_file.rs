//! Any bytes are read as the file of an octree, or refused; what is changed in a sound one is found; and any points are in their tree once.
#![no_main]

use arbitrary::Arbitrary;
use glam::DVec3;
use libfuzzer_sys::fuzz_target;
use pointillist_octree::invariants;

#[derive(Arbitrary, Debug)]
struct Input {
    points: Vec<[f32; 3]>,
    in_memory: u8,
    at: u16,
    change: u8,
    bytes: Vec<u8>,
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
});
