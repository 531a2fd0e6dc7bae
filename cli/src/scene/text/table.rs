//! Typed access to a table, with the messages that go with it.

use super::document::{Document, Key, Node, Span, Value};
use crate::input_error::InputError;
use glam::{DVec3, Vec3};

/// A table being read: every key asked for is known, [`Table::finish`] reports the others.
#[derive(Debug)]
pub struct Table<'a> {
    document: &'a Document,
    path: String,
    entries: &'a [(Key, Node)],
    span: Span,
    known: Vec<&'static str>,
}

type Read<T> = Result<Option<T>, InputError>;

impl<'a> Table<'a> {
    /// Starts reading `node`, which messages call `path`.
    ///
    /// # Errors
    ///
    /// The node is not a table.
    pub fn new(document: &'a Document, node: &'a Node, path: &str) -> Result<Self, InputError> {
        let Value::Table(entries) = &node.value else {
            let message = format!("`{path}` is {}; it must be a table", node.value.kind());
            return Err(document
                .error(node.span, message)
                .with_help(format!("write [{path}] and its keys below")));
        };
        Ok(Self { document, path: path.to_owned(), entries, span: node.span, known: Vec::new() })
    }

    /// The full name of a key, as in `camera.fov`.
    pub fn name_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The value of a key, if it is there.
    pub fn get(&mut self, key: &'static str) -> Option<&'a Node> {
        self.known.push(key);
        self.entries.iter().find(|(found, _)| found.name == key).map(|(_, node)| node)
    }

    /// The place of the value of `key`, or of the table if it is not there.
    pub fn span_of(&self, key: &str) -> Span {
        self.entries.iter().find(|(found, _)| found.name == key).map_or(self.span, |(_, node)| node.span)
    }

    /// Whether the value of `key` is there and a number.
    pub fn is_number(&self, key: &str) -> bool {
        self.entries.iter().any(|(found, node)| found.name == key && matches!(node.value, Value::Number(_)))
    }

    /// Whether the value of `key` is there and a table.
    pub fn is_table(&self, key: &str) -> bool {
        self.entries.iter().any(|(found, node)| found.name == key && matches!(node.value, Value::Table(_)))
    }

    /// Whether the value of `key` is there and text.
    pub fn is_text(&self, key: &str) -> bool {
        self.entries.iter().any(|(found, node)| found.name == key && matches!(node.value, Value::Text(_)))
    }

    /// An error about the value of `key`, or about the table if it is not there.
    pub fn error(&self, key: &str, message: impl Into<String>) -> InputError {
        self.document.error(self.span_of(key), message)
    }

    /// The error that a needed key is not there.
    pub fn missing(&self, key: &str, example: &str) -> InputError {
        let owner = if self.path.is_empty() { "the scene".to_owned() } else { format!("`{}`", self.path) };
        self.document
            .error(self.span, format!("{owner} needs `{key}`"))
            .with_help(format!("add {key} = {example}"))
    }

    fn wrong(&self, key: &str, node: &Node, wanted: &str) -> InputError {
        let (name, found) = (self.name_of(key), self.document.excerpt(node.span));
        let message = format!("`{name}` is {}, {found}; it must be {wanted}", node.value.kind());
        self.document.error(node.span, message)
    }

    fn out_of_range(&self, key: &str, node: &Node, wanted: &str) -> InputError {
        let (name, found) = (self.name_of(key), self.document.excerpt(node.span));
        self.document.error(node.span, format!("`{name}` is {found}; it must be {wanted}"))
    }

    /// A finite number.
    ///
    /// # Errors
    ///
    /// Not a number, or not finite; likewise below.
    pub fn number(&mut self, key: &'static str) -> Read<f64> {
        let Some(node) = self.get(key) else { return Ok(None) };
        self.finite(key, node).map(Some)
    }

    /// A finite number for which `allowed` holds; `wanted` says what that is.
    ///
    /// # Errors
    ///
    /// As the first sentence says; likewise below.
    pub fn number_where(
        &mut self,
        key: &'static str,
        wanted: &str,
        allowed: impl Fn(f64) -> bool,
    ) -> Read<f64> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let number = self.finite(key, node)?;
        if allowed(number) { Ok(Some(number)) } else { Err(self.out_of_range(key, node, wanted)) }
    }

