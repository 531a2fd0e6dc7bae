//! Parses TOML and JSON into the tree.

use super::document::{Document, Key, Node, Origin, Span, Value};
use crate::input_error::InputError;
use jsonc_parser::{CollectOptions, ParseOptions, ast, common::Ranged};
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// The formats of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML.
    Toml,
    /// JSON with the same keys.
    Json,
}

/// JSON as its specification has it, without the extensions that the parser offers.
const STRICT: ParseOptions = ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
};

impl Document {
    /// Reads a text; `name` is how messages call it.
    ///
    /// # Errors
    ///
    /// The text is not in that format, or its outermost value is not a table.
    pub fn parse(name: &str, text: &str, format: Format) -> Result<Self, InputError> {
        let root = match format {
            Format::Toml => parse_toml(name, text, 0)?,
            Format::Json => parse_json(name, text)?,
        };
        Ok(Self { origins: vec![Origin { name: name.to_owned(), text: text.to_owned() }], root })
    }
}

/// The tree of a TOML text; spans say they come from `origin`.
pub(super) fn parse_toml(name: &str, text: &str, origin: usize) -> Result<Node, InputError> {
    let table = DeTable::parse(text).map_err(|error| {
        let span = error.span().unwrap_or_default();
        let message = format!("not TOML: {}", error.message());
        let refused = InputError::in_text(name, text, span.start, span.end, message);
        match bare_word(text, span.start) {
            Some(word) => refused.with_help(format!("text stands in quotes: \"{word}\"")),
            None => refused,
        }
    })?;
    let span = span_of(table.span(), origin);
    Ok(Node { value: toml_table(table.into_inner(), origin), span })
}

/// The value of the line of a place, if it is a word or a path without quotes.
fn bare_word(text: &str, at: usize) -> Option<&str> {
    let before = text.get(..at)?;
    let start = before.rfind('\n').map_or(0, |line| line + 1);
    let line = text[start..].lines().next()?;
    let (_, value) = line.split_once('=')?;
    let value = value.split('#').next()?.trim();
    let may_be_word = value.starts_with(|c: char| c.is_alphabetic() || c == '.' || c == '/' || c == '~');
    (may_be_word && !value.contains(['"', '\'', ',', '[', '{'])).then_some(value)
}

fn span_of(range: Range<usize>, origin: usize) -> Span {
    Span { origin, start: range.start, end: range.end }
}

fn toml_table(table: DeTable<'_>, origin: usize) -> Value {
    let entry = |(key, value): (toml::Spanned<toml::de::DeString<'_>>, toml::Spanned<DeValue<'_>>)| {
        let key = Key { span: span_of(key.span(), origin), name: key.into_inner().into_owned() };
        (key, toml_node(value, origin))
    };
    Value::Table(table.into_iter().map(entry).collect())
}

fn toml_node(node: toml::Spanned<DeValue<'_>>, origin: usize) -> Node {
    let span = span_of(node.span(), origin);
    let value = match node.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        // Beyond i64 there is no such integer in TOML; as a number it is still what the user wrote.
        DeValue::Integer(number) => Value::Number(
            i64::from_str_radix(number.as_str(), number.radix())
                .map_or_else(|_| number.as_str().parse().unwrap_or(f64::NAN), |n| n as f64),
        ),
        DeValue::Float(number) => Value::Number(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(value) => Value::Bool(value),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(items) => {
            Value::Array(items.into_iter().map(|item| toml_node(item, origin)).collect())
        }
        DeValue::Table(table) => toml_table(table, origin),
    };
    Node { value, span }
}

fn parse_json(name: &str, text: &str) -> Result<Node, InputError> {
    let parsed = jsonc_parser::parse_to_ast(text, &CollectOptions::default(), &STRICT).map_err(|error| {
        let range = error.range();
        InputError::in_text(name, text, range.start, range.end, format!("not JSON: {}", error.kind()))
    })?;
    match parsed.value {
        Some(value @ ast::Value::Object(_)) => json_node(name, text, value),
        Some(other) => {
            let range = other.range();
            Err(InputError::in_text(name, text, range.start, range.end, "a scene is a JSON object { … }"))
        }
        None => Err(InputError::of_file(name, "the file is empty")
            .with_help("a scene is a JSON object with `object`, `light`, `camera`, …")),
    }
}

fn json_node(name: &str, text: &str, node: ast::Value<'_>) -> Result<Node, InputError> {
    let range = node.range();
    let value = match node {
        ast::Value::StringLit(text) => Value::Text(text.value.into_owned()),
        ast::Value::NumberLit(number) => Value::Number(number.value.parse().unwrap_or(f64::NAN)),
        ast::Value::BooleanLit(value) => Value::Bool(value.value),
        ast::Value::NullKeyword(_) => Value::Other("null"),
        ast::Value::Array(items) => {
            let items = items.elements.into_iter().map(|item| json_node(name, text, item));
            Value::Array(items.collect::<Result<_, _>>()?)
        }
        ast::Value::Object(object) => json_table(name, text, object)?,
    };
    Ok(Node { value, span: span_of(range.start..range.end, 0) })
}

fn json_table(name: &str, text: &str, object: ast::Object<'_>) -> Result<Value, InputError> {
    let mut entries: Vec<(Key, Node)> = Vec::with_capacity(object.properties.len());
    for property in object.properties {
        let range = property.name.range();
        let key = Key { name: property.name.into_string(), span: span_of(range.start..range.end, 0) };
        if entries.iter().any(|(earlier, _)| earlier.name == key.name) {
            let message = format!("`{}` is given twice", key.name);
            return Err(InputError::in_text(name, text, range.start, range.end, message));
        }
        entries.push((key, json_node(name, text, property.value)?));
    }
    Ok(Value::Table(entries))
}
