//! Names of files in text files, with and without quotes.

/// A name without the quotes around it, if there are any.
pub(super) fn unquoted(name: &str) -> &str {
    let within = |quote: char| name.strip_prefix(quote).and_then(|rest| rest.strip_suffix(quote));
    within('"').or_else(|| within('\'')).filter(|inside| !inside.is_empty()).unwrap_or(name)
}

/// The names of a line: separated by blanks, those with blanks in them in quotes.
pub fn names_of(line: &str) -> Vec<&str> {
    let mut names = vec![];
    let mut rest = line.trim();
    while let Some(first) = rest.chars().next() {
        let closing = if matches!(first, '"' | '\'') { rest[1..].find(first).map(|at| at + 2) } else { None };
        let end = closing.or_else(|| rest.find(char::is_whitespace)).unwrap_or(rest.len());
        names.push(unquoted(&rest[..end]));
        rest = rest[end..].trim_start();
    }
    names
}

#[cfg(test)]
mod tests {
    use super::{names_of, unquoted};

    #[test]
    fn quotes_hold_blanks_together() {
        assert_eq!(names_of("a.mtl \"b c.mtl\"  'd e' f"), ["a.mtl", "b c.mtl", "d e", "f"]);
        assert_eq!(names_of("\"open end"), ["\"open", "end"]);
        assert_eq!(names_of("  "), [""; 0]);
        assert_eq!((unquoted("\"a b\""), unquoted("\"a"), unquoted("\"\"")), ("a b", "\"a", "\"\""));
    }
}
