//! Cells in which masks are neither open nor closed, divided into squares.
//!
//! What is seen through a mask, how it is lit and what it hides all vary over a cell with its holes, and a product of means is not the mean of
//! the product. In a square of a quarter of the area they vary less, and many masks are open or closed throughout.

use crate::dicer::{DiceJob, Dicer, mean_opacity};
use crate::interval::Interval;
use crate::resolve::NEGLIGIBLE_AREA;
use glam::DVec2;
use pointillist_dice::{ConvexPolygon, convex};

/// A square of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    low: DVec2,
    side: f64,
}

impl Square {
    pub(crate) const CELL: Self = Self { low: DVec2::ZERO, side: 1.0 };

    /// Its share of the cell.
    pub(crate) fn area(&self) -> f64 {
        self.side * self.side
    }

    pub(crate) fn side(&self) -> f64 {
        self.side
    }

    pub(crate) fn quarters(&self) -> [Self; 4] {
        let side = 0.5 * self.side;
        [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|at| Self { low: self.low + at * side, side })
    }

    /// What of the parts `from` is in the square, sorted, in `to`.
    pub(crate) fn parts_within(
        &self,
        dicer: &mut Dicer,
        job: &DiceJob<'_>,
        corner: DVec2,
        from: &[u32],
        to: &mut Vec<u32>,
    ) {
        to.clear();
        for &p in from {
            to.extend(self.part_within(dicer, job, corner, p));
        }
        to.sort_unstable_by(|&a, &b| dicer.compare(a, b));
    }

    fn part_within(&self, dicer: &mut Dicer, job: &DiceJob<'_>, corner: DVec2, number: u32) -> Option<u32> {
        let square = ConvexPolygon::rectangle(self.low, self.low + self.side);
        let part = *dicer.part(number);
        let outline = dicer.outline(&part);
        let clipped = match part.fills_cell() {
            true => square,
            false => convex::half_planes(square.vertices())
                .fold(ConvexPolygon::from_vertices(outline), |rest, half| rest.clipped(&half)),
        };
        let (area, centroid) = clipped.area_and_centroid();
        if area <= NEGLIGIBLE_AREA {
            return None;
        }
        let face = &dicer.faces[part.face as usize];
        let opacity =
            match job.geometry.surfaces()[face.surface as usize].textured_opacity && part.opacity < 1.0 {
                true => mean_opacity(job, face, corner, clipped.vertices()),
                false => part.opacity,
            };
        if opacity <= 0.0 {
            return None;
        }
        let mut nearness = Interval::EMPTY;
        clipped.vertices().iter().for_each(|&v| nearness.include(face.nearness_at(v + corner)));
        let nearness =
            Interval { least: part.nearness.clamp(nearness.least), most: part.nearness.clamp(nearness.most) };
        Some(dicer.add_piece_of(part, clipped.vertices(), (area, centroid), nearness, opacity))
    }
}
