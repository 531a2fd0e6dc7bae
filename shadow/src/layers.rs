//! The paper's rule (§4.2.5): in each light cell, opacity adds up from the light outward.

use crate::light::Query;
use crate::scratch::{Nearby, Work};
use glam::{DVec2, IVec2};
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, HalfPlane, convex, cut};
use pointillist_micropoint::Face;

/// What a caster does to one light cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cast {
    nearness: (f64, f64),
    opacity: f64,
}

/// Depth ranges closer than this, relative to their nearness, touch.
const TOUCH: f64 = 1e-7;

/// Shadow micropoints per receiver beyond which the cells are made larger: a fixed grid may be finer
/// than any receiver, and the cost would be without bound.
const MOST_CELLS: f64 = 256.0;

/// Cells from the middle of the light grid to the farthest receiver.
const MOST_DISTANCE: f64 = (1 << 29) as f64;

/// The cells of a light grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LightCells {
    /// Fixed, or for each target the smallest power of two that is no smaller than it.
    pub(crate) size: Option<f64>,
}

impl LightCells {
    /// Size of the cells for a target with these bounds.
    fn size(&self, (low, high): (DVec2, DVec2)) -> f64 {
        let extent = (high - low).max_element();
        // Receivers far smaller than their distance from the middle: cells must be numbered in 32 bits.
        let least = low.abs().max(high.abs()).max_element() / MOST_DISTANCE;
        match self.size {
            Some(size) => size.max(extent / MOST_CELLS.sqrt()).max(least),
            None => extent.max(least).max(f64::MIN_POSITIVE).log2().ceil().exp2(),
        }
    }

    /// The cells that a target touches: whatever is in them may darken it.
    pub(crate) fn around(&self, bounds: (DVec2, DVec2)) -> (DVec2, DVec2) {
        let size = self.size(bounds);
        ((bounds.0 / size).floor() * size, (bounds.1 / size).ceil() * size)
    }
}

/// The lit fraction of a target: cut by the light grid into shadow micropoints, each of which gets
/// what the layers nearer to the light let through in its cell.
pub(crate) fn lit_fraction(
    query: &Query<'_>,
    outline: &[DVec2],
    face: &Face,
    nearby: &[Nearby],
    cells: LightCells,
    work: &mut Work,
) -> f64 {
    let size = cells.size(convex::bounds(outline));
    work.partial += 1;
    let mut pieces = Vec::new();
    cut_by_cells(outline, size, |cell, piece| pieces.push((cell, *piece)));
    let (mut lit, mut total) = (0.0, 0.0);
    for (cell, piece) in &pieces {
        let area = piece.area();
        total += area;
        lit += area * transmittance(query, face, piece, *cell, size, nearby, work);
    }
    if total > 0.0 { (lit / total).min(1.0) } else { 1.0 }
}

/// Cuts a polygon of the light grid by cells of the given size; pieces come back in grid units.
fn cut_by_cells(polygon: &[DVec2], size: f64, mut visit: impl FnMut(IVec2, &ConvexPolygon)) {
    let scaled: Vec<DVec2> = polygon.iter().map(|&v| v / size).collect();
    let window = CellWindow { x0: -(1 << 30), y0: -(1 << 30), x1: 1 << 30, y1: 1 << 30 };
    let limit = pointillist_dice::MAX_CUT_VERTICES;
    cut(&scaled[..scaled.len().min(limit)], window, |part| match part {
        Cut::Span { row, first, end } => {
            for column in first..end {
                let cell = IVec2::new(column, row);
                let low = cell.as_dvec2() * size;
                visit(cell, &ConvexPolygon::rectangle(low, low + size));
            }
        }
        Cut::Piece { cell, polygon } => {
            let mut piece = ConvexPolygon::EMPTY;
            polygon.vertices().iter().for_each(|&v| piece.push(v * size));
            visit(cell, &piece);
        }
    });
}

/// What reaches a shadow micropoint through the layers before it in its cell.
fn transmittance(
    query: &Query<'_>,
    face: &Face,
    piece: &ConvexPolygon,
    cell: IVec2,
    size: f64,
    nearby: &[Nearby],
    work: &mut Work,
) -> f64 {
    let low = cell.as_dvec2() * size;
    let square = ConvexPolygon::rectangle(low, low + size);
    work.layers.clear();
    for near in nearby {
        let overlaps = near.bounds.0.cmplt(low + size).all() && near.bounds.1.cmpgt(low).all();
        if !overlaps || near.id == face.id {
            continue;
        }
        let caster = &query.casters[near.index as usize];
        let inside = clipped_to(&caster.polygon, &square);
        let area = inside.area();
        if inside.is_empty() || area <= 0.0 {
            continue;
        }
        let nearness = range(&caster.face, &inside);
        let opacity = area / (size * size) * query.opacity(caster, inside.vertices());
        work.layers.push(Cast { nearness, opacity });
    }
    let key = |c: &Cast| (-c.nearness.1, -c.nearness.0, c.opacity);
    work.layers.sort_unstable_by(|a, b| {
        let (ka, kb) = (key(a), key(b));
        ka.0.total_cmp(&kb.0).then(ka.1.total_cmp(&kb.1)).then(ka.2.total_cmp(&kb.2))
    });
    let receiver = range(face, piece);
    let mut passed = 1.0;
    let mut i = 0;
    while i < work.layers.len() {
        let (mut bottom, mut opacity) = (work.layers[i].nearness.0, work.layers[i].opacity);
        i += 1;
        while i < work.layers.len() && work.layers[i].nearness.1 >= bottom - TOUCH * bottom.abs() {
            bottom = bottom.min(work.layers[i].nearness.0);
            opacity += work.layers[i].opacity;
            i += 1;
        }
        // The receiver's own layer, and all that lie behind, do not shade it.
        if bottom <= receiver.1 + TOUCH * receiver.1.abs() {
            break;
        }
        passed *= 1.0 - opacity.min(1.0);
    }
    passed
}

fn clipped_to(polygon: &ConvexPolygon, square: &ConvexPolygon) -> ConvexPolygon {
    let corners = square.vertices();
    let mut inside = *polygon;
    for i in 0..corners.len() {
        inside = inside.clipped(&HalfPlane::left_of(corners[i], corners[(i + 1) % corners.len()]));
    }
    inside
}

fn range(face: &Face, polygon: &ConvexPolygon) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    polygon.vertices().iter().map(|&v| face.nearness_at(v)).fold(start, |(l, h), q| (l.min(q), h.max(q)))
}
