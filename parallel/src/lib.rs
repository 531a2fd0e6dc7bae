//! Loops, sorts and joins that run on rayon's threads, or on one thread without the feature `rayon`, with the same results.
//!
//! ```
//! use pointillist_parallel as parallel;
//!
//! assert_eq!(parallel::map(4, |i| i * i), [0, 1, 4, 9]);
//! assert_eq!(parallel::join(|| 1, || 2), (1, 2));
//! ```
//!
//! Signatures do not depend on the feature, so that what compiles with it compiles without. Results do not depend on the number of
//! threads: lists are in the order of their indices, and sorting asks for an order without ties.
//!
//! # Panics and memory
//! A panic in a call is passed on. Lists of `count` entries are allocated at once: more than memory holds is what it is for `Vec`, a panic
//! or the end of the program.
//!
//! # Features
//! `rayon` (default): rayon's current pool. Without it nothing but the calling thread is used, and the crate builds for
//! `wasm32-unknown-unknown`, with the same results. How much is gained depends on the profile of the dependent program: closures are
//! inlined across crates only with optimisation.
#![forbid(unsafe_code)]

mod pool;

pub use pool::Pool;

#[cfg(feature = "rayon")]
use rayon::prelude::*;
use std::cmp::Ordering;

/// Fewest cheap calls that are worth handing to another thread.
#[cfg(feature = "rayon")]
const MIN_CALLS: usize = 256;

/// Fewest entries that are worth handing to another thread.
#[cfg(feature = "rayon")]
const MIN_ENTRIES: usize = 64;

/// `f` of every number below `count`, in order. For calls of about a microsecond or less; see [`map_heavy`].
#[must_use]
pub fn map<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "rayon")]
    return (0..count).into_par_iter().with_min_len(MIN_CALLS).map(f).collect();
    #[cfg(not(feature = "rayon"))]
    (0..count).map(f).collect()
}

/// As [`map`], where each call is worth a thread.
#[must_use]
pub fn map_heavy<T: Send>(count: usize, f: impl Fn(usize) -> T + Send + Sync) -> Vec<T> {
    #[cfg(feature = "rayon")]
    return (0..count).into_par_iter().map(f).collect();
    #[cfg(not(feature = "rayon"))]
    (0..count).map(f).collect()
}

/// As [`map_heavy`]; each call gets memory that no other call uses at the time.
#[must_use]
pub fn map_with<T: Send, S: Send>(
    count: usize,
    memory: impl Fn() -> S + Send + Sync,
    f: impl Fn(&mut S, usize) -> T + Send + Sync,
) -> Vec<T> {
    #[cfg(feature = "rayon")]
    return (0..count).into_par_iter().map_init(memory, f).collect();
    #[cfg(not(feature = "rayon"))]
    {
        let mut memory = memory();
        (0..count).map(|i| f(&mut memory, i)).collect()
    }
}

/// As [`map`], to two lists.
#[must_use]
pub fn map_pairs<A: Send, B: Send>(
    count: usize,
    f: impl Fn(usize) -> (A, B) + Send + Sync,
) -> (Vec<A>, Vec<B>) {
    #[cfg(feature = "rayon")]
    {
        let (mut a, mut b) = (vec![], vec![]);
        (0..count).into_par_iter().with_min_len(MIN_CALLS).map(f).unzip_into_vecs(&mut a, &mut b);
        (a, b)
    }
    #[cfg(not(feature = "rayon"))]
    (0..count).map(f).unzip()
}

/// All that `f` appends for every number below `count`, in order.
#[must_use]
pub fn flat_map<T: Send>(count: usize, f: impl Fn(usize, &mut Vec<T>) + Send + Sync) -> Vec<T> {
    #[cfg(feature = "rayon")]
    {
        let fold = |mut list: Vec<T>, i| {
            f(i, &mut list);
            list
        };
        let numbers = (0..count).into_par_iter().with_min_len(MIN_CALLS);
        let parts: Vec<Vec<T>> = numbers.fold(Vec::new, fold).collect();
        parts.into_iter().flatten().collect()
    }
    #[cfg(not(feature = "rayon"))]
    {
        let mut list = Vec::new();
        (0..count).for_each(|i| f(i, &mut list));
        list
    }
}

/// Calls `f` with every entry.
pub fn for_each_mut<T: Send>(list: &mut [T], f: impl Fn(&mut T) + Send + Sync) {
    #[cfg(feature = "rayon")]
    list.par_iter_mut().with_min_len(MIN_ENTRIES).for_each(f);
    #[cfg(not(feature = "rayon"))]
    list.iter_mut().for_each(f);
}

/// As [`for_each_mut`], where each call is worth a thread.
pub fn for_each_mut_heavy<T: Send>(list: &mut [T], f: impl Fn(&mut T) + Send + Sync) {
    #[cfg(feature = "rayon")]
    list.par_iter_mut().with_max_len(1).for_each(f);
    #[cfg(not(feature = "rayon"))]
    list.iter_mut().for_each(f);
}

/// Sorts by a comparison that leaves no two different elements equal: equal ones end in any order.
pub fn sort_by<T: Send>(list: &mut [T], compare: impl Fn(&T, &T) -> Ordering + Sync) {
    #[cfg(feature = "rayon")]
    list.par_sort_unstable_by(compare);
    #[cfg(not(feature = "rayon"))]
    list.sort_unstable_by(compare);
}

/// Both results; the calls may run at the same time.
pub fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(feature = "rayon")]
    return rayon::join(a, b);
    #[cfg(not(feature = "rayon"))]
    (a(), b())
}

/// How many threads there are to use: 1 without the feature `rayon`.
#[must_use]
pub fn threads() -> usize {
    #[cfg(feature = "rayon")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "rayon"))]
    1
}

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
