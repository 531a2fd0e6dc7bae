//! Pictures from files as textures, each decoded once.

use super::{Texels, Texture, linear_from_srgb};
use crate::image_io;
use image::DynamicImage;
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

/// The textures of a scene.
#[derive(Default)]
pub(super) struct TextureTable {
    list: Vec<Texture>,
    known: HashMap<(PathBuf, Purpose), usize>,
}

impl TextureTable {
    /// The number of the texture in this file, decoded if it is new.
    ///
    /// # Errors
    ///
    /// What is wrong, as the end of a sentence that begins with the path.
    pub(super) fn load(&mut self, path: &Path, purpose: Purpose) -> Result<usize, String> {
        let key = (path.to_path_buf(), purpose);
        if let Some(&number) = self.known.get(&key) {
            return Ok(number);
        }
        let bytes = crate::memory::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        self.add(key, &bytes)
    }

    /// The same for a picture that is part of another file; `path` stands for it.
    ///
    /// # Errors
    ///
    /// As [`TextureTable::load`].
    pub(super) fn load_embedded(
        &mut self,
        path: &Path,
        bytes: &[u8],
        purpose: Purpose,
    ) -> Result<usize, String> {
        let key = (path.to_path_buf(), purpose);
        match self.known.get(&key) {
            Some(&number) => Ok(number),
            None => self.add(key, bytes),
        }
    }

    fn add(&mut self, key: (PathBuf, Purpose), bytes: &[u8]) -> Result<usize, String> {
        let texture = read(&key.0, bytes, key.1)?;
        self.list.push(texture);
        self.known.insert(key, self.list.len() - 1);
        Ok(self.list.len() - 1)
    }

    /// The alpha of a texture's first texel.
    pub(super) fn first_alpha(&self, number: usize) -> f32 {
        self.list[number].texel(0, 0).w
    }

    /// Whether all texels of a texture are equal.
    pub(super) fn is_constant(&self, number: usize) -> bool {
        self.list[number].is_constant()
    }

    /// Adds a texture that is not read from a file, under the path that stands for it.
    pub(super) fn insert(&mut self, path: PathBuf, purpose: Purpose, texture: Texture) {
        self.list.push(texture);
        self.known.insert((path, purpose), self.list.len() - 1);
    }

    pub(super) fn into_textures(self) -> Vec<Texture> {
        self.list
    }
}

fn read(path: &Path, bytes: &[u8], purpose: Purpose) -> Result<Texture, String> {
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
        Purpose::Alpha => Texels::Opacity8(alpha(&image)),
        Purpose::Mask(from) => {
            let mask = |a| if u16::from(a) >= from { u8::MAX } else { 0 };
            Texels::Opacity8(alpha(&image).into_iter().map(mask).collect())
        }
        Purpose::Color { srgb } if is_byte => {
            let texels = image.into_rgba8().pixels().map(|p| p.0).collect();
            if srgb { Texels::Srgb8(texels) } else { Texels::Linear8(texels) }
        }
        Purpose::Color { srgb } => {
            let decode = |c: f32| if srgb && !is_float { linear_from_srgb(c) } else { c };
            let finite = |c: f32| if c.is_finite() { c } else { 0.0 };
            let texel = |[r, g, b, a]: [f32; 4]| [decode(r), decode(g), decode(b), a].map(finite);
            Texels::Float(image.into_rgba32f().pixels().map(|p| texel(p.0)).collect())
        }
    }
}

fn alpha(image: &DynamicImage) -> Vec<u8> {
    image.to_rgba8().pixels().map(|p| p.0[3]).collect()
}

fn opacity(image: &DynamicImage) -> Texels {
    if image.color().has_alpha() {
        let alpha = alpha(image);
        if alpha.iter().any(|&a| a != u8::MAX) {
            return Texels::Opacity8(alpha);
        }
    }
    Texels::Opacity8(image.to_luma8().into_raw())
}
