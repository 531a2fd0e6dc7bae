//! Which points of clouds are drawn, and in which colours: what `scan` and `surfel` share.

use super::values;
use crate::coordinate::LARGEST;
use crate::error::CliError;
use crate::points::{ColorBy, ColorMap, Colouring, Selection, WorldBox};
use glam::DVec3;
use std::str::FromStr;

/// Which points are drawn, and in which colours.
#[derive(Clone, Debug, clap::Args)]
#[command(next_help_heading = "Points")]
pub struct CloudLook {
    /// What points are coloured by
    #[arg(long, value_name = "WHAT", default_value = "rgb")]
    pub color_by: ColorBy,
    /// Colours of values (default: viridis)
    #[arg(long, value_name = "NAME")]
    pub color_map: Option<ColorMap>,
    /// Values at both ends of the map (default: such that 1 % of the points are beyond each)
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true)]
    pub color_range: Option<RangeValue>,
    /// Draw what colours mean into the lower left corner of a PNG or JPEG
    #[arg(long)]
    pub legend: bool,
    /// Only points in this box of the world; several boxes take the points of all
    #[arg(long = "box", value_name = "X,Y,Z,X,Y,Z", allow_hyphen_values = true)]
    pub boxes: Vec<BoxValue>,
    /// No points in this box of the world
    #[arg(long = "drop-box", value_name = "X,Y,Z,X,Y,Z", allow_hyphen_values = true)]
    pub dropped_boxes: Vec<BoxValue>,
    /// Only points of these classes, such as 2,6 for ground and buildings of LAS
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = values::whole::<u8>(0..=u8::MAX))]
    pub classes: Vec<u8>,
    /// No points of these classes, such as 7,18 for noise of LAS
    #[arg(long = "drop-classes", value_name = "LIST", value_delimiter = ',', value_parser = values::whole::<u8>(0..=u8::MAX))]
    pub dropped_classes: Vec<u8>,
}

/// A box by two opposite corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxValue(WorldBox);

impl FromStr for BoxValue {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = values::list(text, ',', "two corners such as 0,0,0,10,10,5")?;
        let &[a, b, c, d, e, f] = numbers.as_slice() else {
            return Err(format!("{} numbers; a box has six: X,Y,Z of two opposite corners", numbers.len()));
        };
        // Without a limit: a box may be open on a side.
        if numbers.iter().any(|number| number.is_nan()) {
            return Err("a corner must be numbers; inf and -inf leave a side open".to_owned());
        }
        let (p, q) = (DVec3::new(a, b, c), DVec3::new(d, e, f));
        Ok(Self(WorldBox { low: p.min(q), high: p.max(q) }))
    }
}

/// Two different values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RangeValue([f64; 2]);

impl FromStr for RangeValue {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = values::list(text, ',', "two numbers such as 100,250")?;
        match numbers[..] {
            [low, high] if low < high && low.abs() <= LARGEST && high.abs() <= LARGEST => {
                Ok(Self([low, high]))
            }
            [_, _] => Err("must be two finite numbers, the smaller first".to_owned()),
            _ => Err(format!("{} numbers; two are needed, such as 100,250", numbers.len())),
        }
    }
}

impl CloudLook {
    /// Which points are drawn.
    #[must_use]
    pub fn selection(&self) -> Selection {
        let boxes = |values: &[BoxValue]| values.iter().map(|value| value.0).collect();
        Selection {
            boxes: boxes(&self.boxes),
            dropped_boxes: boxes(&self.dropped_boxes),
            classes: self.classes.clone(),
            dropped_classes: self.dropped_classes.clone(),
        }
    }

    /// How they are coloured.
    ///
    /// # Errors
    ///
    /// [`CliError::Usage`] for options that have no effect on colours by this.
    pub fn colouring(&self) -> Result<Colouring, CliError> {
        let by = self.color_by;
        let usage = |message: &str| Err(CliError::Usage(message.to_owned()));
        if !by.has_range() && (self.color_map.is_some() || self.color_range.is_some()) {
            return usage("--color-map and --color-range are for --color-by intensity, elevation, x and y");
        }
        if self.legend && !by.has_legend() {
            return usage(
                "--legend: there is nothing to say about these colours; add --color-by elevation, class, …",
            );
        }
        Ok(Colouring {
            by,
            range: self.color_range.map(|range| range.0),
            map: self.color_map.unwrap_or(ColorMap::Viridis),
        })
    }
}
