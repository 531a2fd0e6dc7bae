//! Errors of reading EXR files.

use crate::memory::MemoryError;

/// Why an EXR cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExrError {
    /// The decoder's message.
    #[error("{0}")]
    Decode(#[from] exr::error::Error),
    /// The data window is not inside the display window, or has no pixels.
    #[error("the data window is not inside the display window")]
    Window,
    /// A channel that stores fewer samples than pixels.
    #[error("channel {0} is subsampled")]
    Subsampled(String),
    /// Pixels with a list of samples each.
    #[error("it is deep, which is not read")]
    Deep,
    /// The header announces more than the file can hold, however well compressed.
    #[error(
        "{width}×{height} pixels in {channels} channels are announced, but the file has only {file_bytes} bytes"
    )]
    TooShort {
        /// Columns of the data window.
        width: usize,
        /// Its rows.
        height: usize,
        /// Channels of the layer.
        channels: usize,
        /// Bytes of the whole file.
        file_bytes: u64,
    },
    /// A tile or a block of lines that is longer than the format can say, or than its pixels take.
    #[error("a block of {bytes} bytes is announced, which is more than a block can hold")]
    Block {
        /// As announced.
        bytes: u128,
    },
    /// A tile of a smaller copy in the place of one of the picture.
    #[error("a tile says that it belongs to another level of resolution")]
    Level,
    /// There is not enough memory for it.
    #[error(transparent)]
    Memory(MemoryError),
    /// There is nothing that could be a colour.
    #[error("there are no channels R, G, B or Y")]
    NoColor,
}
