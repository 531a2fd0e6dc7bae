//! Parts of a picture.

/// A rectangle of pixels: columns `x0..x1`, rows `y0..y1`. It is empty unless `x0 < x1` and `y0 < y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PixelRect {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// One past the last column.
    pub x1: u32,
    /// One past the last row.
    pub y1: u32,
}

impl PixelRect {
    /// All pixels of a picture of this width and height.
    #[must_use]
    pub const fn of_picture(width: u32, height: u32) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Pixels from left to right.
    #[must_use]
    pub const fn width(&self) -> u32 {
        self.x1.saturating_sub(self.x0)
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub const fn height(&self) -> u32 {
        self.y1.saturating_sub(self.y0)
    }

    /// How many pixels it holds.
    #[must_use]
    pub const fn pixels(&self) -> u64 {
        self.width() as u64 * self.height() as u64
    }

    /// Whether there is no pixel in it.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.pixels() == 0
    }

    /// The pixels that both rectangles hold; an empty rectangle if there are none.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let (x0, y0) = (self.x0.max(other.x0), self.y0.max(other.y0));
        Self { x0, y0, x1: self.x1.min(other.x1).max(x0), y1: self.y1.min(other.y1).max(y0) }
    }

    /// Tiles of up to `size` × `size` pixels that together are this rectangle, row by row. Their borders are at
    /// multiples of `size` pixels of the whole picture, so that the tiles of a crop are parts of the tiles of the
    /// picture. None is empty. A size of 0 counts as 1.
    pub fn tiles(&self, size: u32) -> impl Iterator<Item = PixelRect> + use<> {
        let rect = *self;
        let size = size.max(1);
        let starts = move |from: u32, to: u32| (from / size * size..to).step_by(size as usize);
        // The aligned start of an inverted rectangle may lie before its end.
        let rows = if rect.is_empty() { starts(0, 0) } else { starts(rect.y0, rect.y1) };
        rows.flat_map(move |y| {
            starts(rect.x0, rect.x1).map(move |x| PixelRect {
                x0: x.max(rect.x0),
                y0: y.max(rect.y0),
                x1: x.saturating_add(size).min(rect.x1),
                y1: y.saturating_add(size).min(rect.y1),
            })
        })
    }
}

/// `x0,y0,x1,y1`, as command lines take it.
impl std::fmt::Display for PixelRect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{},{},{},{}", self.x0, self.y0, self.x1, self.y1)
    }
}
