//! Values of options: vectors, sizes, windows, tiles.

use crate::coordinate::LARGEST;
use crate::image_io::{Bits, PixelRect};
use pointillist_render::linear_from_srgb;
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Three finite numbers, as in `1,2.5,-3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vector(pub [f64; 3]);

impl FromStr for Vector {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Vec<f64> = list(text, ',', "three numbers such as 1,2.5,-3")?;
        match numbers[..] {
            [x, y, z] if numbers.iter().all(|n| n.abs() <= LARGEST) => Ok(Self([x, y, z])),
            [_, _, _] => Err(format!("numbers must be finite, and at most {LARGEST:e}")),
            _ => Err(format!("{} numbers; three are needed, such as 1,2.5,-3", numbers.len())),
        }
    }
}

/// A linear colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [f32; 3]);

impl FromStr for Colour {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WANTED: &str =
            "must be a colour such as ff8000 or f80 (as on the web), 0.5,0.5,0.5 (linear), white or black";
        match text {
            "white" => return Ok(Self([1.0; 3])),
            "black" => return Ok(Self([0.0; 3])),
            _ => {}
        }
        if text.contains(',') {
            let numbers: Vec<f32> = list(text, ',', "three numbers such as 0.5,0.5,0.5")?;
            return match numbers[..] {
                // What a half of an EXR can hold.
                [r, g, b] if numbers.iter().all(|n| (0.0..=65504.0).contains(n)) => Ok(Self([r, g, b])),
                [_, _, _] => Err("numbers must be from 0 to 65504".to_owned()),
                _ => Err(format!("{} numbers; three are needed", numbers.len())),
            };
        }
        // Most shells take an unquoted `#` for the beginning of a comment, so it may be left out.
        let digits = text.strip_prefix('#').unwrap_or(text);
        let digits: Option<Vec<u8>> = digits.chars().map(|c| Some(c.to_digit(16)? as u8)).collect();
        let levels = match digits.as_deref() {
            Some(&[r, g, b]) => [17 * r, 17 * g, 17 * b],
            Some(&[r, s, g, h, b, c]) => [16 * r + s, 16 * g + h, 16 * b + c],
            _ => return Err(WANTED.to_owned()),
        };
        Ok(Self(levels.map(|level| linear_from_srgb(f32::from(level) / 255.0))))
    }
}

/// Pictures of all directions: one, or the six faces of a cube.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Surroundings(Vec<String>);

impl FromStr for Surroundings {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let pieces: Vec<&str> = text.split(',').collect();
        // A name with commas is the name of a file if there is one.
        let one = pieces.len() == 1 || Path::new(text).is_file();
        let names = if one { vec![text] } else { pieces };
        if names.iter().any(|name| name.is_empty()) {
            return Err("the name of a picture is empty".to_owned());
        }
        match names.len() {
            1 | 6 => Ok(Self(names.into_iter().map(str::to_owned).collect())),
            count => Err(format!(
                "{count} pictures; it must be one of all directions, or six of the faces of a cube: +X,-X,+Y,-Y,+Z,-Z"
            )),
        }
    }
}

impl Surroundings {
    /// What `--set` takes.
    pub fn assignment(&self) -> String {
        // A JSON string is a TOML string, too, whatever characters the name holds.
        let value = match &self.0[..] {
            [name] => serde_json::Value::from(name.as_str()),
            faces => serde_json::Value::from(faces),
        };
        format!("image.environment={value}")
    }
}

/// Bits of a number in a PNG.
pub(super) fn bits(text: &str) -> Result<Bits, String> {
    match text {
        "8" => Ok(Bits::Eight),
        "16" => Ok(Bits::Sixteen),
        _ => Err("must be 8 or 16".to_owned()),
    }
}

/// A part of a whole, a picture's rows or probes: from `first` to `last` of `count` nearly equal bands, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// First band.
    pub first: u32,
    /// Last band, included.
    pub last: u32,
    /// How many bands there are.
    pub count: u32,
}

