//! Form factors of a point by hemicube: five faces of cells, each of which takes a known share of the hemisphere \[2\].
//!
//! Two kinds. The *classic* one samples the middle of each cell and assigns the cell to the nearest polygon there. The *exact* one cuts the
//! visible part of each polygon by the cells and assigns it the covered share of each. That has no aliasing; the remaining error is that the
//! form factor of a cell is taken as uniform over the cell.

use glam::{DVec2, DVec3};
use pointillist_dice::{Accumulator, Grid, accumulate, lambert};

use crate::polygon::{Polygon, clipped};
use crate::visible::parts::{Eye, Pieces, Source};

/// How cells are assigned to polygons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HemicubeKind {
    /// By the share of the cell that each polygon covers.
    Exact,
    /// To the polygon that is visible in its middle.
    Classic,
}

/// A hemicube of a fixed resolution, with its form factors of cells and its memory, for any number of points.
#[derive(Clone, Debug)]
pub struct Hemicube {
    kind: HemicubeKind,
    size: usize,
    /// Form factors of the cells of the top, and of the cells of a side, row by row from below.
    top: Vec<f64>,
    side: Vec<f64>,
    faces: Vec<Buffer>,
    accumulator: Accumulator,
    pieces: Pieces,
}

/// Nearest polygon of each cell.
#[derive(Clone, Debug, Default)]
struct Buffer {
    depth: Vec<f64>,
    nearest: Vec<u32>,
}

/// Directions of a face: outwards, along rows, along columns; columns of sides start at the horizon.
#[derive(Clone, Copy)]
struct Face {
    out: DVec3,
    along: DVec3,
    up: DVec3,
    is_top: bool,
}

/// No polygon.
const NOBODY: u32 = u32::MAX;

impl Hemicube {
    /// A hemicube of `resolution` cells along the edges of its top, made even; sides have half as many rows.
    ///
    /// # Panics
    /// If `resolution` is 0 or above 4096.
    #[must_use]
    pub fn new(kind: HemicubeKind, resolution: usize) -> Self {
        assert!((1..=4096).contains(&resolution), "a hemicube has 1 to 4096 cells along an edge");
        let size = resolution.next_multiple_of(2);
        let cell = 2.0 / size as f64;
        let share = |corner: DVec3, u: DVec3, v: DVec3| {
            let ring = [corner, corner + v, corner + u + v, corner + u];
            lambert::share(DVec3::ZERO, DVec3::Z, &ring).abs()
        };
        let at = |i: usize| -1.0 + cell * i as f64;
        let mut top = vec![];
        let mut side = vec![];
        for row in 0..size {
            for column in 0..size {
                let corner = DVec3::new(at(column), at(row), 1.0);
                top.push(share(corner, DVec3::X * cell, DVec3::Y * cell));
                if row < size / 2 {
                    let corner = DVec3::new(1.0, at(column), cell * row as f64);
                    side.push(share(corner, DVec3::Y * cell, DVec3::Z * cell));
                }
            }
        }
        let faces = vec![Buffer::default(); 5];
        Self { kind, size, top, side, faces, accumulator: Accumulator::new(), pieces: Pieces::default() }
    }

    /// Form factors from a surface element at `point` to the fronts of all `polygons`, which hide one another from both sides.
    /// Polygons in the element's plane or behind it get 0.
    pub fn factors(&mut self, point: DVec3, normal: DVec3, polygons: &[Polygon]) -> Vec<f64> {
        let refs: Vec<&Polygon> = polygons.iter().collect();
        self.factors_of(point, normal, &refs, &refs)
    }

    /// As [`Hemicube::factors`], of `receivers` behind `occluders`.
    pub(crate) fn factors_of(
        &mut self,
        point: DVec3,
        normal: DVec3,
        receivers: &[&Polygon],
        occluders: &[&Polygon],
    ) -> Vec<f64> {
        let faces = faces(normal);
        match self.kind {
            HemicubeKind::Exact => {
                receivers.iter().map(|p| self.covered(point, normal, p, occluders, &faces)).collect()
            }
            HemicubeKind::Classic => self.sampled(point, receivers, occluders, &faces),
        }
    }

    fn covered(
        &mut self,
        point: DVec3,
        normal: DVec3,
        polygon: &Polygon,
        occluders: &[&Polygon],
        faces: &[Face; 5],
    ) -> f64 {
        if polygon.height(point) <= 0.0 || polygon.vertices().iter().all(|&v| normal.dot(v - point) <= 0.0) {
            return 0.0;
        }
        let source = Source::new(polygon);
        let others = occluders.iter().copied().filter(|o| !std::ptr::eq(*o, polygon));
        let seen = source.see(Eye::Point(point), others, &mut self.pieces).0.to_vec();
        let mut sum = 0.0;
        for piece in &seen {
            let ring: Vec<DVec3> = piece.vertices().iter().map(|&v| source.in_space(v) - point).collect();
            for face in faces {
                sum += self.on_face(&ring, *face);
            }
        }
        sum
    }

