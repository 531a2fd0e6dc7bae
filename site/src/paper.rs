//! The page behind a picture, and pictures as screens show them.

use crate::SiteError;
use crate::request::Request;
use glam::DVec3;

/// Linear light has more digits than a screen's bytes where it is dark: this many steps are half a byte apart there.
const STEPS: usize = 1 << 13;

/// The colour of the page, in linear light.
pub(crate) struct Paper {
    color: [f32; 3],
    /// What a screen shows of linear light from 0 to 1.
    bytes: Vec<u8>,
}

impl Paper {
    /// Three words: red, green and blue of the page as its style has them, 0 to 255.
    pub(crate) fn read(request: &mut Request<'_>) -> Result<Self, SiteError> {
        let given = request.vector("paper")?.clamp(DVec3::ZERO, DVec3::splat(255.0));
        let bytes = (0..=STEPS).map(|i| byte(i as f64 / STEPS as f64)).collect();
        Ok(Self { color: given.to_array().map(|v| linear(v / 255.0) as f32), bytes })
    }

    /// Bytes for pixels of linear light, premultiplied, over the page.
    pub(crate) fn under(&self, pixels: &[[f32; 4]]) -> Vec<u8> {
        let over = |&[r, g, b, a]: &[f32; 4]| {
            let [x, y, z] = self.color.map(|c| c * (1.0 - a));
            [self.byte(r + x), self.byte(g + y), self.byte(b + z), 255]
        };
        pixels.iter().flat_map(over).collect()
    }

    fn byte(&self, light: f32) -> u8 {
        // Casts saturate: NaN and what is negative are black.
        self.bytes[((light * STEPS as f32 + 0.5) as usize).min(STEPS)]
    }
}

/// sRGB (IEC 61966-2-1) to linear.
fn linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Linear to a byte of sRGB.
fn byte(light: f64) -> u8 {
    let value = if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * value).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_empty_has_the_color_of_the_page_to_the_byte() {
        for (r, g, b) in [(0, 0, 0), (255, 255, 255), (22, 25, 29), (247, 1, 130)] {
            let words = format!("{r} {g} {b}");
            let paper = Paper::read(&mut Request::new(words.as_bytes())).expect("three numbers");
            assert_eq!(paper.under(&[[0.0; 4]]), [r, g, b, 255]);
        }
    }
}
