//! Triangles and views of any kind: weights are shares, tiles do not matter, instances are their triangles.
#![no_main]

mod steps;

use arbitrary::Arbitrary;
use glam::{DAffine3, DVec3};
use libfuzzer_sys::fuzz_target;
use pointillist_micropoint::invariants;
use pointillist_micropoint::{MicropointOptions, Occlusion, Projection, View};
use steps::{soup_of, steps};

#[derive(Arbitrary, Debug)]
struct Input {
    /// Corners in steps of 1/64, often shared, coplanar or coincident.
    triangles: Vec<([[i8; 3]; 3], u8)>,
    box_at: Option<[i8; 3]>,
    eye: [i8; 3],
    target: [i8; 3],
    fov: u8,
    orthographic: bool,
    size: (u8, u8),
    paper: bool,
    raw: Option<[f64; 3]>,
    /// Where all of it stands: scales in quarters, and steps.
    places: Vec<([i8; 3], [i8; 3])>,
}

fuzz_target!(|input: Input| {
    let mut soup = soup_of(&input.triangles, 16, input.box_at);
    if let (Some(raw), Some(p)) = (input.raw, soup.positions.first_mut()) {
        *p = DVec3::from_array(raw);
    }
    let span = 0.05 + f64::from(input.fov) / 100.0;
    let projection = match input.orthographic {
        true => Projection::Orthographic { height: span },
        false => Projection::Perspective { fov_y_rad: span },
    };
    let (w, h) = (u32::from(input.size.0 % 9), u32::from(input.size.1 % 9));
    let Ok(view) = View::look_at(steps(input.eye), steps(input.target), DVec3::Y, projection, w, h) else {
        return;
    };
    let rule = if input.paper { Occlusion::Paper } else { Occlusion::Correlated };
    let options = MicropointOptions::DEFAULT.with_occlusion(rule);
    // What is smaller than the rounding of the farthest vertex coincides, in any order: then an answer is enough.
    if soup.positions.iter().any(|p| !p.is_finite() || p.abs().max_element() > 1e6) {
        let _ = invariants::picture(&soup, view, options);
        return;
    }
    let facts = invariants::weights_are_shares(&soup, view, options)
        .and_then(|()| invariants::tiles_do_not_matter(&soup, view, options))
        .and_then(|()| {
            let place = |&(scale, to): &([i8; 3], [i8; 3])| {
                let scale = DVec3::from_array(scale.map(|s| f64::from(s) / 4.0));
                DAffine3::from_translation(steps(to)) * DAffine3::from_scale(scale)
            };
            let places: Vec<DAffine3> = input.places.iter().take(4).map(place).collect();
            invariants::instances_are_their_triangles(&soup, &places, view)
        });
    if let Err(broken) = facts {
        panic!("{broken}");
    }
});
