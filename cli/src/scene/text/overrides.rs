//! `--set key=value`.

use super::document::{Document, Key, Node, Origin, Span, Value};
use super::formats::parse_toml;
use crate::input_error::InputError;

impl Document {
    /// Sets one key, as in `camera.fov=40` or `light.0.intensity=[1, 2, 3]`; the value is TOML, and text that is no
    /// TOML value stands for itself, so that `render.occlusion=paper` needs no quotes. Tables on the way are made.
    ///
    /// Messages call it `option`.
    ///
    /// # Errors
    ///
    /// No `=`, an empty key, or a list index that does not exist.
    pub fn set(&mut self, option: &str, assignment: &str) -> Result<(), InputError> {
        let origin = self.origins.len();
        let whole = Span { origin, start: 0, end: assignment.len() };
        self.origins.push(Origin { name: option.to_owned(), text: assignment.to_owned() });
        let Some((path, value)) = assignment.split_once('=') else {
            return Err(self.error(whole, "no `=` found").with_help("write --set key=value"));
        };
        let path_span = Span { end: path.len(), ..whole };
        let value_span = Span { start: path.len() + 1, ..whole };
        let node = parse_value(value, value_span);
        // `light[0].name` and `light.0.name` are the same.
        let path = path.replace('[', ".").replace(']', "");
        let names: Vec<&str> = path.split('.').map(str::trim).collect();
        if names.iter().any(|name| name.is_empty()) {
            return Err(self
                .error(path_span, "the key has an empty part")
                .with_help("write --set camera.fov=40"));
        }
        place(&mut self.root, &names, node, path_span).map_err(|message| self.error(path_span, message))
    }

    /// Takes a key out of a table, named as in `camera.path`, if both are there.
    pub fn remove(&mut self, table: &str, key: &str) {
        if let Some(entries) = self.entries(table) {
            entries.retain(|(name, _)| name.name != key);
        }
    }

    /// Whether a table, named as in `camera.path`, has a key.
    pub fn has(&mut self, table: &str, key: &str) -> bool {
        self.entries(table).is_some_and(|entries| entries.iter().any(|(name, _)| name.name == key))
    }

    fn entries(&mut self, table: &str) -> Option<&mut Vec<(Key, Node)>> {
        let mut at = &mut self.root;
        for part in table.split('.') {
            let Value::Table(tables) = &mut at.value else { return None };
            at = tables.iter_mut().find(|(name, _)| name.name == part).map(|(_, node)| node)?;
        }
        if let Value::Table(entries) = &mut at.value { Some(entries) } else { None }
    }
}

/// The value of an assignment, with its place in the assignment.
fn parse_value(text: &str, span: Span) -> Node {
    const PREFIX: &str = "v=";
    let literal = || Node { value: Value::Text(text.trim().to_owned()), span };
    let Ok(mut document) = parse_toml("--set", &format!("{PREFIX}{text}"), span.origin) else {
        return literal();
    };
    let Value::Table(entries) = &mut document.value else { return literal() };
    // More than one entry: the text held a line break and further assignments.
    match (entries.pop(), entries.is_empty()) {
        (Some((_, mut node)), true) => {
            shift(&mut node, span.start, PREFIX.len());
            node
        }
        _ => literal(),
    }
}

fn shift(node: &mut Node, forward: usize, back: usize) {
    let moved = |span: &mut Span| {
        span.start = (span.start + forward).saturating_sub(back);
        span.end = (span.end + forward).saturating_sub(back);
    };
    moved(&mut node.span);
    match &mut node.value {
        Value::Array(items) => items.iter_mut().for_each(|item| shift(item, forward, back)),
        Value::Table(entries) => entries.iter_mut().for_each(|(key, item)| {
            moved(&mut key.span);
            shift(item, forward, back);
        }),
        _ => {}
    }
}

fn place(at: &mut Node, names: &[&str], value: Node, span: Span) -> Result<(), String> {
    let Some((name, rest)) = names.split_first() else {
        *at = value;
        return Ok(());
    };
    match &mut at.value {
        Value::Array(items) => {
            let count = items.len();
            let item = name.parse::<usize>().ok().and_then(|index| items.get_mut(index));
            let item =
                item.ok_or_else(|| format!("`{name}` is not one of the {count} list entries, from 0"))?;
            place(item, rest, value, span)
        }
        Value::Table(entries) => {
            let index = entries.iter().position(|(key, _)| key.name == *name).unwrap_or_else(|| {
                let empty = Node { value: Value::Table(Vec::new()), span };
                entries.push((Key { name: (*name).to_owned(), span }, empty));
                entries.len() - 1
            });
            entries[index].0.span = span;
            place(&mut entries[index].1, rest, value, span)
        }
        other => Err(format!("`{name}` would have to be inside {}", other.kind())),
    }
}
