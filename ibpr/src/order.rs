//! The canonical order of a scan's points that every frame uses: it depends on the points, not on the order of the input.

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

/// The numbers of a scan's points in Morton order; equal codes by coordinates, then by color, then by opacity.
pub(crate) fn in_order(scan: &Scan<'_>, lattice: &Lattice) -> Vec<u32> {
    let mut keys: Vec<(u64, u32)> =
        scan.positions.iter().enumerate().map(|(i, p)| (lattice.code(*p), i as u32)).collect();
    sort_by(&mut keys, |a, b| a.0.cmp(&b.0).then_with(|| compare_points(scan, a.1, b.1)));
    keys.into_iter().map(|(_, point)| point).collect()
}

fn compare_points(scan: &Scan<'_>, a: u32, b: u32) -> Ordering {
    let values = |i: u32| {
        let i = i as usize;
        let [x, y, z] = scan.positions[i].to_array();
        let [r, g, b] = scan.colors.map_or([0.0; 3], |colors| colors[i]).map(f64::from);
        [x, y, z, r, g, b, f64::from(scan.opacities.map_or(0.0, |all| all[i]))]
    };
    let pairs = values(a).into_iter().zip(values(b));
    pairs.map(|(x, y)| x.total_cmp(&y)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
}
