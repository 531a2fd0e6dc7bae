//! The part of a picture that is wanted, and what has to be drawn for it.

use crate::options::Options;
use pointillist_view::PixelRect;
use std::ops::Range;

/// Pixels of the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Wanted {
    pub(crate) columns: Range<usize>,
    pub(crate) rows: Range<usize>,
}

impl Wanted {
    /// What the caller gets, within a picture of this size.
    pub(crate) fn new(options: &Options, [width, height]: [u32; 2]) -> Self {
        let r = options.window.unwrap_or(PixelRect::of_picture(width, height));
        let within = |from: u32, to: u32, size: u32| from.min(size) as usize..to.min(size) as usize;
        Self { columns: within(r.x0, r.x1, width), rows: within(r.y0, r.y1, height) }
    }

    /// The same with what eye-dome lighting looks at around it.
    pub(crate) fn with_surroundings(&self, options: &Options, picture: [u32; 2]) -> Self {
        self.wider(options.eye_dome.map_or(0, |dome| dome.radius as usize), picture)
    }

    /// The same with so many more pixels on each side, as far as they are in a picture of this size.
    pub(crate) fn wider(&self, by: usize, [width, height]: [u32; 2]) -> Self {
        let wider = |range: &Range<usize>, size: u32| {
            range.start.saturating_sub(by)..(range.end + by).min(size as usize)
        };
        Self { columns: wider(&self.columns, width), rows: wider(&self.rows, height) }
    }

    /// The same with all rows of the strips that it meets; strips have so many rows each.
    pub(crate) fn in_strips(&self, strip: usize, height: usize) -> Self {
        let start = self.rows.start - self.rows.start % strip;
        let end = self.rows.end.next_multiple_of(strip).min(height).max(start);
        Self { columns: self.columns.clone(), rows: start..end }
    }
}
