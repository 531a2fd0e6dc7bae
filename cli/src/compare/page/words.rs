//! Text and numbers as a page has them.

/// Text that means itself in HTML, also within quotation marks.
pub(super) fn escaped(text: &str) -> String {
    let mut result = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => result.push_str("&amp;"),
            '<' => result.push_str("&lt;"),
            '>' => result.push_str("&gt;"),
            '"' => result.push_str("&quot;"),
            '\'' => result.push_str("&#39;"),
            c => result.push(c),
        }
    }
    result
}

/// Four digits of a number; with a power of ten where zeros would hide them.
pub(super) fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size < 1e-3 => format!("{value:.3e}").replace('-', "−"),
        size if size < 1e4 => {
            let digits = 3 - size.log10().floor() as i32;
            let digits = usize::try_from(digits.clamp(0, 6)).unwrap_or_default();
            format!("{value:.digits$}").replace('-', "−")
        }
        _ => format!("{value:.3e}").replace('-', "−"),
    }
}

#[cfg(test)]
mod tests {
    use super::{escaped, short};

    #[test]
    fn names_cannot_leave_their_place() {
        assert_eq!(escaped("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
    }

    #[test]
    fn numbers_keep_four_digits() {
        for (value, wanted) in [
            (0.0, "0"),
            (0.012_345, "0.01235"),
            (-31.254_9, "−31.25"),
            (2.5e-7, "2.500e−7"),
            (3.2e9, "3.200e9"),
        ] {
            assert_eq!(short(value), wanted);
        }
    }
}
