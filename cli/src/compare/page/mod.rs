//! A page about two pictures: one under the other with a slider between them, their difference, where it is largest, and the numbers.
//!
//! Everything is within the page. It forbids itself to load anything, so it says the same wherever it is opened, and tells nobody.

mod images;
mod words;

use super::worst::worst_places;
use super::{Comparison, Differences};
use crate::image_io::{Picture, PixelRect};
use images::{Images, Kind};
use std::io::{self, Write};
use words::{escaped, short};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// A picture that is smaller is shown larger, by a whole number, up to this width and height in pixels of a style sheet.
const SHOWN: [u32; 2] = [1024, 640];

/// What a page is about.
#[derive(Clone, Copy, Debug)]
pub struct Page<'p> {
    /// The names of both pictures.
    pub names: [&'p str; 2],
    /// The first picture.
    pub a: &'p Picture,
    /// The second, as large.
    pub b: &'p Picture,
    /// What [`compare`](super::compare) says about them.
    pub comparison: &'p Comparison,
    /// Stops by which both are shown brighter.
    pub exposure_ev: f32,
}

impl Page<'_> {
    /// Writes the page.
    ///
    /// # Errors
    ///
    /// What the output says.
    pub fn write(&self, output: &mut dyn Write) -> io::Result<()> {
        let places = worst_places(self.comparison);
        let images = Images::new(self);
        self.write_head(output)?;
        self.write_stage(output, &images, &places)?;
        write_numbers(output, &self.comparison.differences)?;
        self.write_places(output, &images, &places)?;
        writeln!(output, "</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>")
    }

    fn write_head(&self, output: &mut dyn Write) -> io::Result<()> {
        let [a, b] = self.names.map(escaped);
        let Differences { width, height, .. } = self.comparison.differences;
        writeln!(
            output,
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; \
             style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n\
             <meta name=\"generator\" content=\"pointillist {}\">\n\
             <title>{a} and {b}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             <h1><span class=\"name\">A: {a}</span> <span class=\"name\">B: {b}</span></h1>\n\
             <p class=\"about\">{width} × {height} pixels{}</p>",
            env!("CARGO_PKG_VERSION"),
            self.brightened(),
        )
    }

    /// What is to be said about the exposure.
    fn brightened(&self) -> String {
        match self.exposure_ev {
            0.0 => String::new(),
            ev => format!(", shown with an exposure of {ev} EV; numbers are of the pictures as they are"),
        }
    }

    /// All four pictures one above the other, of which the chosen ones are seen.
    fn write_stage(&self, output: &mut dyn Write, images: &Images, places: &[PixelRect]) -> io::Result<()> {
        let [width, height] = self.a.size;
        let larger = (SHOWN[0] / width).min(SHOWN[1] / height).max(1);
        writeln!(output, "<form class=\"views\" aria-label=\"What is shown\">")?;
        let views = ["slide", "a", "b", "difference", "flip"];
        for (view, label) in views.into_iter().zip(["Slider", "A", "B", "Difference", "FLIP"]) {
            let checked = if view == "slide" { " checked" } else { "" };
            writeln!(
                output,
                "<label><input type=\"radio\" name=\"view\" value=\"{view}\"{checked}><span>{label}</span></label>"
            )?;
        }
        let marks =
            "<label class=\"mark\"><input type=\"checkbox\" id=\"marks\"><span>Mark places</span></label>";
        writeln!(output, "{}</form>", if places.is_empty() { "" } else { marks })?;
        let pixels = if larger > 1 { " enlarged" } else { "" };
        writeln!(
            output,
            "<figure class=\"stage{pixels}\" id=\"stage\" data-view=\"slide\" style=\"max-width:{}px\">",
            width * larger
        )?;
        for kind in Kind::ALL {
            let (class, name) = (kind.class(), kind.name());
            write!(
                output,
                "<img class=\"{class}\" width=\"{width}\" height=\"{height}\" alt=\"{name}\" src=\""
            )?;
            images.write(output, kind, PixelRect::of_picture(width, height))?;
            writeln!(output, "\">")?;
        }
        for (number, place) in places.iter().enumerate() {
            self.write_mark(output, number + 1, *place)?;
        }
        writeln!(
            output,
            "<div class=\"edge\" aria-hidden=\"true\"></div>\n\
             <input class=\"slider\" id=\"slider\" type=\"range\" min=\"0\" max=\"100\" step=\"0.1\" value=\"50\" \
             aria-label=\"Share of the width that shows A; the rest shows B\">\n</figure>\n\
             <p class=\"legend\" id=\"legend\" aria-live=\"polite\"></p>"
        )
    }

    /// A frame about a place, in shares of the picture so that it grows with it.
    fn write_mark(&self, output: &mut dyn Write, number: usize, place: PixelRect) -> io::Result<()> {
        let [width, height] = self.a.size.map(f64::from);
        // The number stands above the frame, but not outside of the picture.
        let class = if f64::from(place.y0) < 0.1 * height { "place top" } else { "place" };
        let percent = |n: u32, of: f64| format!("{:.3}%", 100.0 * f64::from(n) / of);
        writeln!(
            output,
            "<div class=\"{class}\" style=\"left:{};top:{};width:{};height:{}\"><span>{number}</span></div>",
            percent(place.x0, width),
            percent(place.y0, height),
            percent(place.width(), width),
            percent(place.height(), height),
        )
    }

    /// The places, enlarged, in all four pictures.
    fn write_places(&self, output: &mut dyn Write, images: &Images, places: &[PixelRect]) -> io::Result<()> {
        writeln!(output, "<h2>Where they differ most</h2>")?;
        if places.is_empty() {
            return writeln!(output, "<p>Nowhere: all pixels are equal.</p>");
        }
        for (index, place) in places.iter().enumerate() {
            let why = if index == 0 { "the largest difference" } else { "much FLIP" };
            writeln!(
                output,
                "<section class=\"crop\">\n<h3>{}: {why}, columns {} to {}, rows {} to {}</h3>\n<div class=\"row\">",
                index + 1,
                place.x0,
                place.x1 - 1,
                place.y0,
                place.y1 - 1,
            )?;
            for kind in Kind::ALL {
                let (width, height, name) = (place.width(), place.height(), kind.name());
                write!(
                    output,
                    "<figure><img width=\"{width}\" height=\"{height}\" alt=\"{name}, place {}\" src=\"",
                    index + 1
                )?;
                images.write(output, kind, *place)?;
                writeln!(output, "\"><figcaption>{name}</figcaption></figure>")?;
            }
            writeln!(output, "</div>\n</section>")?;
        }
        Ok(())
    }
}

