//! Frames a scene: the camera from which everything is in view.

use super::description::{CameraDescription, DEFAULT_FOV_DEG, Description, view_fault};
use super::{Camera, Mesh, Projection};
use crate::input_error::InputError;
use glam::DVec3;

/// From the scene towards a camera that nothing is said about: in front, a little to the right and above.
const TOWARDS_EYE: DVec3 = DVec3::new(0.45, 0.35, 1.0);

/// How far the upper third of a model leans to one side, over the model's depth, to be taken for its front: heads are
/// held up and forward. Buildings, trees and pots lean by less.
const LEANS: f64 = 0.15;

/// Room around a framed scene.
pub(crate) const MARGIN: f64 = 1.05;

/// The camera that is given for a description, with what it leaves open chosen so that the mesh fills the view.
pub(super) fn place(
    description: &Description,
    given: &CameraDescription,
    mesh: &Mesh,
    aspect: f64,
) -> Result<Camera, InputError> {
    // Where up is another axis, nothing is known about fronts.
    let is_turned = given.eye.is_none() && given.up == DVec3::Y && leans_back(mesh);
    let turned = if is_turned { DVec3::new(-1.0, 1.0, -1.0) } else { DVec3::ONE };
    around_from(given, || corners(mesh), aspect, TOWARDS_EYE * turned).map_err(|fault| {
        let error = InputError::of_file(description.document.name(), format!("camera: {fault}"));
        error.with_help("give camera.eye and camera.target")
    })
}

/// The given camera, with what it leaves open chosen so that the points fill the view; `Err` says what is
/// wrong with what is given.
pub(crate) fn around<I: Iterator<Item = DVec3>>(
    given: &CameraDescription,
    points: impl Fn() -> I,
    aspect: f64,
) -> Result<Camera, &'static str> {
    around_from(given, points, aspect, TOWARDS_EYE)
}

fn around_from<I: Iterator<Item = DVec3>>(
    given: &CameraDescription,
    points: impl Fn() -> I,
    aspect: f64,
    towards_eye: DVec3,
) -> Result<Camera, &'static str> {
    let fov = Projection::Perspective { fov_y_rad: DEFAULT_FOV_DEG.to_radians() };
    let mut camera = Camera {
        eye: given.eye.unwrap_or(DVec3::ZERO),
        target: given.target.unwrap_or_else(|| middle(points())),
        up: given.up,
        projection: given.projection.unwrap_or(fov),
    };
    if given.eye.is_none() {
        let mut towards = towards_eye.normalize();
        if view_fault(towards, DVec3::ZERO, camera.up).is_some() {
            towards = DVec3::Z;
        }
        camera.eye = camera.target + towards;
        camera.eye = camera.target + towards * distance(&camera, points(), aspect);
    }
    match view_fault(camera.eye, camera.target, camera.up) {
        None => Ok(camera),
        Some(fault) => Err(fault),
    }
}

/// How far from its target a camera has to be, in the direction in which it is, so that the mesh fills the view.
pub(crate) fn distance_to(camera: &Camera, mesh: &Mesh, aspect: f64) -> f64 {
    distance(camera, corners(mesh), aspect)
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = DVec3> + '_ {
    mesh.world_triangles().flat_map(|(_, corners)| corners)
}

/// Whether a model's upper part lies towards −Z, so that +Z sees its back.
fn leans_back(mesh: &Mesh) -> bool {
    let (low, high) = bounds(corners(mesh));
    let size = high - low;
    let from = high.y - size.y / 3.0;
    let (mut area, mut moment) = (0.0, 0.0);
    for (_, [a, b, c]) in mesh.world_triangles() {
        let centre = (a + b + c) / 3.0;
        if centre.y >= from {
            let twice = (b - a).cross(c - a).length();
            area += twice;
            moment += twice * (centre.z - 0.5 * (low.z + high.z));
        }
    }
    moment < -LEANS * size.z * area
}

/// Least and greatest coordinates; infinite, and the wrong way round, of no points.
fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

fn middle(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (low, high) = bounds(points);
    // Halved before adding: the sum of two finite numbers may be infinite.
    let middle = low * 0.5 + high * 0.5;
    if middle.is_finite() { middle } else { DVec3::ZERO }
}

/// How far from its target the camera has to be, along the direction it has.
fn distance(camera: &Camera, points: impl Iterator<Item = DVec3>, aspect: f64) -> f64 {
    let [right, up, backward] = camera.axes();
    let reach = |p: DVec3| {
        let p = p - camera.target;
        (p.dot(right).abs(), p.dot(up).abs(), p.dot(backward))
    };
    let needed = match camera.projection {
        Projection::Perspective { fov_y_rad } => {
            // A point is in view if |y| ≤ (distance − z) · tan(fov/2), and |x| likewise.
            let tan_y = (0.5 * fov_y_rad).tan();
            let tan_x = tan_y * aspect;
            points.map(reach).map(|(x, y, z)| z + (x / tan_x).max(y / tan_y)).fold(0.0, f64::max)
        }
        Projection::Orthographic { height } => points.map(reach).map(|(_, _, z)| z).fold(height, f64::max),
    };
    let distance = MARGIN * needed;
    if distance.is_finite() && distance > 0.0 { distance } else { 1.0 }
}
