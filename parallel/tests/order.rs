//! Every helper gives what a plain loop gives, in the same order.

use pointillist_parallel as parallel;

/// More than one thread gets to do.
const COUNT: usize = 10_000;

#[test]
fn lists_are_in_the_order_of_their_indices() {
    let squares: Vec<usize> = (0..COUNT).map(|i| i * i).collect();
    assert_eq!(parallel::map(COUNT, |i| i * i), squares);
    assert_eq!(parallel::map_heavy(COUNT, |i| i * i), squares);
    let (numbers, pairs) = parallel::map_pairs(COUNT, |i| (i, i * i));
    assert_eq!((numbers, pairs), ((0..COUNT).collect(), squares));
    let repeated: Vec<usize> = (0..COUNT).flat_map(|i| vec![i; i % 3]).collect();
    assert_eq!(parallel::flat_map(COUNT, |i, list| list.extend(vec![i; i % 3])), repeated);
}

#[test]
fn entries_are_changed_and_sorted_as_by_one_thread() {
    let scrambled = |i: usize| i * 7919 % COUNT;
    let mut list = parallel::map(COUNT, scrambled);
    parallel::sort_by(&mut list, |a, b| a.cmp(b));
    assert!(list.windows(2).all(|w| w[0] < w[1]));
    parallel::for_each_mut(&mut list, |entry| *entry += 1);
    assert_eq!(list, (1..=COUNT).collect::<Vec<_>>());
    assert_eq!(parallel::join(|| list[0], || list[COUNT - 1]), (1, COUNT));
    assert!(parallel::threads() >= 1);
}