    /// A whole number in a range.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn count(&mut self, key: &'static str, low: u32, high: u32) -> Read<u32> {
        let wanted = format!("a whole number from {low} to {high}");
        let fits = |n: f64| n.fract() == 0.0 && n >= f64::from(low) && n <= f64::from(high);
        Ok(self.number_where(key, &wanted, fits)?.map(|n| n as u32))
    }

    /// `true` or `false`.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn boolean(&mut self, key: &'static str) -> Read<bool> {
        match self.get(key) {
            None => Ok(None),
            Some(Node { value: Value::Bool(value), .. }) => Ok(Some(*value)),
            Some(node) => Err(self.wrong(key, node, "true or false")),
        }
    }

    /// Text.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn text(&mut self, key: &'static str) -> Read<&'a str> {
        match self.get(key) {
            None => Ok(None),
            Some(Node { value: Value::Text(text), .. }) => Ok(Some(text)),
            Some(node) => Err(self.wrong(key, node, "a string")),
        }
    }

    /// Text, or a list of texts; each with its place.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn text_or_texts(&mut self, key: &'static str) -> Read<Vec<(&'a str, Span)>> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let items = if let Value::Array(items) = &node.value { items } else { std::slice::from_ref(node) };
        let text = |item: &'a Node| match &item.value {
            Value::Text(text) => Ok((text.as_str(), item.span)),
            _ => Err(self.wrong(key, item, "a string or a list of strings")),
        };
        items.iter().map(text).collect::<Result<_, _>>().map(Some)
    }

    /// One of some words.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn choice<T: Copy>(&mut self, key: &'static str, choices: &[(&str, T)]) -> Read<T> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let words: Vec<&str> = choices.iter().map(|(word, _)| *word).collect();
        let wanted = one_of(&words);
        let Value::Text(text) = &node.value else { return Err(self.wrong(key, node, &wanted)) };
        let found = choices.iter().find(|(word, _)| word == text).map(|(_, value)| *value);
        found.map(Some).ok_or_else(|| {
            let error = self.out_of_range(key, node, &wanted);
            match nearest(text, &words) {
                Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
                None => error,
            }
        })
    }

    /// Some finite numbers, as many as `N`.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn numbers<const N: usize>(&mut self, key: &'static str) -> Read<[f64; N]> {
        let Some(node) = self.get(key) else { return Ok(None) };
        self.array(key, node).map(Some)
    }

    fn array<const N: usize>(&self, key: &str, node: &Node) -> Result<[f64; N], InputError> {
        let wanted = format!("a list of {N} numbers");
        let Value::Array(items) = &node.value else { return Err(self.wrong(key, node, &wanted)) };
        if items.len() != N {
            let message = format!("`{}` has {} entries; it must be {wanted}", self.name_of(key), items.len());
            return Err(self.document.error(node.span, message));
        }
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = self.finite(key, item)?;
        }
        Ok(numbers)
    }

    /// A list of finite numbers, of any length.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn numbers_list(&mut self, key: &'static str) -> Read<Vec<f64>> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let Value::Array(items) = &node.value else {
            return Err(self.wrong(key, node, "a list of numbers"));
        };
        items.iter().map(|item| self.finite(key, item)).collect::<Result<_, _>>().map(Some)
    }

    /// A list of points.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn vectors(&mut self, key: &'static str) -> Read<Vec<DVec3>> {
        let Some(node) = self.get(key) else { return Ok(None) };
        let wanted = "a list of points, each a list of 3 numbers";
        let Value::Array(items) = &node.value else { return Err(self.wrong(key, node, wanted)) };
        let point = |item: &Node| self.array(key, item).map(DVec3::from_array);
        items.iter().map(point).collect::<Result<_, _>>().map(Some)
    }

    /// A point or direction.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn vector(&mut self, key: &'static str) -> Read<DVec3> {
        Ok(self.numbers::<3>(key)?.map(DVec3::from_array))
    }

    /// A direction of any length but zero.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn direction(&mut self, key: &'static str) -> Read<DVec3> {
        let Some(vector) = self.vector(key)? else { return Ok(None) };
        if vector == DVec3::ZERO {
            let message = format!("`{}` is [0, 0, 0]; it must point somewhere", self.name_of(key));
            return Err(self.error(key, message));
        }
        Ok(Some(vector))
    }

    /// A linear colour or an amount of light; not negative.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn color(&mut self, key: &'static str) -> Read<Vec3> {
        let Some(numbers) = self.numbers::<3>(key)? else { return Ok(None) };
        if numbers.iter().any(|&n| !(0.0..=f64::from(f32::MAX)).contains(&n)) {
            let message = format!("`{}` must not be negative or beyond 3.4e38", self.name_of(key));
            return Err(self.error(key, message));
        }
        Ok(Some(DVec3::from_array(numbers).as_vec3()))
    }

    /// A table inside this one.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn table(&mut self, key: &'static str) -> Read<Table<'a>> {
        let Some(node) = self.get(key) else { return Ok(None) };
        Table::new(self.document, node, &self.name_of(key)).map(Some)
    }

    /// The tables of a list, as in `[[light]]`; none if the key is not there.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn tables(&mut self, key: &'static str) -> Result<Vec<Table<'a>>, InputError> {
        let Some(node) = self.get(key) else { return Ok(Vec::new()) };
        let Value::Array(items) = &node.value else {
            let help = format!("write [[{key}]] with two brackets");
            return Err(self.wrong(key, node, "a list of tables").with_help(help));
        };
        let name = self.name_of(key);
        items
            .iter()
            .enumerate()
            .map(|(i, item)| Table::new(self.document, item, &format!("{name}[{i}]")))
            .collect()
    }

    /// The tables of a table whose keys are free names, as in `[material.clay]`.
    ///
    /// # Errors
    ///
    /// See above.
    pub fn named_tables(&mut self, key: &'static str) -> Result<Vec<(&'a Key, Table<'a>)>, InputError> {
        let Some(node) = self.get(key) else { return Ok(Vec::new()) };
        let Value::Table(entries) = &node.value else {
            return Err(self.wrong(key, node, "a table").with_help(format!("write [{key}.NAME]")));
        };
        let read = |(name, node): &'a (Key, Node)| {
            let path = format!("{key}.{}", name.name);
            Ok((name, Table::new(self.document, node, &path)?))
        };
        entries.iter().map(read).collect()
    }

    /// Reports the first unknown key.
    ///
    /// # Errors
    ///
    /// There is one.
    pub fn finish(self) -> Result<(), InputError> {
        let Some((key, _)) = self.entries.iter().find(|(key, _)| !self.known.contains(&key.name.as_str()))
        else {
            return Ok(());
        };
        let error = self.document.error(key.span, format!("unknown key `{}`", self.name_of(&key.name)));
        let mut known = self.known;
        known.sort_unstable();
        known.dedup();
        Err(error.with_help(match nearest(&key.name, &known) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("known here: {}", known.join(", ")),
        }))
    }

    fn finite(&self, key: &str, node: &Node) -> Result<f64, InputError> {
        match node.value {
            Value::Number(number) if number.abs() <= LARGEST_NUMBER => Ok(number),
            Value::Number(_) => {
                Err(self.out_of_range(key, node, &format!("finite, and at most {LARGEST_NUMBER:e}")))
            }
            _ => Err(self.wrong(key, node, "a number")),
        }
    }
}

/// The largest number of a scene: colours and sizes are computed with in 32 bits, and multiplied by each other.
const LARGEST_NUMBER: f64 = 1e30;

/// The word that was probably meant, if one is near enough.
pub(in crate::scene) fn nearest<'w>(found: &str, words: &[&'w str]) -> Option<&'w str> {
    /// Found by trial: "colour" finds "color" and "fob" finds "fov", but "banana" finds nothing.
    const NEAR: f64 = 0.65;
    let found = found.to_lowercase();
    let similarity = |word: &str| {
        let word = word.to_lowercase();
        let edits = strsim::normalized_damerau_levenshtein(&found, &word);
        edits.max(strsim::jaro_winkler(&found, &word) - 0.1)
    };
    let scored = words.iter().map(|&word| (similarity(word), word));
    scored.filter(|(score, _)| *score >= NEAR).max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, word)| word)
}

fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.join(""),
    }
}
