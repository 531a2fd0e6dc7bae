//! Keys of a scene that are right by themselves and change nothing in this scene.
//!
//! Keys that never do anything where they stand (a `roughness` of a Lambert surface) are errors of their readers. These here depend on
//! other keys, or on what files hold; they are warnings.

use super::Mesh;
use super::description::{Description, LightDescription, MaterialDescription, SurroundingsDescription};
use super::text::{Node, Value};
use crate::input_error::InputError;
use glam::{DVec3, Vec3};
use pointillist_shade::{Light, LightOutline, Model};

/// All keys without effect, in the order of the sections. `has_made_normals`: vertex normals were made for some mesh.
pub(super) fn keys(description: &Description, has_made_normals: bool) -> Vec<InputError> {
    let mut finder = Finder { description, found: vec![] };
    finder.image();
    finder.render(has_made_normals);
    for (index, light) in description.lights.iter().enumerate() {
        finder.light(index, light);
    }
    for (name, material) in &description.materials {
        finder.material(name, material);
    }
    finder.found
}

/// Lights with an area that shine on one side, with all of the mesh on the other.
pub(super) fn turned_away(description: &Description, mesh: &Mesh) -> Vec<InputError> {
    let document = &description.document;
    let mut found = vec![];
    for (index, light) in description.lights.iter().enumerate() {
        let (key, way_out) = match light.light {
            Light::Rect { .. } => ("edge_v", "it shines on the side `edge_u × edge_v`: swap the two"),
            Light::Polygon { two_sided: false, .. } => (
                "vertices",
                "it shines on the side from which they run counter-clockwise: reverse them, or set `two_sided = true`",
            ),
            _ => continue,
        };
        let Some(node) = find(document.root(), &["light", &index.to_string(), key]) else { continue };
        if light.light.outline().is_some_and(|outline| is_behind(&outline, mesh)) {
            let message = format!("`light[{index}]` lights nothing: all of the scene is behind it");
            found.push(document.error(node.span, message).with_help(way_out));
        }
    }
    found
}

/// Whether nothing is in front of an outline's plane by more than rounding.
fn is_behind(outline: &LightOutline, mesh: &Mesh) -> bool {
    let (corner, normal) = (outline.vertices()[0], outline.area_vector().normalize_or_zero());
    let rounding = |p: DVec3| 1e-9 * (p.abs().max_element() + corner.abs().max_element());
    mesh.world_positions().all(|p| (p - corner).dot(normal) <= rounding(p))
}

struct Finder<'a> {
    description: &'a Description,
    found: Vec<InputError>,
}

