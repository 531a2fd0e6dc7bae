//! The textures of the built-in scene.

use crate::scene::textures::Purpose;
use crate::scene::{Texture, srgb_from_linear};

/// All of them, by the names that the scene file uses.
pub(super) fn all() -> Vec<(&'static str, Purpose, Texture)> {
    let color = Purpose::Color { srgb: true };
    vec![("floor texture", color, floor()), ("sky texture", color, sky())]
}

fn texture(name: &str, width: u32, height: u32, color: impl Fn(u32, u32) -> [f32; 3]) -> Texture {
    let byte = |c: f32| (srgb_from_linear(c) * 255.0 + 0.5) as u8;
    Texture::from_srgb(name, [width, height], |x, y| color(x, y).map(byte))
}

/// A chequered floor, no two tiles quite alike.
fn floor() -> Texture {
    texture("floor texture", 8, 8, |x, y| {
        // A multiplicative hash; only its look matters.
        let noise = (x * 8 + y + 1).wrapping_mul(2_654_435_761) >> 24;
        let shade = 1.0 + 0.16 * (noise as f32 / 255.0 - 0.5);
        let light = (x + y) % 2 == 0;
        let tile = if light { [0.52, 0.48, 0.42] } else { [0.16, 0.145, 0.13] };
        tile.map(|c| c * shade)
    })
}

/// Haze: white at the horizon, nothing above; row 0 is the top.
fn sky() -> Texture {
    const ROWS: u32 = 256;
    texture("sky texture", 1, ROWS, |_, y| {
        let height = 1.0 - (y as f32 + 0.5) / ROWS as f32;
        let haze = (-6.6 * height).exp();
        [haze, 0.93 * haze, 0.82 * haze]
    })
}
