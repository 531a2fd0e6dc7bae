//! EXR files: one part, any channels, data window within the display window.

use super::{ExrError, Frame, PixelRect, Stamp, cryptomatte, exr_check, exr_header};
use exr::meta::attribute::AttributeValue;
use exr::prelude::{
    self as exr_lib, AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image,
    ImageAttributes, IntegerBounds, LayerAttributes, LineOrder, ReadChannels as _, ReadLayers as _, Text,
    WritableImage as _, f16,
};
use std::collections::BTreeMap;
use std::io::{Cursor, Seek, Write};

/// Name of the header attribute that holds the [`Stamp`].
const STAMP: &str = "pointillist";

/// How colours are stored. Depth, positions and ids are always float.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 16 bits: three digits, up to 65504.
    #[default]
    Half,
    /// 32 bits.
    Float,
}

/// An EXR in memory, samples as they are stored.
#[derive(Clone, Debug, PartialEq)]
pub struct ExrFile {
    /// Width and height of the display window.
    pub size: [u32; 2],
    /// The data window, relative to the display window's corner.
    pub window: PixelRect,
    /// Where it comes from, if from us.
    pub stamp: Option<Stamp>,
    /// In the order of their names.
    pub channels: Vec<Channel>,
    /// Further texts of the header by their names: what Cryptomatte layers are and which names they show.
    pub texts: BTreeMap<String, String>,
}

/// A plane of an EXR.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// As in the file: `R`, `N.X`.
    pub name: String,
    /// Row-major over the data window.
    pub samples: FlatSamples,
}

impl ExrFile {
    /// The file of a frame.
    pub fn from_frame(frame: &Frame, stamp: Stamp, precision: Precision) -> Self {
        let mut channels = Vec::with_capacity(5 + 3 * frame.layers.len());
        for (index, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
            let plane = frame.color.iter().map(|pixel| pixel[index]);
            channels.push(Channel { name: name.to_owned(), samples: stored(plane, precision) });
        }
        if !frame.depth.is_empty() {
            channels.push(Channel { name: "Z".to_owned(), samples: FlatSamples::F32(frame.depth.clone()) });
        }
        for layer in &frame.layers {
            for (name, plane) in layer.channels.iter().zip(&layer.planes) {
                // Half has eleven bits: too few for a place or a number.
                let exact = name.starts_with("P.") || name == "id" || !layer.names.is_empty();
                let precision = if exact { Precision::Float } else { precision };
                channels
                    .push(Channel { name: name.clone(), samples: stored(plane.iter().copied(), precision) });
            }
        }
        channels.sort_by(|a, b| a.name.cmp(&b.name));
        let texts = frame.layers.iter().flat_map(cryptomatte::texts_of).collect();
        Self { size: frame.size, window: frame.window, stamp: Some(stamp), channels, texts }
    }