impl Finder<'_> {
    /// Reports a key if it is given.
    fn report(&mut self, path: &[&str], why: &str) {
        let document = &self.description.document;
        // `--bg` hides a map, if there is one.
        if let Some(node) = find(document.root(), path).filter(|node| document.origin(node.span) != "--bg") {
            let error = document.error(node.span, format!("`{}` has no effect: {why}", path.join(".")));
            self.found.push(error);
        }
    }

    fn image(&mut self) {
        let image = &self.description.image;
        if image.environment.is_none() {
            self.report(&["image", "backdrop"], "there is no `image.environment`");
        } else if !image.hides_environment {
            self.report(
                &["image", "background"],
                "`image.environment` is seen in its place; `image.backdrop = \"background\"` shows it",
            );
        }
    }

    fn render(&mut self, has_made_normals: bool) {
        if !has_made_normals {
            for key in ["normals", "crease"] {
                self.report(&["render", key], "all meshes bring their normals");
            }
        }
    }

    fn light(&mut self, index: usize, light: &LightDescription) {
        let has_opengl = self.description.materials.iter().any(|(_, m)| m.surface.model.is_opengl());
        let index = index.to_string();
        let mut report = |key: &str, why: &str| self.report(&["light", &index, key], why);
        if !light.shadow {
            report("resolution", "it is about shadows, and `shadow` is false");
        } else if is_taken_whole(&light.light) {
            report(
                "resolution",
                "a light with an area or a length is exact; `samples = N` takes points on it",
            );
        }
        if !has_opengl {
            for key in ["ambient", "specular"] {
                report(key, "no material has model = \"opengl\"");
            }
        }
        if let Some((key, Vec3::ZERO)) = power(&light.light)
            && light.ambient == Vec3::ZERO
            && light.specular.is_none_or(|specular| specular == Vec3::ZERO || !has_opengl)
        {
            report(key, "the light is black");
        }
    }

    fn material(&mut self, name: &str, material: &MaterialDescription) {
        let m = material;
        let mut report = |key: &str, why: &str| self.report(&["material", name, key], why);
        let maps = [
            &m.diffuse_map,
            &m.opacity_map,
            &m.specular_map,
            &m.shininess_map,
            &m.roughness_map,
            &m.metallic_map,
            &m.emission_map,
            &m.reflection_map,
            &m.light_map,
            &m.bump_map,
            &m.normal_map,
        ];
        if maps.iter().all(|map| map.is_none()) {
            for key in ["filter", "wrap", "uv"] {
                report(key, "the material has no map");
            }
        }
        let colors = [&m.diffuse_map, &m.specular_map, &m.emission_map, &m.reflection_map, &m.light_map];
        if colors.iter().all(|map| map.is_none()) {
            report("color_space", "the material has no map of colours");
        }
        let is_ggx = m.surface.model == Model::Ggx;
        let refracts = m.transmission.is_some_and(|t| !t.is_straight());
        let mirrors = is_ggx || m.reflection.is_some() || refracts;
        if m.surroundings != SurroundingsDescription::Scene && !mirrors {
            report("environment", "the material neither mirrors nor refracts");
        }
        if !mirrors {
            report("environment_lookup", "the material mirrors nothing");
        }
        if m.surface.diffuse == Vec3::ZERO {
            report("lightmap", "its light is reflected by `diffuse`, which is 0");
        }
        if m.merl.is_some() {
            for key in ["diffuse", "specular", "shininess"] {
                report(key, "the table of measurements takes its place");
            }
        } else if m.surface.model == Model::Lambert {
            report("specular", "model = \"lambert\", the default, has no highlight");
            report("shininess", "model = \"lambert\", the default, has no highlight");
        } else if !is_ggx && m.surface.specular == Vec3::ZERO {
            report("shininess", "`specular` is 0, the default: there is no highlight");
        }
        if m.surface.emission == Vec3::ZERO {
            report("emission_map", "it multiplies `emission`, which is 0");
        }
    }
}

/// The value at the end of a path of keys and numbers of list entries.
fn find<'a>(node: &'a Node, path: &[&str]) -> Option<&'a Node> {
    let Some((first, rest)) = path.split_first() else { return Some(node) };
    let next = match &node.value {
        Value::Table(entries) => entries.iter().find(|(key, _)| key.name == *first).map(|(_, node)| node),
        Value::Array(items) => first.parse::<usize>().ok().and_then(|index| items.get(index)),
        _ => None,
    };
    find(next?, rest)
}

/// Whether a light's shadows are found without a grid.
fn is_taken_whole(light: &Light) -> bool {
    match light {
        Light::Rect { samples, .. } | Light::Polygon { samples, .. } | Light::Line { samples, .. } => {
            samples.is_none()
        }
        _ => false,
    }
}

/// The key that says how strong a light is, and how strong it is; nothing for a kind of light that scenes cannot have.
fn power(light: &Light) -> Option<(&'static str, Vec3)> {
    match light {
        Light::Point { intensity, .. } | Light::Spot { intensity, .. } => Some(("intensity", *intensity)),
        Light::Directional { irradiance, .. } => Some(("irradiance", *irradiance)),
        Light::Rect { radiance, .. } | Light::Polygon { radiance, .. } | Light::Line { radiance, .. } => {
            Some(("radiance", *radiance))
        }
        _ => None,
    }
}
