//! A fine grid over a cell of many small parts: which parts may meet, and where nothing more can be seen.
//!
//! A mesh whose triangles are far smaller than a cell tiles parts of it with hundreds of parts, and as many lie behind. Parts can only meet
//! where they share a square of the grid. The visible areas of opaque parts are disjoint, so a square is full once they add up to its own area,
//! and what lies behind a full square is hidden: it need not be compared with what hides it.

use glam::DVec2;
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, MAX_CUT_VERTICES, cut};

/// Fewest and most squares on a side.
const SIDES: [usize; 2] = [4, 64];

/// A square is full if no more than this is open, in squares: of the whole cell, as little.
const OPEN: f64 = 1e-11;

/// The squares that a part touches: columns and rows, the last included.
#[derive(Clone, Copy, Debug)]
struct Span {
    low: [u16; 2],
    high: [u16; 2],
}

impl Span {
    fn count(self) -> usize {
        let [columns, rows] = [0, 1].map(|axis| usize::from(self.high[axis] - self.low[axis]) + 1);
        columns * rows
    }

    fn squares(self, side: usize) -> impl Iterator<Item = usize> {
        let columns = usize::from(self.low[0])..=usize::from(self.high[0]);
        (self.low[1]..=self.high[1])
            .flat_map(move |row| columns.clone().map(move |x| usize::from(row) * side + x))
    }

    fn window(self) -> CellWindow {
        let [x0, y0] = self.low.map(i32::from);
        let [x1, y1] = self.high.map(|last| i32::from(last) + 1);
        CellWindow { x0, y0, x1, y1 }
    }
}

/// What of a square is filled by what is seen.
#[derive(Clone, Copy, Debug)]
struct Square {
    /// The latest part in it that is seen: an index into [`FineGrid::seen`], or [`NONE`].
    seen: u32,
    /// The area that is still open, in squares.
    open: f64,
    /// The least nearness of the parts that fill it.
    nearness: f64,
}

impl Square {
    const OPEN: Self = Self { seen: NONE, open: 1.0, nearness: f64::INFINITY };
}

/// End of a list of parts that are seen.
const NONE: u32 = u32::MAX;

/// A part that is seen, in the list of a square.
#[derive(Clone, Copy, Debug)]
struct Seen {
    rank: u32,
    next: u32,
}

/// Memory of the grid, reused from cell to cell.
#[derive(Debug, Default)]
pub(crate) struct FineGrid {
    side: usize,
    /// By rank.
    spans: Vec<Span>,
    squares: Vec<Square>,
    /// The ranks of the parts in square `s`: `ranks[first[s]..first[s + 1]]`, rising.
    first: Vec<u32>,
    ranks: Vec<u32>,
    seen: Vec<Seen>,
    found: Vec<u32>,
}

impl FineGrid {
    /// Takes the bounds of parts, relative to the cell; a part's rank is its place among them. Returns whether the parts are small enough for
    /// the grid to be of use; if not, it must not be asked.
    pub(crate) fn build(&mut self, bounds: impl ExactSizeIterator<Item = (DVec2, DVec2)> + Clone) -> bool {
        let longest = bounds.clone().map(|(low, high)| (high - low).max_element()).sum::<f64>();
        // Squares as large as a part is long on average. A power of two, by which outlines are scaled exactly.
        let side = bounds.len() as f64 / longest;
        if side.is_nan() || side < SIDES[0] as f64 {
            return false;
        }
        let side = 1 << (side as usize).min(SIDES[1]).ilog2();
        self.side = side;
        self.spans.clear();
        let square_of = |v: DVec2| [v.x, v.y].map(|c| ((c * side as f64) as usize).min(side - 1) as u16);
        self.spans.extend(bounds.map(|(low, high)| Span { low: square_of(low), high: square_of(high) }));
        self.squares.clear();
        self.squares.resize(side * side, Square::OPEN);
        self.seen.clear();
        self.sort_into_squares();
        true
    }

    fn sort_into_squares(&mut self) {
        let side = self.side;
        self.first.clear();
        self.first.resize(side * side + 2, 0);
        for span in &self.spans {
            span.squares(side).for_each(|s| self.first[s + 2] += 1);
        }
        for s in 2..self.first.len() {
            self.first[s] += self.first[s - 1];
        }
        self.ranks.clear();
        self.ranks.resize(self.first[self.first.len() - 1] as usize, 0);
        for (rank, span) in (0..).zip(&self.spans) {
            for s in span.squares(side) {
                let place = &mut self.first[s + 1];
                self.ranks[*place as usize] = rank;
                *place += 1;
            }
        }
        self.first.pop();
    }

