//! The parts of a polygon that a point sees past occluders.
//!
//! An occluder hides of the source what lies in its cone, seen from the point, and behind its plane: half-planes of the
//! source's plane, which `dice` cuts by. Nothing is projected, so nothing can come to lie at infinity.
//!
//! Not by `dice::hide::Regions`, which wants closed outlines and keeps transmittances: with it, results are equal within rounding, but a pair past
//! one occluder takes 1.8 times as long (bench `time_error`, `behind`), and a bake of `examples/house.toml` with `--patch 1` 42 s instead of 34 s.

use glam::{DVec2, DVec3};
use pointillist_dice::{ConvexPolygon, HalfPlane, lambert};

use crate::polygon::{Polygon, edges};

/// An occluder whose plane is nearer to the eye than this, times its radius, is seen edge on and hides nothing.
const EDGE_ON: f64 = 1e-13;
/// A source that extends behind an occluder's plane by less than this, times the sum of both radii, lies in the plane.
const COPLANAR: f64 = 1e-12;
/// Most vertices of a part of the source before it is cut.
const MAX_SOURCE_VERTICES: usize = 8;

/// Coordinates in the plane of a polygon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    origin: DVec3,
    axes: [DVec3; 2],
}

impl Frame {
    /// Around the polygon's centre, right-handed seen from its front.
    pub(crate) fn of(polygon: &Polygon) -> Self {
        let u = polygon.normal().any_orthonormal_vector();
        Self { origin: polygon.centre(), axes: [u, polygon.normal().cross(u)] }
    }

    /// The foot of a point in space.
    pub(crate) fn flat(&self, p: DVec3) -> DVec2 {
        self.flat_way(p - self.origin)
    }

    fn flat_way(&self, way: DVec3) -> DVec2 {
        DVec2::new(way.dot(self.axes[0]), way.dot(self.axes[1]))
    }

    /// The point in space of a point in the plane.
    pub(crate) fn in_space(&self, p: DVec2) -> DVec3 {
        self.origin + self.axes[0] * p.x + self.axes[1] * p.y
    }
}

/// A polygon with coordinates in its plane.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    frame: Frame,
    radius: f64,
    parts: Vec<ConvexPolygon>,
}

/// From where the source is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Eye {
    /// A point in space.
    Point(DVec3),
    /// Infinitely far away, looking along this direction.
    Along(DVec3),
}

/// What the caller needs from the last occluder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Last {
    /// Only the parts that it hides.
    IsEnough,
    /// Also the parts that it leaves.
    LeavesPieces,
}

/// Reusable memory, one per thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    seen: Vec<ConvexPolygon>,
    next: Vec<ConvexPolygon>,
    sides: Vec<HalfPlane>,
    /// A piece that is cut by one half-plane after the other: each cut reads one and writes the other.
    turns: [ConvexPolygon; 2],
    outside: ConvexPolygon,
}

impl Source {
    pub(crate) fn new(polygon: &Polygon) -> Self {
        let frame = Frame::of(polygon);
        let ring: Vec<DVec2> = polygon.vertices().iter().map(|&v| frame.flat(v)).collect();
        // A fan of pieces that leave room for cuts.
        let parts = (1..ring.len() - 1)
            .step_by(MAX_SOURCE_VERTICES - 2)
            .map(|i| {
                let end = (i + MAX_SOURCE_VERTICES - 1).min(ring.len());
                let mut part = vec![ring[0]];
                part.extend(&ring[i..end]);
                ConvexPolygon::from_vertices(&part)
            })
            .collect();
        Self { frame, radius: polygon.radius(), parts }
    }

    /// The point in space of a point in the plane.
    pub(crate) fn in_space(&self, p: DVec2) -> DVec3 {
        self.frame.in_space(p)
    }

    /// The half-plane where `normal · (p − through)` is not negative.
    fn half_plane(&self, normal: DVec3, through: DVec3) -> HalfPlane {
        let flat = self.frame.flat_way(normal);
        HalfPlane { anchor: DVec2::ZERO, normal: flat, offset: normal.dot(self.frame.origin - through) }
    }

    /// The pieces that `eye` sees; true with them if some occluder hides something.
    pub(crate) fn see<'p, 's>(
        &self,
        eye: Eye,
        occluders: impl Iterator<Item = &'p Polygon>,
        pieces: &'s mut Pieces,
    ) -> (&'s [ConvexPolygon], bool) {
        let mut cut = false;
        self.hide((eye, Last::LeavesPieces), occluders, pieces, None, |_| cut = true);
        (&pieces.seen, cut)
    }

