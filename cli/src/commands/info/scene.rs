//! Scenes.

use super::bounds;
use crate::options::Common;
use crate::scene::{LoadedScene, Material, Projection, weight};
use pointillist_shade::Model;
use serde_json::{Value, json};

pub(super) fn of_scene(loaded: &LoadedScene) -> Value {
    let LoadedScene { scene, warnings, fingerprint, .. } = loaded;
    let camera = &scene.camera;
    let pixels = u64::from(scene.image.width) * u64::from(scene.image.height);
    let mut view = json!({
        "eye": camera.eye.to_array(),
        "target": camera.target.to_array(),
        "up": camera.up.to_array(),
    });
    match camera.projection {
        Projection::Perspective { fov_y_rad } => view["fov"] = json!(fov_y_rad.to_degrees()),
        Projection::Orthographic { height } => view["height"] = json!(height),
    }
    json!({
        "kind": "scene",
        "size": [scene.image.width, scene.image.height],
        "camera": view,
        "objects": scene.mesh.objects.iter().map(|object| &object.name).collect::<Vec<_>>(),
        "triangles": scene.mesh.triangle_count(),
        "vertices": scene.mesh.world_positions().count(),
        "bounds": bounds(scene.mesh.world_positions()),
        "materials": scene.materials.iter().map(|material| &material.name).collect::<Vec<_>>(),
        "surfaces": scene.materials.iter().map(of_material).collect::<Vec<_>>(),
        "textures": scene.textures.iter()
            .map(|t| json!({ "path": t.name, "size": [t.width, t.height] }))
            .collect::<Vec<_>>(),
        "lights": scene.lights.iter().map(|light| &light.name).collect::<Vec<_>>(),
        "fingerprint": format!("{:016x}", fingerprint),
        "unseen": weight::unseen(scene).iter().map(|object| &object.name).collect::<Vec<_>>(),
        "heavy": weight::heavy(scene),
        "memory_bytes": weight::memory_bytes(scene, pixels, COLOUR_AND_DEPTH, Common::default().thread_count()),
        "warnings": warnings,
    })
}

/// Numbers of a pixel without further layers.
const COLOUR_AND_DEPTH: u64 = 5;

/// What a material reflects by, and which maps it has.
fn of_material(material: &Material) -> Value {
    let d = &material.details;
    let maps = [
        ("diffuse", material.diffuse_map.is_some()),
        ("opacity", material.opacity_map.is_some()),
        ("specular", d.specular_map.is_some()),
        ("shininess", d.shininess_map.is_some()),
        ("roughness", d.roughness_map.is_some()),
        ("metallic", d.metallic_map.is_some()),
        ("emission", d.emission_map.is_some()),
        ("reflection", d.reflection_map.is_some()),
        ("light", d.light_map.is_some()),
        ("occlusion", d.occlusion.is_some()),
        ("bump", d.bump.is_some()),
        ("normal", d.normal.is_some()),
    ];
    let model = match material.surface.model {
        _ if d.measured.is_some() => "merl",
        Model::Lambert => "lambert",
        Model::NormalizedPhong => "phong",
        Model::OpenGl => "opengl",
        Model::OpenGlPhong => "opengl, phong",
        Model::NormalizedBlinnPhong => "blinn-phong",
        Model::Ggx => "ggx",
        Model::Phong => "phong, not normalised",
        Model::BlinnPhong => "blinn-phong, not normalised",
        _ => "another",
    };
    json!({
        "name": material.name,
        "model": model,
        "maps": maps.iter().filter(|(_, there)| *there).map(|(name, _)| name).collect::<Vec<_>>(),
        "mirrors": d.reflection.is_some() || material.surface.model == Model::Ggx,
        "transmits": d.transmission.is_some(),
    })
}
