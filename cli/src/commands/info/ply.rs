//! What a PLY says of itself: any element with any properties, whether or not they can be drawn.

use crate::input_error::InputError;
use serde_json::{Value, json};

/// Headers are text of a few hundred bytes; comments may make them longer.
const LONGEST_HEADER: usize = 1 << 20;

/// The elements of a header: name, number, and the names of their properties.
pub(super) fn elements(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let head = &bytes[..bytes.len().min(LONGEST_HEADER)];
    let mut elements: Vec<Value> = vec![];
    for (number, line) in head.split(|&b| b == b'\n').enumerate() {
        let text = String::from_utf8_lossy(line);
        let words: Vec<&str> = text.split_whitespace().collect();
        match words[..] {
            ["end_header", ..] => return Ok(json!(elements)),
            ["element", element, count] => {
                let count: u64 = count.parse().map_err(|_| {
                    InputError::in_line(name, bytes, number + 1, "the number of an element is no number")
                })?;
                elements.push(json!({ "name": element, "count": count, "properties": [] }));
            }
            ["property", .., property] => {
                if let Some(Value::Array(list)) = elements.last_mut().map(|e| &mut e["properties"]) {
                    list.push(json!(property));
                }
            }
            _ => {}
        }
    }
    Err(InputError::of_file(name, "the header does not end (no line `end_header`)"))
}

/// Whether the header has positions, so that the file is a cloud or a mesh.
pub(super) fn has_positions(elements: &Value) -> bool {
    let vertices = elements.as_array().into_iter().flatten().find(|e| e["name"] == "vertex");
    let properties = vertices.and_then(|e| e["properties"].as_array());
    properties.is_some_and(|list| ["x", "y", "z"].iter().all(|axis| list.iter().any(|p| p == axis)))
}
