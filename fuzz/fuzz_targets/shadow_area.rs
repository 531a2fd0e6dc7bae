//! Triangles, masks, polygonal lights, lines that shine and views of any kind: what is seen of a light depends neither on tiles nor on the order of
//! triangles, and is what rays find where there are no masks.
#![no_main]

mod steps;

use arbitrary::Arbitrary;
use glam::DVec3;
use libfuzzer_sys::fuzz_target;
use pointillist_micropoint::{Projection, View};
use pointillist_shadow::invariants::{area, line};
use steps::{soup_of, steps};

#[derive(Arbitrary, Debug)]
struct Input {
    triangles: Vec<([[i8; 3]; 3], u8)>,
    box_at: Option<[i8; 3]>,
    eye: [i8; 3],
    target: [i8; 3],
    corner: [i8; 3],
    edges: [[i8; 3]; 2],
    seed: u64,
    /// A bit for each of the first triangles: whether its opacity is a mask's.
    masks: u8,
}

/// An edge across the light misplaces half a cell of each row or column at most; twelve triangles and a box have 48.
const TOLERANCE: f64 = 0.25;
/// Places of rays along each side of the light, or along a line.
const PLACES: u32 = 40;

fuzz_target!(|input: Input| {
    let mut soup = soup_of(&input.triangles, 12, input.box_at);
    for (i, surface) in soup.surfaces.iter_mut().take(8).enumerate() {
        surface.textured_opacity = input.masks >> i & 1 == 1;
    }
    let masked = soup.surfaces.iter().any(|surface| surface.textured_opacity);
    let by_rays = |fact: &dyn Fn() -> Result<(), String>| if masked { Ok(()) } else { fact() };
    let corner = steps(input.corner);
    let [u, v] = input.edges.map(steps);
    let camera = Projection::Perspective { fov_y_rad: 1.0 };
    let Ok(view) = View::look_at(steps(input.eye), steps(input.target), DVec3::Y, camera, 5, 4) else {
        return;
    };
    let outline = [corner, corner + u, corner + u + v, corner + v];
    let ends = [corner, corner + u];
    let facts = area::tiles_do_not_matter(&soup, view, &outline)
        .and_then(|()| area::triangle_order_does_not_matter(&soup, view, &outline, input.seed))
        .and_then(|()| by_rays(&|| area::agrees_with_rays(&soup, view, [corner, u, v], PLACES, TOLERANCE)))
        .and_then(|()| line::tiles_do_not_matter(&soup, view, ends))
        .and_then(|()| line::triangle_order_does_not_matter(&soup, view, ends, input.seed))
        .and_then(|()| by_rays(&|| line::agrees_with_rays(&soup, view, ends, PLACES * PLACES, TOLERANCE)));
    if let Err(broken) = facts {
        panic!("{broken}");
    }
});
