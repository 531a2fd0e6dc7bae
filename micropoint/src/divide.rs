//! Cells in which masks are neither open nor closed, divided into squares.
//!
//! What is seen through a mask, how it is lit and what it hides all vary over a cell with its holes, and a product of means is not the mean of
//! the product. In a small square they vary less, and many masks are open or closed throughout.

use crate::dicer::{DiceJob, Dicer, mean_opacity};
use crate::interval::Interval;
use crate::resolve::NEGLIGIBLE_AREA;
use glam::{DVec2, IVec2};
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, cut};

/// The parts in each square of a cell, row by row.
#[derive(Debug, Default)]
pub(crate) struct Squares {
    lists: Vec<Vec<u32>>,
}

impl Squares {
    /// Divides the parts `from` of a cell. The numbers that [`Squares::iter`] gives are valid until the dicer forgets them.
    pub(crate) fn divide(&mut self, dicer: &mut Dicer, job: &DiceJob<'_>, corner: DVec2, from: &[u32]) {
        let side = job.squares_per_side;
        self.lists.iter_mut().for_each(Vec::clear);
        self.lists.resize_with((side * side) as usize, Vec::new);
        for &number in from {
            self.divide_part(dicer, job, corner, number);
        }
        for list in &mut self.lists {
            list.sort_unstable_by(|&a, &b| dicer.compare(a, b));
        }
    }

    /// The parts in each square, nearest first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.lists.iter().map(Vec::as_slice)
    }

    fn divide_part(&mut self, dicer: &mut Dicer, job: &DiceJob<'_>, corner: DVec2, number: u32) {
        let side = job.squares_per_side;
        let (size, part) = (f64::from(side), *dicer.part(number));
        let mut outline = ConvexPolygon::EMPTY;
        dicer.outline(&part).iter().for_each(|&v| outline.push(v * size));
        let window = CellWindow { x0: 0, y0: 0, x1: side, y1: side };
        let mut add = |square: IVec2, polygon: &ConvexPolygon| {
            if let Some(piece) = add_piece(dicer, job, (corner, number), polygon) {
                self.lists[(square.y * side + square.x) as usize].push(piece);
            }
        };
        cut(outline.vertices(), window, |piece| match piece {
            Cut::Span { row, first, end } => {
                for column in first..end {
                    let low = DVec2::new(column.into(), row.into());
                    let high = low + 1.0;
                    add(IVec2::new(column, row), &ConvexPolygon::rectangle(low / size, high / size));
                }
            }
            Cut::Piece { cell, polygon } => {
                let mut scaled = ConvexPolygon::EMPTY;
                polygon.vertices().iter().for_each(|&v| scaled.push(v / size));
                add(cell, &scaled);
            }
        });
    }
}

/// Adds what of a part is in a square; `None` if that is nothing.
fn add_piece(
    dicer: &mut Dicer,
    job: &DiceJob<'_>,
    (corner, number): (DVec2, u32),
    polygon: &ConvexPolygon,
) -> Option<u32> {
    let (area, centroid) = polygon.area_and_centroid();
    if area <= NEGLIGIBLE_AREA {
        return None;
    }
    let part = *dicer.part(number);
    let face = &dicer.faces[part.face as usize];
    let textured = job.geometry.surfaces()[face.surface as usize].textured_opacity;
    let opacity = match textured && part.opacity < 1.0 {
        true => mean_opacity(job, face, corner, polygon.vertices()),
        false => part.opacity,
    };
    if opacity <= 0.0 {
        return None;
    }
    let mut nearness = Interval::EMPTY;
    polygon.vertices().iter().for_each(|&v| nearness.include(face.nearness_at(v + corner)));
    let nearness =
        Interval { least: part.nearness.clamp(nearness.least), most: part.nearness.clamp(nearness.most) };
    Some(dicer.add_piece_of(part, polygon.vertices(), (area, centroid), nearness, opacity))
}
