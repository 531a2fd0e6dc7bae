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

    /// An error that names what is wrong is what was asked for.
    pub(crate) fn refused_naming<T, E: std::fmt::Display>(name: &str, result: Result<T, E>) -> Self {
        let names = result.as_ref().err().is_some_and(|error| error.to_string().contains(name));
        let mut verdict = Self::refused(result);
        if verdict.passed && !names {
            verdict.passed = false;
            verdict.happened += &format!(" (does not name `{name}`)");
        }
        verdict
    }

    /// Facts that hold for any input of this kind, or the first that does not.
    pub(crate) fn facts(facts: impl IntoIterator<Item = Result<(), String>>) -> Self {
        let mut count = 0;
        for fact in facts {
            if let Err(message) = fact {
                return Self { happened: message, passed: false };
            }
            count += 1;
        }
        Self { happened: format!("{count} facts hold"), passed: count > 0 }
    }
}

/// A row of the report.
pub(crate) struct Check {
    pub(crate) input: String,
    pub(crate) expected: &'static str,
    pub(crate) run: Box<dyn Fn() -> Verdict>,
}
