//! Depth of field by brute force: the mean of sharp pictures from places all over the lens.

use glam::{DVec2, IVec2};
use pointillist_surfel::{Cloud, Focus, Frame, Options, Procedure, Renderer, SurfelError, View};

use crate::common::picture_layers::PictureLayers;
use crate::surfel::lens_camera::LensCamera;
use crate::surfel::lens_samples::LensSamples;
use crate::surfel::measured::Measured;
use crate::surfel::stage::{Stage, drawn, in_turns, times, view};

/// Where the spread of places on the lens begins.
const SEED: u64 = 1;

/// A sharp picture from one place on the lens.
struct LensView {
    view: View,
    /// Its pixel that shows what the first pixel of the mean shows in the plane of focus.
    first: [usize; 2],
}

/// Pictures from `count` places all over the lens.
///
/// What lies in the plane of focus must stay where it is. The exact way is an off-axis projection, which `View` lacks; a
/// shift of the picture by f·(u, v)/focus pixels is the same map. So each picture gets a margin, from which it is cut out at
/// the shift, and places (u, v) are rounded to those whose shift is whole pixels: nothing is resampled. The radius of the lens is tens of
/// those pixels, so its disc is still covered evenly. Tiles of the margin are mostly empty and cost next to nothing.
fn lens_views(camera: &LensCamera, count: u32) -> Result<Vec<LensView>, SurfelError> {
    let px_per_place = camera.focal_px() / camera.focus;
    let margin = (px_per_place * camera.aperture).ceil() as i32;
    let samples = LensSamples::new(count);
    let of_place = |lens: DVec2| {
        let shift_px = (px_per_place * camera.aperture * lens).round().as_ivec2();
        let camera = camera.widened(margin as u32, shift_px.as_dvec2() / px_per_place);
        // An eye further right sees all further left, one further up all further down.
        let first = margin + IVec2::new(-shift_px.x, shift_px.y);
        Ok(LensView { view: view(&camera), first: first.to_array().map(|v| v as usize) })
    };
    samples.of_pixel(0, SEED).map(|(_, lens)| of_place(lens)).collect()
}

/// Working memory for the mean of several pictures.
#[derive(Default)]
struct Mean {
    renderer: Renderer,
    frame: Frame,
    colour: Vec<[f32; 4]>,
    /// Points drawn in all pictures together.
    points: usize,
}

impl Mean {
    fn take(
        &mut self,
        cloud: &Cloud,
        options: &Options,
        views: &[LensView],
        [width, height]: [usize; 2],
    ) -> Result<(), SurfelError> {
        self.colour.clear();
        self.colour.resize(width * height, [0.0; 4]);
        self.points = 0;
        let share = 1.0 / views.len() as f32;
        for LensView { view, first: [x, y] } in views {
            self.renderer.draw(cloud, view, options, &mut self.frame)?;
            self.points += self.frame.counts().points;
            let lines = self.frame.color().chunks_exact(self.frame.width()).skip(*y);
            for (sums, line) in self.colour.chunks_exact_mut(width).zip(lines) {
                for (sum, colour) in sums.iter_mut().zip(&line[*x..]) {
                    sum.iter_mut().zip(colour).for_each(|(s, c)| *s += share * c);
                }
            }
        }
        Ok(())
    }
}

impl Stage {
    /// The mean of `count` pictures; depths and normals are those of the one through the middle of the lens.
    pub(crate) fn measured_views(&self, cloud: &Cloud, count: u32) -> Result<Measured, SurfelError> {
        let mut options = self.options(Procedure::Blended);
        options.focus = Focus::Everywhere;
        let views = lens_views(&self.camera, count)?;
        let size = [self.camera.width, self.camera.height].map(|n| n as usize);
        let mut mean = Mean::default();
        let times = times(|| mean.take(cloud, &options, &views, size))?;
        let blended = self.options(Procedure::Blended);
        let ratio = in_turns(|| mean.take(cloud, &options, &views, size), self.frames(cloud, &blended))?;
        let (sharp, _) = drawn(cloud, &self.camera, &options)?;
        let picture = PictureLayers { colour: mean.colour, ..sharp };
        let row = self.row(cloud, ("lens views", format!("{count} views")), mean.points, times, &picture);
        Ok(Measured { ratio: Some(ratio), ..row })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};
    use pointillist_surfel::Points;

    /// A square across the view in the plane of focus.
    fn square() -> Cloud {
        let place = |i: u32| DVec3::new(f64::from(i % 40), f64::from(i / 40), 0.0) * 0.01 - DVec3::splat(0.2);
        let positions: Vec<DVec3> = (0..1600).map(place).collect();
        Cloud::new(&Points::new(&positions).with_normals(&[Vec3::Z; 1600])).expect("the points are valid")
    }

    #[test]
    fn what_is_in_focus_stays_where_it_is() {
        let camera = LensCamera::look_at([DVec3::Z * 1.8, -DVec3::Z * 0.2, DVec3::Y], 0.3, [48, 40]);
        let camera = camera.with_lens(0.1, 2.0);
        let (cloud, options) = (square(), Options::default());
        let mut mean = Mean::default();
        mean.take(&cloud, &options, &lens_views(&camera, 16).unwrap(), [48, 40]).unwrap();
        let (sharp, _) = drawn(&cloud, &camera, &options).unwrap();
        let opacities = mean.colour.iter().zip(&sharp.colour).map(|(a, b)| (a[3] - b[3]).abs());
        assert!(opacities.fold(0.0, f32::max) < 0.02, "nothing moves by a part of a pixel");
    }
}
