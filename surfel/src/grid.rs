//! Tiles of a picture: their size, and where they lie.

/// Pixels of a tile: sums and depths fit into the second-level cache.
pub(crate) const WIDTH: usize = 128;
pub(crate) const HEIGHT: usize = 64;

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
