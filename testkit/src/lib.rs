//! What the tests of several crates share. Not published: crates name it as a dependency of their tests, by path alone.
#![forbid(unsafe_code)]

pub mod numbers;
pub mod points;
mod rate;

pub use rate::Rate;

use proptest::test_runner::{Config, FileFailurePersistence, RngSeed};

/// Seed of every property test, unless `PROPTEST_RNG_SEED` gives another.
const SEED: u64 = 0x706f_696e_7473;

/// Cases that `PROPTEST_CASES` is relative to: proptest's own default.
const USUAL_CASES: u32 = 256;

/// How a property test runs: `cases` cases from a fixed seed, so that the same source gives the same result on every run.
///
/// Exploring is asked for by proptest's own variables: `PROPTEST_RNG_SEED` is the seed, and `PROPTEST_CASES` scales the number of
/// cases (256: as many as in a plain run, 2560: ten times as many). `.ci/explore` sets both. Seeds of failures are
/// kept beside the test's source in `*.proptest-regressions` and run first from then on.
#[must_use]
pub fn config(cases: u32) -> Config {
    let given = Config::default();
    let scaled = u64::from(cases) * u64::from(given.cases) / u64::from(USUAL_CASES);
    Config {
        cases: u32::try_from(scaled).unwrap_or(u32::MAX).max(1),
        rng_seed: match given.rng_seed {
            RngSeed::Random => RngSeed::Fixed(SEED),
            fixed => fixed,
        },
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("proptest-regressions"))),
        ..given
    }
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
