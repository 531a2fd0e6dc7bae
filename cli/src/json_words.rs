//! Messages of JSON and MessagePack readers in the words of those formats, not in those of our types.

use crate::input_error::InputError;
use serde::de::DeserializeOwned;

/// What a reader calls things, and what a user does. The first that fits counts.
const WORDS: [(&str, &str); 20] = [
    ("f64", "a number"),
    ("f32", "a number"),
    ("u8", "a whole number from 0 to 255"),
    ("u16", "a whole number from 0"),
    ("u32", "a whole number from 0"),
    ("u64", "a whole number from 0"),
    ("usize", "a whole number from 0"),
    ("i32", "a whole number"),
    ("i64", "a whole number"),
    ("a sequence", "a list"),
    ("sequence", "a list"),
    ("a map", "an object"),
    ("map", "an object"),
    ("string", "the string"),
    ("integer", "the number"),
    ("floating point", "the number"),
    ("boolean", "the value"),
    ("unit value", "nothing"),
    ("null", "nothing"),
    ("an array of length", "a list of"),
];

/// The message of a reader without place and without names of types.
pub(crate) fn plain(message: &str) -> String {
    // A string of the user's may have the same words.
    let is_place = |end: &str| end.split(" column ").all(|number| number.parse::<u64>().is_ok());
    let message = match message.rsplit_once(" at line ") {
        Some((message, end)) if is_place(end) => message,
        _ => message,
    };
    let Some((found, wanted)) = message.split_once(", expected ") else { return message.to_owned() };
    let thing = found.strip_prefix("invalid type: ").or_else(|| found.strip_prefix("invalid value: "));
    match (thing, found.strip_prefix("invalid length ")) {
        (Some(thing), _) => format!("is {} and should be {}", named(thing), named(wanted)),
        (None, Some(_)) if wanted.starts_with("struct ") => "is a list and should be an object".to_owned(),
        (None, Some(length)) => format!("has {length} entries and should be {}", named(wanted)),
        // Lists of keys and messages of their own.
        (None, None) => message.to_owned(),
    }
}

/// A thing in the user's words: its first word is translated, what follows (a value, a number) stays.
fn named(thing: &str) -> String {
    if thing.starts_with("struct ") {
        return "an object".to_owned();
    }
    let known = WORDS.iter().find(|(word, _)| {
        thing.strip_prefix(word).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
    });
    match known {
        Some((word, name)) => format!("{name}{}", &thing[word.len()..]),
        None => thing.to_owned(),
    }
}

/// Reads a whole JSON file; `help` says how such files look or where they come from.
///
/// # Errors
/// What is wrong, with the line and the field.
pub(crate) fn parse<T: DeserializeOwned>(name: &str, bytes: &[u8], help: &str) -> Result<T, InputError> {
    let mut reader = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let field = error.path().to_string();
        let inner: &serde_json::Error = error.inner();
        let what = plain(&inner.to_string());
        let message = if field == "." { what } else { format!("`{field}` {}", after_field(&what)) };
        InputError::in_line(name, bytes, inner.line(), message).with_help(help)
    })?;
    reader.end().map_err(|error| {
        InputError::in_line(name, bytes, error.line(), "more text after the end of the JSON")
    })?;
    Ok(value)
}

/// What follows the name of a field: `is …`, `has …`, or a sentence after a colon.
pub(crate) fn after_field(what: &str) -> String {
    if what.starts_with("is ") || what.starts_with("has ") {
        what.to_owned()
    } else {
        format!("is wrong: {what}")
    }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn types_are_called_what_users_call_them() {
        for (message, wanted) in [
            (
                "invalid type: map, expected a sequence at line 1 column 5",
                "is an object and should be a list",
            ),
            (
                "invalid type: string \"stop at line 3\", expected f64 at line 1 column 20",
                "is the string \"stop at line 3\" and should be a number",
            ),
            ("invalid type: string \"a, b\", expected f64", "is the string \"a, b\" and should be a number"),
            ("invalid type: integer `5`, expected struct Asset", "is the number `5` and should be an object"),
            ("invalid type: null, expected u32", "is nothing and should be a whole number from 0"),
            (
                "invalid value: integer `-1`, expected usize",
                "is the number `-1` and should be a whole number from 0",
            ),
            ("invalid length 2, expected an array of length 3", "has 2 entries and should be a list of 3"),
            ("invalid length 9, expected struct File with 10 elements", "is a list and should be an object"),
            (
                "unknown field `polgyon`, expected `polygon` or `grid`",
                "unknown field `polgyon`, expected `polygon` or `grid`",
            ),
            ("missing field `position` at line 1 column 9", "missing field `position`"),
        ] {
            assert_eq!(plain(message), wanted);
        }
    }
}
