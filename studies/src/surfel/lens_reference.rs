//! Reference pictures through a thin lens: many rays a pixel, each through its own place on the lens.

use glam::{DVec2, DVec3, dvec2};
use rayon::prelude::*;

use crate::common::picture_layers::PictureLayers;
use crate::common::true_surface::Surface;
use crate::surfel::lens_camera::LensCamera;
use crate::surfel::lens_samples::LensSamples;

/// Linear colour of a place by its position and unit normal.
pub(crate) type Shade<'a> = dyn Fn(DVec3, DVec3) -> DVec3 + Sync + 'a;

/// The picture that a lens makes of a surface; light is averaged over pixel and lens by `samples` rays.
///
/// Depth and normal are those that a pinhole sees at the pixel's centre. A power of two of samples is spread best.
/// The result depends on the seed, and not on threads.
pub(crate) fn trace(
    surface: &Surface,
    camera: &LensCamera,
    shade: &Shade<'_>,
    samples: u32,
    seed: u64,
) -> PictureLayers {
    let points = LensSamples::new(samples);
    let (width, height) = (camera.width as usize, camera.height as usize);
    let pixel = |i: usize| {
        let corner = dvec2((i % width) as f64, (i / width) as f64);
        let (depth, normal) = through_centre(surface, camera, corner);
        let mut sum = [0.0; 4];
        for (place, lens) in points.of_pixel(i as u64, seed) {
            let (origin, direction) = camera.ray(corner + place, lens);
            if let Some(hit) = surface.cast(origin, direction) {
                let colour = shade(origin + direction * hit.distance, hit.normal);
                let seen = [colour.x, colour.y, colour.z, 1.0];
                sum.iter_mut().zip(seen).for_each(|(sum, c)| *sum += c);
            }
        }
        (sum.map(|s| (s / points.count() as f64) as f32), depth, normal)
    };
    let pixels: Vec<_> = (0..width * height).into_par_iter().map(pixel).collect();
    PictureLayers {
        width,
        height,
        colour: pixels.iter().map(|p| p.0).collect(),
        depth: pixels.iter().map(|p| p.1).collect(),
        normal: pixels.iter().map(|p| p.2).collect(),
    }
}

/// Depth and normal of the surface behind a pixel's centre.
fn through_centre(surface: &Surface, camera: &LensCamera, corner: DVec2) -> (f32, [f32; 3]) {
    let (origin, direction) = camera.ray(corner + 0.5, DVec2::ZERO);
    surface
        .cast(origin, direction)
        .map_or((f32::INFINITY, [0.0; 3]), |hit| (hit.distance as f32, hit.normal.as_vec3().to_array()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Looks along −z from the origin; `pixels` a side.
    fn camera(pixels: u32) -> LensCamera {
        LensCamera::look_at([DVec3::ZERO, -DVec3::Z, DVec3::Y], 0.5, [pixels, pixels])
    }

    /// A square of this half side across the view, on the axis.
    fn square(depth: f64, half: f64) -> Surface {
        let corner = |x: f64, y: f64| DVec3::new(half * x, half * y, -depth);
        let corners = vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        Surface::new("a square", corners, vec![[0, 1, 2], [0, 2, 3]])
    }

    fn white(_: DVec3, _: DVec3) -> DVec3 {
        DVec3::ONE
    }

    #[test]
    fn a_small_square_becomes_a_disc_of_the_lens_equations_radius() {
        let camera = camera(48).with_lens(0.2, 1.0);
        let radius = camera.blur_px(4.0);
        assert!((radius - camera.focal_px() * 0.2 * 0.75).abs() < 1e-12);
        let half = 0.1;
        let picture = trace(&square(4.0, half), &camera, &white, 256, 1);
        let (mut sum, mut moment) = (0.0, 0.0);
        for (i, c) in picture.colour.iter().enumerate() {
            let from_axis = dvec2((i % 48) as f64, (i / 48) as f64) - 23.5;
            let weight = f64::from(c[3]);
            (sum, moment) = (sum + weight, moment + weight * from_axis.length_squared());
        }
        // Every place on the lens sees the square as large as a pinhole does.
        let side = 2.0 * half * camera.focal_px() / 4.0;
        assert!((sum / side.powi(2) - 1.0).abs() < 0.01, "{sum} is not {}", side.powi(2));
        // Mean squares add up: of the disc, of the square and of the pixel.
        let wanted = radius.powi(2) / 2.0 + (side.powi(2) + 1.0) / 6.0;
        assert!((moment / sum / wanted - 1.0).abs() < 0.01, "{} is not {wanted}", moment / sum);
    }

    #[test]
    fn without_aperture_focus_changes_nothing() {
        let picture = |camera: LensCamera| trace(&square(2.0, 0.3), &camera, &white, 16, 1);
        let pinhole = picture(camera(24));
        assert_eq!(picture(camera(24).with_lens(0.0, 7.0)), pinhole);
        let side = 0.6 * camera(24).focal_px() / 2.0;
        let sum: f64 = pinhole.colour.iter().map(|c| f64::from(c[3])).sum();
        assert!((sum / side.powi(2) - 1.0).abs() < 0.01, "{sum} is not {}", side.powi(2));
    }

    #[test]
    fn what_is_in_focus_is_as_sharp_as_by_a_pinhole() {
        let surface = square(2.0, 0.3);
        let picture = |camera: LensCamera| trace(&surface, &camera, &white, 64, 3);
        let (sharp, lens) = (picture(camera(24)), picture(camera(24).with_lens(0.2, 2.0)));
        // A sample on the very edge may fall to either side by rounding.
        let differ = sharp.colour.iter().zip(&lens.colour).filter(|(a, b)| (a[3] - b[3]).abs() > 1.5 / 64.0);
        assert_eq!(differ.count(), 0);
        assert_eq!((sharp.depth, sharp.normal), (lens.depth, lens.normal));
    }

    #[test]
    fn threads_change_nothing() {
        let picture = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            let camera = camera(16).with_lens(0.1, 1.0);
            pool.install(|| trace(&square(2.0, 0.3), &camera, &white, 8, 5))
        };
        assert_eq!(picture(1), picture(3));
    }
}
