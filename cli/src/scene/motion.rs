//! What moves in a scene from frame to frame.

use super::description::{CameraPath, Description, ObjectPath, view_fault};
use super::{Camera, Mesh, Scene};
use crate::coordinate::{LARGEST, is_usable};
use crate::input_error::InputError;
use glam::{DAffine3, DQuat, DVec3, Vec3};
use pointillist_render::normal_matrix;
use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::Arc;

/// What moves in a scene from frame to frame; nothing by default.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    camera: CameraMotion,
    objects: Vec<MovingObject>,
}

#[derive(Clone, Debug, Default)]
enum CameraMotion {
    #[default]
    Still,
    /// And the error about it, without its message.
    Path(CameraPath, Box<InputError>),
    /// Around the target, in so many views.
    Turntable(u32),
}

/// An object on a path: which part of the scene's mesh it is, and what it is made of.
#[derive(Clone, Debug)]
pub(super) struct MovingObject {
    path: ObjectPath,
    /// What moves all of it, wherever it is on its path.
    placement: DAffine3,
    positions: Range<usize>,
    /// As in the file, shared by all copies.
    at_home: Arc<[DVec3]>,
    normals: Range<usize>,
    /// At frame 0.
    normals_at_start: Vec<Vec3>,
    /// The error about its path, without its message.
    fault: InputError,
}

impl MovingObject {
    /// The object that was added to a mesh last, from these positions and normals on.
    pub(super) fn new(
        path: &ObjectPath,
        placement: DAffine3,
        home: &Arc<[DVec3]>,
        mesh: &Mesh,
        [position, normal]: [usize; 2],
        fault: InputError,
    ) -> Self {
        Self {
            path: path.clone(),
            placement,
            positions: position..mesh.positions.len(),
            at_home: home.clone(),
            normals: normal..mesh.normals.len(),
            normals_at_start: mesh.normals[normal..].to_vec(),
            fault,
        }
    }

    fn pose(&self, mesh: &mut Mesh, frame: u32) -> Result<(), InputError> {
        let world = self.placement * self.path.world_from_mesh(frame);
        for (position, &home) in mesh.positions[self.positions.clone()].iter_mut().zip(&*self.at_home) {
            *position = world.transform_point3(home);
        }
        if let Some(index) = mesh.positions[self.positions.clone()].iter().position(|p| !is_usable(*p)) {
            let message =
                format!("at frame {frame}, vertex {index} is out of the range of numbers, ±{LARGEST:e}");
            return Err(InputError { message, ..self.fault.clone() });
        }
        let (turn, start) = (self.path.turn(frame), self.path.turn(0));
        // Normals at the start stand in the world, and turn as the object does before it is placed there.
        let placed = normal_matrix(self.placement.matrix3);
        let relative = placed * (turn * start.transpose()) * placed.inverse();
        // Where both are the same, their product is not quite the identity: normals stay those of the scene that was loaded.
        let turned =
            |n: Vec3| if turn == start { n } else { (relative * n.as_dvec3()).normalize_or_zero().as_vec3() };
        for (normal, &start) in mesh.normals[self.normals.clone()].iter_mut().zip(&self.normals_at_start) {
            *normal = turned(start);
        }
        Ok(())
    }
}

impl Motion {
    pub(super) fn new(description: &Description, objects: Vec<MovingObject>) -> Self {
        let camera = match &description.camera_path {
            None => CameraMotion::Still,
            Some(path) => {
                let fault = description.document.error(path.span, "");
                CameraMotion::Path(path.clone(), Box::new(fault))
            }
        };
        Self { camera, objects }
    }

    /// A camera that goes around its target once in so many views, counter-clockwise seen from above.
    #[must_use]
    pub fn turntable(views: u32) -> Self {
        Self { camera: CameraMotion::Turntable(views.max(1)), objects: vec![] }
    }

    /// Whether nothing moves.
    #[must_use]
    pub fn is_still(&self) -> bool {
        matches!(self.camera, CameraMotion::Still) && self.objects.is_empty()
    }

    /// The last frame in which the camera is not where it stays; 0 if it never moves.
    #[must_use]
    pub fn last_frame(&self) -> u32 {
        match &self.camera {
            CameraMotion::Still => 0,
            CameraMotion::Path(path, _) => path.last_frame(),
            CameraMotion::Turntable(views) => views - 1,
        }
    }

    /// The camera of a frame, of a scene whose camera at frame 0 is this.
    ///
    /// # Errors
    ///
    /// A camera without a direction.
    pub fn camera(&self, start: &Camera, frame: u32) -> Result<Camera, InputError> {
        match &self.camera {
            CameraMotion::Still => Ok(*start),
            CameraMotion::Path(path, fault) => {
                let (eye, target) = path.at(frame);
                let camera = Camera {
                    eye: eye.unwrap_or(start.eye),
                    target: target.unwrap_or(start.target),
                    ..*start
                };
                match view_fault(camera.eye, camera.target, camera.up) {
                    None => Ok(camera),
                    Some(found) => Err(InputError {
                        message: format!("`camera.path` at frame {frame}: {found}"),
                        ..(**fault).clone()
                    }),
                }
            }
            CameraMotion::Turntable(views) => {
                // The first view is the camera's own, to the last bit.
                if frame.is_multiple_of(*views) {
                    return Ok(*start);
                }
                let angle = TAU * f64::from(frame % views) / f64::from(*views);
                let turn = DQuat::from_axis_angle(start.up.normalize(), angle);
                Ok(Camera { eye: start.target + turn * (start.eye - start.target), ..*start })
            }
        }
    }

    /// Whether all objects are in the same place at two frames.
    #[must_use]
    pub fn same_objects(&self, a: u32, b: u32) -> bool {
        a == b || self.objects.iter().all(|o| o.path.world_from_mesh(a) == o.path.world_from_mesh(b))
    }

    /// Moves the objects of the scene to where they are at a frame.
    ///
    /// # Errors
    ///
    /// One that leaves the range of numbers.
    pub fn pose(&self, scene: &mut Scene, frame: u32) -> Result<(), InputError> {
        self.objects.iter().try_for_each(|object| object.pose(&mut scene.mesh, frame))
    }
}
