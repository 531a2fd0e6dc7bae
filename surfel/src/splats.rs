//! The discs of a tile.

use crate::splat::{Projected, Splat};

/// A list that keeps its memory, filled, when it is emptied: new entries are written in place. To push what was made
/// elsewhere would copy it once more.
#[derive(Default)]
pub(crate) struct Splats {
    all: Vec<Splat>,
    count: usize,
}

impl Splats {
    pub(crate) fn clear(&mut self) {
        self.count = 0;
    }

    pub(crate) fn as_slice(&self) -> &[Splat] {
        &self.all[..self.count]
    }

    /// Adds those that were projected of `count` items.
    #[inline(always)]
    pub(crate) fn append(&mut self, projected: &Projected, count: usize) {
        let room = self.count + count;
        if self.all.len() < room {
            self.all.resize(room.next_power_of_two(), Splat::NONE);
        }
        for item in (0..count).filter(|&item| projected.is_kept(item)) {
            self.all[self.count] = projected.splat(item);
            self.count += 1;
        }
    }
}
