//! Colours of points by what was measured, where they are, or whose they are.

use super::palette::{ColorMap, MapTable, class_colour, class_name, number_colour};
use crate::cloud_io::Scalar;
use clap::ValueEnum;
use glam::DVec3;
use pointillist_render::linear_from_srgb;

/// What points are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ColorBy {
    /// The colours of the file
    #[default]
    Rgb,
    /// Strength of the return
    Intensity,
    /// Class, in the colours that are usual for those of LAS
    #[value(alias = "classification")]
    Class,
    /// Number of the return
    #[value(alias = "return-number")]
    Return,
    /// Coordinate z, which is up in surveys
    #[value(alias = "z")]
    Elevation,
    /// Coordinate x
    X,
    /// Coordinate y
    Y,
    /// Which scan or file a point is of
    Scan,
    /// Direction of the surface, as (n + 1) / 2 in red, green and blue; without light
    #[value(alias = "normals")]
    Normal,
}

/// How points are coloured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colouring {
    /// By what.
    pub by: ColorBy,
    /// Values at both ends of the map; without, such that 1 % of the points are beyond each.
    pub range: Option<[f64; 2]>,
    /// Colours of values.
    pub map: ColorMap,
}

/// Points that came from the same place.
#[derive(Debug)]
pub struct Part<'a> {
    /// In the world.
    pub positions: &'a [DVec3],
    /// What was measured, if the colours are made of it.
    pub values: &'a [f32],
    /// Name of the scan or file.
    pub name: &'a str,
    /// Its number among all, from 0.
    pub number: usize,
}

/// What a colour means.
#[derive(Clone, Debug)]
pub struct Legend {
    /// What is shown.
    pub title: String,
    /// The colours.
    pub key: Key,
}

/// Colours and their values.
#[derive(Clone, Debug)]
pub enum Key {
    /// From the first value to the last.
    Scale([f64; 2], MapTable),
    /// One by one.
    Entries(Vec<Entry>),
}

/// A value with a colour of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The value, by which entries are sorted.
    pub number: f32,
    /// What it is called.
    pub name: String,
    /// Its colour, linear.
    pub colour: [f32; 3],
}

impl Legend {
    /// What colours mean of which these say it in part.
    #[must_use]
    pub fn merged<'a>(legends: impl IntoIterator<Item = &'a Self>) -> Option<Self> {
        let mut legends = legends.into_iter();
        let mut all = legends.next()?.clone();
        if let Key::Entries(entries) = &mut all.key {
            for legend in legends {
                let Key::Entries(more) = &legend.key else { continue };
                for entry in more {
                    if let Err(at) = entries.binary_search_by(|e| e.number.total_cmp(&entry.number)) {
                        entries.insert(at, entry.clone());
                    }
                }
            }
        }
        Some(all)
    }
}

/// Share of the points beyond each end of the map, so that a few outliers do not take up most of it.
const BEYOND: f64 = 0.01;

impl ColorBy {
    /// The measured value that this needs.
    #[must_use]
    pub const fn scalar(self) -> Option<Scalar> {
        match self {
            Self::Intensity => Some(Scalar::Intensity),
            Self::Class => Some(Scalar::Class),
            Self::Return => Some(Scalar::Return),
            _ => None,
        }
    }

    /// Whether a map with a range says what colours mean.
    #[must_use]
    pub const fn has_range(self) -> bool {
        matches!(self, Self::Intensity | Self::Elevation | Self::X | Self::Y)
    }

    /// Whether there is a legend to draw.
    #[must_use]
    pub const fn has_legend(self) -> bool {
        !matches!(self, Self::Rgb | Self::Normal)
    }
}

impl Colouring {
    /// The same with the range of a scale that was found, for points that are coloured apart from others.
    #[must_use]
    pub fn as_in(self, legend: Option<&Legend>) -> Self {
        match legend.map(|legend| &legend.key) {
            Some(Key::Scale(range, _)) => Self { range: Some(*range), ..self },
            _ => self,
        }
    }

