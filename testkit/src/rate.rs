//! How many of a property's cases it says something of.

use proptest::test_runner::TestCaseError;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};

/// Cases before a rate is judged.
const ENOUGH: u32 = 128;

/// The share of cases that were accepted. A fact that holds of all input that is refused says nothing where all is refused.
#[derive(Debug)]
pub struct Rate {
    cases: AtomicU32,
    accepted: AtomicU32,
    least: f64,
    /// Of the first case with which too few were accepted: proptest then tries simpler ones, which are refused more often.
    failure: OnceLock<String>,
}

impl Rate {
    /// One that must be at least so much, 0 to 1.
    #[must_use]
    pub const fn of_at_least(least: f64) -> Self {
        Self { cases: AtomicU32::new(0), accepted: AtomicU32::new(0), least, failure: OnceLock::new() }
    }

    /// Counts a case.
    ///
    /// # Errors
    /// Fails the case if too few were accepted so far.
    pub fn count(&self, accepted: bool) -> Result<(), TestCaseError> {
        let cases = self.cases.fetch_add(1, Ordering::Relaxed) + 1;
        let so_far = self.accepted.fetch_add(accepted.into(), Ordering::Relaxed) + u32::from(accepted);
        let fails = cases >= ENOUGH && f64::from(so_far) < self.least * f64::from(cases);
        if !fails && self.failure.get().is_none() {
            return Ok(());
        }
        let failure = self.failure.get_or_init(|| format!("only {so_far} of {cases} cases are accepted"));
        Err(TestCaseError::fail(failure.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_few_accepted_cases_fail() {
        let rate = Rate::of_at_least(0.5);
        let first = (0..ENOUGH - 1).map(|_| rate.count(false));
        assert!(first.into_iter().all(|case| case.is_ok()));
        assert!(rate.count(true).is_err());
        let rate = Rate::of_at_least(0.5);
        assert!((0..10 * ENOUGH).all(|i| rate.count(i % 2 == 0).is_ok()));
    }
}
