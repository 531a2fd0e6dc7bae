//! Exposure brackets: several pictures of the same scene, joined to one of more range.

use crate::{Clipping, Response, ShError};

/// Joins pictures of equal size that were exposed differently. Each channel of a pixel is the mean of what the pictures say, weighted
/// by 2^−exposure: by the light that a picture collected, whose noise grows with its root. What is clipped in a picture, a channel
/// with the highest or the lowest level, counts only where no picture has it otherwise.
#[derive(Clone, Debug, Default)]
pub struct Brackets {
    /// `None` before the first picture, which may have no pixels.
    pixels: Option<Vec<[Channel; 3]>>,
}

/// What is known of a channel of a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    sum: f64,
    weight: f64,
    /// The largest radiance that was reached or exceeded.
    over: Option<f32>,
    /// The smallest radiance that was not exceeded.
    under: Option<f32>,
}

impl Channel {
    fn value(&self) -> f32 {
        match (self.over, self.under) {
            _ if self.weight > 0.0 => (self.sum / self.weight) as f32,
            (Some(over), _) => over,
            (None, under) => under.unwrap_or(0.0),
        }
    }
}

impl Brackets {
    /// Without a picture yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a photograph of 8-bit levels; exposure as in [`Response::radiance`]: of several, the darkest has the highest.
    ///
    /// # Errors
    /// `Exposure` unless it is from −64 to 64; `BracketSize` if there are not as many pixels as before.
    pub fn add_photograph(
        &mut self,
        pixels: &[[u8; 3]],
        response: &Response,
        exposure_ev: f32,
    ) -> Result<(), ShError> {
        let (known, weight) = self.accept(pixels.len(), exposure_ev)?;
        for (known, pixel) in known.iter_mut().zip(pixels) {
            for (channel, &level) in known.iter_mut().zip(pixel) {
                let radiance = response.radiance(level, exposure_ev);
                match level {
                    u8::MAX => channel.over = Some(channel.over.map_or(radiance, |most| most.max(radiance))),
                    0 => channel.under = Some(channel.under.map_or(radiance, |least| least.min(radiance))),
                    _ => {
                        channel.sum += weight * f64::from(radiance);
                        channel.weight += weight;
                    }
                }
            }
        }
        Ok(())
    }

    /// Adds a picture of linear radiance, in which nothing is clipped; it is multiplied by 2^`exposure_ev`.
    ///
    /// # Errors
    /// As [`Brackets::add_photograph`].
    pub fn add_radiance(&mut self, pixels: &[[f32; 3]], exposure_ev: f32) -> Result<(), ShError> {
        let (known, weight) = self.accept(pixels.len(), exposure_ev)?;
        let gain = f64::from(exposure_ev.exp2());
        for (known, pixel) in known.iter_mut().zip(pixels) {
            for (channel, &radiance) in known.iter_mut().zip(pixel) {
                channel.sum += weight * gain * f64::from(radiance);
                channel.weight += weight;
            }
        }
        Ok(())
    }

    /// What is known so far, for a picture of so many pixels, and what one of this exposure counts.
    fn accept(&mut self, count: usize, exposure_ev: f32) -> Result<(&mut [[Channel; 3]], f64), ShError> {
        if !(-64.0..=64.0).contains(&exposure_ev) {
            return Err(ShError::Exposure { exposure_ev });
        }
        let known = self.pixels.get_or_insert_with(|| vec![[Channel::default(); 3]; count]);
        let expected = known.len();
        if count != expected {
            return Err(ShError::BracketSize { count, expected });
        }
        Ok((known, f64::from(-exposure_ev).exp2()))
    }

