//! Pictures from files as textures, each decoded once.

use super::{Texels, Texture, linear_from_srgb};
use crate::image_io;
use crate::input_error::InputError;
use image::DynamicImage;
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What a texture is for, which says how it is decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Purpose {
    /// Colour; 8- and 16-bit values are sRGB-encoded or linear.
    Color {
        /// Whether they are encoded.
        srgb: bool,
    },
    /// Opacity: the picture's alpha if it has one that says something, else its brightness.
    Opacity,
    /// Opacity: the picture's alpha, nothing else.
    Alpha,
    /// Opacity: all from this alpha on (of 255), none below.
    Mask(u16),
}

/// The textures of a scene. Those in files of their own are read and decoded all at once, on all cores, when the table is complete.
#[derive(Default)]
pub(super) struct TextureTable {
    list: Vec<Entry>,
    known: HashMap<(PathBuf, Purpose), usize>,
}

enum Entry {
    Decoded(Texture),
    File(TextureFile),
}

/// A texture that is not yet decoded.
struct TextureFile {
    path: PathBuf,
    purpose: Purpose,
    /// The message if it cannot be used, without its end, which says why.
    fault: InputError,
}

impl TextureTable {
    /// The number of the texture in this file. `fault` makes the error that [`TextureTable::into_textures`] gives if the file cannot be used: its
    /// message begins a sentence that is completed by what is wrong.
    pub(super) fn load(
        &mut self,
        path: &Path,
        purpose: Purpose,
        fault: impl FnOnce() -> InputError,
    ) -> usize {
        let key = (path.to_path_buf(), purpose);
        if let Some(&number) = self.known.get(&key) {
            return number;
        }
        let path = path.to_path_buf();
        self.add(key, Entry::File(TextureFile { path, purpose, fault: fault() }))
    }

    /// The number of a picture that is part of another file, decoded if it is new; `path` stands for it.
    ///
    /// # Errors
    ///
    /// What is wrong, as the end of a sentence that begins with the path.
    pub(super) fn load_embedded(
        &mut self,
        path: &Path,
        bytes: &[u8],
        purpose: Purpose,
    ) -> Result<usize, String> {
        let key = (path.to_path_buf(), purpose);
        match self.known.get(&key) {
            Some(&number) => Ok(number),
            None => {
                let texture = decode(path, bytes, purpose)?;
                Ok(self.add(key, Entry::Decoded(texture)))
            }
        }
    }

    fn add(&mut self, key: (PathBuf, Purpose), entry: Entry) -> usize {
        self.list.push(entry);
        self.known.insert(key, self.list.len() - 1);
        self.list.len() - 1
    }

    /// A texture by its number, decoded now if it was not yet.
    ///
    /// # Errors
    ///
    /// What is wrong with its file.
    pub(super) fn decoded(&mut self, number: usize) -> Result<&Texture, InputError> {
        if let Entry::File(file) = &self.list[number] {
            self.list[number] = Entry::Decoded(file.decode()?);
        }
        match &self.list[number] {
            Entry::Decoded(texture) => Ok(texture),
            Entry::File(_) => unreachable!("it was decoded above"),
        }
    }

    /// Adds a texture that is not read from a file, under the path that stands for it.
    pub(super) fn insert(&mut self, path: PathBuf, purpose: Purpose, texture: Texture) {
        self.add((path, purpose), Entry::Decoded(texture));
    }

    /// All textures by their numbers.
    ///
    /// # Errors
    ///
    /// What is wrong with the first file that cannot be used.
    pub(super) fn into_textures(self) -> Result<Vec<Texture>, InputError> {
        let texture = |entry: Entry| match entry {
            Entry::Decoded(texture) => Ok(texture),
            Entry::File(file) => file.decode(),
        };
        let textures: Vec<_> = self.list.into_par_iter().map(texture).collect();
        textures.into_iter().collect()
    }
}

impl TextureFile {
    fn decode(&self) -> Result<Texture, InputError> {
        let bytes = crate::memory::read(&self.path).map_err(|error| format!("cannot be read: {error}"));
        bytes.and_then(|bytes| decode(&self.path, &bytes, self.purpose)).map_err(|reason| {
            let mut fault = self.fault.clone();
            fault.message.push_str(&reason);
            fault
        })
    }
}

fn decode(path: &Path, bytes: &[u8], purpose: Purpose) -> Result<Texture, String> {
    let image = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr")) {
        let picture =
            image_io::read_exr_picture(bytes).map_err(|error| format!("cannot be decoded: {error}"))?;
        let [width, height] = picture.size;
        let flat = picture.color.into_iter().flatten().collect();
        let buffer = image::ImageBuffer::from_raw(width, height, flat);
        DynamicImage::ImageRgba32F(buffer.ok_or("has an impossible size")?)
    } else {
        image_io::decode_image(bytes).map_err(|error| format!("cannot be decoded: {error}"))?
    };
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err("has no pixels".to_owned());
    }
    Ok(Texture::new(path.display().to_string(), [width, height], texels(image, purpose)))
}

fn texels(image: DynamicImage, purpose: Purpose) -> Texels {
    let is_byte = image.color().bytes_per_pixel() == image.color().channel_count();
    let is_float = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    match purpose {
        Purpose::Opacity => opacity(&image),
        Purpose::Alpha => Texels::from_opacities(alpha(&image)),
        Purpose::Mask(from) => {
            let mask = |a| if u16::from(a) >= from { u8::MAX } else { 0 };
            Texels::from_opacities(alpha(&image).into_iter().map(mask).collect())
        }
        Purpose::Color { srgb } if is_byte => bytes(image, srgb),
        Purpose::Color { srgb } => {
            let decode = |c: f32| if srgb && !is_float { linear_from_srgb(c) } else { c };
            let finite = |c: f32| if c.is_finite() { c } else { 0.0 };
            let texel = |[r, g, b, a]: [f32; 4]| [decode(r), decode(g), decode(b), a].map(finite);
            let texels: Vec<_> = image.into_rgba32f().pixels().map(|p| texel(p.0)).collect();
            Texels::Float(texels.into())
        }
    }
}

/// The texels of a picture with 8 bits for each channel.
fn bytes(image: DynamicImage, srgb: bool) -> Texels {
    if image.color().has_alpha() {
        let texels: Vec<_> = image.into_rgba8().pixels().map(|p| p.0).collect();
        return if srgb { Texels::Srgb8(texels.into()) } else { Texels::Linear8(texels.into()) };
    }
    let is_gray = |image: &image::RgbImage| image.pixels().all(|p| p.0 == [p.0[0]; 3]);
    let image = image.into_rgb8();
    if !srgb && is_gray(&image) {
        return Texels::from_grays(image.pixels().map(|p| p.0[0]).collect());
    }
    let texels: Vec<_> = image.pixels().map(|p| p.0).collect();
    if srgb { Texels::OpaqueSrgb8(texels.into()) } else { Texels::OpaqueLinear8(texels.into()) }
}

fn alpha(image: &DynamicImage) -> Vec<u8> {
    image.to_rgba8().pixels().map(|p| p.0[3]).collect()
}

fn opacity(image: &DynamicImage) -> Texels {
    if image.color().has_alpha() {
        let alpha = alpha(image);
        if alpha.iter().any(|&a| a != u8::MAX) {
            return Texels::from_opacities(alpha);
        }
    }
    Texels::from_opacities(image.to_luma8().into_raw())
}
