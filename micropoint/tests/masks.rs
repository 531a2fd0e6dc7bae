//! Masks: the opacity of what is seen is that of its own region, not of its whole part.

use glam::{DVec2, DVec3, dvec2, dvec3};
use pointillist_micropoint::invariants::{Soup, picture_of};
use pointillist_micropoint::{
    MicropointError, MicropointOptions, PixelRect, Projection, Renderer, SurfacePoint, TexturedOpacity, View,
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

#[test]
fn masks_with_their_holes_in_one_place_hide_like_one() {
    let mask = |z: f64| (card([-1.0, 1.0], z), true);
    // As independent masks, the second would add a quarter.
    close(&weights(&[mask(1.0), mask(0.0)]), &[0.5, 0.0]);
    close(&weights(&[mask(1.0), mask(0.0), (card([-1.0, 1.0], -1.0), false)]), &[0.5, 0.0, 0.5]);
}

#[test]
fn a_pixel_is_divided_where_a_mask_is_partly_open_only() {
    let mut soup = Soup::default();
    let surface = soup.surface(1.0);
    soup.surfaces[surface as usize].textured_opacity = true;
    soup.polygon(
        &[dvec3(-2.0, -1.0, 0.0), dvec3(2.0, -1.0, 0.0), dvec3(2.0, 1.0, 0.0), dvec3(-2.0, 1.0, 0.0)],
        surface,
    );
    let geometry = soup.geometry().unwrap();
    let camera = Projection::Orthographic { height: 1.0 };
    let view = View::look_at(DVec3::Z * 9.0, DVec3::ZERO, DVec3::Y, camera, 3, 1).unwrap();
    for (cells, squares, expected) in [(1, 1, 1), (1, 2, 2), (1, 4, 8), (2, 1, 2), (2, 2, 4), (2, 4, 16)] {
        // The mask is closed left of the middle of the first cell, and of the others nothing is seen.
        let options =
            MicropointOptions::DEFAULT.with_cells_per_pixel(cells).with_squares_under_masks(squares);
        let renderer = Renderer::new(&geometry, &LeftHalf, view, options).unwrap();
        let picture = picture_of(&renderer, [PixelRect { x0: 0, y0: 0, x1: 3, y1: 1 }]);
        assert!(picture[1].is_empty() && picture[2].is_empty());
        let weight: f64 = picture[0].iter().map(|seen| seen.weight).sum();
        assert!(
            (weight - 0.5 / f64::from(cells)).abs() < 1e-6 && picture[0].len() == expected,
            "{weight}, {} pieces",
            picture[0].len()
        );
    }
    let refused =
        Renderer::new(&geometry, &LeftHalf, view, MicropointOptions::DEFAULT.with_squares_under_masks(3));
    assert_eq!(refused.err(), Some(MicropointError::BadSquaresUnderMasks(3)));
}