    /// Decodes a file.
    ///
    /// # Errors
    ///
    /// Not an EXR, one that we cannot show (deep, subsampled, data outside the display window), or one that does not fit
    /// into memory.
    pub fn read(bytes: &[u8]) -> Result<Self, ExrError> {
        exr_check::check(bytes)?;
        let image = exr_lib::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))?;
        let display = image.attributes.display_window;
        let layer = image.layer_data;
        let offset = layer.attributes.layer_position - display.position;
        let start = |n: i32| u32::try_from(n).map_err(|_| ExrError::Window);
        let extent = |n: usize| u32::try_from(n).map_err(|_| ExrError::Window);
        let (x0, y0) = (start(offset.x())?, start(offset.y())?);
        let end = |first: u32, length: usize| extent(length)?.checked_add(first).ok_or(ExrError::Window);
        let window = PixelRect { x0, y0, x1: end(x0, layer.size.x())?, y1: end(y0, layer.size.y())? };
        let size = [extent(display.size.x())?, extent(display.size.y())?];
        if window.x1 > size[0] || window.y1 > size[1] || window.pixels() == 0 {
            return Err(ExrError::Window);
        }
        let stamp = match layer.attributes.other.get(&Text::from(STAMP)) {
            Some(AttributeValue::Text(text)) => Stamp::from_text(&text.to_string()),
            _ => None,
        };
        let text = |(name, value): (&Text, &AttributeValue)| match (name.to_string(), value) {
            (name, AttributeValue::Text(text)) if name.starts_with(cryptomatte::PREFIX) => {
                Some((name, text.to_string()))
            }
            _ => None,
        };
        let texts = layer.attributes.other.iter().filter_map(text).collect();
        let mut channels = Vec::with_capacity(layer.channel_data.list.len());
        for AnyChannel { name, sample_data, .. } in layer.channel_data.list {
            let name = name.to_string();
            if sample_data.len() as u64 != window.pixels() {
                return Err(ExrError::Subsampled(name));
            }
            channels.push(Channel { name, samples: sample_data });
        }
        Ok(Self { size, window, stamp, channels, texts })
    }

    /// Encodes the file.
    ///
    /// # Errors
    ///
    /// What the output says.
    pub fn write(self, mut output: impl Write + Seek) -> std::io::Result<()> {
        if self.texts.is_empty() {
            return self.encode(output);
        }
        let mut bytes = vec![];
        self.encode(Cursor::new(&mut bytes))?;
        exr_header::sort_attributes(&mut bytes);
        output.write_all(&bytes)
    }

    fn encode(self, output: impl Write + Seek) -> std::io::Result<()> {
        let [width, height] = self.size.map(|n| n as usize);
        let mut attributes = LayerAttributes {
            layer_position: exr_lib::Vec2(self.window.x0 as i32, self.window.y0 as i32),
            software_name: Some(Text::from(concat!("pointillist ", env!("CARGO_PKG_VERSION")))),
            ..LayerAttributes::default()
        };
        if let Some(stamp) = &self.stamp {
            // One attribute for everything: several are written in the random order of a hash map.
            let text = AttributeValue::Text(Text::from(stamp.to_text().as_str()));
            attributes.other.insert(Text::from(STAMP), text);
        }
        for (name, text) in &self.texts {
            let text = AttributeValue::Text(Text::from(text.as_str()));
            attributes.other.insert(Text::from(name.as_str()), text);
        }
        let channels = self.channels.into_iter().map(|c| AnyChannel::new(c.name.as_str(), c.samples));
        let encoding = Encoding {
            compression: Compression::ZIP16,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        };
        let size = (self.window.width() as usize, self.window.height() as usize);
        let layer = exr_lib::Layer::new(size, attributes, encoding, AnyChannels::sort(channels.collect()));
        let display = IntegerBounds::new((0, 0), (width, height));
        let image = Image::new(ImageAttributes::new(display), layer);
        image.write().to_buffered(output).map_err(|error| match error {
            exr::error::Error::Io(error) => error,
            other => std::io::Error::other(other.to_string()),
        })
    }

    /// The samples of a channel as `f32`, if it is there.
    pub fn plane(&self, name: &str) -> Option<Vec<f32>> {
        let channel = self.channels.iter().find(|channel| channel.name == name)?;
        Some(match &channel.samples {
            FlatSamples::F16(samples) => samples.iter().map(|sample| sample.to_f32()).collect(),
            FlatSamples::F32(samples) => samples.clone(),
            FlatSamples::U32(samples) => samples.iter().map(|&sample| sample as f32).collect(),
        })
    }
}

fn stored(plane: impl Iterator<Item = f32>, precision: Precision) -> FlatSamples {
    match precision {
        Precision::Float => FlatSamples::F32(plane.collect()),
        Precision::Half => {
            // A light that is too bright for a half is the brightest half, not infinite.
            let largest = f16::MAX.to_f32();
            let half = |n: f32| f16::from_f32(if n.is_finite() { n.clamp(-largest, largest) } else { n });
            FlatSamples::F16(plane.map(half).collect())
        }
    }
}