/// The numbers of the JSON under the same names; `value` has all digits.
fn write_numbers(output: &mut dyn Write, differences: &Differences) -> io::Result<()> {
    let d = differences;
    let pixel = format!("at column {}, row {}", d.max_pixel[0], d.max_pixel[1]);
    let psnr = if d.psnr.is_some() { "dB, of 1 as the largest" } else { "the pictures are equal" };
    let rows = [
        ("rmse", "RMSE", Some(d.rmse), "root of the mean square"),
        ("mae", "MAE", Some(d.mae), "mean of the absolute difference"),
        ("bias", "Bias", Some(d.bias), "mean of A − B"),
        ("max", "Largest", Some(d.max), &pixel),
        ("psnr", "PSNR", d.psnr, psnr),
        ("flip", "FLIP", Some(d.flip), "mean of what is seen when flipping between them, 0 to 1"),
    ];
    writeln!(output, "<h2>Numbers</h2>\n<table>")?;
    for (key, name, value, about) in rows {
        let (exact, shown) = match value {
            Some(value) => (serde_json::to_string(&value)?, short(value)),
            None => ("null".to_owned(), "∞".to_owned()),
        };
        writeln!(
            output,
            "<tr><th scope=\"row\">{name}</th><td><data id=\"{key}\" value=\"{exact}\">{shown}</data></td><td>{about}</td></tr>"
        )?;
    }
    writeln!(output, "</table>")?;
    if d.nonfinite > 0 {
        writeln!(
            output,
            "<p class=\"warning\"><data id=\"nonfinite\" value=\"{0}\">{0}</data> numbers are not finite; they count as 0.</p>",
            d.nonfinite
        )?;
    }
    writeln!(
        output,
        "<p class=\"about\">Over linear red, green and blue. The picture of the difference is brightened so that the \
         largest is white; FLIP goes from black (equal) over red to pale yellow.</p>"
    )
}
