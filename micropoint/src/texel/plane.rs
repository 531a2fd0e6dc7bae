//! The integral of a wrapped texture over a polygon, ∬ f = ∮ F dy with F the sums along rows.

use super::corner::TexelWrap;
use super::rows::RowSums;
use glam::DVec2;
use pointillist_dice::convex;

/// A texture that fills the plane.
pub(super) struct Plane<'a, R> {
    pub(super) sums: &'a R,
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) wrap: TexelWrap,
    /// A row of sums stands for 2 to this power rows of texels. Not a number of rows: it would be divided by at every step.
    pub(super) shift: u32,
}

/// Where one row's sums hold.
struct Band {
    row: usize,
    /// One past its last y.
    end: f64,
}

/// Largest integer not above `x`, for |x| < 2⁶³. The library's is a call on processors without SSE4.1.
#[inline]
fn floor(x: f64) -> f64 {
    let truncated = x as i64 as f64;
    if truncated > x { truncated - 1.0 } else { truncated }
}

impl<R> Plane<'_, R> {
    /// The integral over a closed ring, in units of the sums.
    pub(super) fn integral<const N: usize>(&self, ring: &[DVec2]) -> [f64; N]
    where
        R: RowSums<N>,
    {
        let mut sum = [0.0; N];
        let (low, high) = convex::bounds(ring);
        let size = DVec2::new(self.width as f64, self.height as f64);
        let inside = low.cmpge(DVec2::ZERO).all() && high.cmplt(size).all();
        for (i, &from) in ring.iter().enumerate() {
            let to = ring[(i + 1) % ring.len()];
            match inside {
                true => self.add_edge_inside(from, to, &mut sum),
                false => self.add_edge(from, to, &mut sum),
            }
        }
        sum
    }

    /// As [`Plane::add_edge`], with the same result, for an edge inside the texture: rows and columns are counted, not looked for.
    fn add_edge_inside<const N: usize>(&self, a: DVec2, b: DVec2, sum: &mut [f64; N])
    where
        R: RowSums<N>,
    {
        if a.y == b.y {
            return;
        }
        let (from, to, sign) = if a.y < b.y { (a, b, 1.0) } else { (b, a, -1.0) };
        let run = (to.x - from.x) / (to.y - from.y);
        let (left, right) = (from.x.min(to.x), from.x.max(to.x));
        let mut p = from;
        for row in (from.y as usize) >> self.shift.. {
            let end = ((row + 1) << self.shift) as f64;
            if end >= to.y {
                self.add_row_inside(row, p.x, to.x, sign * (to.y - p.y), sum);
                return;
            }
            let x = (from.x + (end - from.y) * run).clamp(left, right);
            self.add_row_inside(row, p.x, x, sign * (end - p.y), sum);
            p = DVec2::new(x, end);
        }
    }

    /// As [`Plane::add_row`] between two places inside the texture.
    #[inline]
    fn add_row_inside<const N: usize>(&self, row: usize, xa: f64, xb: f64, height: f64, sum: &mut [f64; N])
    where
        R: RowSums<N>,
    {
        let (lo, hi) = (xa.min(xb), xa.max(xb));
        let (first, last) = (lo as usize, hi as usize);
        let (mut before, mut texel) = self.sums.around(row, first);
        let mut add = |before: &[f64; N], texel: &[f64; N], t: f64, weight: f64| {
            for c in 0..N {
                sum[c] += weight * (before[c] + t * texel[c]);
            }
        };
        if first == last {
            add(&before, &texel, 0.5 * (lo + hi) - first as f64, height);
            return;
        }
        let per_length = height / (hi - lo);
        let mut x = lo;
        for column in first..last {
            let end = (column + 1) as f64;
            add(&before, &texel, 0.5 * (x + end) - column as f64, per_length * (end - x));
            x = end;
            // Exact: both are whole numbers, or halves.
            before.iter_mut().zip(texel).for_each(|(b, t)| *b += t);
            texel = self.sums.texel(row, column + 1);
        }
        add(&before, &texel, 0.5 * (x + hi) - last as f64, per_length * (hi - x));
    }

    /// The texel at integer coordinates.
    pub(super) fn texel<const N: usize>(&self, x: f64, y: f64) -> [f64; N]
    where
        R: RowSums<N>,
    {
        let row = self.band(y.floor() + 0.5).row;
        let (before, after) = (self.row_sum(row, x.floor()), self.row_sum(row, x.floor() + 1.0));
        std::array::from_fn(|c| after[c] - before[c])
    }

    /// Adds ∫ F dy along an edge.
    fn add_edge<const N: usize>(&self, a: DVec2, b: DVec2, sum: &mut [f64; N])
    where
        R: RowSums<N>,
    {
        if a.y == b.y {
            return;
        }
        let (from, to, sign) = if a.y < b.y { (a, b, 1.0) } else { (b, a, -1.0) };
        let run = (to.x - from.x) / (to.y - from.y);
        let (left, right) = (from.x.min(to.x), from.x.max(to.x));
        let mut p = from;
        while p.y < to.y {
            let band = self.band(p.y);
            let y = if band.end > p.y { band.end.min(to.y) } else { to.y };
            // On an edge that is almost level the slope overflows, and the next column line would be at infinity.
            let x = if y == to.y { to.x } else { (from.x + (y - from.y) * run).clamp(left, right) };
            self.add_row(band.row, p.x, x, sign * (y - p.y), sum);
            p = DVec2::new(x, y);
        }
    }

    /// Adds height × mean of F between two places of one row.
    #[inline]
    fn add_row<const N: usize>(&self, row: usize, xa: f64, xb: f64, height: f64, sum: &mut [f64; N])
    where
        R: RowSums<N>,
    {
        let (lo, hi) = (xa.min(xb), xa.max(xb));
        let (first, last) = (floor(lo), floor(hi));
        let inside = first >= 0.0 && last < self.width as f64;
        let mut add = |column: f64, x: f64, weight: f64| {
            let t = x - column;
            let (before, texel) = if inside {
                self.sums.around(row, column as usize)
            } else {
                let before = self.row_sum(row, column);
                let after = self.row_sum(row, column + 1.0);
                (before, std::array::from_fn(|c| after[c] - before[c]))
            };
            for c in 0..N {
                sum[c] += weight * (before[c] + t * texel[c]);
            }
        };
        if first == last {
            add(first, 0.5 * (lo + hi), height);
            return;
        }
        let per_length = height / (hi - lo);
        let mut x = lo;
        let mut column = first;
        while x < hi {
            let end = (column + 1.0).min(hi);
            add(column, 0.5 * (x + end), per_length * (end - x));
            x = end;
            column += 1.0;
        }
    }

    /// Sum of a row from 0 to an integer column, wrapped.
    #[inline]
    pub(super) fn row_sum<const N: usize>(&self, row: usize, column: f64) -> [f64; N]
    where
        R: RowSums<N>,
    {
        let at = |i: usize| self.sums.before(row, i);
        let width = self.width as f64;
        if (0.0..=width).contains(&column) {
            return at(column as usize);
        }
        let total = at(self.width);
        let combine = |periods: f64, rest: [f64; N]| std::array::from_fn(|c| periods * total[c] + rest[c]);
        match self.wrap {
            TexelWrap::Repeat => {
                let periods = (column / width).floor();
                combine(periods, at(((column - periods * width) as usize).min(self.width)))
            }
            TexelWrap::Clamp => {
                let (edge, beyond) =
                    if column < 0.0 { (0, column) } else { (self.width - 1, column - width) };
                let (lo, hi) = (at(edge), at(edge + 1));
                let base = if column < 0.0 { [0.0; N] } else { total };
                std::array::from_fn(|c| base[c] + beyond * (hi[c] - lo[c]))
            }
            TexelWrap::Mirror => {
                let periods = (column / width).floor();
                let rest = ((column - periods * width) as usize).min(self.width);
                if periods.rem_euclid(2.0) == 0.0 {
                    combine(periods, at(rest))
                } else {
                    let mirrored = at(self.width - rest);
                    combine(periods, std::array::from_fn(|c| total[c] - mirrored[c]))
                }
            }
        }
    }

    /// The band of rows that holds `y` (its lower border included), and where it ends.
    #[inline]
    fn band(&self, y: f64) -> Band {
        let height = self.height as f64;
        let shift = self.shift;
        let last = (self.height - 1) >> shift;
        let inside = |r: f64| ((r as usize) >> shift).min(last);
        let upper = |band: usize| ((band + 1) << shift).min(self.height) as f64;
        if (0.0..height).contains(&y) {
            let row = inside(y);
            return Band { row, end: upper(row) };
        }
        match self.wrap {
            TexelWrap::Clamp if y < 0.0 => Band { row: 0, end: 0.0 },
            TexelWrap::Clamp => Band { row: last, end: f64::INFINITY },
            TexelWrap::Mirror if (y / height).floor().rem_euclid(2.0) != 0.0 => {
                let next = ((y / height).floor() + 1.0) * height;
                // Distance from the next mirror line, upward: rows run backward.
                let back = (next - y).min(height);
                let row = ((back.ceil() as usize).max(1) - 1) >> shift;
                Band { row: row.min(last), end: next - (row.min(last) << shift) as f64 }
            }
            _ => {
                let base = (y / height).floor() * height;
                let row = inside(y - base);
                Band { row, end: base + upper(row) }
            }
        }
    }
}
