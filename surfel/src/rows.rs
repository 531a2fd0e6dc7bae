//! Points near a place.

use glam::DVec3;
use pointillist_parallel as parallel;

/// Points in rows along the longest side of their box, sorted along each row: a search looks into a few rows and, in
/// each, at the points within reach only.
///
/// Memory is 40 bytes per point. For points that are spread over surfaces a search looks at a few times as many points
/// as it finds; for other points it is slower, and as correct.
pub(crate) struct Rows {
    /// Which coordinates of a point are along and across the rows.
    axes: [usize; 3],
    low: DVec3,
    /// Width of a row.
    width: f64,
    /// Rows across, on either axis.
    counts: [usize; 2],
    /// Where each row begins in `sorted`, and the end.
    starts: Vec<u32>,
    /// Positions, coordinates in the order of `axes`.
    sorted: Vec<DVec3>,
    /// Number of each point in `sorted` in the caller's list.
    order: Vec<u32>,
}

impl Rows {
    /// Sorts `count` points, below 2³², for searches up to about `reach` (more than 0).
    pub(crate) fn new(count: usize, reach: f64, position: impl Fn(usize) -> DVec3 + Send + Sync) -> Self {
        let (low, high) = (0..count)
            .map(&position)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let size = high - low;
        let first = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let axes = [first, (first + 1) % 3, (first + 2) % 3];
        let turned = |p: DVec3| DVec3::new(p[axes[0]], p[axes[1]], p[axes[2]]);
        let (low, size) = (turned(low), turned(size));
        let most = 2.0 * count as f64 + 1024.0;
        let mut width = reach;
        while (size.y / width + 1.0) * (size.z / width + 1.0) > most {
            // Points that fill little of their box: wider rows find the same.
            width *= 2.0;
        }
        let across = |size: f64| (size / width) as usize + 1;
        let counts = if count == 0 { [1, 1] } else { [across(size.y), across(size.z)] };
        let mut rows = Self { axes, low, width, counts, starts: vec![], sorted: vec![], order: vec![] };
        rows.sort(count, |i| turned(position(i)));
        rows
    }

    fn sort(&mut self, count: usize, position: impl Fn(usize) -> DVec3 + Send + Sync) {
        let mut keys = parallel::map(count, |i| {
            let p = position(i);
            let [y, z] = [self.row(p.y, 0), self.row(p.z, 1)];
            ((z * self.counts[0] + y) as u32, i as u32, p)
        });
        parallel::sort_by(&mut keys, |a, b| a.0.cmp(&b.0).then(a.2.x.total_cmp(&b.2.x)).then(a.1.cmp(&b.1)));
        self.starts = vec![0; self.counts[0] * self.counts[1] + 1];
        keys.iter().for_each(|key| self.starts[key.0 as usize + 1] += 1);
        for i in 1..self.starts.len() {
            self.starts[i] += self.starts[i - 1];
        }
        self.sorted = keys.iter().map(|key| key.2).collect();
        self.order = keys.iter().map(|key| key.1).collect();
    }

    /// The row of a coordinate across, clamped to those that are there.
    fn row(&self, across: f64, axis: usize) -> usize {
        (((across - self.low[1 + axis]) / self.width) as usize).min(self.counts[axis] - 1)
    }

    /// The caller's number of the point at each place.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The point at a place, with coordinates in an order of our own.
    pub(crate) fn at(&self, place: usize) -> DVec3 {
        self.sorted[place]
    }

    /// A point in our order of coordinates.
    pub(crate) fn turned(&self, p: DVec3) -> DVec3 {
        DVec3::new(p[self.axes[0]], p[self.axes[1]], p[self.axes[2]])
    }

    /// Calls `found` with place and squared distance of every point within reach of `p` (as [`Rows::at`] gives
    /// it), always in the same order.
    pub(crate) fn near(&self, p: DVec3, reach: f64, mut found: impl FnMut(usize, f64)) {
        let [y, z] = [0, 1].map(|axis| {
            let across = p[1 + axis];
            self.row(across - reach, axis)..=self.row(across + reach, axis)
        });
        let reach2 = reach * reach;
        for z in z {
            for y in y.clone() {
                let row = z * self.counts[0] + y;
                let (start, end) = (self.starts[row] as usize, self.starts[row + 1] as usize);
                let points = &self.sorted[start..end];
                let skip = points.partition_point(|q| q.x < p.x - reach);
                for (i, q) in points[skip..].iter().enumerate().take_while(|(_, q)| q.x <= p.x + reach) {
                    let distance2 = q.distance_squared(p);
                    if distance2 <= reach2 {
                        found(start + skip + i, distance2);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_finds_what_a_look_at_all_finds() {
        let mut random = 7u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / f64::from(1 << 24)
        };
        for scale in [DVec3::ONE, DVec3::new(1.0, 30.0, 0.0), DVec3::new(0.0, 0.0, 0.0), DVec3::splat(1e6)] {
            let points: Vec<DVec3> = (0..300).map(|_| DVec3::new(next(), next(), next()) * scale).collect();
            for reach in [0.02, 0.3, 4.0] {
                let rows = Rows::new(points.len(), reach, |i| points[i]);
                for &p in &points {
                    let mut fast = vec![];
                    rows.near(rows.turned(p), reach, |place, _| fast.push(rows.order()[place] as usize));
                    fast.sort_unstable();
                    let slow: Vec<usize> = (0..points.len())
                        .filter(|&i| points[i].distance_squared(p) <= reach * reach)
                        .collect();
                    assert_eq!(fast, slow);
                }
            }
        }
    }
}