    /// Of the parts that share a square with a part, those that are seen before it and those from the next one up to `end`: the ranks of which
    /// `wanted` holds, rising.
    pub(crate) fn near(&mut self, rank: u32, end: u32, wanted: impl Fn(&u32) -> bool) -> &[u32] {
        let Self { squares, seen, first, ranks, found, .. } = self;
        found.clear();
        let span = self.spans[rank as usize];
        for s in span.squares(self.side) {
            let mut next = squares[s].seen;
            while let Some(entry) = seen.get(next as usize) {
                found.extend(Some(entry.rank).filter(&wanted));
                next = entry.next;
            }
            let all = &ranks[first[s] as usize..first[s + 1] as usize];
            let later = &all[all.partition_point(|&other| other <= rank)..];
            found.extend(later.iter().copied().take_while(|&other| other < end).filter(&wanted));
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Lists a part, of higher rank than all before, as one that is seen.
    pub(crate) fn add_seen(&mut self, rank: u32) {
        for s in self.spans[rank as usize].squares(self.side) {
            let next = std::mem::replace(&mut self.squares[s].seen, self.seen.len() as u32);
            self.seen.push(Seen { rank, next });
        }
    }

    /// Whether all that a part touches is full in front of a nearness.
    pub(crate) fn hides(&self, rank: usize, nearness: f64) -> bool {
        self.spans[rank].squares(self.side).all(|s| {
            let square = &self.squares[s];
            square.open <= OPEN && nearness < square.nearness
        })
    }

    /// Fills what is seen of an opaque part: a polygon relative to the cell that is disjoint from all others that are seen.
    pub(crate) fn fill(&mut self, rank: usize, seen: &[DVec2], area: f64, nearness: f64) {
        let (span, side) = (self.spans[rank], self.side);
        let size = side as f64;
        let mut fill = |square: usize, area: f64| {
            let square = &mut self.squares[square];
            square.open -= area;
            square.nearness = square.nearness.min(nearness);
        };
        if span.count() == 1 {
            return span.squares(side).for_each(|s| fill(s, area * size * size));
        }
        let mut scaled = ConvexPolygon::EMPTY;
        seen.iter().for_each(|&v| scaled.push(v * size));
        // `cut` takes fewer vertices than a region may have: along a diagonal, the others are a polygon of their own.
        let corners = scaled.vertices();
        let (few, others) = corners.split_at(corners.len().min(MAX_CUT_VERTICES));
        let mut rest = ConvexPolygon::EMPTY;
        if !others.is_empty() {
            [few[0], few[MAX_CUT_VERTICES - 1]].iter().chain(others).for_each(|&v| rest.push(v));
        }
        for outline in [few, rest.vertices()] {
            cut(outline, span.window(), |piece| match piece {
                Cut::Span { row, first, end } => {
                    (first..end).for_each(|column| fill(row as usize * side + column as usize, 1.0));
                }
                Cut::Piece { cell, polygon } => {
                    fill(cell.y as usize * side + cell.x as usize, polygon.area());
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use pointillist_dice::convex;

    /// The two triangles of each quad of a sheet of `n` × `n` over the cell.
    fn sheet(n: u32) -> Vec<[DVec2; 3]> {
        let at = |x: u32, y: u32| dvec2(x.into(), y.into()) / f64::from(n);
        let quads = (0..n * n).map(|i| (i % n, i / n));
        quads
            .flat_map(|(x, y)| {
                let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect()
    }

    fn grid_of(parts: &[[DVec2; 3]]) -> FineGrid {
        let mut grid = FineGrid::default();
        assert!(grid.build(parts.iter().map(|part| convex::bounds(part))));
        grid
    }

    #[test]
    fn parts_that_share_a_square_are_found_once() {
        // A prime number of quads: they lie across the squares.
        let parts = sheet(13);
        let mut grid = grid_of(&parts);
        let overlap = |a: u32, b: u32| {
            let [a, b] = [a, b].map(|rank| convex::bounds(&parts[rank as usize]));
            a.0.cmplt(b.1).all() && b.0.cmplt(a.1).all()
        };
        for rank in 0..parts.len() as u32 {
            let end = (rank + 9).min(parts.len() as u32);
            let found = grid.near(rank, end, |&other| overlap(rank, other)).to_vec();
            // Every third part before this one was seen.
            let seen = (0..rank).filter(|other| other % 3 == 0);
            let expected: Vec<u32> =
                seen.chain(rank + 1..end).filter(|&other| overlap(rank, other)).collect();
            assert_eq!(found, expected, "{rank}");
            if rank % 3 == 0 {
                grid.add_seen(rank);
            }
        }
    }

    #[test]
    fn full_squares_hide_what_lies_behind_them_and_nothing_else() {
        let front = sheet(13);
        // The same again behind, and a gap in front of one quad of it.
        let gap = 2 * (6 * 13 + 6);
        let parts: Vec<_> = front.iter().chain(&front).copied().collect();
        let mut grid = grid_of(&parts);
        for (rank, part) in front.iter().enumerate().filter(|(rank, _)| *rank != gap) {
            grid.fill(rank, part, convex::area(part), 2.0);
        }
        for (rank, part) in parts.iter().enumerate().skip(front.len()) {
            let near_gap = convex::bounds(part).0.distance(convex::bounds(&front[gap]).0) < 0.5;
            assert!(grid.hides(rank, 1.0) || near_gap, "{rank}");
            assert!(!grid.hides(rank, 2.0), "{rank} is not behind");
        }
        assert!(!grid.hides(front.len() + gap, 1.0));
    }

    /// Regions between many occluders have more corners than `cut` takes.
    #[test]
    fn regions_of_many_corners_fill_their_area() {
        let parts = sheet(13);
        let mut grid = grid_of(&parts);
        let sides = convex::MAX_VERTICES;
        let corner = |i: usize| {
            dvec2(0.5, 0.5) + 0.4 * DVec2::from_angle(std::f64::consts::TAU * i as f64 / sides as f64)
        };
        let region: Vec<DVec2> = (0..sides).map(corner).collect();
        // As if it were what is seen of a part that covers the cell.
        grid.spans[0] = Span { low: [0; 2], high: [grid.side as u16 - 1; 2] };
        grid.fill(0, &region, convex::area(&region), 1.0);
        let open: f64 = grid.squares.iter().map(|square| square.open).sum();
        let filled = 1.0 - open / (grid.side * grid.side) as f64;
        assert!((filled - convex::area(&region)).abs() < 1e-14, "{filled}");
    }

    #[test]
    fn long_parts_are_left_to_others() {
        let stripe = |i: u32| {
            let y = f64::from(i) / 100.0;
            (dvec2(0.0, y), dvec2(1.0, y + 0.01))
        };
        assert!(!FineGrid::default().build((0..100).map(stripe)));
    }
}
