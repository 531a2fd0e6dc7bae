//! Checks a glTF document for what the `gltf` crate assumes and would panic without.

use ::gltf::json::Root;
use ::gltf::json::camera::Type as View;
use ::gltf::json::extensions::scene::khr_lights_punctual::Type as Kind;
use ::gltf::json::validation::Checked;

/// Refuses a document that its reader would stumble over.
pub(super) fn check(root: &Root) -> Result<(), String> {
    positions(root)?;
    images(root)?;
    cameras(root)?;
    lights(root)
}

/// The schema's own check looks positions up before it knows that they are there.
fn positions(root: &Root) -> Result<(), String> {
    let count = root.accessors.len();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            if let Some(beyond) = primitive.attributes.values().find(|index| index.value() >= count) {
                let beyond = beyond.value();
                return Err(format!(
                    "mesh {m}, primitive {p} names accessor {beyond}, but there are {count}"
                ));
            }
        }
    }
    Ok(())
}

fn images(root: &Root) -> Result<(), String> {
    for (i, image) in root.images.iter().enumerate() {
        match (&image.buffer_view, &image.uri) {
            (Some(_), _) if image.mime_type.is_none() => {
                return Err(format!("image {i} has a bufferView, but no mimeType"));
            }
            (None, None) => return Err(format!("image {i} has neither a bufferView nor a uri")),
            _ => {}
        }
    }
    Ok(())
}

fn cameras(root: &Root) -> Result<(), String> {
    for (i, camera) in root.cameras.iter().enumerate() {
        let complete = match camera.type_ {
            Checked::Valid(View::Perspective) => camera.perspective.is_some(),
            Checked::Valid(View::Orthographic) => camera.orthographic.is_some(),
            Checked::Invalid => false,
        };
        if !complete {
            return Err(format!("camera {i} does not say what its type needs"));
        }
    }
    Ok(())
}

fn lights(root: &Root) -> Result<(), String> {
    let list = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
    let list = list.map_or(&[][..], |extension| &extension.lights);
    for (i, light) in list.iter().enumerate() {
        let complete = match light.type_ {
            Checked::Valid(Kind::Spot) => light.spot.is_some(),
            Checked::Valid(_) => true,
            Checked::Invalid => false,
        };
        if !complete {
            return Err(format!("light {i} does not say what its type needs"));
        }
    }
    for (n, node) in root.nodes.iter().enumerate() {
        let light = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if let Some(light) = light.filter(|light| light.light.value() >= list.len()) {
            let light = light.light.value();
            return Err(format!("node {n} names light {light}, but there are {}", list.len()));
        }
    }
    Ok(())
}
