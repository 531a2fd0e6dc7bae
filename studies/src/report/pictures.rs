//! Pictures of the same scene by points and by samples, with the page of `compare` for each pair: a slider, the difference, the places
//! where they differ most.

use crate::common::draw;
use crate::common::picture::Picture;
use crate::common::point_sampling;
use crate::common::ray_reference::Tree;
use crate::common::scenes::{checker_ground, lit_spheres, stripes, wires};
use pointillist_cli::compare::{Page, compare};
use pointillist_cli::image_io::{Picture as Drawn, PixelRect};
use pointillist_render::Scene;
use std::fmt::Write as _;

/// Pixels along a side.
const SIZE: u32 = 256;

/// Samples along a side of a pixel.
const SIDE: u32 = 4;

/// The pairs, one shown at a time.
pub(super) fn frames() -> Result<String, Box<dyn std::error::Error + Send + Sync>> {
    let scenes: [(&str, Scene); 4] = [
        ("stripes to the horizon", stripes(SIZE, 400)),
        ("wires", wires(SIZE)),
        ("matt spheres", lit_spheres(SIZE)),
        ("a texture to the horizon", checker_ground(SIZE, false)),
    ];
    let samples = SIDE * SIDE;
    let mut choice = String::new();
    let mut frames = String::new();
    for (i, (name, scene)) in scenes.iter().enumerate() {
        let points = drawn(&draw::with_pipeline(scene)?);
        let sampled = drawn(&sampled(scene));
        let comparison = compare(&points, &sampled);
        let names = ["points", &format!("{samples} samples a pixel")];
        let page = Page { names, a: &points, b: &sampled, comparison: &comparison, exposure_ev: 0.0 };
        let mut html = vec![];
        page.write(&mut html)?;
        let (checked, hidden) = if i == 0 { (" checked", "") } else { ("", " hidden") };
        let _ = writeln!(
            choice,
            "<label><input type=\"radio\" name=\"picture\" value=\"picture-{i}\"{checked}>{name}</label>"
        );
        let _ = writeln!(
            frames,
            "<iframe id=\"picture-{i}\" title=\"{name}\" srcdoc=\"{}\"{hidden}></iframe>",
            in_attribute(&String::from_utf8(html)?)
        );
    }
    Ok(format!(
        "<p>Left the micropoints, with the settings that they have by default, right the same scene by {samples} samples a pixel, one in each \
         stratum. The slider goes from one to the other; below it are the places where they differ most.</p>\n\
         <div class=\"choice\">\n{choice}</div>\n{frames}<script>\n{CHOOSE}</script>\n"
    ))
}

/// Shows the chosen pair.
const CHOOSE: &str = "for (const input of document.querySelectorAll('[name=picture]')) {\n  \
    input.addEventListener('change', () => {\n    \
    for (const frame of document.querySelectorAll('#pictures iframe')) frame.hidden = frame.id !== input.value;\n  \
    });\n}\n";

fn sampled(scene: &Scene) -> Picture {
    let tree = Tree::new(scene);
    let visible = |at: &_, light: usize, sample| {
        let light = &scene.lights[light];
        if light.shadow { tree.transmittance(at, light.light.source(sample)) } else { 1.0 }
    };
    point_sampling::render(scene, SIDE, &visible)
}

fn drawn(picture: &Picture) -> Drawn {
    let height = picture.pixels.len() / picture.width;
    let window = PixelRect::of_picture(picture.width as u32, height as u32);
    let color = picture.pixels.iter().map(|c| [c.x as f32, c.y as f32, c.z as f32, 1.0]).collect();
    Drawn { size: [picture.width as u32, height as u32], window, color }
}

fn in_attribute(html: &str) -> String {
    html.replace('&', "&amp;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_page_within_a_page_keeps_its_marks() {
        assert_eq!(super::in_attribute("<a title=\"b &amp; c\">"), "<a title=&quot;b &amp;amp; c&quot;>");
    }
}
