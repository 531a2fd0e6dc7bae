//! Masks: the opacity of what is seen is that of its own region, not of its whole part.

use glam::{DVec2, DVec3, dvec2, dvec3};
use pointillist_micropoint::invariants::{Soup, picture_of};
use pointillist_micropoint::{
    MicropointOptions, PixelRect, Projection, Renderer, SurfacePoint, TexturedOpacity, View,
};

/// Opaque left of the middle of the only pixel, empty right of it.
struct LeftHalf;

impl TexturedOpacity for LeftHalf {
    fn mean_opacity(&self, _: u32, polygon: &[SurfacePoint]) -> f32 {
        let ring: Vec<DVec2> = polygon.iter().map(|p| p.grid).collect();
        let mut left = vec![];
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % ring.len()];
            if a.x <= 0.5 {
                left.push(a);
            }
            if (a.x < 0.5) != (b.x < 0.5) && a.x != b.x {
                left.push(a.lerp(b, (0.5 - a.x) / (b.x - a.x)));
            }
        }
        (area(&left) / area(&ring)).clamp(0.0, 1.0) as f32
    }
}

fn area(ring: &[DVec2]) -> f64 {
    0.5 * (0..ring.len()).map(|i| ring[i].perp_dot(ring[(i + 1) % ring.len()])).sum::<f64>()
}

/// Weights of surfaces in a picture of one pixel, a unit square about the origin. Each card is `[low, high]` and whether it is masked.
fn weights(cards: &[([DVec3; 2], bool)]) -> Vec<f64> {
    let mut soup = Soup::default();
    for &([low, high], masked) in cards {
        let surface = soup.surface(1.0);
        soup.surfaces[surface as usize].textured_opacity = masked;
        let corners = [low, dvec3(high.x, low.y, low.z), high, dvec3(low.x, high.y, high.z)];
        soup.polygon(&corners, surface);
    }
    let geometry = soup.geometry().unwrap();
    let camera = Projection::Orthographic { height: 1.0 };
    let view = View::look_at(DVec3::Z * 9.0, DVec3::ZERO, DVec3::Y, camera, 1, 1).unwrap();
    let renderer = Renderer::new(&geometry, &LeftHalf, view, MicropointOptions::DEFAULT).unwrap();
    let picture = picture_of(&renderer, [PixelRect { x0: 0, y0: 0, x1: 1, y1: 1 }]);
    let mut weights = vec![0.0; cards.len()];
    picture[0].iter().for_each(|seen| weights[seen.surface as usize] += seen.weight);
    weights
}

fn card(x: [f64; 2], z: f64) -> [DVec3; 2] {
    let [low, high] = x.map(|x| dvec2(x, x.signum()).extend(z));
    [low.with_y(-1.0), high.with_y(1.0)]
}

fn close(got: &[f64], wanted: &[f64]) {
    assert!(got.iter().zip(wanted).all(|(g, w)| (g - w).abs() < 1e-6), "{got:?}, not {wanted:?}");
}

#[test]
fn what_is_behind_a_hole_is_seen_whole() {
    let (mask, right, left) = (card([-1.0, 1.0], 1.0), card([0.0, 1.0], 0.0), card([-1.0, 0.0], 0.0));
    close(&weights(&[(mask, true)]), &[0.5]);
    close(&weights(&[(mask, true), (right, false)]), &[0.5, 0.5]);
    close(&weights(&[(mask, true), (left, false)]), &[0.5, 0.0]);
}

#[test]
fn of_a_mask_whose_opaque_half_is_hidden_nothing_is_seen() {
    let (mask, right, left) = (card([-1.0, 1.0], 0.0), card([0.0, 1.0], 1.0), card([-1.0, 0.0], 1.0));
    close(&weights(&[(mask, true), (left, false)]), &[0.0, 0.5]);
    close(&weights(&[(mask, true), (right, false)]), &[0.5, 0.5]);
}
