//! Pictures in and out: EXR with layers, PNG, JPEG, and what is read for comparison.

mod atomic;
mod cryptomatte;
mod cube_faces;
mod exr_check;
mod exr_error;
mod exr_file;
mod exr_header;
mod jpeg;
mod picture;
mod png;
mod stamp;

pub use atomic::{check_writable, leave, write_atomically};
pub use cube_faces::{face_fault, faces_of_strip, strip_face};
pub use exr_error::ExrError;
pub use exr_file::{Channel, ExrFile, Precision};
pub use jpeg::{JpegOptions, encode_jpeg};
pub use picture::{Levels, Picture, decode_image, read_exr_picture, read_levels, read_picture};
pub use png::{Bits, PngOptions, encode_png, encode_rgb_png};
pub use pointillist_render::{Frame, Layer, LayerKind, PixelRect};
pub use stamp::Stamp;
