//! Scenes as the renderers of `studies/peers` read them.

use std::fmt::Write as _;

use glam::{DVec3, Vec3};
use pointillist_render::shade::{Falloff, Light, Model};
use pointillist_render::{AmbientLight, LightSource, Material, Scene};

use super::point_sampling::Pinhole;

/// Which lights a renderer knows.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Lights {
    /// Points and directions.
    Simple,
    /// Rectangles, too.
    Rectangles,
}

/// A scene as text (`studies/peers/embree/direct_light.cpp` says which numbers it holds); `None` if there is more to it than flat, evenly coloured, matt or
/// glowing surfaces and lights that the renderer knows.
pub(crate) fn written(scene: &Scene, lights: Lights) -> Option<String> {
    let dark = matches!(scene.ambient, AmbientLight::Color(color) if color == Vec3::ZERO);
    if !dark || !scene.materials.iter().all(is_plain) {
        return None;
    }
    let camera = Pinhole::new(scene);
    let [right, down, forward] = camera.axes();
    let mut text = format!("{} {}\n", scene.image.width, scene.image.height);
    for v in [camera.eye, right, down, forward] {
        push(&mut text, v);
    }
    let _ = writeln!(text, "{:e}", camera.scale());
    push(&mut text, scene.image.background.as_dvec3());
    let _ = writeln!(text, "{}", scene.materials.len());
    for material in &scene.materials {
        push(&mut text, material.surface.diffuse.as_dvec3());
        push(&mut text, material.surface.emission.as_dvec3());
        let _ = writeln!(text, "{:e}", material.surface.opacity);
    }
    let _ = writeln!(text, "{}", scene.lights.len());
    for light in &scene.lights {
        push_light(&mut text, light, lights)?;
    }
    let mesh = &scene.mesh;
    let _ = writeln!(text, "{}", mesh.positions.len());
    mesh.positions.iter().for_each(|&p| push(&mut text, p));
    let _ = writeln!(text, "{}", mesh.triangles.len());
    for ([a, b, c], material) in mesh.triangles.iter().zip(&mesh.material_of) {
        let _ = writeln!(text, "{a} {b} {c} {material}");
    }
    Some(text)
}

/// `None` for a light that the renderer does not know.
fn push_light(text: &mut String, light: &LightSource, known: Lights) -> Option<()> {
    let (kind, place, strength, edges) = match light.light {
        Light::Point { position, intensity, falloff: Falloff::InverseSquare } => {
            (0, position, intensity, None)
        }
        Light::Directional { direction, irradiance } => (1, direction.normalize(), irradiance, None),
        Light::Rect { corner, edge_u, edge_v, radiance, falloff: Falloff::InverseSquare, .. }
            if known == Lights::Rectangles =>
        {
            (2, corner, radiance, Some([edge_u, edge_v]))
        }
        _ => return None,
    };
    let _ = writeln!(text, "{kind}");
    push(text, place);
    push(text, strength.as_dvec3());
    let _ = writeln!(text, "{}", u8::from(light.shadow));
    edges.into_iter().flatten().for_each(|edge| push(text, edge));
    Some(())
}

fn is_plain(material: &Material) -> bool {
    let surface = &material.surface;
    let is_matt = surface.model == Model::Lambert || surface.specular == Vec3::ZERO;
    is_matt && material.diffuse_map.is_none() && material.opacity_map.is_none()
}

fn push(text: &mut String, v: DVec3) {
    let _ = writeln!(text, "{:e} {:e} {:e}", v.x, v.y, v.z);
}
