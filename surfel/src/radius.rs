//! How large a disc must be so that no gap stays between it and its neighbours' discs.
//!
//! On a plane, discs leave no gap exactly if each reaches to the farthest corner of its point's Voronoi cell: the place
//! that is as near to two neighbours, the farthest that are needed. The cell is cut out of the tangent plane, neighbour by
//! neighbour, up to the distance at which none can cut any more.

use crate::eliminate::OTHER_SIDE;
use crate::rows::Rows;
use crate::{SurfacePoint, parallel};
use glam::{DVec2, DVec3};

/// Corners of the square that a cell begins as, and of what the cell is cut to where it has no neighbours.
const SQUARE: [DVec2; 4] =
    [DVec2::new(1.0, 1.0), DVec2::new(-1.0, 1.0), DVec2::new(-1.0, -1.0), DVec2::new(1.0, -1.0)];

/// Cosine of the angle between the normals of neighbours above which their discs cover for each other: 60°. Beyond it the
/// surface has a crease between them: each side has to be covered by its own discs, but only up to the crease.
const SAME_SURFACE: f64 = 0.5;

/// Gives every point its radius, at most `reach`: no place of the surface is farther from its nearest point. Points on a
/// border get radii up to that.
pub(crate) fn assign(points: &mut [SurfacePoint], reach: f64) {
    let rows = Rows::new(points.len(), reach, |i| points[i].position);
    let normals: Vec<DVec3> = rows.order().iter().map(|&i| rows.turned(points[i as usize].normal)).collect();
    let radii = parallel::map(points.len(), |place| {
        // Most cells are small: half the reach finds all that cuts them, at a quarter of the time.
        let near = Cell::of(&rows, &normals, place, 0.5 * reach);
        let cell = if near.is_closed { near } else { Cell::of(&rows, &normals, place, reach) };
        cell.farthest2().sqrt().min(reach)
    });
    for (place, radius) in radii.into_iter().enumerate() {
        points[rows.order()[place] as usize].radius = rounded_up(radius);
    }
}

fn rounded_up(radius: f64) -> f32 {
    let near = radius as f32;
    if f64::from(near) < radius { near.next_up() } else { near }
}

/// A neighbour as its point sees it.
struct Neighbour {
    distance2: f64,
    place: usize,
}

/// A Voronoi cell in a tangent plane, about its point.
#[derive(Default)]
struct Cell {
    corners: Vec<DVec2>,
    scratch: Vec<DVec2>,
    /// Whether nothing farther away can cut any more of it.
    is_closed: bool,
}

impl Cell {
    fn of(rows: &Rows, normals: &[DVec3], place: usize, reach: f64) -> Self {
        let (p, normal) = (rows.at(place), normals[place]);
        let mut neighbours = Vec::with_capacity(32);
        // A neighbour at twice the distance of a corner cannot cut it off.
        rows.near(p, 2.0 * reach, |other, distance2| {
            if other != place && normal.dot(normals[other]) > OTHER_SIDE {
                neighbours.push(Neighbour { distance2, place: other });
            }
        });
        neighbours.sort_unstable_by(|a, b| a.distance2.total_cmp(&b.distance2).then(a.place.cmp(&b.place)));
        let (right, up) = normal.any_orthonormal_pair();
        let mut cell = Self { corners: SQUARE.map(|c| c * reach).to_vec(), ..Self::default() };
        for n in &neighbours {
            if n.distance2 > 4.0 * cell.farthest2() {
                break;
            }
            let offset = rows.at(n.place) - p;
            let flat = |v: DVec3| DVec2::new(right.dot(v), up.dot(v));
            let other = normals[n.place];
            if normal.dot(other) > SAME_SURFACE {
                cell.cut(flat(offset), 0.5 * n.distance2);
            } else {
                cell.cut_at_crease(flat(offset), flat(other), offset.dot(other));
            }
        }
        cell.is_closed = cell.farthest2() <= reach * reach;
        cell
    }

    /// Keeps what has `x · direction ≤ limit`.
    fn cut(&mut self, direction: DVec2, limit: f64) {
        let beyond = |p: DVec2| p.dot(direction) - limit;
        if self.corners.iter().all(|&p| beyond(p) <= 0.0) {
            return;
        }
        self.scratch.clear();
        for (i, &p) in self.corners.iter().enumerate() {
            let q = self.corners[(i + 1) % self.corners.len()];
            let (bp, bq) = (beyond(p), beyond(q));
            if bp <= 0.0 {
                self.scratch.push(p);
            }
            if (bp <= 0.0) != (bq <= 0.0) {
                self.scratch.push(p + (q - p) * (bp / (bp - bq)));
            }
        }
        std::mem::swap(&mut self.corners, &mut self.scratch);
    }

    /// Keeps what lies before the line in which a neighbour's plane, with this normal and height above the point, meets
    /// this one, and never less than half the way to the neighbour.
    fn cut_at_crease(&mut self, offset: DVec2, normal: DVec2, height: f64) {
        // Zero for parallel planes, whose line is infinitely far.
        let Some(across) = normal.try_normalize() else { return };
        let line = height / normal.length();
        let (across, line) = if line < 0.0 { (-across, -line) } else { (across, line) };
        self.cut(across, line.max(0.5 * offset.length()));
    }

    fn farthest2(&self) -> f64 {
        self.corners.iter().map(|p| p.length_squared()).fold(0.0, f64::max)
    }
}
