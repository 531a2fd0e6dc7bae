//! Working memory that calls on several threads borrow.

use std::sync::Mutex;

/// Pieces of working memory, each used by one call at a time and kept for the next.
///
/// ```
/// use pointillist_parallel::{Pool, map_heavy};
///
/// let pool = Pool::<Vec<usize>>::default();
/// let sums = map_heavy(3, |i| pool.with(|scratch| {
///     scratch.clear();
///     scratch.extend(0..=i);
///     scratch.iter().sum::<usize>()
/// }));
/// assert_eq!(sums, [0, 1, 3]);
/// ```
#[derive(Debug, Default)]
pub struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Makes as many pieces as may be used at once, so that no call has to make its own.
    pub fn fill(&mut self, count: usize) {
        let free = self.0.get_mut().unwrap_or_else(|poisoned| poisoned.into_inner());
        free.resize_with(count.max(free.len()), T::default);
    }

    /// Runs `work` with a piece that no other thread uses, as the call before left it. A piece whose `work` panics is dropped.
    pub fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        // Taking and giving back cannot panic, so a poisoned lock holds a whole list.
        let lock = || self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let taken = lock().pop();
        let mut item = taken.unwrap_or_default();
        let result = work(&mut item);
        lock().push(item);
        result
    }
}
