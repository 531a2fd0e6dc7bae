//! A row of the report, and what it found.

/// What a row found.
pub(crate) struct Verdict {
    pub(crate) happened: String,
    pub(crate) passed: bool,
}

impl Verdict {
    /// A measured error and the most that is allowed.
    pub(crate) fn within(what: &str, error: f64, limit: f64) -> Self {
        Self { happened: format!("{what} {error:.1e} (limit {limit:.0e})"), passed: error <= limit }
    }

    /// An error is what was asked for.
    pub(crate) fn refused<T, E: std::fmt::Display>(result: Result<T, E>) -> Self {
        match result {
            Ok(_) => Self { happened: "accepted".to_owned(), passed: false },
            Err(error) => {
                let text = error.to_string();
                let first = text.lines().next().unwrap_or_default();
                Self { happened: format!("error: {first}"), passed: !first.is_empty() }
            }
        }
    }
}

/// A row of the report.
pub(crate) struct Check {
    pub(crate) input: String,
    pub(crate) expected: &'static str,
    pub(crate) run: Box<dyn Fn() -> Verdict>,
}
