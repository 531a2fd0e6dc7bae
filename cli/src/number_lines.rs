//! Text files with some numbers on each line.

use crate::coordinate::LARGEST;
use crate::input;
use crate::input_error::InputError;
use std::path::Path;

/// What `make` makes of the numbers of each line, with blanks or commas between them; empty lines and those that begin with `#` are left
/// out. `-` is standard input.
///
/// # Errors
/// A line with a word that is no finite number, or that `make` refuses with a message; `help` says what a line is.
pub(crate) fn read<T>(
    path: &Path,
    help: &str,
    make: impl Fn(&[f64]) -> Result<T, String>,
) -> Result<Vec<T>, InputError> {
    let (name, bytes) = (input::name_of(path), input::read(path)?);
    let (mut rows, mut numbers) = (vec![], vec![]);
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let text = text.trim();
        if text.is_empty() || text.starts_with('#') {
            continue;
        }
        numbers.clear();
        let row = text
            .split([' ', '\t', ','])
            .filter(|word| !word.is_empty())
            .try_for_each(|word| number(word).map(|number| numbers.push(number)))
            .and_then(|()| make(&numbers))
            .map_err(|what| {
                let help = format!("{help}, numbers with spaces between them");
                InputError::in_line(&name, &bytes, i + 1, what).with_help(help)
            })?;
        rows.push(row);
    }
    Ok(rows)
}

fn number(word: &str) -> Result<f64, String> {
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() && number.abs() <= LARGEST => Ok(number),
        Ok(_) => Err(format!("`{word}` is not finite, or beyond ±{LARGEST:e}")),
        Err(_) => Err(format!("`{word}` is not a number")),
    }
}
