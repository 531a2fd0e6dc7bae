//! Draws what the colours of a picture mean into its lower left corner.

use super::colouring::{Entry, Key, Legend};
use crate::image_io::Frame;
use embedded_graphics::Drawable as _;
use embedded_graphics::mono_font::ascii::{FONT_6X10, FONT_9X15, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::{DrawTarget, OriginDimensions, Pixel, Point, Size};
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;

/// Opacity of the panel that text stands on.
const PANEL: f32 = 0.7;

/// Longest text of a line, in letters.
const LETTERS: usize = 32;

/// Steps of a scale that have a number, both ends included.
const TICKS: u32 = 5;

/// Lines of colour for each number of a scale.
const LINES_PER_TICK: u32 = 2;

/// A rectangle of a legend: `left`, `top`, `width`, `height` in pixels from the panel's corner.
type Rectangle = [u32; 4];

/// What is drawn, in pixels from the panel's upper left corner.
#[derive(Default)]
struct Layout {
    texts: Vec<(u32, u32, String)>,
    fills: Vec<(Rectangle, [f32; 3])>,
    size: [u32; 2],
}

/// Draws a legend; `gain` is what colours are multiplied by when the picture is written. Returns whether there was room for it.
pub fn draw_legend(frame: &mut Frame, legend: &Legend, gain: f32) -> bool {
    let [width, height] = [frame.window.width(), frame.window.height()];
    let font = match height {
        0..480 => &FONT_6X10,
        480..1000 => &FONT_9X15,
        _ => &FONT_10X20,
    };
    let margin = font.character_size.height / 2;
    let layout = Layout::of(legend, font, height.saturating_sub(2 * margin));
    let [w, h] = layout.size;
    if w + 2 * margin > width || h + 2 * margin > height {
        return false;
    }
    let mut canvas = Canvas { frame, left: margin, top: height - margin - h, gain };
    canvas.fill([0, 0, w, h], [0.0; 3], PANEL);
    for &(rectangle, colour) in &layout.fills {
        canvas.fill(rectangle, colour, 1.0);
    }
    let style = MonoTextStyle::new(font, BinaryColor::On);
    for (left, top, text) in &layout.texts {
        let at = Point::new(*left as i32, *top as i32);
        let _ = Text::with_baseline(text, at, style, Baseline::Top).draw(&mut canvas);
    }
    true
}

impl Layout {
    /// A title, and colours with their texts below it, in at most `height` pixels if at all possible.
    fn of(legend: &Legend, font: &MonoFont<'_>, height: u32) -> Self {
        let line = font.character_size.height + font.character_size.height / 4;
        let pad = font.character_size.width;
        let mut layout = Self::default();
        layout.texts.push((pad, pad, legend.title.clone()));
        let top = pad + line;
        let bottom = match &legend.key {
            Key::Scale(range, table) => layout.scale(*range, [pad, top, line], &|share| table.at(share)),
            Key::Entries(entries) => layout.entries(entries, [pad, top, line], height.saturating_sub(pad)),
        };
        let right =
            layout.texts.iter().map(|(left, _, text)| left + font.character_size.width * text.len() as u32);
        layout.size = [right.max().unwrap_or(0) + pad, bottom + pad];
        layout
    }

    /// A bar from the highest value down, with numbers beside it. Returns where it ends.
    fn scale(
        &mut self,
        [low, high]: [f64; 2],
        [pad, top, line]: [u32; 3],
        colour: &dyn Fn(f64) -> [f32; 3],
    ) -> u32 {
        let length = LINES_PER_TICK * line * (TICKS - 1);
        let from_top = |step: u32| (step * length).div_ceil(TICKS - 1);
        for row in 0..length {
            let share = 1.0 - (f64::from(row) + 0.5) / f64::from(length);
            // Half a line lower, so that the first number is beside the end of the bar.
            self.fills.push(([pad, top + line / 2 + row, line, 1], colour(share)));
        }
        for step in 0..TICKS {
            let share = 1.0 - f64::from(step) / f64::from(TICKS - 1);
            let text = number(low + share * (high - low), high - low);
            self.texts.push((2 * pad + line, top + from_top(step), text));
        }
        top + length + line
    }

    /// A colour and a text a line; what does not fit is counted.
    fn entries(&mut self, entries: &[Entry], [pad, top, line]: [u32; 3], bottom: u32) -> u32 {
        let room = (bottom.saturating_sub(top) / line).max(1) as usize;
        let shown = if entries.len() > room { room - 1 } else { entries.len() };
        let mut at = top;
        for Entry { name, colour, .. } in &entries[..shown] {
            self.fills.push(([pad, at, line - line / 5, line - line / 5], *colour));
            self.texts.push((2 * pad + line, at, short(name)));
            at += line;
        }
        if shown < entries.len() {
            self.texts.push((pad, at, format!("and {} more", entries.len() - shown)));
            at += line;
        }
        at
    }
}

/// A number with as many digits as tell steps of a range apart.
fn number(value: f64, range: f64) -> String {
    let digits = if range > 0.0 { (2.0 - range.log10().floor()).clamp(0.0, 9.0) as usize } else { 3 };
    if value.abs() < 1e9 && (range == 0.0 || range > 1e-7) {
        format!("{value:.digits$}")
    } else {
        format!("{value:.3e}")
    }
}

/// The end of a long name, which says more than its beginning; letters that the font has none for become question marks.
fn short(name: &str) -> String {
    let letters: Vec<char> =
        name.chars().map(|c| if c.is_ascii() && !c.is_control() { c } else { '?' }).collect();
    if letters.len() <= LETTERS {
        return letters.into_iter().collect();
    }
    let end = &letters[letters.len() - (LETTERS - 2)..];
    format!("..{}", end.iter().collect::<String>())
}

/// The panel on a picture.
struct Canvas<'a> {
    frame: &'a mut Frame,
    left: u32,
    top: u32,
    gain: f32,
}

