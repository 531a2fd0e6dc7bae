//! Chunks of a list with rayon and without: the rows and blocks of a picture, which are zipped.

#[cfg(feature = "rayon")]
pub(crate) use rayon::prelude::*;

/// Chunks of `n` (at least 1) entries, walked on all cores.
#[cfg(feature = "rayon")]
pub(crate) fn chunks<T: Send>(slice: &mut [T], n: usize) -> rayon::slice::ChunksMut<'_, T> {
    slice.par_chunks_mut(n.max(1))
}

/// Chunks of `n` (at least 1) entries.
#[cfg(not(feature = "rayon"))]
pub(crate) fn chunks<T>(slice: &mut [T], n: usize) -> std::slice::ChunksMut<'_, T> {
    slice.chunks_mut(n.max(1))
}