    /// The linear colours of all parts, and what they mean; nothing if points keep their own.
    #[must_use]
    pub fn colours(&self, parts: &[Part<'_>]) -> Option<(Vec<Vec<[f32; 3]>>, Legend)> {
        let axis = |axis: usize, title: &str| self.scale(parts, title, |part, i| part.positions[i][axis]);
        let measured = |part: &Part<'_>, i: usize| part.values[i];
        let made = match self.by {
            ColorBy::Rgb | ColorBy::Normal => return None,
            ColorBy::Intensity => self.scale(parts, "intensity", |part, i| f64::from(measured(part, i))),
            ColorBy::Elevation => axis(2, "elevation"),
            ColorBy::X => axis(0, "x"),
            ColorBy::Y => axis(1, "y"),
            ColorBy::Class => by_number(parts, "class", class_colour, |class| {
                class_name(class).map_or_else(|| format!("{class}"), |name| format!("{class} {name}"))
            }),
            ColorBy::Return => by_number(parts, "return", number_colour, |number| format!("{number}")),
            ColorBy::Scan => by_scan(parts),
        };
        Some(made)
    }

    fn scale(
        &self,
        parts: &[Part<'_>],
        title: &str,
        value: impl Fn(&Part<'_>, usize) -> f64,
    ) -> (Vec<Vec<[f32; 3]>>, Legend) {
        let values = |part| (0..len(part)).map(|i| value(part, i)).collect::<Vec<f64>>();
        let values: Vec<Vec<f64>> = parts.iter().map(values).collect();
        let [low, high] = self.range.unwrap_or_else(|| usual_range(values.iter().flatten()));
        let table = self.map.table();
        // In the middle if all values are the same.
        let share = |value: f64| if high > low { (value - low) / (high - low) } else { 0.5 + 0.0 * value };
        let colours = values.iter().map(|part| part.iter().map(|&v| table.at(share(v))).collect()).collect();
        (colours, Legend { title: title.to_owned(), key: Key::Scale([low, high], table) })
    }
}

fn len(part: &Part<'_>) -> usize {
    part.positions.len()
}

/// Values that a share of [`BEYOND`] of the points is below and above.
fn usual_range<'a>(values: impl Iterator<Item = &'a f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.copied().filter(|value| value.is_finite()).collect();
    if values.is_empty() {
        return [0.0, 1.0];
    }
    let beyond = (BEYOND * values.len() as f64) as usize;
    let last = values.len() - 1 - beyond;
    [beyond, last].map(|rank| *values.select_nth_unstable_by(rank, f64::total_cmp).1)
}

/// Colours of whole numbers; the legend has those that occur, in their order.
fn by_number(
    parts: &[Part<'_>],
    title: &str,
    colour: impl Fn(f32) -> [f32; 3],
    name: impl Fn(f32) -> String,
) -> (Vec<Vec<[f32; 3]>>, Legend) {
    let mut known: Vec<(f32, [f32; 3])> = vec![];
    let mut colours = Vec::with_capacity(parts.len());
    for part in parts {
        let mut of_part = Vec::with_capacity(part.values.len());
        for &value in part.values {
            // `total_cmp`, so that NaN is found again; -0 counts as 0.
            let value = value + 0.0;
            let at = known.binary_search_by(|(number, _)| number.total_cmp(&value)).unwrap_or_else(|at| {
                known.insert(at, (value, colour(value)));
                at
            });
            of_part.push(known[at].1);
        }
        colours.push(of_part);
    }
    let named = |(number, colour): (f32, _)| Entry {
        number,
        name: if number.is_nan() { "none".to_owned() } else { name(number) },
        colour,
    };
    let key = Key::Entries(known.into_iter().map(named).collect());
    (colours, Legend { title: title.to_owned(), key })
}

fn by_scan(parts: &[Part<'_>]) -> (Vec<Vec<[f32; 3]>>, Legend) {
    let entry = |part: &Part<'_>| {
        let number = part.number as f32;
        Entry { number, name: part.name.to_owned(), colour: number_colour(number) }
    };
    let entries: Vec<Entry> = parts.iter().map(entry).collect();
    let colours = parts.iter().zip(&entries).map(|(part, entry)| vec![entry.colour; len(part)]).collect();
    (colours, Legend { title: "scan".to_owned(), key: Key::Entries(entries) })
}

/// A colour that says where a surface points, with the opacity of `drawn`.
#[must_use]
pub(super) fn normal_colour(drawn: [f32; 4], normal: [f32; 3]) -> [f32; 4] {
    let alpha = drawn[3];
    let [r, g, b] = normal.map(|n| alpha * linear_from_srgb((0.5 * n + 0.5).clamp(0.0, 1.0)));
    [r, g, b, alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn colours(by: ColorBy, values: &[f32], range: Option<[f64; 2]>) -> (Vec<[f32; 3]>, Legend) {
        let positions: Vec<DVec3> = (0..values.len()).map(|i| DVec3::new(0.0, 0.0, 1e6 + i as f64)).collect();
        let part = Part { positions: &positions, values, name: "a.las", number: 0 };
        let colouring = Colouring { by, range, map: ColorMap::Gray };
        let (mut colours, legend) = colouring.colours(&[part]).unwrap();
        (colours.pop().unwrap(), legend)
    }

    #[test]
    fn outliers_do_not_stretch_the_map() {
        let mut values: Vec<f32> = (0..1000).map(|i| i as f32).collect();
        values[999] = 1e9;
        values[500] = f32::NAN;
        let (gray, legend) = colours(ColorBy::Intensity, &values, None);
        let Key::Scale([low, high], _) = legend.key else { panic!("{legend:?}") };
        assert!((5.0..15.0).contains(&low) && (985.0..995.0).contains(&high), "{low} {high}");
        assert_eq!((gray[0], gray[999]), ([0.0; 3], [1.0; 3]));
        assert_eq!(gray[500], super::super::palette::UNKNOWN);
        let (gray, _) = colours(ColorBy::Intensity, &values, Some([0.0, 2.0]));
        assert_eq!((gray[0], gray[2], gray[3]), ([0.0; 3], [1.0; 3], [1.0; 3]));
    }

    #[test]
    fn elevation_is_fine_at_large_coordinates() {
        let (gray, _) = colours(ColorBy::Elevation, &[0.0; 5], Some([1e6, 1e6 + 4.0]));
        let wanted = [0.0, 0.25, 0.5, 0.75, 1.0].map(linear_from_srgb);
        for (found, wanted) in gray.iter().zip(wanted) {
            assert!((found[0] - wanted).abs() < 2e-3, "{found:?} {wanted}");
        }
        let (same, _) = colours(ColorBy::X, &[0.0; 3], None);
        assert_eq!(same[0], same[2]);
    }

    #[test]
    fn a_legend_has_the_classes_that_occur() {
        let (found, legend) = colours(ColorBy::Class, &[6.0, 2.0, 6.0, f32::NAN, 77.0, -0.0, 0.0], None);
        assert_eq!(found[0], found[2]);
        let Key::Entries(entries) = legend.key else { panic!("{legend:?}") };
        let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        assert_eq!(names, ["0 never classified", "2 ground", "6 building", "77", "none"]);
    }

    #[test]
    fn legends_of_parts_are_that_of_the_whole() {
        let all = [6.0, 2.0, f32::NAN, 77.0, 0.0, 6.0, 2.0];
        let whole = colours(ColorBy::Class, &all, None).1;
        let parts = all.chunks(2).map(|part| colours(ColorBy::Class, part, None).1).collect::<Vec<_>>();
        let merged = Legend::merged(&parts).unwrap();
        let names = |legend: &Legend| match &legend.key {
            Key::Entries(entries) => entries.iter().map(|entry| entry.name.clone()).collect::<Vec<_>>(),
            Key::Scale(..) => vec![],
        };
        assert!(names(&whole).len() == 5 && names(&merged) == names(&whole), "{merged:?}");
        assert!(Legend::merged([]).is_none());
        let scale = colours(ColorBy::Elevation, &all, None).1;
        let colouring = Colouring { by: ColorBy::Elevation, range: None, map: ColorMap::Gray };
        assert_eq!(colouring.as_in(Some(&scale)).range, Some([1e6, 1e6 + 6.0]));
        assert_eq!(colouring.as_in(None).range, None);
    }

    #[test]
    fn normals_become_colours_under_their_opacity() {
        let half = linear_from_srgb(0.5);
        assert_eq!(normal_colour([0.3, 0.2, 0.1, 0.5], [0.0, 0.0, 1.0]), [0.5 * half, 0.5 * half, 0.5, 0.5]);
        assert_eq!(normal_colour([0.0; 4], [0.0; 3]), [0.0; 4]);
    }
}
