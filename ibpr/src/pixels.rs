//! The surfaces that a picture pixel keeps of the faces over it: the nearest one, or several.

use crate::buffer::DepthScale;
use crate::options::Translucency;
use crate::raster::{Paint, Pixels};
use std::ops::Range;

/// Stands for no surface.
const FAR: [f32; 4] = [f32::INFINITY, 0.0, 0.0, 0.0];

/// The nearest surface of each pixel, and of the rims in front of it the one that covers most.
///
/// A rim is a surface whose outline crosses the pixel: it covers the pixel in part, and what lies behind
/// shows through the rest.
#[derive(Debug, Default)]
pub(crate) struct Nearest {
    /// Bent depth (+∞ where nothing is) and normal.
    pub(crate) solid: Vec<[f32; 4]>,
    pub(crate) rim: Vec<[f32; 4]>,
    /// Covered share of rim pixels; 0 where there is no rim.
    pub(crate) rim_cover: Vec<f32>,
    /// Colors of the two, if asked for.
    pub(crate) solid_paint: Vec<Paint>,
    pub(crate) rim_paint: Vec<Paint>,
}

impl Nearest {
    /// Makes room for `n` pixels, in rows of so many, and empties these columns.
    pub(crate) fn begin(&mut self, n: usize, width: usize, columns: &Range<usize>, painted: bool) {
        self.solid.resize(n, FAR);
        self.rim.resize(n, FAR);
        self.rim_cover.resize(n, 0.0);
        self.solid.chunks_mut(width).for_each(|row| row[columns.clone()].fill(FAR));
        self.rim_cover.chunks_mut(width).for_each(|row| row[columns.clone()].fill(0.0));
        let painted = if painted { n } else { 0 };
        self.solid_paint.resize(painted, Paint::NONE);
        self.rim_paint.resize(painted, Paint::NONE);
    }

    /// Puts a coarser pass over this one at these pixels, except where this shows another surface in front.
    pub(crate) fn draw_over(
        &mut self,
        coarse: &Self,
        pixels: impl Iterator<Item = usize>,
        scale: &DepthScale,
        steps: f32,
    ) {
        for i in pixels {
            let (under, over) = (&mut self.solid[i], &coarse.solid[i]);
            if over[0] < f32::INFINITY && over[0] < under[0] + scale.bent_step(over[0], steps) {
                *under = *over;
                if let Some(paint) = self.solid_paint.get_mut(i) {
                    *paint = coarse.solid_paint[i];
                }
            }
        }
    }
}

impl Pixels for Nearest {
    #[inline(always)]
    fn put(&mut self, at: usize, surface: [f32; 4], cover: f32, paint: impl FnOnce() -> Option<Paint>) {
        if cover >= 1.0 {
            if surface[0] < self.solid[at][0] {
                self.solid[at] = surface;
                if let Some(paint) = paint() {
                    self.solid_paint[at] = paint;
                }
            }
        } else if surface[0] < self.solid[at][0] && cover > self.rim_cover[at] {
            self.rim[at] = surface;
            self.rim_cover[at] = cover;
            if let Some(paint) = paint() {
                self.rim_paint[at] = paint;
            }
        }
    }
}

/// A surface over a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fragment {
    pub(crate) surface: [f32; 4],
    pub(crate) cover: f32,
    pub(crate) paint: Paint,
}

/// Most surfaces that a pixel keeps: as many as a buffer has layers, with room for folds.
pub(crate) const MOST_FRAGMENTS: usize = Translucency::MOST_LAYERS + 4;

/// The nearest surfaces of each pixel, from near to far.
#[derive(Debug, Default)]
pub(crate) struct Stack {
    fragments: Vec<Fragment>,
    counts: Vec<u8>,
}

impl Stack {
    /// Makes room for `n` pixels, in rows of so many, and empties these columns.
    pub(crate) fn begin(&mut self, n: usize, width: usize, columns: &Range<usize>) {
        self.fragments.resize(n * MOST_FRAGMENTS, Fragment { surface: FAR, cover: 0.0, paint: Paint::NONE });
        self.counts.resize(n, 0);
        self.counts.chunks_mut(width).for_each(|row| row[columns.clone()].fill(0));
    }

    /// The surfaces of a pixel, nearest first.
    pub(crate) fn of(&self, at: usize) -> &[Fragment] {
        &self.fragments[at * MOST_FRAGMENTS..][..usize::from(self.counts[at])]
    }

    /// Puts a coarser pass over this one at these pixels: where both have a surface, the coarser one stays.
    pub(crate) fn draw_over(
        &mut self,
        coarse: &Self,
        pixels: impl Iterator<Item = usize>,
        scale: &DepthScale,
        steps: f32,
    ) {
        for at in pixels {
            let over = coarse.of(at);
            if over.is_empty() {
                continue;
            }
            let under: [Fragment; MOST_FRAGMENTS] =
                self.fragments[at * MOST_FRAGMENTS..][..MOST_FRAGMENTS].try_into().expect("a pixel's room");
            let count = usize::from(std::mem::take(&mut self.counts[at]));
            for f in over {
                self.insert(at, *f);
            }
            let apart = |f: &Fragment, g: &Fragment| {
                (f.surface[0] - g.surface[0]).abs() >= scale.bent_step(g.surface[0], steps)
            };
            for f in under[..count].iter().filter(|f| over.iter().all(|g| apart(f, g))) {
                self.insert(at, *f);
            }
        }
    }

    fn insert(&mut self, at: usize, fragment: Fragment) {
        let room = &mut self.fragments[at * MOST_FRAGMENTS..][..MOST_FRAGMENTS];
        let count = usize::from(self.counts[at]);
        let place = room[..count].partition_point(|f| f.surface[0] <= fragment.surface[0]);
        if place == MOST_FRAGMENTS {
            return;
        }
        let kept = (count + 1).min(MOST_FRAGMENTS);
        room[place..kept].rotate_right(1);
        room[place] = fragment;
        self.counts[at] = kept as u8;
    }
}

impl Pixels for Stack {
    #[inline(always)]
    fn put(&mut self, at: usize, surface: [f32; 4], cover: f32, paint: impl FnOnce() -> Option<Paint>) {
        self.insert(at, Fragment { surface, cover, paint: paint().unwrap_or(Paint::NONE) });
    }
}
