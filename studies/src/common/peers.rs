//! Programs of others that results are compared with, if they are there.

use std::path::PathBuf;

/// A program that a variable names, or that `studies/peers/build` made under this name.
pub(crate) fn find(variable: &str, name: &str) -> Option<PathBuf> {
    let named = std::env::var_os(variable).map(PathBuf::from);
    named.or_else(|| built(name)).filter(|path| path.is_file())
}

/// What sections say whose peer is not there.
pub(crate) const SKIPPED: &str = "was skipped: neither did `studies/peers/build` make it";

/// Why a peer is not in a table, as a sentence with [`SKIPPED`].
pub(crate) fn skipped(what: &str, variable: &str) -> String {
    format!("{what} {SKIPPED}, nor does `{variable}` name a program.")
}

/// This program is in `target/release`, peers are in `target/peers`.
fn built(name: &str) -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    Some(program.parent()?.parent()?.join("peers").join(name))
}
