//! The same code with rayon and without.

#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// `f` of every number below `count`, in order.
#[cfg(feature = "rayon")]
pub(crate) fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    (0..count).into_par_iter().with_min_len(256).map(f).collect()
}

/// `f` of every number below `count`, in order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map<T>(count: usize, f: impl Fn(usize) -> T) -> Vec<T> {
    (0..count).map(f).collect()
}

/// All that `f` appends for every number below `count`, in order.
#[cfg(feature = "rayon")]
pub(crate) fn flat_map<T: Send>(count: usize, f: impl Fn(usize, &mut Vec<T>) + Send + Sync) -> Vec<T> {
    let parts: Vec<Vec<T>> = (0..count)
        .into_par_iter()
        .with_min_len(256)
        .fold(Vec::new, |mut list, i| {
            f(i, &mut list);
            list
        })
        .collect();
    parts.into_iter().flatten().collect()
}

/// All that `f` appends for every number below `count`, in order.
#[cfg(not(feature = "rayon"))]
pub(crate) fn flat_map<T>(count: usize, f: impl Fn(usize, &mut Vec<T>)) -> Vec<T> {
    let mut list = Vec::new();
    (0..count).for_each(|i| f(i, &mut list));
    list
}

/// Sorts by a comparison that leaves no two different elements equal.
#[cfg(feature = "rayon")]
pub(crate) fn sort_by<T: Send>(list: &mut [T], compare: impl Fn(&T, &T) -> std::cmp::Ordering + Sync) {
    list.par_sort_unstable_by(compare);
}

/// Sorts by a comparison that leaves no two different elements equal.
#[cfg(not(feature = "rayon"))]
pub(crate) fn sort_by<T>(list: &mut [T], compare: impl Fn(&T, &T) -> std::cmp::Ordering) {
    list.sort_unstable_by(compare);
}
