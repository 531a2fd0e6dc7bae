//! Tiles of a picture: their size, and where they lie.

/// Pixels that a tile shows: sums and depths fit into the second-level cache.
pub(crate) const WIDTH: usize = 128;
pub(crate) const HEIGHT: usize = 64;

/// Pixels around those that a tile shows, which it draws too: `resolve` looks at the neighbours of a pixel, and at theirs.
pub(crate) const RING: usize = 2;

/// Pixels that a tile draws.
pub(crate) const DRAWN_WIDTH: usize = WIDTH + 2 * RING;
pub(crate) const DRAWN_HEIGHT: usize = HEIGHT + 2 * RING;

/// Side, in pixels, of the squares for which the farthest depth is kept, to skip hidden nodes.
pub(crate) const SQUARE: usize = 16;

/// Where a tile lies in the picture, in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileRect {
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) width: usize,
    pub(crate) height: usize,
}

impl TileRect {
    /// With the ring around it, as far as that lies in a picture of this size.
    pub(crate) fn in_ring(&self, picture: [usize; 2]) -> Self {
        let widened = |from: usize, size: usize, limit: usize| {
            let start = from.saturating_sub(RING);
            (start, (from + size + RING).min(limit) - start)
        };
        let (x, width) = widened(self.x, self.width, picture[0]);
        let (y, height) = widened(self.y, self.height, picture[1]);
        Self { x, y, width, height }
    }
}
