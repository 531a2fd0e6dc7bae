//! What the header of an EXR says of its Cryptomatte layers (the specification's section on metadata).

use super::Layer;
use pointillist_render::{cryptomatte_hash, cryptomatte_id};
use std::collections::BTreeMap;

/// How the names of these texts begin.
pub(super) const PREFIX: &str = "cryptomatte/";

/// The texts of one layer; none if it is not a Cryptomatte.
pub(super) fn texts_of(layer: &Layer) -> Vec<(String, String)> {
    // All channels are `NAME00.R` and so on.
    let name = layer.channels.first().and_then(|channel| channel.strip_suffix("00.R"));
    let Some(name) = name.filter(|_| !layer.names.is_empty()) else { return vec![] };
    let hash = format!("{:08x}", cryptomatte_hash(name));
    let key = &hash[..7];
    let bits = |name: &String| format!("{:08x}", cryptomatte_id(name).to_bits());
    let manifest: BTreeMap<&String, String> = layer.names.iter().map(|name| (name, bits(name))).collect();
    let manifest = ascii(&serde_json::json!(manifest).to_string());
    [
        ("name", name.to_owned()),
        ("hash", "MurmurHash3_32".to_owned()),
        ("conversion", "uint32_to_float32".to_owned()),
        ("manifest", manifest),
    ]
    .into_iter()
    .map(|(what, text)| (format!("{PREFIX}{key}/{what}"), text))
    .collect()
}

/// JSON without letters beyond ASCII: texts of a header have one byte for each letter.
fn ascii(json: &str) -> String {
    let mut text = String::with_capacity(json.len());
    for c in json.chars() {
        if c.is_ascii() {
            text.push(c);
        } else {
            c.encode_utf16(&mut [0; 2]).iter().for_each(|unit| text.push_str(&format!("\\u{unit:04x}")));
        }
    }
    text
}
