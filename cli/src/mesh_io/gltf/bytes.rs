//! Loads the bytes of a glTF: from the file itself, from files beside it, and from data URIs.

use ::gltf::{Gltf, buffer, image};

/// The bytes of a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum GltfBytes {
    /// In the file.
    Embedded(Vec<u8>),
    /// In another, relative to it.
    File(String),
}

/// All buffers, read.
pub(super) struct Buffers(Vec<Vec<u8>>);

impl Buffers {
    pub(super) fn read(gltf: &Gltf, open: &dyn Fn(&str) -> Result<Vec<u8>, String>) -> Result<Self, String> {
        let mut buffers = Vec::new();
        for buffer in gltf.buffers() {
            let at = buffer.index();
            let bytes = match buffer.source() {
                buffer::Source::Bin => {
                    gltf.blob.clone().ok_or_else(|| format!("buffer {at} is not in the file"))?
                }
                buffer::Source::Uri(uri) => match from_uri(uri).map_err(|e| format!("buffer {at} {e}"))? {
                    GltfBytes::Embedded(bytes) => bytes,
                    GltfBytes::File(path) => open(&path).map_err(|e| format!("buffer {at}: `{path}` {e}"))?,
                },
            };
            if bytes.len() < buffer.length() {
                return Err(format!("buffer {at} has {} bytes, not {}", bytes.len(), buffer.length()));
            }
            buffers.push(bytes);
        }
        Ok(Self(buffers))
    }

    pub(super) fn view(&self, view: &buffer::View<'_>) -> Result<&[u8], String> {
        let bytes = self.0.get(view.buffer().index());
        let end = view.offset().checked_add(view.length());
        bytes
            .zip(end)
            .and_then(|(bytes, end)| bytes.get(view.offset()..end))
            .ok_or_else(|| format!("bufferView {} goes beyond its buffer", view.index()))
    }
}

pub(super) fn image(image: &image::Image<'_>, buffers: &Buffers) -> Result<GltfBytes, String> {
    match image.source() {
        image::Source::View { view, .. } => {
            let bytes = buffers.view(&view).map_err(|e| format!("image {}: {e}", image.index()))?;
            Ok(GltfBytes::Embedded(bytes.to_vec()))
        }
        image::Source::Uri { uri, .. } => from_uri(uri).map_err(|e| format!("image {} {e}", image.index())),
    }
}

/// The bytes of a `data:` text, or the path of a file.
fn from_uri(uri: &str) -> Result<GltfBytes, String> {
    let Some(data) = uri.strip_prefix("data:") else { return Ok(GltfBytes::File(unescaped(uri))) };
    let Some((_, text)) = data.split_once(";base64,") else {
        return Err("is a data: text without `;base64,`".to_owned());
    };
    base64(text.as_bytes()).map(GltfBytes::Embedded).ok_or_else(|| "is not base64".to_owned())
}

/// %20 and the like as the bytes they stand for.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, more @ ..] = rest {
        let escaped =
            || std::str::from_utf8(more.get(..2)?).ok().and_then(|hex| u8::from_str_radix(hex, 16).ok());
        match (*first == b'%').then(escaped).flatten() {
            Some(byte) => {
                bytes.push(byte);
                rest = &more[2..];
            }
            None => {
                bytes.push(*first);
                rest = more;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn base64(text: &[u8]) -> Option<Vec<u8>> {
    let text = text.strip_suffix(b"==").or_else(|| text.strip_suffix(b"=")).unwrap_or(text);
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut count) = (0u32, 0);
    for c in text {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_and_percent_signs_are_decoded() {
        assert_eq!(base64(b"cG9pbnRz").unwrap(), b"points");
        assert_eq!(base64(b"cG9pbnQ=").unwrap(), b"point");
        assert_eq!(base64(b"cG9pbg==").unwrap(), b"poin");
        assert_eq!(base64(b"c?"), None);
        assert_eq!(unescaped("a%20b%2"), "a b%2");
    }
}
