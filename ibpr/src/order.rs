//! The canonical order of points that every frame uses: it depends on the points, not on the order of the input.

use crate::scan::Scan;
use glam::DVec3;
use pointillist_parallel::sort_by;
use pointillist_view::{MORTON_BITS, morton_code};
use std::cmp::Ordering;

/// A box with a cubic lattice of 2^[`MORTON_BITS`] cells per axis over it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lattice {
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// Side of the cube.
    pub(crate) extent: f64,
}

impl Lattice {
    pub(crate) fn around<'a>(points: impl Iterator<Item = &'a DVec3>) -> Self {
        let (low, high) =
            points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        Self { low, high, extent: (high - low).max_element() }
    }

    pub(crate) fn centre(&self) -> DVec3 {
        0.5 * self.low + 0.5 * self.high
    }

    /// Morton code of the cell that holds `p`.
    pub(crate) fn code(&self, p: DVec3) -> u64 {
        let cells = f64::from(1u32 << MORTON_BITS);
        let scale = if self.extent > 0.0 { cells / self.extent } else { 0.0 };
        let cell = ((p - self.low) * scale).min(DVec3::splat(cells - 1.0));
        morton_code(cell.to_array().map(|c| c as u32))
    }
}

/// One scan's points in Morton order; equal codes by coordinates, then by color.
pub(crate) struct Ordered {
    pub(crate) scan: usize,
    pub(crate) codes: Vec<u64>,
    pub(crate) points: Vec<u32>,
}

/// All scans that hold points, in an order that does not depend on the order they came in.
pub(crate) fn in_order(scans: &[Scan<'_>], lattice: &Lattice) -> Vec<Ordered> {
    let mut ordered: Vec<Ordered> = scans
        .iter()
        .enumerate()
        .filter(|(_, s)| !s.positions.is_empty())
        .map(|(i, s)| points_in_order(i, s, lattice))
        .collect();
    ordered.sort_by(|a, b| compare_scans(scans, a, b));
    ordered
}

fn points_in_order(scan: usize, s: &Scan<'_>, lattice: &Lattice) -> Ordered {
    let mut keys: Vec<(u64, u32)> =
        s.positions.iter().enumerate().map(|(i, p)| (lattice.code(*p), i as u32)).collect();
    sort_by(&mut keys, |a, b| a.0.cmp(&b.0).then_with(|| compare_points((s, a.1), (s, b.1))));
    let (codes, points) = keys.into_iter().unzip();
    Ordered { scan, codes, points }
}

type PointOf<'s, 'a> = (&'s Scan<'a>, u32);

fn compare_points(a: PointOf<'_, '_>, b: PointOf<'_, '_>) -> Ordering {
    let position = |(s, i): PointOf<'_, '_>| s.positions[i as usize].to_array();
    let color = |(s, i): PointOf<'_, '_>| s.colors.map_or([-1.0; 3], |c| c[i as usize]);
    let (p, q) = (position(a), position(b));
    let by_position = p.iter().zip(&q).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne());
    by_position.unwrap_or_else(|| {
        let (c, d) = (color(a), color(b));
        c.iter().zip(&d).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    })
}

fn compare_scans(scans: &[Scan<'_>], a: &Ordered, b: &Ordered) -> Ordering {
    let (s, t) = (&scans[a.scan], &scans[b.scan]);
    let rest = |s: &Scan<'_>| {
        let d = s.towards_scanner.map_or([0.0; 4], |d| [1.0, d.x, d.y, d.z]);
        [s.spacing.unwrap_or(0.0), d[0], d[1], d[2], d[3]]
    };
    let points = a.points.iter().zip(&b.points);
    points
        .map(|(&i, &j)| compare_points((s, i), (t, j)))
        .find(|o| o.is_ne())
        .unwrap_or_else(|| a.points.len().cmp(&b.points.len()))
        .then_with(|| {
            let (x, y) = (rest(s), rest(t));
            x.iter().zip(&y).map(|(p, q)| p.total_cmp(q)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
        })
}