    /// Share of the cosine-weighted hemisphere at `point` that the occluders take from the source.
    pub(crate) fn hidden_share<'p>(
        &self,
        (point, normal): (DVec3, DVec3),
        occluders: impl Iterator<Item = &'p Polygon>,
        pieces: &mut Pieces,
        meets: Option<&mut dyn FnMut(usize)>,
    ) -> f64 {
        let mut sum = 0.0;
        let visit = |hidden: &ConvexPolygon| sum += self.share_of(point, normal, hidden);
        self.hide((Eye::Point(point), Last::IsEnough), occluders, pieces, meets, visit);
        sum
    }

    /// Takes from the source, occluder by occluder, what it hides of what is left; `visit` gets these pieces, which do not overlap.
    /// `meets` is told of every occluder before the source, whether others hide the same or not; without it, nothing is looked at once all is hidden.
    fn hide<'p>(
        &self,
        (eye, last): (Eye, Last),
        occluders: impl Iterator<Item = &'p Polygon>,
        pieces: &mut Pieces,
        mut meets: Option<&mut dyn FnMut(usize)>,
        mut visit: impl FnMut(&ConvexPolygon),
    ) {
        pieces.seen.clear();
        pieces.seen.extend_from_slice(&self.parts);
        let mut any = false;
        let mut occluders = occluders.enumerate().peekable();
        while let Some((index, occluder)) = occluders.next() {
            if pieces.seen.is_empty() && meets.is_none() {
                break;
            }
            if self.shadow(eye, occluder, &mut pieces.sides) {
                let goes_on = last == Last::LeavesPieces || occluders.peek().is_some();
                let hides = pieces.subtract(goes_on, &mut visit);
                // What is behind others already may still be before the source.
                if let (true, Some(meets)) = (hides || any, &mut meets) {
                    meets(index);
                }
                any |= hides;
            }
        }
    }

    /// Share of the cosine-weighted hemisphere at `point` that the pieces take.
    pub(crate) fn share(&self, point: DVec3, normal: DVec3, pieces: &[ConvexPolygon]) -> f64 {
        pieces.iter().map(|piece| self.share_of(point, normal, piece)).sum()
    }

    fn share_of(&self, point: DVec3, normal: DVec3, piece: &ConvexPolygon) -> f64 {
        lambert::share_of_ring(normal, piece.vertices().iter().map(|&v| self.in_space(v) - point))
    }

    /// The half-planes whose common part the occluder hides; false if it hides nothing.
    fn shadow(&self, eye: Eye, occluder: &Polygon, sides: &mut Vec<HalfPlane>) -> bool {
        sides.clear();
        let height = match eye {
            Eye::Point(p) => occluder.height(p),
            Eye::Along(d) => -occluder.normal().dot(d) * occluder.radius(),
        };
        if height.abs() <= EDGE_ON * occluder.radius() {
            return false;
        }
        let towards_eye = height.signum();
        // Behind the occluder's plane, seen from the eye.
        let behind = self.half_plane(occluder.normal() * -towards_eye, occluder.centre());
        // An occluder in the source's plane has a half-plane made of rounding.
        let slack = COPLANAR * (self.radius + occluder.radius());
        if self.is_outside(&behind, slack) {
            return false;
        }
        sides.push(behind);
        for (a, b) in edges(occluder.vertices()) {
            let normal = match eye {
                Eye::Point(p) => (a - p).cross(b - p),
                Eye::Along(d) => d.cross(b - a),
            };
            // Counter-clockwise for the eye if it is in front.
            let half = self.half_plane(normal * -towards_eye, a);
            if half.normal == DVec2::ZERO && half.offset >= 0.0 {
                continue;
            }
            if self.is_outside(&half, 0.0) {
                return false;
            }
            sides.push(half);
        }
        true
    }

    fn is_outside(&self, half: &HalfPlane, slack: f64) -> bool {
        self.parts.iter().all(|part| part.vertices().iter().all(|&v| half.value(v) <= slack))
    }
}

impl Pieces {
    /// Takes away what lies in all half-planes, and visits it; false if there is none. Pieces are `kept` if what is left matters.
    fn subtract(&mut self, kept: bool, mut visit: impl FnMut(&ConvexPolygon)) -> bool {
        let is_apart = |piece: &ConvexPolygon, sides: &[HalfPlane]| {
            sides.iter().any(|half| piece.vertices().iter().all(|&v| half.value(v) <= 0.0))
        };
        // Most occluders hide nothing of what others have left, and then nothing is copied.
        let Some(first) = self.seen.iter().position(|piece| !is_apart(piece, &self.sides)) else {
            return false;
        };
        self.next.clear();
        if kept {
            self.next.extend_from_slice(&self.seen[..first]);
        }
        let mut any = false;
        for (number, piece) in self.seen.iter().enumerate().skip(first) {
            if number > first && is_apart(piece, &self.sides) {
                if kept {
                    self.next.push(*piece);
                }
                continue;
            }
            let mut now = 0;
            for (i, half) in self.sides.iter().enumerate() {
                let [a, b] = &mut self.turns;
                let (left, inside) = if now == 0 { (a, b) } else { (b, a) };
                let left = if i == 0 { piece } else { left };
                left.divide_into(half, inside, &mut self.outside);
                now = 1 - now;
                if kept && !self.outside.is_empty() {
                    self.next.push(self.outside);
                }
                if inside.is_empty() {
                    break;
                }
            }
            if !self.turns[now].is_empty() {
                visit(&self.turns[now]);
                any = true;
            }
        }
        std::mem::swap(&mut self.seen, &mut self.next);
        any
    }
}
