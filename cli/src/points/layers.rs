//! A drawn frame as the layers of a picture file.

use super::colouring::{ColorBy, normal_colour};
use crate::image_io::{Frame, Layer, PixelRect};
use glam::DVec2;
use pointillist_view::View;

/// What can be asked for beside colour and depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointLayer {
    /// `N.X N.Y N.Z`.
    Normal,
    /// `P.X P.Y P.Z`.
    Position,
    /// `count`: points per buffer pixel.
    Count,
}

/// A drawn frame: row-major layers; normals and counts may be empty if they are not asked for.
#[derive(Clone, Copy, Debug)]
pub struct Drawn<'a> {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Linear RGB, premultiplied, and opacity.
    pub colour: &'a [[f32; 4]],
    /// Distance along the view axis; +∞ where there is nothing.
    pub depth: &'a [f32],
    /// Unit normal in the world.
    pub normal: &'a [[f32; 3]],
    /// Points per pixel.
    pub count: &'a [f32],
}

/// The part of a drawn frame in `window`, with the layers that were asked for. Normals take the place of colours if it is coloured by them.
pub fn window_of(
    frame: &Drawn<'_>,
    window: PixelRect,
    layers: &[PointLayer],
    view: &View,
    coloured_by: ColorBy,
) -> Frame {
    let rows = (window.y0..window.y1).map(|y| {
        let start = y as usize * frame.width;
        start + window.x0 as usize..start + window.x1 as usize
    });
    let pixels: Vec<usize> = rows.flatten().collect();
    let plane = |value: &dyn Fn(usize) -> f32| pixels.iter().map(|i| value(*i)).collect::<Vec<f32>>();
    let named = |name: &str, value: &dyn Fn(usize) -> [f32; 3]| Layer {
        channels: ["X", "Y", "Z"].map(|axis| format!("{name}.{axis}")).to_vec(),
        planes: [0, 1, 2].map(|axis| plane(&|i| value(i)[axis])).to_vec(),
        names: vec![],
    };
    let layer = |layer: &PointLayer| match layer {
        PointLayer::Normal => named("N", &|i| frame.normal[i]),
        PointLayer::Position => named("P", &|i| position(frame, i, view)),
        PointLayer::Count => Layer {
            channels: vec!["count".to_owned()],
            planes: vec![plane(&|i| frame.count[i])],
            names: vec![],
        },
    };
    Frame {
        size: [frame.width as u32, frame.height as u32],
        window,
        color: match coloured_by {
            ColorBy::Normal => {
                pixels.iter().map(|i| normal_colour(frame.colour[*i], frame.normal[*i])).collect()
            }
            _ => pixels.iter().map(|i| frame.colour[*i]).collect(),
        },
        depth: pixels.iter().map(|i| frame.depth[*i]).collect(),
        layers: layers.iter().map(layer).collect(),
    }
}

/// Where the surface at the centre of pixel `i` is; 0 where there is none.
fn position(frame: &Drawn<'_>, i: usize, view: &View) -> [f32; 3] {
    let depth = f64::from(frame.depth[i]);
    if depth.is_infinite() {
        return [0.0; 3];
    }
    let pixel = DVec2::new((i % frame.width) as f64 + 0.5, (i / frame.width) as f64 + 0.5);
    view.unproject(pixel, depth).as_vec3().to_array()
}
