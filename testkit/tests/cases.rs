//! How many cases property tests run.

use proptest::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

static RUN: AtomicU32 = AtomicU32::new(0);

proptest! {
    #![proptest_config(testkit::config(7))]

    fn each_case_counts(_ in 0..1000u32) {
        RUN.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn a_test_runs_as_many_cases_as_it_is_configured_for() {
    each_case_counts();
    // Unless proptest's own variable gives another number, for all tests.
    if std::env::var_os("PROPTEST_CASES").is_none() {
        assert_eq!(RUN.load(Ordering::Relaxed), testkit::config(7).cases);
    }
}
