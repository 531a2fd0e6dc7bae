//! Scene text to a tree in which every key and value knows its place, and typed access to that tree.
//!
//! TOML and JSON end up as the same tree, and `--set` changes it, so that there is one schema and one kind of message.

mod document;
mod formats;
mod overrides;
mod table;

pub use document::{Document, Key, Node, Span, Value};
pub use formats::Format;
pub use table::Table;
pub(super) use table::nearest;
