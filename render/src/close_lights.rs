//! Lights so close that they vary over what is seen of a micropoint.
//!
//! Where a surface runs into the depth, a pixel sees metres of it: next to a lamp its middle does not stand for the rest.

use crate::lights::LightSample;
use crate::shader::{Place, Point, Shader};
use glam::{DVec2, DVec3, Vec3};
use pointillist_micropoint::{Face, LensKind, Tile};
use pointillist_shade::Source;

/// Length of a pixel on a surface, over its distance from the light, from which on light is averaged. Below, the middle is off by at most the square
/// of this times about ½: a thousandth.
const CLOSE: f64 = 0.05;

/// Longest side of a triangle, over its distance from the light, up to which the middles of its sides stand for it.
const FINE: f64 = 0.5;

/// The same two lengths, over the width of a highlight in radians: its middle is off by the square of this over 24.
const CLOSE_TO_LOBE: f64 = 0.2;
const FINE_FOR_LOBE: f64 = 1.0;

/// How often triangles are halved at most: the light may touch the surface.
const MOST_HALVINGS: u32 = 8;

impl Shader<'_> {
    /// Whether a light varies over what is seen of a micropoint. Pictures that are drawn coarsely do not ask.
    pub(crate) fn is_close(&self, tile: &Tile, light: &LightSample<'_>, p: &Point) -> bool {
        let Source::Position(from) = self.scene.lights[light.light].light.source(light.sample) else {
            return false;
        };
        // The length of a pixel on the surface is (distance from the eye) / (cosine of the slope · scale), and the cosine times that distance is `height`.
        let normal = p.place.face_normal.as_dvec3();
        let (distance2, height) = match tile.lens().kind {
            LensKind::Perspective => {
                let from_eye = p.place.position - self.eye;
                (from_eye.length_squared(), normal.dot(from_eye).abs())
            }
            LensKind::Orthographic => (1.0, normal.dot(self.forward).abs()),
        };
        let close = CLOSE.min(CLOSE_TO_LOBE * lobe_width(p));
        let limit = close * height * tile.lens().scale;
        // Squares, since roots take long.
        self.economy.is_none()
            && distance2 * distance2 > limit * limit * p.place.position.distance_squared(from)
    }

    /// The mean of [`Shader::arriving`] over convex polygons of the picture, each with its weight.
    pub(crate) fn mean_arriving<'p>(
        &self,
        tile: &Tile,
        light: &LightSample<'_>,
        (point, face): (&Point, &Face),
        polygons: impl Iterator<Item = (&'p [DVec2], f64)>,
    ) -> Vec3 {
        let from = match self.scene.lights[light.light].light.source(light.sample) {
            Source::Position(from) => from,
            _ => return self.arriving(light, point, face),
        };
        let fine = FINE.min(FINE_FOR_LOBE * lobe_width(point));
        let mut mean = Mean { shader: self, tile, light, from, point, face, fine, sum: Vec3::ZERO };
        let mut total = 0.0;
        for (outline, weight) in polygons {
            let area = |b: DVec2, c: DVec2| (b - outline[0]).perp_dot(c - outline[0]).abs();
            let whole: f64 = outline[1..].windows(2).map(|w| area(w[0], w[1])).sum();
            if whole <= 0.0 {
                continue;
            }
            for w in outline[1..].windows(2) {
                let corners = [outline[0], w[0], w[1]].map(|grid| (grid, mean.position(grid)));
                mean.add(corners, weight * area(w[0], w[1]) / whole, MOST_HALVINGS);
            }
            total += weight;
        }
        if total > 0.0 { mean.sum / total as f32 } else { self.arriving(light, point, face) }
    }
}

/// Width of a highlight; without one, there is no limit.
fn lobe_width(p: &Point) -> f64 {
    match p.material.depends_on_view() {
        true => f64::from(p.material.lobe(p.normal, p.place.to_eye).width_rad),
        false => f64::INFINITY,
    }
}

/// A sum over triangles of the picture.
struct Mean<'a> {
    shader: &'a Shader<'a>,
    tile: &'a Tile,
    light: &'a LightSample<'a>,
    /// Where the light is.
    from: DVec3,
    point: &'a Point,
    face: &'a Face,
    /// Longest side of a triangle that is not halved, over its distance from the light.
    fine: f64,
    sum: Vec3,
}

impl Mean<'_> {
    /// Where the face is, in the world.
    fn position(&self, grid: DVec2) -> DVec3 {
        self.shader.eye + self.tile.position(grid, self.face.nearness_at(grid))
    }

    /// Adds a triangle, by its corners in the picture and in the world.
    fn add(&mut self, corners: [(DVec2, DVec3); 3], weight: f64, halvings: u32) {
        let side = |k: usize| corners[k].1.distance_squared(corners[(k + 1) % 3].1);
        let longest = (0..3).fold(0, |longest, k| if side(k) > side(longest) { k } else { longest });
        let [a, b, c] = [0, 1, 2].map(|k| corners[(longest + k) % 3]);
        let middle = |a: DVec2, b: DVec2| (0.5 * (a + b), self.position(0.5 * (a + b)));
        let ab = middle(a.0, b.0);
        let nearest =
            [a, b, c, ab].map(|p| p.1.distance_squared(self.from)).into_iter().fold(f64::INFINITY, f64::min);
        if halvings > 0 && side(longest) > self.fine * self.fine * nearest {
            self.add([a, ab, c], 0.5 * weight, halvings - 1);
            self.add([ab, b, c], 0.5 * weight, halvings - 1);
            return;
        }
        // The middles of the sides: exact for what is quadratic in the picture.
        for (_, position) in [ab, middle(b.0, c.0), middle(c.0, a.0)] {
            let to_eye = self.shader.to_eye(position);
            let there = Point { place: Place { position, to_eye, ..self.point.place }, ..*self.point };
            self.sum += self.shader.arriving(self.light, &there, self.face) * (weight / 3.0) as f32;
        }
    }
}
