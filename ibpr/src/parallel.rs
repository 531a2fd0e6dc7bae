//! The same code with rayon and without.

#[cfg(feature = "rayon")]
pub(crate) use rayon::prelude::*;
use std::cmp::Ordering;
use std::sync::Mutex;

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

#[cfg(feature = "rayon")]
pub(crate) fn sort_by<T: Send>(slice: &mut [T], compare: impl Fn(&T, &T) -> Ordering + Sync) {
    slice.par_sort_unstable_by(compare);
}

#[cfg(not(feature = "rayon"))]
pub(crate) fn sort_by<T>(slice: &mut [T], compare: impl Fn(&T, &T) -> Ordering) {
    slice.sort_unstable_by(compare);
}

/// Threads that may run at the same time.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "rayon"))]
    1
}

/// Working memory that bands borrow: one per thread, made once.
#[derive(Debug, Default)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Makes sure that no band has to make its own.
    pub(crate) fn fill(&mut self, count: usize) {
        let free = self.0.get_mut().expect("no thread panics while it holds the lock");
        free.resize_with(count.max(free.len()), T::default);
    }

    /// Runs `work` with one that no other thread uses.
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let lock = || self.0.lock().expect("no thread panics while it holds the lock");
        let mut item = lock().pop().unwrap_or_default();
        let result = work(&mut item);
        lock().push(item);
        result
    }
}
