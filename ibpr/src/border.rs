//! What a buffer has around the picture.

/// Buffer pixels on each side whose points are drawn although they lie beyond the picture: what surfaces there do to it. A face in the
/// picture reaches to a corner up to two pixels outside, whose windows are as wide as [`PAD`].
pub(crate) const MARGIN: usize = 2 + PAD;

/// Empty pixels around picture and margin, so that windows need no test for the buffer's border.
pub(crate) const PAD: usize = 4;