impl FromStr for Tile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        const WANTED: &str =
            "I/N or A-B/N, counted from 0, such as 0/4 or 2-3/4, or IofN, counted from 1, such as 1of4";
        let wrong = || format!("must be {WANTED}");
        let number = |text: &str| text.parse::<u32>().map_err(|_| wrong());
        if let Some((band, count)) = text.split_once("of") {
            // For schedulers that count tasks from 1 and cannot calculate.
            let (band, count) = (number(band)?, number(count)?);
            if band == 0 || band > count {
                return Err(format!("tiles of {count} go from 1 to {count} where they are written IofN"));
            }
            return Ok(Self { first: band - 1, last: band - 1, count });
        }
        let (bands, count) = text.split_once('/').ok_or_else(wrong)?;
        let (first, last) = bands.split_once('-').unwrap_or((bands, bands));
        let tile = Self { first: number(first)?, last: number(last)?, count: number(count)? };
        if tile.count == 0 {
            Err("there must be at least one tile".to_owned())
        } else if tile.first > tile.last {
            Err(format!("tile {} comes after tile {}", tile.first, tile.last))
        } else if tile.last >= tile.count {
            Err(format!("tiles of {} go from 0 to {}", tile.count, tile.count - 1))
        } else {
            Ok(tile)
        }
    }
}

impl std::fmt::Display for Tile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.first == self.last {
            write!(f, "{}/{}", self.first, self.count)
        } else {
            write!(f, "{}-{}/{}", self.first, self.last, self.count)
        }
    }
}

impl Tile {
    /// The rows of `region` that this tile covers, `None` if there are fewer rows than tiles.
    ///
    /// Tiles 0 to N − 1 cover the region without gap or overlap.
    pub fn window(self, region: PixelRect) -> Option<PixelRect> {
        let rows = u64::from(region.height());
        let count = u64::from(self.count);
        if count > rows {
            return None;
        }
        // Fits: at most `rows`, which is a u32.
        let edge = |band: u64| region.y0 + (rows * band / count) as u32;
        Some(PixelRect { y0: edge(u64::from(self.first)), y1: edge(u64::from(self.last) + 1), ..region })
    }
}

/// The last frame that there can be: more digits than a file name is padded to, and far more than a film has.
pub const LAST_FRAME: u32 = 9_999_999;

/// Frames from `first` to `last`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// First frame.
    pub first: u32,
    /// Last frame.
    pub last: u32,
}

impl FrameRange {
    /// How many frames there are.
    #[must_use]
    pub const fn count(self) -> u32 {
        self.last - self.first + 1
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            let wrong = || format!("must be A-B or A, frames from 0 to {LAST_FRAME}, such as 1-24");
            text.parse::<u32>().ok().filter(|&frame| frame <= LAST_FRAME).ok_or_else(wrong)
        };
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let (first, last) = (number(first)?, number(last)?);
        if first > last {
            Err(format!("frame {first} comes after frame {last}"))
        } else {
            Ok(Self { first, last })
        }
    }
}

impl std::fmt::Display for FrameRange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}-{}", self.first, self.last)
    }
}

/// `WxH`.
pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let numbers: Vec<u32> = list(text, 'x', "width and height such as 1280x720")?;
    match numbers[..] {
        [0, _] | [_, 0] => Err("width and height must be at least 1".to_owned()),
        [width, height] => Ok([width, height]),
        _ => Err("must be width and height such as 1280x720".to_owned()),
    }
}

/// `X0,Y0,X1,Y1` with x0 < x1 and y0 < y1.
pub(super) fn window(text: &str) -> Result<PixelRect, String> {
    let numbers: Vec<u32> = list(text, ',', "four pixel numbers X0,Y0,X1,Y1")?;
    match numbers[..] {
        [x0, y0, x1, y1] if x0 < x1 && y0 < y1 => Ok(PixelRect { x0, y0, x1, y1 }),
        [_, _, _, _] => {
            Err("the window is empty: two corners are needed, X0 < X1 and Y0 < Y1, not a corner and a size"
                .to_owned())
        }
        _ => Err("must be four pixel numbers X0,Y0,X1,Y1".to_owned()),
    }
}

/// `X,Y,Z` that is not zero.
pub(super) fn direction(text: &str) -> Result<Vector, String> {
    let direction: Vector = text.parse()?;
    if direction.0.iter().all(|n| *n == 0.0) {
        return Err("must be a direction, which 0,0,0 is not".to_owned());
    }
    Ok(direction)
}

/// A share, 0 to 1.
pub(super) fn share(text: &str) -> Result<f32, String> {
    let wanted = || "must be a number from 0 to 1".to_owned();
    text.parse().ok().filter(|n| (0.0..=1.0).contains(n)).ok_or_else(wanted)
}

/// A share above 0.
pub(super) fn share_above_0(text: &str) -> Result<f64, String> {
    let wanted = || "must be a number above 0 and at most 1".to_owned();
    text.parse().ok().filter(|n| *n > 0.0 && *n <= 1.0).ok_or_else(wanted)
}

