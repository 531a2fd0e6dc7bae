//! A bush of leaf cards with a mask, made by code.

use std::f64::consts::TAU;
use std::num::NonZeroU32;

use glam::{DVec2, DVec3, Vec3, Vec4, dvec2, dvec3};
use pointillist_render::{LightSource, Scene, Texels, Texture};
use pointillist_shade::{self as shade, Falloff, Light};

use crate::common::ray_reference::random;
use crate::common::scenes::Sketch;

/// Pixels on a side.
pub(crate) const SIZE: u32 = 96;

/// Cards of the bush.
pub(crate) const CARDS: u32 = 500;

/// Half a side of a card.
const HALF: f64 = 0.14;

/// Points along a side of a texel that its opacity is taken from.
const MASK_POINTS: u32 = 4;

/// Whether each card is one quad, or two in one place that face opposite ways.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cards {
    Single,
    Pairs,
}

/// The bush above the ground, under a sun and a lamp; its mask has `texels` × `texels` texels.
pub(crate) fn bush(texels: u32, cards: Cards) -> Scene {
    let mut s = Sketch::new(dvec3(0.4, 1.5, 4.4), dvec3(0.0, 0.75, 0.0), 30.0, SIZE);
    let ground = s.matt(0.6, 1.0);
    let corner = |x: f64, z: f64| dvec3(4.0 * x, 0.0, 4.0 * z);
    s.polygon(&[corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], ground);
    let map = s.scene.add_texture(leaf(texels));
    let leaf = s.material(shade::Material::lambert(Vec3::ONE), Some(map));
    s.scene.materials[leaf as usize].opacity_map = Some(map);
    let mut state = 0x2545_f491_4f6c_dd1d;
    for _ in 0..CARDS {
        let quad = card(&mut state);
        s.textured_quad(&quad, leaf);
        if cards == Cards::Pairs {
            s.textured_back(&quad, leaf);
        }
    }
    s.sun(dvec3(-0.5, -1.0, -0.6));
    s.lamp(dvec3(1.6, 2.0, 1.8), 1.6);
    s.scene
}

/// The bush under a rectangular light of `samples` points, 0 for the whole of it, twice as wide as itself.
pub(crate) fn bush_under_area(size: u32, samples: u32) -> Scene {
    let mut scene = bush(64, Cards::Single);
    [scene.image.width, scene.image.height] = [size; 2];
    let light = Light::Rect {
        corner: dvec3(-1.6, 4.0, -1.6),
        edge_u: dvec3(3.2, 0.0, 0.0),
        edge_v: dvec3(0.0, 0.0, 3.2),
        radiance: Vec3::splat(4.0),
        samples: NonZeroU32::new(samples),
        falloff: Falloff::InverseSquare,
    };
    scene.lights = vec![LightSource::new("sky", light)];
    scene
}

/// Four corners of a card somewhere in an ellipsoid above the ground, turned at random.
fn card(state: &mut u64) -> [DVec3; 4] {
    let centre = dvec3(0.0, 0.9, 0.0) + in_ball(state) * dvec3(0.8, 0.7, 0.8);
    let normal = in_ball(state).normalize();
    let (u, v) = normal.any_orthonormal_pair();
    let turn = DVec2::from_angle(TAU * random(state));
    let (u, v) = (u * turn.x + v * turn.y, v * turn.x - u * turn.y);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| centre + (u * x + v * y) * HALF)
}

/// A random point of the unit ball, but for its very centre.
fn in_ball(state: &mut u64) -> DVec3 {
    loop {
        let point = dvec3(random(state), random(state), random(state)) * 2.0 - 1.0;
        if (0.01..1.0).contains(&point.length_squared()) {
            return point;
        }
    }
}

/// A twig of leaflets: green with darker ribs, alpha 0 between them; texels at outlines are covered in part.
fn leaf(texels: u32) -> Texture {
    let texel = |i: u32| {
        let corner = dvec2(f64::from(i % texels), f64::from(i / texels));
        let at = |k: u32| {
            let within = dvec2(f64::from(k % MASK_POINTS) + 0.5, f64::from(k / MASK_POINTS) + 0.5);
            (corner + within / f64::from(MASK_POINTS)) / f64::from(texels)
        };
        let points = MASK_POINTS * MASK_POINTS;
        let covered = (0..points).filter(|&k| leaflet(at(k)).is_some()).count();
        let rib = leaflet(at(points / 2)).is_some_and(|across| across.abs() < 0.1);
        let color = if rib { Vec3::new(0.35, 0.45, 0.1) } else { Vec3::new(0.25, 0.7, 0.15) };
        let bytes = color.extend(covered as f32 / points as f32) * 255.0 + Vec4::splat(0.5);
        bytes.to_array().map(|b| b as u8)
    };
    let texels_of_leaf: Vec<[u8; 4]> = (0..texels * texels).map(texel).collect();
    Texture::new("leaf", [texels, texels], Texels::Linear8(texels_of_leaf.into()))
}

/// How far across its leaflet a point lies, −1..1, if it is in one.
fn leaflet(at: DVec2) -> Option<f64> {
    (0..7).find_map(|i| {
        // Three pairs along the stem and one leaflet at its end.
        let (row, side) = (f64::from(i / 2), if i % 2 == 0 { 1.0 } else { -1.0 });
        let (base, way) = match i {
            6 => (dvec2(0.5, 0.32), dvec2(0.0, -1.0)),
            _ => (dvec2(0.5, 0.92 - 0.22 * row), dvec2(side, -0.45).normalize()),
        };
        let local = dvec2(way.dot(at - base), way.perp_dot(at - base));
        let along = local.x / 0.3;
        let half_width = 0.075 * (along * TAU / 2.0).sin().max(0.0).sqrt();
        let inside = (0.0..=1.0).contains(&along) && local.y.abs() < half_width;
        inside.then(|| local.y / half_width)
    })
}
