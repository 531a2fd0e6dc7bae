//! Blocks of which no point counts: all lie behind the nearest surface by more than what belongs to it.

use crate::block_view::BlockView;
use crate::project::Band;

/// Side of the squares in which depths are summed up, buffer pixels: a block of a dense scan covers a few of them.
const SQUARE: usize = 8;

/// How far points may lie behind and count, for each square of a band: no point of the square beyond that does.
#[derive(Debug, Default)]
pub(crate) struct Limits {
    /// −∞ where a square has no point.
    squares: Vec<f32>,
    columns: usize,
}

impl Limits {
    /// From the nearest depths of a band's pixels (infinite where there is no point). `limit` says up to which depth points belong to a surface of some depth;
    /// it grows with the depth.
    pub(crate) fn find(&mut self, near: &[f32], band: &Band, limit: impl Fn(f32) -> f32) {
        self.columns = band.width.div_ceil(SQUARE);
        self.squares.clear();
        self.squares.resize(self.columns * band.rows.div_ceil(SQUARE), f32::NEG_INFINITY);
        for (row, depths) in near.chunks(band.width).enumerate() {
            let squares = &mut self.squares[row / SQUARE * self.columns..][..self.columns];
            for (farthest, depths) in squares.iter_mut().zip(depths.chunks(SQUARE)) {
                for &depth in depths {
                    // Pixels without a point have none of any block.
                    let depth = if depth < f32::INFINITY { depth } else { f32::NEG_INFINITY };
                    *farthest = farthest.max(depth);
                }
            }
        }
        for farthest in self.squares.iter_mut().filter(|farthest| **farthest > f32::NEG_INFINITY) {
            *farthest = limit(*farthest);
        }
    }

    /// Whether no point of a block counts in the band.
    pub(crate) fn hide(&self, view: &BlockView, band: &Band) -> bool {
        let squares =
            |from: usize, to: usize, size: usize| from.min(size) / SQUARE..to.min(size).div_ceil(SQUARE);
        let (top, bottom) = (view.top.max(band.first_row), view.bottom.max(band.first_row));
        let rows = squares(top - band.first_row, bottom - band.first_row, band.rows);
        let columns = squares(view.left, view.right, band.width);
        let limits = |row: usize| &self.squares[row * self.columns..][columns.clone()];
        rows.into_iter().all(|row| limits(row).iter().all(|limit| *limit < view.nearest))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block_view::{view_blocks, walk};
    use crate::buffer_map::BufferMap;
    use crate::cloud::Cloud;
    use crate::scan::Scan;
    use glam::{DVec3, Vec3, dvec3};
    use pointillist_view::{Projection, View};

    /// Two bumpy sheets, of which the nearer one covers two thirds of the other.
    fn sheets() -> Cloud {
        let bumps = |x: f64, y: f64| 0.05 * (9.0 * x).sin() * (7.0 * y).cos();
        let place = |i: u32| (f64::from(i % 200) / 100.0 - 1.0, f64::from(i / 200) / 100.0 - 1.0);
        let points = (0..80_000).filter_map(|i| {
            let ((x, y), behind) = (place(i % 40_000), i >= 40_000);
            (behind || x < 0.33).then(|| dvec3(x, y, bumps(x, y) - if behind { 0.6 } else { 0.0 }))
        });
        let points: Vec<DVec3> = points.collect();
        Cloud::new(&[Scan::new(&points)], Vec3::ONE).unwrap()
    }

    #[test]
    fn no_point_of_a_hidden_block_counts_and_most_that_do_not_are_hidden() {
        let cloud = sheets();
        let visible: Vec<u32> = (0..cloud.blocks.len() as u32).collect();
        let cameras = [Projection::Perspective { fov_y_rad: 0.8 }, Projection::Orthographic { height: 2.2 }];
        for (camera, eye) in
            cameras.into_iter().flat_map(|c| [(c, dvec3(0.1, 0.2, 3.0)), (c, dvec3(1.0, 0.7, 2.5))])
        {
            let view = View::look_at(eye, DVec3::ZERO, DVec3::Y, camera, 400, 400).unwrap();
            let map = BufferMap::new(&view, 2.0, 3.0, cloud.unit);
            let mut views = vec![];
            view_blocks(&cloud, &visible, &map, &mut views);
            let slab = (0.05 / cloud.unit) as f32;
            let (mut hidden, mut useless) = (0, 0);
            for first_row in (0..map.height).step_by(64) {
                let band = Band::new(&map, first_row, 64.min(map.height - first_row));
                let mut near = vec![f32::INFINITY; band.width * band.rows];
                walk(&cloud, &views, &band, |_| false, |p, k, at, _| near[at] = near[at].min(p.depth[k]));
                let mut limits = Limits::default();
                limits.find(&near, &band, |near| near + slab);
                for view in &views {
                    let (mut points, mut counted) = (0, 0);
                    walk(
                        &cloud,
                        std::slice::from_ref(view),
                        &band,
                        |_| false,
                        |p, k, at, _| {
                            points += 1;
                            counted += usize::from(p.depth[k] <= near[at] + slab);
                        },
                    );
                    let is_hidden = points > 0 && limits.hide(view, &band);
                    assert!(!is_hidden || counted == 0, "{counted} of {points} count");
                    hidden += usize::from(is_hidden);
                    useless += usize::from(points > 0 && counted == 0);
                }
            }
            assert!(hidden > 12 && 2 * hidden > useless, "{hidden} of {useless}");
        }
    }
}
