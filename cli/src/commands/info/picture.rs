//! Pictures.

use crate::image_io::{ExrFile, read_picture};
use crate::input_error::InputError;
use serde_json::{Value, json};
use std::path::Path;

/// An EXR: channels, and where it comes from if it is ours. A tile, or a part that an interrupted run left, says what it is a part of.
pub(super) fn of_exr(name: &str, bytes: &[u8]) -> Result<Value, InputError> {
    let file = ExrFile::read(bytes)
        .map_err(|error| InputError::of_file(name, format!("cannot be decoded: {error}")))?;
    let window = file.window;
    let mut value = json!({
        "kind": "image",
        "format": "exr",
        "size": file.size,
        "window": [window.x0, window.y0, window.x1, window.y1],
        "channels": file.channels.iter().map(|channel| &channel.name).collect::<Vec<_>>(),
    });
    if let Some(stamp) = &file.stamp {
        let region = stamp.region;
        value["version"] = json!(stamp.version);
        value["fingerprint"] = json!(format!("{:016x}", stamp.fingerprint));
        value["tile"] = json!(stamp.tile);
        value["region"] = json!([region.x0, region.y0, region.x1, region.y1]);
        value["is_part"] = json!(region != window);
        value["background"] = json!(stamp.background);
    }
    Ok(value)
}

/// PNG, JPEG or HDR.
pub(super) fn of_picture(format: &str, path: &Path) -> Result<Value, InputError> {
    let picture = read_picture(path)?;
    let opaque = picture.color.iter().all(|pixel| pixel[3] == 1.0);
    Ok(json!({ "kind": "image", "format": format, "size": picture.size, "opaque": opaque }))
}
