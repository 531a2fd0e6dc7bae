//! The nodes of a glTF scene, from its roots.

use super::GltfModel;
use super::bytes::Buffers;
use super::primitive;
use crate::mesh_io::FileMesh;
use ::gltf::khr_lights_punctual::Kind;
use ::gltf::{Gltf, Node, camera};
use glam::{DAffine3, DMat4, DVec3, Vec3};
use pointillist_shade::{Falloff, Light};

/// A camera in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GltfCamera {
    /// Where it is.
    pub eye: DVec3,
    /// The way it looks; of unit length.
    pub forward: DVec3,
    /// Up in the picture.
    pub up: DVec3,
    /// Vertical field of view, or else the height of a parallel view.
    pub fov_y_rad: Option<f64>,
    /// Height of a parallel view; 0 for a perspective one.
    pub height: f64,
}

/// A light in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct GltfLight {
    /// As in the file; may be empty.
    pub name: String,
    /// What it sends out.
    pub light: Light,
}

/// A node that waits, with the placement of its parent.
struct Waiting<'a>(Node<'a>, DAffine3);

/// Adds everything that the file's scene shows: its default one, or the first, or all nodes if there is none.
pub(super) fn walk(
    gltf: &Gltf,
    buffers: &Buffers,
    name: &str,
    mesh: &mut FileMesh,
    model: &mut GltfModel,
) -> Result<(), String> {
    let scene = gltf.default_scene().or_else(|| gltf.scenes().next());
    let roots: Vec<Node<'_>> = match scene {
        Some(scene) => scene.nodes().collect(),
        None => gltf.nodes().collect(),
    };
    let mut seen = vec![false; gltf.nodes().len()];
    // A stack, last first: a chain of nodes may be longer than the program's own.
    let mut waiting: Vec<Waiting<'_>> =
        roots.into_iter().rev().map(|n| Waiting(n, DAffine3::IDENTITY)).collect();
    while let Some(Waiting(node, parent)) = waiting.pop() {
        let at = node.index();
        if std::mem::replace(&mut seen[at], true) {
            // Without a scene, children are roots, too; with one, the file is wrong.
            if scene_is_missing(gltf) {
                continue;
            }
            return Err(format!("node {at} has two parents, or is its own ancestor"));
        }
        let world = parent * affine(&node);
        if !world.is_finite() {
            return Err(format!("node {at} is placed out of the range of numbers"));
        }
        visit(&node, world, buffers, name, mesh, model).map_err(|e| format!("node {at}: {e}"))?;
        let children: Vec<Node<'_>> = node.children().collect();
        waiting.extend(children.into_iter().rev().map(|child| Waiting(child, world)));
    }
    Ok(())
}

fn scene_is_missing(gltf: &Gltf) -> bool {
    gltf.scenes().len() == 0
}

fn affine(node: &Node<'_>) -> DAffine3 {
    let columns = node.transform().matrix().map(|c| c.map(f64::from));
    DAffine3::from_mat4(DMat4::from_cols_array_2d(&columns))
}

fn visit(
    node: &Node<'_>,
    world: DAffine3,
    buffers: &Buffers,
    name: &str,
    mesh: &mut FileMesh,
    model: &mut GltfModel,
) -> Result<(), String> {
    if let Some(found) = node.mesh() {
        for primitive in found.primitives() {
            // The last material is that of primitives that name none.
            let material = primitive.material().index().unwrap_or(model.materials.len() - 1) as u32;
            let context = |e| format!("mesh {}, primitive {}: {e}", found.index(), primitive.index());
            if !primitive::append(&primitive, world, material, buffers, mesh).map_err(context)? {
                let (mesh, primitive) = (found.index(), primitive.index());
                model
                    .warnings
                    .push(format!("{name}: mesh {mesh}, primitive {primitive} is points or lines; ignored"));
            }
        }
    }
    if let Some(camera) = node.camera() {
        model.cameras.push(in_world(&camera, world));
    }
    if let Some(light) = node.light() {
        let name = light.name().unwrap_or_default().to_owned();
        model.lights.push(GltfLight { name, light: light_in_world(&light, world) });
    }
    Ok(())
}

fn in_world(camera: &::gltf::Camera<'_>, world: DAffine3) -> GltfCamera {
    let (fov_y_rad, height) = match camera.projection() {
        camera::Projection::Perspective(p) => (Some(f64::from(p.yfov())), 0.0),
        camera::Projection::Orthographic(o) => (None, 2.0 * f64::from(o.ymag())),
    };
    GltfCamera {
        eye: world.translation,
        forward: world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z),
        up: world.transform_vector3(DVec3::Y),
        fov_y_rad,
        height,
    }
}

fn light_in_world(light: &::gltf::khr_lights_punctual::Light<'_>, world: DAffine3) -> Light {
    let color = Vec3::from_array(light.color()) * light.intensity();
    let direction = world.transform_vector3(DVec3::NEG_Z).normalize_or(DVec3::NEG_Z);
    let (position, falloff) = (world.translation, Falloff::InverseSquare);
    match light.kind() {
        Kind::Directional => Light::Directional { direction, irradiance: color },
        Kind::Point => Light::Point { position, intensity: color, falloff },
        Kind::Spot { inner_cone_angle, outer_cone_angle } => Light::Spot {
            position,
            direction,
            intensity: color,
            beam_rad: f64::from(inner_cone_angle),
            cutoff_rad: f64::from(outer_cone_angle),
            exponent: 0.0,
            falloff,
        },
    }
}