    /// Σ covered share of a cell · its share of the hemisphere.
    fn on_face(&mut self, ring: &[DVec3], face: Face) -> f64 {
        let Some(flat) = projected(ring, face, self.size) else { return 0.0 };
        let (size, shares) = (self.size, if face.is_top { &self.top } else { &self.side });
        let mut sum = 0.0;
        let result = accumulate(&flat, &Grid::UNIT, &mut self.accumulator, |run| {
            // Rounding may put a corner of the ring outside of the face by an ulp.
            if run.row < 0 {
                return;
            }
            for column in run.columns.clone() {
                if (0..size as i32).contains(&column) {
                    let cell = run.row as usize * size + column as usize;
                    sum += run.area * shares.get(cell).copied().unwrap_or_default();
                }
            }
        });
        // The ring is finite and within the face.
        debug_assert!(result.is_ok(), "{result:?}");
        sum
    }

    fn sampled(
        &mut self,
        point: DVec3,
        receivers: &[&Polygon],
        occluders: &[&Polygon],
        faces: &[Face; 5],
    ) -> Vec<f64> {
        let cells = self.size * self.size;
        for buffer in &mut self.faces {
            buffer.depth.clear();
            buffer.depth.resize(cells, f64::INFINITY);
            buffer.nearest.clear();
            buffer.nearest.resize(cells, NOBODY);
        }
        // What is seen from its front is a receiver; the backs of occluders only hide.
        let fronts = receivers.iter().enumerate().filter(|(_, p)| p.height(point) > 0.0);
        let backs = occluders.iter().filter(|p| p.height(point) < 0.0);
        let all = fronts.map(|(i, p)| (i as u32, *p)).chain(backs.map(|p| (NOBODY, *p)));
        for (id, polygon) in all {
            let ring: Vec<DVec3> = polygon.vertices().iter().map(|&v| v - point).collect();
            for (number, face) in faces.iter().enumerate() {
                self.rasterise(number, *face, &ring, polygon, point, id);
            }
        }
        let mut factors = vec![0.0; receivers.len()];
        for (buffer, face) in self.faces.iter().zip(faces) {
            let shares = if face.is_top { &self.top } else { &self.side };
            for (nearest, share) in buffer.nearest.iter().zip(shares) {
                if let Some(factor) = factors.get_mut(*nearest as usize) {
                    *factor += share;
                }
            }
        }
        factors
    }

    fn rasterise(
        &mut self,
        number: usize,
        face: Face,
        ring: &[DVec3],
        polygon: &Polygon,
        point: DVec3,
        id: u32,
    ) {
        let Some(flat) = projected(ring, face, self.size) else { return };
        let (low, high) = pointillist_dice::convex::bounds(&flat);
        let rows = if face.is_top { self.size } else { self.size / 2 };
        let range = |low: f64, high: f64, end: usize| {
            (low - 0.5).ceil().max(0.0) as usize..((high + 0.5).floor().max(0.0) as usize).min(end)
        };
        let height = -polygon.height(point);
        for row in range(low.y, high.y, rows) {
            for column in range(low.x, high.x, self.size) {
                let middle = DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
                let mut before = flat[flat.len() - 1];
                let inside = flat.iter().all(|&v| {
                    let side = (v - before).perp_dot(middle - before);
                    before = v;
                    side >= 0.0
                });
                if !inside {
                    continue;
                }
                let scaled = middle * (2.0 / self.size as f64);
                let low = if face.is_top { -1.0 } else { 0.0 };
                let direction = face.out + face.along * (scaled.x - 1.0) + face.up * (scaled.y + low);
                let depth = height / polygon.normal().dot(direction);
                let cell = row * self.size + column;
                let buffer = &mut self.faces[number];
                if depth < buffer.depth[cell] {
                    buffer.depth[cell] = depth;
                    buffer.nearest[cell] = id;
                }
            }
        }
    }
}

fn faces(normal: DVec3) -> [Face; 5] {
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let side = |out: DVec3| Face { out, along: normal.cross(out), up: normal, is_top: false };
    [Face { out: normal, along: u, up: v, is_top: true }, side(u), side(v), side(-u), side(-v)]
}

/// The part of a ring (relative to the point) on a face, in cells; positively oriented.
fn projected(ring: &[DVec3], face: Face, size: usize) -> Option<Vec<DVec2>> {
    let Face { out, along, up, is_top } = face;
    let mut part = clipped(ring, |p| p.dot(out));
    part = clipped(&part, |p| p.dot(out - along));
    part = clipped(&part, |p| p.dot(out + along));
    part = clipped(&part, |p| p.dot(out - up));
    part = clipped(&part, |p| if is_top { p.dot(out + up) } else { p.dot(up) });
    if part.len() < 3 {
        return None;
    }
    let half = 0.5 * size as f64;
    let low = if is_top { 1.0 } else { 0.0 };
    let mut flat = Vec::with_capacity(part.len());
    for p in &part {
        let depth = p.dot(out);
        if depth <= 0.0 {
            return None;
        }
        flat.push(DVec2::new((p.dot(along) / depth + 1.0) * half, (p.dot(up) / depth + low) * half));
    }
    if pointillist_dice::convex::area(&flat) < 0.0 {
        flat.reverse();
    }
    Some(flat)
}
