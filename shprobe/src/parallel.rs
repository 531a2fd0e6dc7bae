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

/// As [`map`], to two lists.
#[cfg(feature = "rayon")]
pub(crate) fn map_pairs<A: Send, B: Send>(
    count: usize,
    f: impl Fn(usize) -> (A, B) + Send + Sync,
) -> (Vec<A>, Vec<B>) {
    let (mut a, mut b) = (vec![], vec![]);
    (0..count).into_par_iter().with_min_len(256).map(f).unzip_into_vecs(&mut a, &mut b);
    (a, b)
}

/// As [`map`], to two lists.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_pairs<A, B>(count: usize, f: impl Fn(usize) -> (A, B)) -> (Vec<A>, Vec<B>) {
    (0..count).map(f).unzip()
}

/// How many threads there are to use.
#[cfg(feature = "rayon")]
pub(crate) fn threads() -> usize {
    rayon::current_num_threads()
}

/// How many threads there are to use.
#[cfg(not(feature = "rayon"))]
pub(crate) const fn threads() -> usize {
    1
}

/// Both results.
#[cfg(feature = "rayon")]
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    rayon::join(a, b)
}

/// Both results.
#[cfg(not(feature = "rayon"))]
pub(crate) fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// As [`map`], where each number is much work.
#[cfg(feature = "rayon")]
pub(crate) fn map_heavy<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    (0..count).into_par_iter().map(f).collect()
}

/// As [`map`], where each number is much work.
#[cfg(not(feature = "rayon"))]
pub(crate) fn map_heavy<T>(count: usize, f: impl Fn(usize) -> T) -> Vec<T> {
    map(count, f)
}

/// Calls `f` with every entry, on all cores.
#[cfg(feature = "rayon")]
pub(crate) fn for_each_mut<T: Send>(list: &mut [T], f: impl Fn(&mut T) + Send + Sync) {
    list.par_iter_mut().with_min_len(64).for_each(f);
}

/// Calls `f` with every entry.
#[cfg(not(feature = "rayon"))]
pub(crate) fn for_each_mut<T>(list: &mut [T], f: impl Fn(&mut T)) {
    list.iter_mut().for_each(f);
}
