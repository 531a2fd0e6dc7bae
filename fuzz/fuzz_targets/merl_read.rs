//! Any bytes as a measured BRDF: finite answers in any direction, or a reason why not.
#![no_main]

use glam::Vec3;
use libfuzzer_sys::fuzz_target;
use pointillist_shade::invariants::{merl_is_read_or_refused, merl_of_pattern};

fuzz_target!(|input: (u8, [[f32; 3]; 3], &[u8])| {
    let (kind, directions, bytes) = input;
    let directions = directions.map(Vec3::from_array);
    merl_is_read_or_refused(bytes, directions).unwrap();
    // A file of full size takes a while, so not every time.
    if kind % 64 == 0 {
        merl_is_read_or_refused(&merl_of_pattern(bytes), directions).unwrap();
    }
});
