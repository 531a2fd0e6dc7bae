//! Maps, lists, words and numbers, as JSON and as YAML. Keys keep their order: templates are read by people, too.

use serde::ser::{Serialize, SerializeMap as _, Serializer};

/// Part of a template.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Map(Vec<(&'static str, Node)>),
    List(Vec<Node>),
    Text(String),
    Number(i64),
}

impl Node {
    pub(super) fn map<const N: usize>(entries: [(&'static str, Self); N]) -> Self {
        Self::Map(entries.into())
    }

    pub(super) fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    pub(super) fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a tree of text and numbers") + "\n"
    }

    pub(super) fn to_yaml(&self) -> String {
        let mut text = String::new();
        self.write_yaml(&mut text, 0);
        text
    }

    /// Lines at this depth. What is not a map or a list stands in the line that is open.
    fn write_yaml(&self, text: &mut String, depth: usize) {
        let indent = "  ".repeat(depth);
        match self {
            Self::Map(entries) => {
                for (i, (key, value)) in entries.iter().enumerate() {
                    // The first key of a map in a list stands behind the dash.
                    if i > 0 || text.is_empty() || text.ends_with('\n') {
                        text.push_str(&indent);
                    }
                    text.push_str(key);
                    text.push(':');
                    text.push(if value.is_nested() { '\n' } else { ' ' });
                    value.write_yaml(text, depth + 1);
                }
            }
            Self::List(items) => {
                for item in items {
                    text.push_str(&indent);
                    text.push_str("- ");
                    item.write_yaml(text, depth + 1);
                }
            }
            // A JSON string is a YAML string, whatever it holds.
            Self::Text(word) => text.push_str(&format!("{}\n", serde_json::Value::from(word.as_str()))),
            Self::Number(number) => text.push_str(&format!("{number}\n")),
        }
    }

    fn is_nested(&self) -> bool {
        matches!(self, Self::Map(_) | Self::List(_))
    }
}

impl Serialize for Node {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Map(entries) => {
                let mut map = serializer.serialize_map(Some(entries.len()))?;
                entries.iter().try_for_each(|(key, value)| map.serialize_entry(key, value))?;
                map.end()
            }
            Self::List(items) => items.serialize(serializer),
            Self::Text(text) => text.serialize(serializer),
            Self::Number(number) => number.serialize(serializer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn yaml_has_the_shape_of_the_tree() {
        let step =
            |name| Node::map([("name", Node::text(name)), ("args", Node::List(vec![Node::Number(1)]))]);
        let tree =
            Node::map([("a", Node::text("x: \"y\"")), ("steps", Node::List(vec![step("b"), step("c")]))]);
        let wanted = "a: \"x: \\\"y\\\"\"\nsteps:\n  - name: \"b\"\n    args:\n      - 1\n  - name: \"c\"\n    args:\n      - 1\n";
        assert_eq!(tree.to_yaml(), wanted);
        assert!(tree.to_json().starts_with("{\n  \"a\": \"x: \\\"y\\\"\",\n  \"steps\": [\n"));
    }
}
