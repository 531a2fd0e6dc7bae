//! Any numbers: a camera is refused, or projecting and unprojecting invert each other, rays hit, and its matrix gives it back.
#![no_main]

use arbitrary::Arbitrary;
use glam::{DAffine3, DVec2, DVec3};
use libfuzzer_sys::fuzz_target;
use pointillist_view::{PixelRect, Projection, View, invariants};

#[derive(Arbitrary, Debug)]
struct Input {
    eye: [f64; 3],
    target: [f64; 3],
    up: [f64; 3],
    matrix: Option<[f64; 12]>,
    span: f64,
    is_perspective: bool,
    size: (u32, u32),
    point: [f64; 3],
    pixel: [f64; 2],
    depth: f64,
    rect: [u8; 4],
    tile: u8,
}

fn facts(view: &View, input: &Input) -> Result<(), String> {
    let point = DVec3::from_array(input.point);
    invariants::axes_are_orthonormal(view)?;
    invariants::the_matrix_gives_the_view(view)?;
    invariants::unprojecting_gives_the_point(view, point)?;
    invariants::projecting_gives_the_pixel(view, DVec2::from_array(input.pixel), input.depth)?;
    invariants::rays_hit_what_is_seen(view, point)
}

fuzz_target!(|input: Input| {
    let (w, h) = input.size;
    let projection = match input.is_perspective {
        true => Projection::Perspective { fov_y_rad: input.span },
        false => Projection::Orthographic { height: input.span },
    };
    let [eye, target, up] = [input.eye, input.target, input.up].map(DVec3::from_array);
    let view = match input.matrix {
        Some(matrix) => View::from_matrix(DAffine3::from_cols_array(&matrix), projection, w, h),
        None => View::look_at(eye, target, up, projection, w, h),
    };
    let [x0, y0, x1, y1] = input.rect.map(u32::from);
    let tiles = invariants::tiles_partition(PixelRect { x0, y0, x1, y1 }, input.tile.into());
    if let Err(broken) = tiles.and_then(|()| view.map_or(Ok(()), |view| facts(&view, &input))) {
        panic!("{broken}");
    }
});
