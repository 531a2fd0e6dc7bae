//! The paper's rule (§4.2.5): in each light cell, opacity adds up from the light outward.

use crate::cells::LightCells;
use crate::query::Query;
use glam::{DVec2, IVec2};
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, HalfPlane, convex, cut};
use pointillist_micropoint::{Face, Interval};

/// What a caster does to one light cell.
#[derive(Clone, Copy, Debug)]
struct Cast {
    nearness: Interval,
    opacity: f64,
}

/// Depth ranges whose gap is at most this, times their nearness, touch and belong to one layer.
const TOUCH: f64 = 1e-7;

/// Reusable memory of the paper's rule.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    casts: Vec<Cast>,
    /// Targets that were cut.
    pub(crate) partial: u64,
}

/// The lit fraction of a target: cut by the light grid into shadow micropoints, each of which gets
/// what the layers nearer to the light let through in its cell.
pub(crate) fn lit_fraction(
    query: &Query<'_>,
    outline: &[DVec2],
    face: &Face,
    cells: LightCells,
    work: &mut Memory,
) -> f64 {
    let size = cells.size(convex::bounds(outline));
    work.partial += 1;
    let mut pieces = Vec::new();
    cut_by_cells(outline, size, |cell, piece| pieces.push((cell, *piece)));
    let (mut lit, mut total) = (0.0, 0.0);
    for (cell, piece) in &pieces {
        let area = piece.area();
        total += area;
        lit += area * transmittance(query, face, piece, *cell, size, work);
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

/// Transmittance of the layers between the light and a shadow micropoint, in its cell.
fn transmittance(
    query: &Query<'_>,
    face: &Face,
    piece: &ConvexPolygon,
    cell: IVec2,
    size: f64,
    work: &mut Memory,
) -> f64 {
    let low = cell.as_dvec2() * size;
    let square = ConvexPolygon::rectangle(low, low + size);
    work.casts.clear();
    for near in query.nearby {
        let overlaps = near.bounds.0.cmplt(low + size).all() && near.bounds.1.cmpgt(low).all();
        if !overlaps || near.id == face.id {
            continue;
        }
        let caster = &query.casters[near.index as usize];
        let inside = clipped_to(&ConvexPolygon::from_vertices(query.shape(near.index).0), &square);
        let area = inside.area();
        if inside.is_empty() || area <= 0.0 {
            continue;
        }
        let nearness = range(&caster.face, &inside);
        let opacity = area / (size * size) * query.opacity(caster, inside.vertices());
        work.casts.push(Cast { nearness, opacity });
    }
    let key = |c: &Cast| (-c.nearness.most, -c.nearness.least, c.opacity);
    work.casts.sort_unstable_by(|a, b| {
        let (ka, kb) = (key(a), key(b));
        ka.0.total_cmp(&kb.0).then(ka.1.total_cmp(&kb.1)).then(ka.2.total_cmp(&kb.2))
    });
    let receiver = range(face, piece);
    let mut passed = 1.0;
    let mut i = 0;
    while i < work.casts.len() {
        let (mut bottom, mut opacity) = (work.casts[i].nearness.least, work.casts[i].opacity);
        i += 1;
        while i < work.casts.len() && work.casts[i].nearness.most >= bottom - TOUCH * bottom.abs() {
            bottom = bottom.min(work.casts[i].nearness.least);
            opacity += work.casts[i].opacity;
            i += 1;
        }
        // The receiver's own layer, and all that lie behind, do not shade it.
        if bottom <= receiver.most + TOUCH * receiver.most.abs() {
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

fn range(face: &Face, polygon: &ConvexPolygon) -> Interval {
    let mut range = Interval::EMPTY;
    polygon.vertices().iter().for_each(|&v| range.include(face.nearness_at(v)));
    range
}
