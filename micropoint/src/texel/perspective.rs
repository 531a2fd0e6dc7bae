//! Means over polygons whose depths differ: texels count by their area in the grid.

use super::Precision;
use super::corner::TexelCorner;
use glam::{DVec2, DVec3};
use pointillist_dice::{CellWindow, ConvexPolygon, Cut, clip_ring, convex, cut, share_before_crossing};

/// Extent in texels that is followed texel by texel; time grows with what is seen of it, not with this.
const MOST_CELLS: i32 = 1 << 12;

/// Perspective, few texels: each texel's share is its area in the grid. `None` for a polygon without area.
pub(super) fn mean_by_texels<const N: usize>(
    corners: &[TexelCorner],
    texel_at: impl Fn(f64, f64) -> [f64; N],
) -> Option<[f64; N]> {
    let map = GridFromTexels::new(corners)?;
    let mut ring: Vec<DVec2> = corners.iter().map(|c| c.texel).collect();
    let origin = ring.iter().fold(DVec2::INFINITY, |l, &p| l.min(p)).floor();
    ring.iter_mut().for_each(|p| *p -= origin);
    if convex::area(&ring) < 0.0 {
        ring.reverse();
    }
    let window = CellWindow { x0: 0, y0: 0, x1: MOST_CELLS, y1: MOST_CELLS };
    let (mut sum, mut total) = ([0.0; N], 0.0);
    let mut add = |column: i32, row: i32, outline: &[DVec2]| {
        let mut in_grid = ConvexPolygon::EMPTY;
        outline.iter().for_each(|&p| in_grid.push(map.apply(p + origin)));
        let area = in_grid.area().abs();
        let texel = texel_at(origin.x + f64::from(column), origin.y + f64::from(row));
        total += area;
        sum.iter_mut().zip(texel).for_each(|(s, t)| *s += area * t);
    };
    cut(&ring[..ring.len().min(pointillist_dice::MAX_CUT_VERTICES)], window, |part| match part {
        Cut::Span { row, first, end } => {
            for column in first..end {
                let low = DVec2::new(f64::from(column), f64::from(row));
                add(column, row, ConvexPolygon::rectangle(low, low + 1.0).vertices());
            }
        }
        Cut::Piece { cell, polygon } => add(cell.x, cell.y, polygon.vertices()),
    });
    (total > 0.0).then(|| sum.map(|s| s / total))
}

/// Perspective, many texels: strips between which depth grows by the factor of `precision`, if there are not too many. `least` and `most` bound the corners'
/// `rational`; `mean_of` gives the mean of a strip whose texels count alike.
pub(super) fn mean_by_strips<const N: usize>(
    corners: &[TexelCorner],
    (least, most): (f64, f64),
    precision: &Precision,
    mean_of: impl Fn(&[TexelCorner]) -> [f64; N],
) -> [f64; N] {
    let (mut sum, mut total) = ([0.0; N], 0.0);
    let count =
        ((most / least).ln() / precision.strip.ln()).ceil().clamp(1.0, f64::from(precision.most_strips));
    let border = |i: f64| most * (least / most).powf(i / count);
    let mut rest = corners.to_vec();
    for i in 0..count as usize {
        let last = i + 1 == count as usize;
        let below = border(i as f64 + 1.0);
        let (strip, further) = if last {
            (std::mem::take(&mut rest), Vec::new())
        } else {
            divide(&rest, |c| c.rational - below)
        };
        rest = further;
        if strip.len() >= 3 {
            let ring: Vec<DVec2> = strip.iter().map(|c| c.grid).collect();
            let area = convex::area(&ring).abs();
            let mean = mean_of(&strip);
            total += area;
            sum.iter_mut().zip(mean).for_each(|(s, m)| *s += area * m);
        }
    }
    if total > 0.0 { sum.map(|s| s / total) } else { mean_of(corners) }
}

/// The part of a polygon where a function is above 0, and that where it is below. The function is linear over the grid.
pub(super) fn divide(
    corners: &[TexelCorner],
    value: impl Fn(&TexelCorner) -> f64,
) -> (Vec<TexelCorner>, Vec<TexelCorner>) {
    let part = |sign: f64| {
        let mut part = Vec::with_capacity(corners.len() + 1);
        clip_ring(corners, |c| sign * value(&c), crossing, |c| part.push(c));
        part
    };
    (part(1.0), part(-1.0))
}

/// The corner on the edge from `a` to `b` where a function with these values is 0.
fn crossing((a, va): (TexelCorner, f64), (b, vb): (TexelCorner, f64)) -> TexelCorner {
    let t = share_before_crossing(va, vb);
    let rational = a.rational + (b.rational - a.rational) * t;
    let (ta, tb) = (a.texel * a.rational, b.texel * b.rational);
    TexelCorner { grid: a.grid.lerp(b.grid, t), rational, texel: (ta + (tb - ta) * t) / rational }
}

/// The projective map from texels to the grid, from three corners.
struct GridFromTexels {
    anchor: DVec2,
    /// Grid position × depth, and depth, as affine functions of the texel.
    at_anchor: DVec3,
    along_x: DVec3,
    along_y: DVec3,
}

impl GridFromTexels {
    fn new(corners: &[TexelCorner]) -> Option<Self> {
        let a = corners.first()?;
        let wide = |i: usize| (corners[i].texel - a.texel).perp_dot(corners[i + 1].texel - a.texel).abs();
        let best = (1..corners.len().checked_sub(1)?).max_by(|&i, &j| wide(i).total_cmp(&wide(j)))?;
        let (b, c) = (&corners[best], &corners[best + 1]);
        let lifted = |k: &TexelCorner| (k.grid - a.grid).extend(1.0) / k.rational;
        let (e, f) = (b.texel - a.texel, c.texel - a.texel);
        let determinant = e.perp_dot(f);
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let (le, lf) = (lifted(b) - lifted(a), lifted(c) - lifted(a));
        let along_x = (le * f.y - lf * e.y) / determinant;
        let along_y = (lf * e.x - le * f.x) / determinant;
        Some(Self { anchor: a.texel, at_anchor: lifted(a), along_x, along_y })
    }

    fn apply(&self, texel: DVec2) -> DVec2 {
        let d = texel - self.anchor;
        let p = self.at_anchor + self.along_x * d.x + self.along_y * d.y;
        DVec2::new(p.x, p.y) / p.z
    }
}