/// A field of view.
pub(super) fn degrees(text: &str) -> Result<f64, String> {
    let angle = text.parse::<f64>().map_err(|_| "must be a number of degrees".to_owned())?;
    if angle > 0.0 && angle < 180.0 {
        Ok(angle)
    } else {
        Err("must be more than 0 and less than 180".to_owned())
    }
}

/// An exposure.
pub(super) fn exposure(text: &str) -> Result<f32, String> {
    let ev = text.parse::<f32>().map_err(|_| "must be a number of stops".to_owned())?;
    if ev.abs() <= 60.0 { Ok(ev) } else { Err("must be from -60 to 60".to_owned()) }
}

/// `NXxNYxNZ`.
pub(super) fn grid(text: &str) -> Result<[usize; 3], String> {
    const MOST: usize = 1 << 24;
    let numbers: Vec<usize> = list(text, 'x', "numbers of probes such as 12x6x6")?;
    match numbers[..] {
        [_, _, _] if numbers.contains(&0) => Err("there must be at least 1 along each axis".to_owned()),
        [x, y, z] if x.saturating_mul(y).saturating_mul(z) <= MOST => Ok([x, y, z]),
        [_, _, _] => Err(format!("these are more than {MOST} probes")),
        _ => Err("must be three numbers such as 12x6x6".to_owned()),
    }
}

/// How the levels of a photograph follow the light.
#[derive(Clone, Debug, PartialEq)]
pub enum ResponseCurve {
    /// The curve of sRGB.
    Srgb,
    /// In proportion.
    Linear,
    /// To the power 1/γ.
    Gamma(f64),
    /// As the 256 numbers in a file say.
    File(PathBuf),
}

/// `srgb`, `linear`, `gamma=2.2` or a file.
pub(super) fn response(text: &str) -> Result<ResponseCurve, String> {
    match text.split_once('=') {
        _ if text == "srgb" => Ok(ResponseCurve::Srgb),
        _ if text == "linear" => Ok(ResponseCurve::Linear),
        Some(("gamma", value)) => positive(value).map(ResponseCurve::Gamma),
        _ if Path::new(text).is_file() => Ok(ResponseCurve::File(PathBuf::from(text))),
        _ => Err("must be srgb, linear, gamma=2.2, or a file with the radiance of each of the 256 levels"
            .to_owned()),
    }
}

/// The range of sizes: they are computed with in 32 bits, too.
const SIZES: RangeInclusive<f64> = 1e-30..=1e30;

/// A size.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|_| "must be a number".to_owned())?;
    match number {
        _ if SIZES.contains(&number) => Ok(number),
        _ if number > 0.0 => Err(format!("must be from {:e} to {:e}", SIZES.start(), SIZES.end())),
        _ => Err("must be more than 0".to_owned()),
    }
}

/// A whole number within `range`.
pub(super) fn whole<T>(
    range: RangeInclusive<T>,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| {
        let wrong = || format!("must be a whole number from {} to {}", range.start(), range.end());
        text.parse().ok().filter(|n| range.contains(n)).ok_or_else(wrong)
    }
}

/// Bytes: `8G`, `512M`, `1.5GiB`.
pub(super) fn memory(text: &str) -> Result<u64, String> {
    let wrong = || "must be a size such as 512M or 8G (K, M, G and T are powers of 1024)".to_owned();
    let upper = text.trim().to_ascii_uppercase();
    let amount = upper.strip_suffix("IB").or_else(|| upper.strip_suffix('B')).unwrap_or(&upper);
    let unit = amount.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(amount.len());
    let power = match &amount[unit..] {
        "" => 0,
        "K" => 1,
        "M" => 2,
        "G" => 3,
        "T" => 4,
        _ => return Err(wrong()),
    };
    let number: f64 = amount[..unit].trim().parse().map_err(|_| wrong())?;
    let bytes = number * 1024_f64.powi(power);
    // Far beyond any machine, and far within the range of the type.
    if (1.0..1e18).contains(&bytes) { Ok(bytes as u64) } else { Err(wrong()) }
}

/// A limit.
pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().map_err(|_| "must be a number".to_owned())?;
    if (0.0..=*SIZES.end()).contains(&number) {
        Ok(number)
    } else {
        Err("must be 0 or more, and finite".to_owned())
    }
}

pub(super) fn list<T: FromStr>(text: &str, separator: char, wanted: &str) -> Result<Vec<T>, String> {
    text.split(separator).map(|part| part.trim().parse().map_err(|_| format!("must be {wanted}"))).collect()
}
