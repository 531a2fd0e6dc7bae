//! The same code with rayon and without.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// `f` of every number below `count`, in order; each call gets memory of its thread.
#[cfg(feature = "rayon")]
pub(crate) fn map<T: Send, S: Send>(
    count: usize,
    memory: impl Fn() -> S + Send + Sync,
    f: impl Fn(&mut S, usize) -> T + Send + Sync,
) -> Vec<T> {
    (0..count).into_par_iter().map_init(memory, f).collect()
}

/// `f` of every number below `count`, in order; all calls get the same memory.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<T, S>(count: usize, memory: impl Fn() -> S, f: impl Fn(&mut S, usize) -> T) -> Vec<T> {
    let mut memory = memory();
    (0..count).map(|i| f(&mut memory, i)).collect()
}
