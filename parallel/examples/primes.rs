//! Counts the primes below a million on all cores; without the feature `rayon` the same on one.
//!
//! `cargo run --release -p pointillist-parallel --example primes`

use pointillist_parallel as parallel;

/// Numbers that one call looks at.
const BLOCK: usize = 10_000;

fn is_prime(n: usize) -> bool {
    n > 1 && (2..).take_while(|d| d * d <= n).all(|d| !n.is_multiple_of(d))
}

fn main() {
    let counts = parallel::map_heavy(100, |block| {
        (block * BLOCK..(block + 1) * BLOCK).filter(|&n| is_prime(n)).count()
    });
    println!("{} threads: {} primes below 1 000 000", parallel::threads(), counts.iter().sum::<usize>());
}
