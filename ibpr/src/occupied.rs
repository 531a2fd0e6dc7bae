//! Which cells of a grid hold points of how many scans: how dense all scans are when they are laid over one another.

use glam::DVec3;

/// Cells of a grid that is fixed to the world.
#[derive(Clone, Debug, Default)]
pub(crate) struct Occupied {
    /// Side of the cells, a power of 2.
    side: f64,
    /// Hashes of the cells in order, and how many scans have points there.
    cells: Vec<(u64, u32)>,
}

/// A scan's cells: hashes in order, each once.
pub(crate) type Cells = Vec<u64>;

impl Occupied {
    /// An empty grid for points of this spacing: cells of about 2.5 spacings, so that few of a surface's cells are empty by chance.
    pub(crate) fn for_spacing(spacing: f64) -> Self {
        let exponent = (spacing.log2() + 2.5_f64.log2()).round().clamp(-1000.0, 1000.0);
        Self { side: exponent.exp2(), cells: vec![] }
    }

    /// Whether points of this spacing have the same grid.
    pub(crate) fn suits(&self, spacing: f64) -> bool {
        Self::for_spacing(spacing).side == self.side
    }

    /// The cells of a scan's points.
    pub(crate) fn cells_of(&self, points: impl Iterator<Item = DVec3>) -> Cells {
        // A surface in Morton order comes back to a cell soon or not at all, so that most repeated cells are found here.
        const RECENT: usize = 8;
        let mut recent = [DVec3::NAN; RECENT];
        let mut oldest = 0;
        let mut cells = vec![];
        let per_cell = 1.0 / self.side;
        for point in points {
            let cell = (point * per_cell).floor();
            if !recent.contains(&cell) {
                recent[oldest] = cell;
                oldest = (oldest + 1) % RECENT;
                cells.push(hash(cell));
            }
        }
        cells.sort_unstable();
        cells.dedup();
        cells
    }

    pub(crate) fn add(&mut self, cells: &Cells) {
        let before = std::mem::take(&mut self.cells);
        self.cells.reserve(before.len() + cells.len());
        let mut added = cells.iter().copied().peekable();
        for (cell, scans) in before {
            while let Some(new) = added.next_if(|&new| new < cell) {
                self.cells.push((new, 1));
            }
            let both = added.next_if_eq(&cell).is_some();
            self.cells.push((cell, scans + u32::from(both)));
        }
        self.cells.extend(added.map(|new| (new, 1)));
    }

    /// Takes cells out that were added.
    pub(crate) fn remove(&mut self, cells: &Cells) {
        let mut removed = cells.iter().copied().peekable();
        self.cells.retain_mut(|(cell, scans)| {
            *scans -= u32::from(removed.next_if_eq(cell).is_some());
            *scans > 0
        });
    }

    /// Distance between neighbours of `points` points in these cells: √(area / points).
    ///
    /// A plane cuts |nₓ| + |n_y| + |n_z| cells of side h per h², 1.5 in the mean over directions.
    pub(crate) fn spacing(&self, points: usize) -> f64 {
        const CELLS_PER_AREA: f64 = 1.5;
        // Not the root of the area: the square of `side` could overflow or underflow.
        self.side * (self.cells.len() as f64 / CELLS_PER_AREA / points as f64).sqrt()
    }
}

/// 64 bits of a cell's coordinates: a billion cells have one pair in twenty that is taken for one.
fn hash(cell: DVec3) -> u64 {
    // The mixing steps of Steele, Lea and Flood (SplitMix, 2014).
    let mix = |z: u64| {
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    // The cast ends at the largest number, where a cell far from the origin is one with its neighbours.
    let along = cell.to_array().map(|coordinate| coordinate as i64 as u64);
    along.into_iter().fold(0, |sum, value| mix((sum ^ value).wrapping_add(0x9e37_79b9_7f4a_7c15)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_added_can_be_removed_in_any_order() {
        let sheet = |z: f64| (0..400).map(move |i| DVec3::new(f64::from(i % 20), f64::from(i / 20), z));
        let empty = Occupied::for_spacing(1.0);
        let cells = [0.0, 0.5, 9.0].map(|z| empty.cells_of(sheet(z)));
        assert_eq!(cells[0], cells[1]);
        let mut all = empty.clone();
        cells.iter().for_each(|cells| all.add(cells));
        let mut two = empty.clone();
        two.add(&cells[2]);
        two.add(&cells[1]);
        all.remove(&cells[0]);
        assert_eq!(all.cells, two.cells);
        all.remove(&cells[2]);
        all.remove(&cells[1]);
        assert!(all.cells.is_empty());
    }

    #[test]
    fn the_scale_of_the_world_does_not_matter() {
        for scale in [1e-300, 1e-9, 1.0, 1e9, 1e300] {
            let points =
                || (0..10_000).map(|i| scale * DVec3::new(f64::from(i % 100), f64::from(i / 100), 0.5));
            let mut occupied = Occupied::for_spacing(scale);
            let cells = occupied.cells_of(points());
            occupied.add(&cells);
            let spacing = occupied.spacing(10_000) / scale;
            assert!((0.7..1.3).contains(&spacing), "{scale:e}: {spacing}");
        }
    }
}
