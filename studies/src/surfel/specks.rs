//! Specks: pixels of a surface of rough facets through which what is behind it shows, because no point lies in a fold.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use glam::{DVec2, DVec3};
use pointillist_surfel::{
    Cloud, Frame, Method, Options, Points, Projection, Renderer, SampleOptions, SurfelError, View,
};

use crate::common::true_surface::Surface;
use crate::surfel::coloured_cloud::ColouredCloud;
use crate::surfel::lens_scenes::front;

/// Views around the surface, alternately from above, the side and below.
const VIEWS: u32 = 12;

/// Sines of the eye's elevation, about.
const ELEVATIONS: [f64; 3] = [-0.3, 0.0, 0.3];

/// Pixels on a side of the pictures.
const SIZES: [u32; 2] = [512, 1024];

/// From the middle of the box of the surface to the eye, in diagonals of that box; full vertical field of view.
const DISTANCE: f64 = 1.5;
const FOV_Y_RAD: f64 = 0.6;

/// Opacity below which a pixel is a speck, and below which it is a hole.
const SPECK: f32 = 0.97;
const HOLE: f32 = 0.5;

/// Surroundings of a speck, pixels: all of them are covered.
const AROUND: [[i64; 2]; 8] = [[5, 0], [-5, 0], [0, 5], [0, -5], [4, 4], [-4, 4], [4, -4], [-4, -4]];
const COVERED: f32 = 0.999;

/// What was counted in all views.
#[derive(Clone, Copy, Debug, Default)]
struct Count {
    /// Pixels that are at least half opaque.
    covered: usize,
    specks: usize,
    holes: usize,
}

/// A row of the table for each number of points and size of the picture.
pub(crate) fn table(counts: &[usize]) -> Result<String, SurfelError> {
    let surface = Surface::rough_bunny_or_bumpy();
    let mut text = format!(
        "{} ({} triangles), {VIEWS} views around it. *Specks*: pixels with an opacity below {SPECK} whose middle shows the surface, \
         and whose surroundings at a distance of five pixels are covered. *Holes*: those below {HOLE}. *Estimated*: without normals and \
         radii.\n\n\
         | points | picture | pixels of the surface | specks | holes | specks, estimated | holes, estimated |\n\
         | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
        surface.name,
        surface.triangle_count(),
    );
    for &count in counts {
        eprintln!("surfel: specks of {count} points");
        let options = SampleOptions::DEFAULT.with_method(Method::Poisson).with_count(count);
        let sampled = ColouredCloud::of(&surface, &front(&surface, 1).1, &options)?;
        let clouds = [sampled.ready()?, Cloud::new(&Points::new(&sampled.positions))?];
        for size in SIZES {
            let [given, estimated] = clouds.each_ref().map(|cloud| counted(&surface, cloud, size));
            let (given, estimated) = (given?, estimated?);
            let _ = writeln!(
                text,
                "| {count} | {size}² | {} | {} | {} | {} | {} |",
                given.covered, given.specks, given.holes, estimated.specks, estimated.holes
            );
        }
    }
    Ok(text)
}

fn counted(surface: &Surface, cloud: &Cloud, size: u32) -> Result<Count, SurfelError> {
    let (mut renderer, mut frame) = (Renderer::new(), Frame::default());
    let mut count = Count::default();
    for number in 0..VIEWS {
        let view = view(surface, number, size);
        renderer.draw(cloud, &view, &Options::default(), &mut frame)?;
        count.add(surface, &view, &frame);
    }
    Ok(count)
}

fn view(surface: &Surface, number: u32, size: u32) -> View {
    let (x, z) = (TAU * f64::from(number) / f64::from(VIEWS)).sin_cos();
    let to_eye = DVec3::new(x, ELEVATIONS[number as usize % ELEVATIONS.len()], z).normalize();
    let eye = surface.centre() + DISTANCE * surface.diagonal() * to_eye;
    let projection = Projection::Perspective { fov_y_rad: FOV_Y_RAD };
    View::look_at(eye, surface.centre(), DVec3::Y, projection, size, size)
        .expect("the eye is neither at its target nor above it")
}

impl Count {
    fn add(&mut self, surface: &Surface, view: &View, frame: &Frame) {
        let [width, height] = [frame.width(), frame.height()].map(|n| n as i64);
        let opacity = |x: i64, y: i64| {
            let is_inside = (0..width).contains(&x) && (0..height).contains(&y);
            if is_inside { frame.color()[(y * width + x) as usize][3] } else { 0.0 }
        };
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let own = opacity(x, y);
            self.covered += usize::from(own >= HOLE);
            let is_enclosed = || AROUND.iter().all(|[dx, dy]| opacity(x + dx, y + dy) > COVERED);
            if own >= SPECK || !is_enclosed() {
                continue;
            }
            let ray = view.ray(DVec2::new(x as f64, y as f64) + 0.5);
            if surface.cast(ray.origin, ray.direction).is_some() {
                self.specks += 1;
                self.holes += usize::from(own < HOLE);
            }
        }
    }
}