impl Canvas<'_> {
    fn put(&mut self, x: u32, y: u32, colour: [f32; 3], alpha: f32) {
        let index = (self.top + y) as usize * self.frame.window.width() as usize + (self.left + x) as usize;
        let pixel = &mut self.frame.color[index];
        for (channel, value) in colour.into_iter().enumerate() {
            pixel[channel] = pixel[channel] * (1.0 - alpha) + alpha * value / self.gain;
        }
        pixel[3] = pixel[3] * (1.0 - alpha) + alpha;
    }

    fn fill(&mut self, [left, top, width, height]: Rectangle, colour: [f32; 3], alpha: f32) {
        for (y, x) in (top..top + height).flat_map(|y| (left..left + width).map(move |x| (y, x))) {
            self.put(x, y, colour, alpha);
        }
    }
}

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.frame.window.width() - self.left, self.frame.window.height() - self.top)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let Size { width, height } = self.size();
        for Pixel(at, color) in pixels {
            let (Ok(x), Ok(y)) = (u32::try_from(at.x), u32::try_from(at.y)) else { continue };
            if color == BinaryColor::On && x < width && y < height {
                self.put(x, y, [1.0; 3], 1.0);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::palette::ColorMap;
    use super::*;
    use crate::image_io::PixelRect;

    fn frame(width: u32, height: u32) -> Frame {
        let count = (width * height) as usize;
        Frame {
            size: [width, height],
            window: PixelRect::of_picture(width, height),
            color: vec![[0.0; 4]; count],
            depth: vec![f32::INFINITY; count],
            layers: vec![],
        }
    }

    #[test]
    fn a_scale_shows_its_ends_and_stays_in_the_corner() {
        let legend =
            Legend { title: "elevation".to_owned(), key: Key::Scale([120.0, 480.0], ColorMap::Gray.table()) };
        let mut picture = frame(300, 300);
        assert!(draw_legend(&mut picture, &legend, 4.0));
        let drawn = |x: usize, y: usize| picture.color[y * 300 + x];
        assert_eq!(drawn(299, 0), [0.0; 4]);
        assert!(picture.color.iter().all(|p| p[0] <= 0.25 && p[3] <= 1.0), "the gain makes white of 1/4");
        let opaque = picture.color.iter().filter(|p| p[3] == 1.0).count();
        assert!(opaque > 1000, "{opaque}");
        assert!(!draw_legend(&mut frame(40, 40), &legend, 1.0));
    }

    #[test]
    fn entries_that_do_not_fit_are_counted() {
        let entry = |i: u8| Entry { number: i.into(), name: format!("{i}"), colour: [0.5; 3] };
        let entries: Vec<Entry> = (0..100).map(entry).collect();
        let legend = Legend { title: "scan".to_owned(), key: Key::Entries(entries) };
        let layout = Layout::of(&legend, &FONT_6X10, 150);
        assert!(layout.size[1] <= 150, "{:?}", layout.size);
        let last = &layout.texts.last().unwrap().2;
        assert_eq!(*last, format!("and {} more", 100 - (layout.texts.len() - 2)));
        assert!(draw_legend(&mut frame(200, 160), &legend, 1.0));
    }

    #[test]
    fn numbers_have_the_digits_that_differ() {
        assert_eq!(number(1_000_000.125, 0.5), "1000000.125");
        assert_eq!(number(480.0, 360.0), "480");
        assert_eq!(number(7.0, 0.0), "7.000");
        assert_eq!(number(2e12, 1e12), "2.000e12");
        assert_eq!(short("a/very/long/path/that/nobody/wants/to/read/scan-12.ply").len(), LETTERS);
        assert_eq!(short("Übung"), "?bung");
    }
}
