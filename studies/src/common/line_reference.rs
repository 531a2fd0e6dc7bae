//! Reference pictures: exact along horizontal lines, many lines a pixel.
//!
//! Along a line the visible surfaces change only where a triangle begins or ends, so that what a pixel
//! gets of a line is exact; across lines the middle rule converges as their number squared wherever
//! outlines are straight. This shares nothing with cutting by cells, and is far better than points.

use rayon::prelude::*;

use glam::{DVec3, dvec2};
use pointillist_render::Scene;

use crate::common::picture::Picture;
use crate::common::point_sampling::{Pinhole, Projected, by_rows, project, span};
use crate::common::scenes::{SurfaceSample, radiance};

/// Part of a line that a triangle covers.
struct Piece {
    low: f64,
    high: f64,
    index: u32,
}

/// Draws a scene without shadows with `lines` lines a pixel. Triangles must not pass through each other.
pub(crate) fn render(scene: &Scene, lines: u32) -> Picture {
    let camera = Pinhole::new(scene);
    let triangles = project(scene, &camera);
    let rows = by_rows(&triangles, scene.image.height);
    let mut picture = Picture::black(scene.image.width, scene.image.height);
    let width = picture.width;
    picture.pixels.par_chunks_mut(width).zip(&rows).enumerate().for_each(|(y, (row, indices))| {
        for line in 0..lines {
            let at = y as f64 + (f64::from(line) + 0.5) / f64::from(lines);
            draw_line(scene, &camera, &triangles, indices, at, 1.0 / f64::from(lines), row);
        }
    });
    picture
}

fn draw_line(
    scene: &Scene,
    camera: &Pinhole,
    triangles: &[Projected],
    indices: &[u32],
    y: f64,
    share: f64,
    row: &mut [DVec3],
) {
    let width = row.len() as f64;
    let mut pieces: Vec<Piece> = vec![];
    // Every pixel begins a piece of its own: shading that varies is then taken at most a pixel apart.
    let mut ends: Vec<f64> = (0..=row.len()).map(|x| x as f64).collect();
    for &index in indices {
        if let Some((low, high)) = span(&triangles[index as usize], y)
            && low < width
            && high > 0.0
        {
            let (low, high) = (low.max(0.0), high.min(width));
            ends.extend([low, high]);
            pieces.push(Piece { low, high, index });
        }
    }
    pieces.sort_by(|a, b| a.low.total_cmp(&b.low));
    ends.sort_by(f64::total_cmp);
    let (mut open, mut next) = (Vec::<&Piece>::new(), 0);
    for w in ends.windows(2).filter(|w| w[1] > w[0]) {
        let x = 0.5 * (w[0] + w[1]);
        while next < pieces.len() && pieces[next].low <= x {
            open.push(&pieces[next]);
            next += 1;
        }
        open.retain(|p| p.high > x);
        row[x as usize] += seen(scene, camera, triangles, &open, x, y) * ((w[1] - w[0]) * share);
    }
}

/// Colour at a position at which the triangles of `open` lie.
fn seen(scene: &Scene, camera: &Pinhole, triangles: &[Projected], open: &[&Piece], x: f64, y: f64) -> DVec3 {
    let (mut sum, mut left, mut behind) = (DVec3::ZERO, 1.0, f64::INFINITY);
    // Nearest first, one after the other: there are few.
    while left > 0.0 {
        let nearness = |p: &&&Piece| {
            let plane = triangles[p.index as usize].plane;
            plane.x * x + plane.y * y + plane.z
        };
        let rest = open.iter().filter(|p| nearness(p) < behind);
        let Some(nearest) = rest.max_by(|a, b| nearness(a).total_cmp(&nearness(b))) else {
            return sum + left * scene.image.background.as_dvec3();
        };
        behind = nearness(&nearest);
        let t = &triangles[nearest.index as usize];
        let ray = camera.direction(dvec2(x, y));
        let at = SurfaceSample { triangle: t.triangle, position: camera.eye + ray / behind, to_eye: -ray };
        sum += left * t.opacity * radiance(scene, &at, &|_, _, _| 1.0);
        left *= 1.0 - t.opacity;
    }
    sum
}
