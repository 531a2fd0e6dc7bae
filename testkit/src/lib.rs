//! What the tests of several crates share. Not published: crates name it as a dependency of their tests, by path alone.
#![forbid(unsafe_code)]

pub mod numbers;
pub mod points;
mod rate;

pub use rate::Rate;

use proptest::test_runner::{Config, FileFailurePersistence, RngSeed};

/// Seed of every property test, unless `PROPTEST_RNG_SEED` gives another.
const SEED: u64 = 0x706f_696e_7473;

/// The variable that says how many times as many cases each property test has.
const TIMES: &str = "TESTKIT_TIMES";

/// How a property test runs: `cases` cases from a fixed seed, so that the same source gives the same result on every run.
///
/// `.ci/explore` explores: `PROPTEST_RNG_SEED` is the seed, and `TESTKIT_TIMES` multiplies the number of cases, so that tests keep
/// their shares of the time. (proptest's own `PROPTEST_CASES` would give all tests the same number, those whose cases take a
/// second, too; it stands in the place of both.) Seeds of failures are kept beside the test's source in
/// `*.proptest-regressions` and run first from then on.
///
/// # Panics
/// If `TESTKIT_TIMES` is no whole number above 0.
#[must_use]
pub fn config(cases: u32) -> Config {
    let given = Config::default();
    let times = times(std::env::var(TIMES).ok().as_deref());
    Config {
        cases: cases.saturating_mul(times),
        max_global_rejects: given.max_global_rejects.saturating_mul(times),
        rng_seed: match given.rng_seed {
            RngSeed::Random => RngSeed::Fixed(SEED),
            fixed => fixed,
        },
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("proptest-regressions"))),
        ..given
    }
}

fn times(given: Option<&str>) -> u32 {
    let Some(text) = given else { return 1 };
    let number = text.parse().ok().filter(|n| *n > 0);
    number.unwrap_or_else(|| panic!("{TIMES} is `{text}`, not a whole number above 0"))
}

/// Ends the case of a property test with what is wrong if a fact, a `Result<(), String>`, does not hold.
#[macro_export]
macro_rules! holds {
    ($fact:expr) => {
        $fact.map_err(proptest::test_runner::TestCaseError::fail)?
    };
}

#[cfg(test)]
mod tests {
    use super::times;
    use std::path::{Path, PathBuf};

    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" && !name.starts_with('.') {
                sources(&path, found);
            } else if name.ends_with(".rs") {
                found.push(path);
            }
        }
    }

    #[test]
    fn cases_are_multiplied_by_a_whole_number() {
        assert_eq!([None, Some("1"), Some("40")].map(times), [1, 1, 40]);
        for text in ["", "0", "-1", "1.5", "many"] {
            assert!(std::panic::catch_unwind(|| times(Some(text))).is_err(), "{text}");
        }
    }

    /// proptest's own default is a new seed for every run: a block without a configuration would bring failures by chance back.
    #[test]
    fn every_property_test_of_the_workspace_has_this_configuration() {
        let mut files = Vec::new();
        sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), &mut files);
        let (block, attribute) = (concat!("proptest", "! {"), concat!("#![proptest_", "config("));
        let mut blocks = 0;
        for file in files {
            let text = std::fs::read_to_string(&file).unwrap();
            for after in text.split(block).skip(1) {
                blocks += 1;
                let line = after.lines().map(str::trim).find(|l| !l.is_empty() && !l.starts_with("//"));
                let configured = line
                    .is_some_and(|l| l.starts_with(attribute) && l.contains(concat!("testkit::", "config")));
                assert!(configured, "{}: a property test without `testkit::config`", file.display());
            }
        }
        assert!(blocks > 20, "{blocks} blocks of property tests found");
    }
}
