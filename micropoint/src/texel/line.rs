//! Means over polygons that a texture sees as a line: of a surface that it runs along, or one that it sees edge-on.

use super::corner::TexelCorner;
use super::perspective::divide;
use glam::DVec2;
use pointillist_dice::convex;

/// Area in texels, relative to the square of the extent, up to which a polygon is a line: sums along its outline have no digits left.
const LINE: f64 = 1e-9;

/// Texels along a line up to which each has its own share. On longer ones this many places at equal distances stand for all.
const MOST_ON_LINE: f64 = 4096.0;

/// Whether a polygon has no area in the texture.
pub(super) fn is_line(corners: &[TexelCorner], extent: DVec2) -> bool {
    let first = corners[0].texel;
    let mut twice_area = 0.0;
    for (i, a) in corners.iter().enumerate() {
        let b = &corners[(i + 1) % corners.len()];
        twice_area += (a.texel - first).perp_dot(b.texel - first);
    }
    0.5 * twice_area.abs() <= LINE * extent.max_element().powi(2)
}

/// The mean along the line: each texel counts by the area of what sees it in the grid or, without area there, by its length.
pub(super) fn mean_along_line<const N: usize>(
    corners: &[TexelCorner],
    texel_at: impl Fn(DVec2) -> [f64; N],
) -> [f64; N] {
    let from = corners[0].texel;
    let far = |from: DVec2| {
        let distance2 = |c: &TexelCorner| c.texel.distance_squared(from);
        corners
            .iter()
            .map(|c| (c.texel, distance2(c)))
            .fold((from, 0.0), |m, c| if c.1 > m.1 { c } else { m })
            .0
    };
    let start = far(from);
    let along = far(start) - start;
    let share = |c: &TexelCorner| (c.texel - start).dot(along) / along.length_squared();
    let ring_area = |corners: &[TexelCorner]| {
        let mut ring = [DVec2::ZERO; convex::MAX_VERTICES];
        let len = corners.len().min(ring.len());
        ring.iter_mut().zip(corners).for_each(|(to, c)| *to = c.grid);
        convex::area(&ring[..len]).abs()
    };
    let has_area = ring_area(corners) > 0.0;
    let mut rest = corners.to_vec();
    let (mut sum, mut total) = ([0.0; N], 0.0);
    for_each_part(start, along, |begin, end| {
        let weight = if has_area && end < 1.0 {
            // Linear over the grid times `rational`, so that parts are cut exactly in perspective, too.
            let (part, further) = divide(&rest, |c| c.rational * (end - share(c)));
            rest = further;
            ring_area(&part)
        } else if has_area {
            ring_area(&rest)
        } else {
            end - begin
        };
        let texel = texel_at((start + along * (0.5 * (begin + end))).floor());
        total += weight;
        sum.iter_mut().zip(texel).for_each(|(s, t)| *s += weight * t);
    });
    if total > 0.0 { sum.map(|s| s / total) } else { texel_at((start + 0.5 * along).floor()) }
}

/// The parts of a line from texel border to texel border, from 0 to 1.
fn for_each_part(start: DVec2, along: DVec2, mut each: impl FnMut(f64, f64)) {
    if along.abs().element_sum() > MOST_ON_LINE {
        let at = |i: u32| f64::from(i) / MOST_ON_LINE;
        (0..MOST_ON_LINE as u32).for_each(|i| each(at(i), at(i + 1)));
        return;
    }
    let mut columns = Borders::new(start.x, along.x);
    let mut rows = Borders::new(start.y, along.y);
    let mut begin = 0.0;
    while begin < 1.0 {
        let (x, y) = (columns.share(), rows.share());
        let end = x.min(y).min(1.0);
        if end > begin {
            each(begin, end);
        }
        // Where rounding has put a border before the last one, nothing lies between.
        begin = end.max(begin);
        if x <= begin {
            columns.next += columns.along.signum();
        }
        if y <= begin {
            rows.next += rows.along.signum();
        }
    }
}

/// The borders of columns or of rows that a line crosses, one by one.
struct Borders {
    start: f64,
    along: f64,
    next: f64,
}

impl Borders {
    fn new(start: f64, along: f64) -> Self {
        let next = if along > 0.0 { start.floor() + 1.0 } else { start.ceil() - 1.0 };
        Self { start, along, next }
    }

    /// Where the next border is, from 0 to 1; infinite for a line along the borders.
    fn share(&self) -> f64 {
        if self.along == 0.0 { f64::INFINITY } else { (self.next - self.start) / self.along }
    }
}
