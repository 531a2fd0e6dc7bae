//! Colours for values and for classes.

use clap::ValueEnum;
use colorgrad::{Color, Gradient, preset};

/// A map from values to colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ColorMap {
    /// Dark blue over green to yellow; even steps of lightness, also for the colour-blind
    Viridis,
    /// The rainbow with even steps
    Turbo,
    /// Blue to yellow, made for the colour-blind
    Cividis,
    /// Black over red to light yellow
    Inferno,
    /// Black to white
    Gray,
    /// Red over yellow to blue
    Spectral,
}

/// Linear colours of a map at even steps.
#[derive(Clone, Debug)]
pub struct MapTable(Vec<[f32; 3]>);

/// Steps of a table: more than an 8-bit picture can tell apart.
const STEPS: usize = 1024;

impl ColorMap {
    /// The map at even steps.
    #[must_use]
    pub fn table(self) -> MapTable {
        let along = |gradient: &dyn Gradient| {
            let at = |step: usize| linear(&gradient.at(step as f32 / (STEPS - 1) as f32));
            MapTable((0..STEPS).map(at).collect())
        };
        match self {
            Self::Viridis => along(&preset::viridis()),
            Self::Turbo => along(&preset::turbo()),
            Self::Cividis => along(&preset::cividis()),
            Self::Inferno => along(&preset::inferno()),
            Self::Spectral => along(&preset::spectral()),
            Self::Gray => {
                let gray = |step: usize| {
                    let level = step as f32 / (STEPS - 1) as f32;
                    linear(&Color::new(level, level, level, 1.0))
                };
                MapTable((0..STEPS).map(gray).collect())
            }
        }
    }
}

impl MapTable {
    /// The colour at `share` of the range, from 0 to 1; beyond, that of the nearest end. Grey for NaN.
    #[must_use]
    pub fn at(&self, share: f64) -> [f32; 3] {
        if share.is_nan() {
            return UNKNOWN;
        }
        // The cast ends at 0 and the largest number.
        self.0[((share * (STEPS - 1) as f64 + 0.5) as usize).min(STEPS - 1)]
    }
}

/// Colour of points without a value.
pub(super) const UNKNOWN: [f32; 3] = [0.2; 3];

/// Names and colours of the classes of the ASPRS that have one (LAS 1.4 R15, table 17).
const CLASSES: [(u8, &str, [u8; 3]); 19] = [
    (0, "never classified", [160, 160, 160]),
    (1, "unclassified", [190, 190, 190]),
    (2, "ground", [166, 118, 72]),
    (3, "low vegetation", [170, 214, 120]),
    (4, "medium vegetation", [92, 174, 82]),
    (5, "high vegetation", [22, 112, 50]),
    (6, "building", [216, 84, 62]),
    (7, "low noise", [255, 0, 255]),
    (8, "key point", [240, 220, 90]),
    (9, "water", [60, 130, 220]),
    (10, "rail", [120, 84, 140]),
    (11, "road surface", [96, 98, 104]),
    (13, "wire guard", [250, 200, 40]),
    (14, "wire conductor", [250, 150, 20]),
    (15, "transmission tower", [130, 60, 190]),
    (16, "wire connector", [230, 110, 160]),
    (17, "bridge deck", [150, 170, 200]),
    (18, "high noise", [180, 0, 120]),
    (20, "ignored ground", [120, 92, 66]),
];

/// Name of a class, if the ASPRS gave it one.
#[must_use]
pub fn class_name(class: f32) -> Option<&'static str> {
    CLASSES.iter().find(|(number, ..)| f32::from(*number) == class).map(|(_, name, _)| *name)
}

/// Linear colour of a class.
#[must_use]
pub(super) fn class_colour(class: f32) -> [f32; 3] {
    let known = CLASSES.iter().find(|(number, ..)| f32::from(*number) == class);
    match known {
        Some((_, _, [r, g, b])) => linear(&Color::from_rgba8(*r, *g, *b, 255)),
        None => number_colour(class),
    }
}

/// Linear colour of a whole number, unlike those of its neighbours; grey for NaN.
#[must_use]
pub(super) fn number_colour(number: f32) -> [f32; 3] {
    /// Steps around the circle of hues that come nowhere near each other for long: the golden section.
    const STEP: f32 = 0.618_034;
    if number.is_nan() {
        return UNKNOWN;
    }
    linear(&preset::sinebow().at((number * STEP + 0.05).rem_euclid(1.0)))
}

fn linear(color: &Color) -> [f32; 3] {
    let [r, g, b, _] = color.to_linear_rgba();
    [r, g, b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_go_from_end_to_end_and_are_in_range() {
        for map in ColorMap::value_variants() {
            let table = map.table();
            assert_eq!(table.at(-3.0), table.at(0.0));
            assert_eq!(table.at(7.0), table.at(1.0));
            assert_ne!(table.at(0.0), table.at(1.0));
            assert_eq!(table.at(f64::NAN), UNKNOWN);
            assert!(table.0.iter().flatten().all(|channel| (0.0..=1.0).contains(channel)), "{map:?}");
        }
    }

    #[test]
    fn classes_have_colours_of_their_own() {
        let colours: Vec<_> = CLASSES.iter().map(|(class, ..)| class_colour(f32::from(*class))).collect();
        for (i, colour) in colours.iter().enumerate() {
            assert!(!colours[..i].contains(colour), "{:?}", CLASSES[i]);
        }
        assert_eq!(class_name(6.0), Some("building"));
        assert_eq!(class_name(64.0), None);
        assert_ne!(class_colour(64.0), class_colour(65.0));
    }
}