    /// Radiance of all pixels, and the share of them of which a channel is clipped in every picture.
    #[must_use]
    pub fn merged(&self) -> (Vec<[f32; 3]>, Clipping) {
        let pixels = self.pixels.as_deref().unwrap_or_default();
        let mut clipping = Clipping::default();
        let share = 1.0 / pixels.len().max(1) as f64;
        for pixel in pixels {
            let unknown = |channel: &Channel| channel.weight == 0.0;
            if pixel.iter().any(|channel| unknown(channel) && channel.over.is_some()) {
                clipping.over_exposed += share;
            }
            if pixel.iter().all(|channel| unknown(channel) && channel.over.is_none()) {
                clipping.under_exposed += share;
            }
        }
        (pixels.iter().map(|pixel| pixel.map(|channel| channel.value())).collect(), clipping)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Levels of a photograph of this radiance.
    fn level(radiance: f32, exposure_ev: f32) -> u8 {
        (radiance * (-exposure_ev).exp2() * 255.0).round().clamp(0.0, 255.0) as u8
    }

    #[test]
    fn brackets_hold_what_no_picture_of_them_holds() {
        let scene = [[0.001_f32, 0.02, 0.4], [0.9, 3.0, 12.0]];
        let exposures = [-6.0, -3.0, 0.0, 4.0];
        let mut brackets = Brackets::new();
        for ev in exposures {
            let pixels = scene.map(|p| p.map(|v| level(v, ev)));
            brackets.add_photograph(&pixels, &Response::linear(), ev).unwrap();
        }
        let (merged, clipping) = brackets.merged();
        for (found, wanted) in merged.iter().flatten().zip(scene.iter().flatten()) {
            assert!((found / wanted - 1.0).abs() < 0.05, "{found} {wanted}");
        }
        assert_eq!(clipping, Clipping::default());
    }

    #[test]
    fn what_is_clipped_everywhere_is_at_its_bound() {
        let mut brackets = Brackets::new();
        for ev in [0.0, 2.0] {
            brackets.add_photograph(&[[255, 0, 100]], &Response::linear(), ev).unwrap();
        }
        let (merged, clipping) = brackets.merged();
        // A weighted mean of 100/255 and 400/255, with weights 1 and 1/4.
        let mean = (100.0 + 0.25 * 400.0) / 1.25 / 255.0;
        assert_eq!((merged[0][0], merged[0][1]), (4.0, 0.0));
        assert!((merged[0][2] - mean).abs() < 1e-6);
        assert_eq!((clipping.over_exposed, clipping.under_exposed), (1.0, 0.0));
    }

    #[test]
    fn one_picture_is_what_its_response_says() {
        let pixels: Vec<[u8; 3]> = (0..=255).map(|v| [v, 255 - v, v / 2]).collect();
        let mut brackets = Brackets::new();
        brackets.add_photograph(&pixels, &Response::srgb(), 1.5).unwrap();
        let (merged, clipping) = brackets.merged();
        let (alone, of_one) = Response::srgb().linearise(&pixels, 1.5).unwrap();
        assert!(merged.iter().flatten().zip(alone.iter().flatten()).all(|(a, b)| (a - b).abs() <= 1e-6 * b));
        assert!((clipping.over_exposed - of_one.over_exposed).abs() < 1e-12);
    }

    #[test]
    fn sizes_and_exposures_are_checked() {
        let mut brackets = Brackets::new();
        brackets.add_radiance(&[[1.0; 3]; 4], 0.0).unwrap();
        assert_eq!(
            brackets.add_radiance(&[[1.0; 3]; 3], 0.0),
            Err(ShError::BracketSize { count: 3, expected: 4 })
        );
        assert!(brackets.add_radiance(&[[1.0; 3]; 4], f32::NAN).is_err());
        assert!(brackets.add_radiance(&[[1.0; 3]; 4], 65.0).is_err());
        let (merged, _) = brackets.merged();
        assert_eq!(merged, [[1.0; 3]; 4]);
    }

    /// It counted for none, and the next one could have any size; found by fuzzing.
    #[test]
    fn a_picture_without_pixels_is_a_picture() {
        let mut brackets = Brackets::new();
        brackets.add_radiance(&[], 0.0).unwrap();
        let refused = ShError::BracketSize { count: 1, expected: 0 };
        assert_eq!(brackets.add_photograph(&[[0; 3]], &Response::linear(), 0.0), Err(refused));
    }
}
