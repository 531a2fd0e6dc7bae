//! The tree that scene text is parsed into: keys and values, each with its place in the text.

use crate::input_error::InputError;

/// A scene's text as a tree, with the texts it came from.
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene file first, then one for each `--set`.
    pub(super) origins: Vec<Origin>,
    /// The outermost table.
    pub(super) root: Node,
}

/// A text that parts of the tree come from.
#[derive(Clone, Debug)]
pub(super) struct Origin {
    pub(super) name: String,
    pub(super) text: String,
}

/// Bytes of one of the texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    pub(super) origin: usize,
    pub(super) start: usize,
    pub(super) end: usize,
}

impl Span {
    /// Whether it lies in an option such as `--set`, not in the scene file.
    pub fn is_in_option(self) -> bool {
        self.origin > 0
    }
}

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// The value.
    pub value: Value,
    /// Where it stands.
    pub span: Span,
}

/// The name in front of a value, and its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Key {
    /// Without quotes.
    pub name: String,
    /// Where it stands.
    pub span: Span,
}

/// What a scene file can hold.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Names and values, in no order that matters.
    Table(Vec<(Key, Node)>),
    /// Values in order.
    Array(Vec<Node>),
    /// Text.
    Text(String),
    /// A number, whole or not.
    Number(f64),
    /// `true` or `false`.
    Bool(bool),
    /// Something no key takes: a date in TOML, `null` in JSON.
    Other(&'static str),
}

impl Value {
    /// What it is, for messages: "a string".
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Table(_) => "a table",
            Self::Array(_) => "a list",
            Self::Text(_) => "a string",
            Self::Number(_) => "a number",
            Self::Bool(_) => "a boolean",
            Self::Other(kind) => kind,
        }
    }
}

impl Document {
    /// The outermost table.
    pub fn root(&self) -> &Node {
        &self.root
    }

    /// Name of the scene file.
    pub fn name(&self) -> &str {
        &self.origins[0].name
    }

    /// Name of the file or option that a place lies in.
    pub fn origin(&self, span: Span) -> &str {
        &self.origins[span.origin].name
    }

    /// An error about a place in one of the texts.
    pub fn error(&self, span: Span, message: impl Into<String>) -> InputError {
        let origin = &self.origins[span.origin];
        InputError::in_text(&origin.name, &origin.text, span.start, span.end, message)
    }

    /// The text of a place, cut if it is long.
    pub fn excerpt(&self, span: Span) -> String {
        let text = self.origins[span.origin].text.get(span.start..span.end).unwrap_or_default();
        let line = text.lines().next().unwrap_or_default().trim();
        if line.chars().count() > 40 {
            line.chars().take(37).chain("...".chars()).collect()
        } else {
            line.to_owned()
        }
    }
}
