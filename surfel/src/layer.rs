//! Working memory of a tile, in blocks of pixels that are computed together.

use crate::grid::{DRAWN_HEIGHT, DRAWN_WIDTH, SQUARE};
use std::ops::Range;

/// Pixels of a block, next to one another in a row: a whole number of vectors of any processor.
pub(crate) const LANES: usize = 8;

/// Blocks from row to row: whole squares.
pub(crate) const PITCH: usize = DRAWN_WIDTH.next_multiple_of(SQUARE) / LANES;

/// A value for each pixel of a block.
pub(crate) type Lanes = [f32; LANES];

/// Distances of the pixels of a block from its first.
pub(crate) const RAMP: Lanes = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];

/// Depths of a block.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Depths {
    /// Bent depth of the nearest disc.
    pub(crate) near: Lanes,
    /// Depth of the layer before: discs must lie behind it by more than their thickness. +∞ where the pixel is done.
    pub(crate) floor: Lanes,
}

/// Weighted sums of a block: weight, bent depth, sharpness, color.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Sums(pub(crate) [Lanes; 6]);

impl Sums {
    pub(crate) const NOTHING: Self = Self([[0.0; LANES]; 6]);
}

/// Weighted sums of a block that not every frame has: normals (in the picture's axes) and opacity.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Extras {
    pub(crate) normals: [Lanes; 3],
    pub(crate) opacity: Lanes,
}

impl Extras {
    pub(crate) const NOTHING: Self = Self { normals: [[0.0; LANES]; 3], opacity: [0.0; LANES] };
}

/// What a block shows while layers are laid under one another.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Pixels {
    /// Premultiplied color and opacity.
    pub(crate) color: [Lanes; 4],
    /// Bent depth and normal (in the picture's axes) of the layer that made it half opaque; the depth is +∞ before.
    pub(crate) depth: Lanes,
    pub(crate) normal: [Lanes; 3],
    /// Share that surfaces cover, however opaque; untouched in clouds without opacities, where it is the opacity.
    pub(crate) covered: Lanes,
}

impl Pixels {
    pub(crate) const EMPTY: Self = Self {
        color: [[0.0; LANES]; 4],
        depth: [f32::INFINITY; LANES],
        normal: [[0.0; LANES]; 3],
        covered: [0.0; LANES],
    };
}

/// Depths and sums of the layer that is being drawn.
pub(crate) struct Layer {
    pub(crate) depths: Vec<Depths>,
    pub(crate) sums: Vec<Sums>,
    /// Untouched unless normals are asked for or the cloud has opacities.
    pub(crate) extras: Vec<Extras>,
}

impl Layer {
    pub(crate) fn new() -> Self {
        let count = PITCH * DRAWN_HEIGHT;
        let depths = Depths { near: [0.0; LANES], floor: [0.0; LANES] };
        Self {
            depths: vec![depths; count],
            sums: vec![Sums::NOTHING; count],
            extras: vec![Extras::NOTHING; count],
        }
    }

    /// Makes these sums empty, with the extras if any are `WANTED`.
    #[inline(always)]
    pub(crate) fn clear_sums<const WANTED: bool>(&mut self, blocks: Range<usize>) {
        self.sums[blocks.clone()].fill(Sums::NOTHING);
        if WANTED {
            self.extras[blocks].fill(Extras::NOTHING);
        }
    }

    /// Opens blocks that no disc touches.
    pub(crate) fn open(&mut self, blocks: Range<usize>) {
        self.depths[blocks].iter_mut().for_each(|d| d.floor = [0.0; LANES]);
    }

    /// Makes these blocks of depths empty.
    pub(crate) fn clear_near(&mut self, touched: &Touched) {
        for row in touched.rows() {
            self.depths[touched.blocks(row)].iter_mut().for_each(|d| d.near = [f32::INFINITY; LANES]);
        }
    }
}

/// Blocks of a tile with pixels that let light through: a bit for each column of blocks, in each row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Open([u32; DRAWN_HEIGHT]);

impl Open {
    pub(crate) const NOWHERE: Self = Self([0; DRAWN_HEIGHT]);

    /// Adds a block.
    #[inline(always)]
    pub(crate) fn add(&mut self, column: usize, row: usize) {
        self.0[row] |= 1 << column;
    }

    #[inline(always)]
    pub(crate) fn has(&self, column: usize, row: usize) -> bool {
        self.0[row] >> column & 1 != 0
    }

    pub(crate) fn is_nowhere(&self) -> bool {
        self.0.iter().all(|columns| *columns == 0)
    }

    /// Whether any of these blocks is open.
    #[inline(always)]
    pub(crate) fn meets(&self, columns: Range<usize>, rows: Range<usize>) -> bool {
        let bits = (1u32 << columns.end) - (1u32 << columns.start);
        self.0[rows].iter().fold(0, |all, open| all | open) & bits != 0
    }
}

/// Blocks of a tile that discs may touch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touched {
    /// First and last, the last not included.
    columns: [usize; 2],
    rows: [usize; 2],
}

impl Touched {
    pub(crate) const NOTHING: Self = Self { columns: [PITCH, 0], rows: [DRAWN_HEIGHT, 0] };
    pub(crate) const ALL: Self = Self { columns: [0, PITCH], rows: [0, DRAWN_HEIGHT] };

    /// Adds columns and rows of pixels, the last not included.
    pub(crate) fn add(&mut self, columns: [usize; 2], rows: [usize; 2]) {
        self.columns[0] = self.columns[0].min(columns[0] / LANES);
        self.columns[1] = self.columns[1].max(columns[1].div_ceil(LANES));
        self.rows[0] = self.rows[0].min(rows[0]);
        self.rows[1] = self.rows[1].max(rows[1]);
    }

    pub(crate) fn rows(&self) -> Range<usize> {
        self.rows[0]..self.rows[1]
    }

    /// Columns of blocks.
    pub(crate) fn columns(&self) -> Range<usize> {
        self.columns[0]..self.columns[1]
    }

    /// These and what else is in the squares that they touch.
    pub(crate) fn in_squares(&self) -> Self {
        let outwards = |[first, last]: [usize; 2], side: usize| {
            [first / side * side, last.next_multiple_of(side).max(first / side * side)]
        };
        let rows = outwards(self.rows, SQUARE).map(|row| row.min(DRAWN_HEIGHT));
        Self { columns: outwards(self.columns, SQUARE / LANES), rows }
    }

    /// Indices of all other blocks of the first `height` rows of a tile.
    pub(crate) fn others(&self, height: usize) -> impl Iterator<Item = Range<usize>> {
        let Self { columns: [left, right], rows } = *self;
        let of_row = move |row: usize| {
            let (start, end) = (row * PITCH, (row + 1) * PITCH);
            let is_beside = (rows[0]..rows[1]).contains(&row);
            if is_beside { [start..start + left, start + right..end] } else { [start..end, end..end] }
        };
        (0..height).flat_map(of_row)
    }

    /// Indices of a row's blocks.
    pub(crate) fn blocks(&self, row: usize) -> Range<usize> {
        row * PITCH + self.columns[0]..row * PITCH + self.columns[1]
    }
}
