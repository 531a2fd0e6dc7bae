//! Triangles, lights and views of any kind: lit fractions are fractions, tiles do not matter, and lit regions are what is lit.
#![no_main]

mod steps;

use arbitrary::Arbitrary;
use glam::DVec3;
use libfuzzer_sys::fuzz_target;
use pointillist_micropoint::{Projection, View};
use pointillist_shadow::{Emitter, ShadowOptions, invariants};
use steps::{soup_of, steps};

#[derive(Arbitrary, Debug)]
struct Input {
    triangles: Vec<([[i8; 3]; 3], u8)>,
    box_at: Option<[i8; 3]>,
    eye: [i8; 3],
    target: [i8; 3],
    light: [i8; 3],
    axis: [i8; 3],
    directional: bool,
    raw: Option<[f64; 3]>,
}

fuzz_target!(|input: Input| {
    let soup = soup_of(&input.triangles, 12, input.box_at);
    let position = input.raw.map_or(steps(input.light), DVec3::from_array);
    let emitter = match input.directional {
        true => Emitter::Directional { direction: position },
        false => Emitter::Point { position, axis: steps(input.axis) },
    };
    let camera = Projection::Perspective { fov_y_rad: 1.0 };
    let Ok(view) = View::look_at(steps(input.eye), steps(input.target), DVec3::Y, camera, 5, 4) else {
        return;
    };
    let options = ShadowOptions::default();
    // Any floats may give surfaces edge-on to within rounding: then an answer is enough.
    if input.raw.is_some() {
        let _ = invariants::lit_picture(&soup, view, emitter, options);
        return;
    }
    let facts = invariants::fractions_are_fractions(&soup, view, emitter, options)
        .and_then(|()| invariants::tiles_do_not_matter(&soup, view, emitter, options))
        .and_then(|()| invariants::lit_regions_make_up_the_fraction(&soup, view, emitter, 1e-6));
    if let Err(broken) = facts {
        panic!("{broken}");
    }
});
