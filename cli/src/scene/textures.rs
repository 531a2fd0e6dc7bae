//! Pictures from files as textures, each decoded once.

use super::Texture;
use super::texture_decoding::{decode, joined_faces};
use crate::input_error::InputError;
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
    /// Light from all directions: a strip of the six faces of a cube is laid out as [`Texture::is_cube`] says, everything else is equirectangular.
    Surroundings,
}

/// What is done to values once they are decoded: `base + gain · value`, not below 0, and for opacities not above 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tone {
    pub(super) base: f32,
    pub(super) gain: f32,
}

impl Tone {
    /// Values as they are.
    pub(super) const PLAIN: Self = Self { base: 0.0, gain: 1.0 };

    pub(super) fn of(self, value: f32) -> f32 {
        (self.base + self.gain * value).max(0.0)
    }
}

/// A picture, or six of the faces of a cube, and how it is read: the same again is the same texture.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Source {
    files: Vec<PathBuf>,
    purpose: Purpose,
    /// Bits of [`Tone`].
    tone: [u32; 2],
}

impl Source {
    fn new(files: Vec<PathBuf>, purpose: Purpose, tone: Tone) -> Self {
        Self { files, purpose, tone: [tone.base, tone.gain].map(f32::to_bits) }
    }
}

/// The textures of a scene. Those in files of their own are read and decoded all at once, on all cores, when the table is complete.
#[derive(Default)]
pub(super) struct TextureTable {
    list: Vec<Entry>,
    known: HashMap<Source, usize>,
}

enum Entry {
    Decoded(Texture),
    File(TextureFile),
}

/// A texture that is not yet decoded.
struct TextureFile {
    /// Each with the message if it cannot be used, without its end, which says why.
    files: Vec<(PathBuf, InputError)>,
    purpose: Purpose,
    tone: Tone,
}

impl TextureTable {
    /// The number of the texture in this file. `fault` makes the error that [`TextureTable::into_textures`] gives if the file cannot be used: its
    /// message begins a sentence that is completed by what is wrong.
    pub(super) fn load(
        &mut self,
        path: &Path,
        purpose: Purpose,
        tone: Tone,
        fault: impl FnOnce() -> InputError,
    ) -> usize {
        let source = Source::new(vec![path.to_path_buf()], purpose, tone);
        if let Some(&number) = self.known.get(&source) {
            return number;
        }
        let files = vec![(path.to_path_buf(), fault())];
        self.add(source, Entry::File(TextureFile { files, purpose, tone }))
    }

    /// The number of the texture of the six faces of a cube, each in a file of its own, with its error as for [`TextureTable::load`].
    pub(super) fn load_cube(&mut self, faces: Vec<(PathBuf, InputError)>, tone: Tone) -> usize {
        let purpose = Purpose::Surroundings;
        let source = Source::new(faces.iter().map(|(path, _)| path.clone()).collect(), purpose, tone);
        match self.known.get(&source) {
            Some(&number) => number,
            None => self.add(source, Entry::File(TextureFile { files: faces, purpose, tone })),
        }
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
        let source = Source::new(vec![path.to_path_buf()], purpose, Tone::PLAIN);
        match self.known.get(&source) {
            Some(&number) => Ok(number),
            None => {
                let texture = decode(path, bytes, purpose, Tone::PLAIN)?;
                Ok(self.add(source, Entry::Decoded(texture)))
            }
        }
    }

    fn add(&mut self, source: Source, entry: Entry) -> usize {
        self.list.push(entry);
        self.known.insert(source, self.list.len() - 1);
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
        self.add(Source::new(vec![path], purpose, Tone::PLAIN), Entry::Decoded(texture));
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
        let fault = |file: usize, reason: &str| {
            let mut fault = self.files[file].1.clone();
            fault.message.push_str(reason);
            fault
        };
        let texture = |(file, (path, _)): (usize, &(PathBuf, InputError))| {
            let bytes = crate::memory::read(path).map_err(|error| format!("cannot be read: {error}"));
            bytes
                .and_then(|bytes| decode(path, &bytes, self.purpose, self.tone))
                .map_err(|reason| fault(file, &reason))
        };
        let mut textures =
            self.files.iter().enumerate().map(texture).collect::<Result<Vec<Texture>, InputError>>()?;
        match textures.len() {
            1 => Ok(textures.swap_remove(0)),
            _ => joined_faces(&textures).map_err(|(file, reason)| fault(file, &reason)),
        }
    }
}
