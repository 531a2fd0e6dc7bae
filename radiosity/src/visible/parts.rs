//! The parts of a polygon that a point sees past occluders.
//!
//! An occluder hides of the source what lies in its cone, seen from the point, and behind its plane: half-planes of the
//! source's plane, which `dice` cuts by. Nothing is projected, so nothing can come to lie at infinity.

use glam::{DVec2, DVec3};
use pointillist_dice::{ConvexPolygon, HalfPlane};

use crate::kernel::lambert;
use crate::polygon::{Polygon, edges};

/// Points nearer to an occluder's plane than this, relative to its size, see it edge on.
const EDGE_ON: f64 = 1e-13;
/// What sticks out behind an occluder by less than this, relative to both, is in its plane.
const COPLANAR: f64 = 1e-12;
/// Most vertices of a part of the source before it is cut.
const MAX_SOURCE_VERTICES: usize = 8;

/// A polygon with coordinates in its plane.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    origin: DVec3,
    axes: [DVec3; 2],
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

/// Memory of one thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pieces {
    seen: Vec<ConvexPolygon>,
    next: Vec<ConvexPolygon>,
    sides: Vec<HalfPlane>,
}

impl Source {
    pub(crate) fn new(polygon: &Polygon) -> Self {
        let normal = polygon.normal();
        let u = normal.any_orthonormal_vector();
        let axes = [u, normal.cross(u)];
        let origin = polygon.centre();
        let flat = |v: &DVec3| DVec2::new((*v - origin).dot(axes[0]), (*v - origin).dot(axes[1]));
        let ring: Vec<DVec2> = polygon.vertices().iter().map(flat).collect();
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
        Self { origin, axes, radius: polygon.radius(), parts }
    }

    /// The point in space of a point in the plane.
    pub(crate) fn in_space(&self, p: DVec2) -> DVec3 {
        self.origin + self.axes[0] * p.x + self.axes[1] * p.y
    }

    /// The half-plane where `normal · (p − through)` is not negative.
    fn half_plane(&self, normal: DVec3, through: DVec3) -> HalfPlane {
        let flat = DVec2::new(normal.dot(self.axes[0]), normal.dot(self.axes[1]));
        HalfPlane { anchor: DVec2::ZERO, normal: flat, offset: normal.dot(self.origin - through) }
    }

    /// Visits the pieces that `eye` sees. `meets` is told of every occluder that hides something of them.
    pub(crate) fn see<'p, 's>(
        &self,
        eye: Eye,
        occluders: impl Iterator<Item = &'p Polygon>,
        pieces: &'s mut Pieces,
        mut meets: impl FnMut(usize),
    ) -> &'s [ConvexPolygon] {
        pieces.seen.clear();
        pieces.seen.extend_from_slice(&self.parts);
        for (index, occluder) in occluders.enumerate() {
            if self.shadow(eye, occluder, &mut pieces.sides) && pieces.subtract() {
                meets(index);
            }
            if pieces.seen.is_empty() {
                break;
            }
        }
        &pieces.seen
    }

    /// Share of the cosine-weighted hemisphere at `point` that the pieces take.
    pub(crate) fn share(&self, point: DVec3, normal: DVec3, pieces: &[ConvexPolygon]) -> f64 {
        let mut ring = [DVec3::ZERO; pointillist_dice::convex::MAX_VERTICES];
        let mut sum = 0.0;
        for piece in pieces {
            let corners = piece.vertices();
            for (place, corner) in ring.iter_mut().zip(corners) {
                *place = self.in_space(*corner);
            }
            sum += lambert::share(point, normal, &ring[..corners.len()]);
        }
        sum
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
    /// Takes away what lies in all half-planes; false if nothing does.
    fn subtract(&mut self) -> bool {
        let sides = &self.sides;
        self.next.clear();
        let mut met = false;
        for piece in &self.seen {
            let apart = |half: &HalfPlane| piece.vertices().iter().all(|&v| half.value(v) <= 0.0);
            if sides.iter().any(apart) {
                self.next.push(*piece);
                continue;
            }
            met = true;
            let mut left = *piece;
            for half in sides {
                let (inside, outside) = left.divided(half);
                if !outside.is_empty() {
                    self.next.push(outside);
                }
                left = inside;
                if left.is_empty() {
                    break;
                }
            }
        }
        std::mem::swap(&mut self.seen, &mut self.next);
        met
    }
}
