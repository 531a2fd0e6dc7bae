//! The pictures of the page: PNG within the page's text.

use super::Page;
use crate::compare::difference_bytes;
use crate::compare::flip_colors::flip_bytes;
use crate::image_io::{Picture, PixelRect, PngOptions, encode_png, encode_rgb_png};
use base64::display::Base64Display;
use base64::engine::general_purpose::STANDARD;
use std::io::{self, Write};

/// What the page shows of both pictures, whole and in parts.
pub(super) struct Images<'p> {
    a: &'p Picture,
    b: &'p Picture,
    png: PngOptions,
    difference: Vec<u8>,
    flip: Vec<u8>,
}

/// One of those.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    A,
    B,
    Difference,
    Flip,
}

impl Kind {
    pub(super) const ALL: [Self; 4] = [Self::A, Self::B, Self::Difference, Self::Flip];

    /// What it is called on the page.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::Difference => "Difference",
            Self::Flip => "FLIP",
        }
    }

    /// What it is called in the style sheet.
    pub(super) const fn class(self) -> &'static str {
        match self {
            Self::A => "a",
            Self::B => "b",
            Self::Difference => "difference",
            Self::Flip => "flip",
        }
    }
}

impl<'p> Images<'p> {
    pub(super) fn new(page: &Page<'p>) -> Self {
        let png = PngOptions { exposure_ev: page.exposure_ev, opaque: true, ..PngOptions::default() };
        Self {
            a: page.a,
            b: page.b,
            png,
            difference: difference_bytes(page.a, page.b),
            flip: flip_bytes(&page.comparison.flip),
        }
    }

    /// Writes a `data:` address of what is seen within `window`.
    pub(super) fn write(&self, output: &mut dyn Write, kind: Kind, window: PixelRect) -> io::Result<()> {
        let mut png = vec![];
        let (width, height) = (window.width(), window.height());
        let row = self.a.size[0] as usize;
        match kind {
            Kind::A | Kind::B => {
                let picture = if kind == Kind::A { self.a } else { self.b };
                encode_png(&mut png, &cut(&picture.color, row, window, 1), width, height, &self.png)?;
            }
            Kind::Difference => {
                encode_rgb_png(&mut png, &cut(&self.difference, row, window, 3), width, height)?
            }
            Kind::Flip => encode_rgb_png(&mut png, &cut(&self.flip, row, window, 3), width, height)?,
        }
        write!(output, "data:image/png;base64,{}", Base64Display::new(&png, &STANDARD))
    }
}

/// What lies within a window, of rows of `row` pixels of `each` numbers.
fn cut<T: Copy>(all: &[T], row: usize, window: PixelRect, each: usize) -> Vec<T> {
    let columns = each * window.x0 as usize..each * window.x1 as usize;
    let rows = all.chunks_exact(each * row).take(window.y1 as usize).skip(window.y0 as usize);
    rows.flat_map(|line| &line[columns.clone()]).copied().collect()
}
