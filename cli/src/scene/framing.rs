//! A camera that has everything in view, and a light for a mesh that comes without.

use super::description::{CameraDescription, DEFAULT_FOV_DEG, Description, view_fault};
use super::{AmbientLight, Camera, LightSource, Mesh, Projection, Resolution, Scene};
use crate::input_error::InputError;
use glam::{DVec3, Vec3};
use pointillist_shade::Light;

/// From the scene towards a camera that nothing is said about: in front, a little to the right and above.
const TOWARDS_EYE: DVec3 = DVec3::new(0.45, 0.35, 1.0);

/// Room around a framed scene.
const MARGIN: f64 = 1.05;

/// The camera that is given for a description, with what it leaves open chosen so that the mesh fills the view.
pub(super) fn place(
    description: &Description,
    given: &CameraDescription,
    mesh: &Mesh,
    aspect: f64,
) -> Result<Camera, InputError> {
    around(given, || corners(mesh), aspect).map_err(|fault| {
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
    let fov = Projection::Perspective { fov_y_rad: DEFAULT_FOV_DEG.to_radians() };
    let mut camera = Camera {
        eye: given.eye.unwrap_or(DVec3::ZERO),
        target: given.target.unwrap_or_else(|| middle(points())),
        up: given.up,
        projection: given.projection.unwrap_or(fov),
    };
    if given.eye.is_none() {
        let mut towards = TOWARDS_EYE.normalize();
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

fn corners(mesh: &Mesh) -> impl Iterator<Item = DVec3> + '_ {
    mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize])
}

fn middle(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let around =
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    // Halved before adding: the sum of two finite numbers may be infinite.
    let middle = around.0 * 0.5 + around.1 * 0.5;
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

/// Adds a light over the left shoulder with shadow, and some ambient light if there is none.
pub(super) fn add_light(scene: &mut Scene) {
    /// A white surface that faces the light gets radiance near 1.
    const IRRADIANCE: f32 = 2.8;
    const AMBIENT: f32 = 0.12;
    let [right, up, backward] = scene.camera.axes();
    let towards_light = -0.5 * right + 0.9 * up + 0.8 * backward;
    scene.lights.push(LightSource {
        name: "light0".to_owned(),
        light: Light::Directional { direction: -towards_light, irradiance: Vec3::splat(IRRADIANCE) },
        shadow: true,
        resolution: Resolution::Auto,
    });
    if matches!(scene.ambient, AmbientLight::Color(Vec3::ZERO)) {
        scene.ambient = AmbientLight::Color(Vec3::splat(AMBIENT));
    }
}
