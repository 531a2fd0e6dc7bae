//! The walk from cell to cell towards a position.

use crate::locator::Locator;
use crate::simplex::{HULL, Simplex};
use glam::DVec3;

/// A barycentric coordinate this far below 0 is rounding: the position counts as inside.
const ROUNDING: f64 = 1e-12;

/// The same, where all cells were looked at and none has the position inside by more than that.
const NEAR: f64 = 1e-9;

/// Flat cells that are passed at once.
const MOST_FLAT: usize = 64;

/// How a walk ended.
pub(crate) enum End {
    Inside { cell: u32, coordinates: [f64; 4] },
    Outside { cell: u32, facet: u32 },
}

/// Where a flat cell leads to.
enum Beyond {
    /// On from this cell.
    Cell(u32),
    End(End),
}

impl Locator {
    /// Walks from cell to cell through the side that `p` is farthest beyond.
    ///
    /// Among Delaunay cells such a walk never visits a cell twice. If rounding makes it do so for as many steps as there are cells, all are
    /// looked at.
    #[inline]
    pub(crate) fn walk(&self, p: DVec3, start: u32) -> End {
        let mut cell = if (start as usize) < self.cells.len() { start } else { 0 };
        let mut before = cell;
        for _ in 0..=self.cells.len() {
            let simplex = &self.cells[cell as usize];
            let coordinates = simplex.coordinates(p);
            let (side, least) = least(coordinates);
            if least >= -ROUNDING {
                return End::Inside { cell, coordinates };
            }
            let next = if least.is_nan() {
                match self.past_flat_cells(p, cell) {
                    Beyond::Cell(next) => next,
                    Beyond::End(end) => return end,
                }
            } else {
                simplex.neighbours[side]
            };
            if next & HULL != 0 {
                return End::Outside { cell, facet: next & !HULL };
            }
            // Two cells that both find `p` farthest beyond the side between them: it lies in that side, up to rounding.
            if next == before && next != cell {
                return End::Inside { cell, coordinates };
            }
            (before, cell) = (cell, next);
        }
        self.search(p)
    }

    /// From a cell that is flat up to rounding, and through all such cells beside it, to a cell from which the way leads elsewhere.
    #[cold]
    fn past_flat_cells(&self, p: DVec3, from: u32) -> Beyond {
        let (mut flat, mut facets, mut beside) = (vec![from], vec![], vec![]);
        let mut i = 0;
        while i < flat.len() && flat.len() <= MOST_FLAT {
            for next in self.cells[flat[i] as usize].beyond() {
                if next & HULL != 0 {
                    facets.push(next & !HULL);
                    continue;
                }
                if flat.contains(&next) {
                    continue;
                }
                let simplex = &self.cells[next as usize];
                let coordinates = simplex.coordinates(p);
                let (side, least) = least(coordinates);
                if least.is_nan() {
                    flat.push(next);
                } else if least >= -ROUNDING {
                    return Beyond::End(End::Inside { cell: next, coordinates });
                } else {
                    beside.push((least, next, simplex.neighbours[side]));
                }
            }
            i += 1;
        }
        let leads_on = |&&(_, _, towards): &&(f64, u32, u32)| !flat.contains(&towards);
        match beside.iter().filter(leads_on).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) {
            Some(&(_, next, _)) => Beyond::Cell(next),
            None if flat.len() > MOST_FLAT => Beyond::End(self.search(p)),
            // From all around, `p` lies beyond these cells: it is before the hull that they are part of.
            None => match self.hull.nearest_of(&self.vertices, facets, p) {
                Some(facet) => Beyond::End(End::Outside { cell: from, facet }),
                None => Beyond::End(self.search(p)),
            },
        }
    }

    /// The cell that holds `p`, or the facet of the hull that is nearest, found by looking at all.
    #[cold]
    fn search(&self, p: DVec3) -> End {
        let of = |(cell, simplex): (usize, &Simplex)| {
            let coordinates = simplex.coordinates(p);
            (least(coordinates).1, cell as u32, coordinates)
        };
        let sound = self.cells.iter().enumerate().filter(|(_, simplex)| !simplex.is_flat());
        match sound.map(of).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) {
            Some((least, cell, coordinates)) if least >= -NEAR => End::Inside { cell, coordinates },
            best => {
                let facets = 0..self.hull.facet_count();
                let facet = self.hull.nearest_of(&self.vertices, facets, p).unwrap_or(0);
                End::Outside { cell: best.map_or(0, |best| best.1), facet }
            }
        }
    }
}

/// The smallest of four numbers and where it is; the first and NaN, if that is NaN.
#[inline]
fn least(c: [f64; 4]) -> (usize, f64) {
    let (i, a) = if c[1] < c[0] { (1, c[1]) } else { (0, c[0]) };
    let (j, b) = if c[3] < c[2] { (3, c[3]) } else { (2, c[2]) };
    if b < a { (j, b) } else { (i, a) }
}
