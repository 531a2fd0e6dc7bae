//! File names with a place for a number: `{frame}` for the plain number, `{frame:04}` for four digits and more.

use std::path::{Path, PathBuf};

/// Most digits that a number is padded to.
const MOST_DIGITS: usize = 9;

/// Whether a name has a place for a number of this kind.
///
/// # Errors
///
/// A place that is written in another way, such as `{frame:x}`.
pub(crate) fn has(path: &Path, kind: &str) -> Result<bool, String> {
    parts(&path.to_string_lossy(), kind).map(|parts| parts.len() > 1)
}

/// The name with the number in its places.
///
/// # Errors
///
/// As [`has`].
pub(crate) fn fill(path: &Path, kind: &str, number: u32) -> Result<PathBuf, String> {
    // A name that is no Unicode has no place for a number, and stays as it is.
    let Some(text) = path.to_str() else { return Ok(path.to_path_buf()) };
    let mut name = String::new();
    for (before, digits) in parts(text, kind)? {
        name += before;
        if let Some(digits) = digits {
            name += &format!("{number:0digits$}");
        }
    }
    Ok(PathBuf::from(name))
}

/// The text before each place, with the digits that the number there has at least; the last one has no place.
fn parts<'t>(text: &'t str, kind: &str) -> Result<Vec<(&'t str, Option<usize>)>, String> {
    let start = format!("{{{kind}");
    let (mut rest, mut parts) = (text, vec![]);
    while let Some((before, after)) = rest.split_once(&start) {
        let (digits, after) = match after.split_once('}') {
            Some(("", after)) => (0, after),
            Some((format, after)) => (digits_of(format, kind)?, after),
            None => return Err(wrong(kind)),
        };
        parts.push((before, Some(digits)));
        rest = after;
    }
    parts.push((rest, None));
    Ok(parts)
}

fn digits_of(format: &str, kind: &str) -> Result<usize, String> {
    let digits = format.strip_prefix(":0").and_then(|digits| digits.parse().ok());
    digits.filter(|&digits| digits <= MOST_DIGITS).ok_or_else(|| wrong(kind))
}

fn wrong(kind: &str) -> String {
    format!("a number's place is written {{{kind}}}, or {{{kind}:04}} for four digits")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_take_their_places() {
        let fill = |name: &str| fill(Path::new(name), "frame", 7).map(|path| path.display().to_string());
        assert_eq!(fill("a.{frame}.png").as_deref(), Ok("a.7.png"));
        assert_eq!(fill("{frame:04}/a.{frame:02}.exr").as_deref(), Ok("0007/a.07.exr"));
        assert_eq!(fill("a.{tile}.{frame:01}.png").as_deref(), Ok("a.{tile}.7.png"));
        for wrong in ["a.{frame:x}.png", "a.{frame:4}.png", "a.{frame", "a.{frames}.png", "a.{frame:099}.png"]
        {
            assert!(fill(wrong).is_err(), "{wrong}");
        }
        assert_eq!(has(Path::new("a.png"), "frame"), Ok(false));
        assert_eq!(has(Path::new("a.{frame}.png"), "frame"), Ok(true));
    }
}
