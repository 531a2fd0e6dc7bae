//! What shading knows of a scene, and the state of one micropoint while it is shaded.

use crate::ambient::{Ambient, Spot};
use crate::casters::{ClearBoxes, Occasion, Origin};
use crate::cryptomatte::MatteIds;
use crate::lights::SceneLights;
use crate::prepared::Prepared;
use crate::reflections::Reflections;
use crate::scene::Scene;
use crate::see_through::Sight;
use crate::shaft::Box3;
use crate::surfaces::Surfaces;
use glam::{DVec3, Vec3};
use pointillist_micropoint::{DepthRange, Face};
use pointillist_shade::Material;
use pointillist_view::View;

/// What a frame shows of the scene's light.
#[derive(Clone, Copy)]
pub(crate) struct Style<'a> {
    /// Light that does not come straight from lights.
    pub(crate) ambient: Ambient<'a>,
    /// Which surfaces that glow are seen to glow.
    pub(crate) glow: Glow,
    /// What comes straight from the lights is seen.
    pub(crate) lights: bool,
    /// For pictures that are only summed up: fewer questions about details within a pixel.
    pub(crate) economy: Option<Economy>,
    /// Surfaces at other depths are not seen.
    pub(crate) depths: DepthRange,
    /// The background's colour is seen in the place of the environment.
    pub(crate) hides_environment: bool,
}

/// Whose emission is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Glow {
    Nothing,
    /// That of materials which light others directly is left out, as lights are: it counts already.
    OtherThanLights,
    Everything,
}

/// How much is asked about details smaller than a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Economy {
    /// Fragments of a pixel whose shadow is computed, for each light.
    pub(crate) shadows_per_pixel: usize,
    /// Fragments of a micropoint, the heaviest, whose texels are averaged.
    pub(crate) textures_per_micropoint: usize,
    /// Whether lights with an area are taken as points.
    pub(crate) samples_areas: bool,
}

impl Economy {
    /// Squares on a side of a cell under masks.
    pub(crate) const SQUARES_UNDER_MASKS: u32 = 1;
}

/// What all tiles share.
pub(crate) struct Shader<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) surfaces: &'a Surfaces,
    pub(crate) reflections: &'a Reflections,
    pub(crate) lights: &'a SceneLights<'a>,
    pub(crate) clear: &'a ClearBoxes,
    pub(crate) economy: Option<Economy>,
    pub(crate) ambient: Ambient<'a>,
    pub(crate) glow: Glow,
    pub(crate) mattes: MatteIds,
    pub(crate) eye: DVec3,
    pub(crate) forward: DVec3,
    /// Whether all is seen along `forward`: there is no field of view.
    pub(crate) is_parallel: bool,
    /// 1 for the channels that are shaded, 0 for the others.
    pub(crate) channels: Vec3,
    /// As [`Sight::own_light`].
    pub(crate) own_light: &'a [f64],
}

/// Where a micropoint is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// World position.
    pub(crate) position: DVec3,
    /// Only known where something is interpolated between corners.
    pub(crate) barycentric: Vec3,
    /// Zero where nothing depends on it: see [`FaceLook::depends_on_view`](crate::face_look::FaceLook::depends_on_view).
    pub(crate) to_eye: Vec3,
    /// Unit face normal, on the eye's side.
    pub(crate) face_normal: Vec3,
}

impl Place {
    /// Of what looks the same everywhere.
    const NONE: Self =
        Self { position: DVec3::ZERO, barycentric: Vec3::ZERO, to_eye: Vec3::ZERO, face_normal: Vec3::ZERO };
}

/// A micropoint while it is shaded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) place: Place,
    /// Unit normal to shade with.
    pub(crate) normal: Vec3,
    pub(crate) material: Material,
    pub(crate) direct: Vec3,
    /// Reflected ambient light.
    pub(crate) indirect: Vec3,
}

impl Point {
    /// A point whose place nobody asks for, of a surface that reflects nothing.
    pub(crate) const fn constant(material: Material) -> Self {
        Self { place: Place::NONE, normal: Vec3::ZERO, material, direct: Vec3::ZERO, indirect: Vec3::ZERO }
    }
}

/// A point of a surface before light is added.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadedSurface {
    pub(crate) triangle: u32,
    /// Whether its front is seen.
    pub(crate) front: bool,
    pub(crate) position: DVec3,
    pub(crate) to_eye: Vec3,
    pub(crate) face_normal: Vec3,
    /// See [`Spot::side`].
    pub(crate) side: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) material: Material,
}

impl ShadedSurface {
    /// Where ambient light is asked for, from around a direction.
    pub(crate) fn spot(&self, normal: Vec3) -> Spot {
        let Self { position, triangle, front, side, .. } = *self;
        Spot { position, triangle, front, side, normal }
    }
}

impl<'a> Shader<'a> {
    pub(crate) fn new(
        prepared: &'a Prepared<'_>,
        lights: &'a SceneLights<'a>,
        view: &View,
        style: &Style<'a>,
        (sight, channels): (&'a Sight, Vec3),
    ) -> Self {
        let Style { ambient, glow, economy, .. } = *style;
        Self {
            scene: prepared.scene,
            surfaces: &prepared.surfaces,
            reflections: &prepared.reflections,
            lights,
            clear: &prepared.clear_boxes,
            economy,
            ambient,
            glow,
            mattes: MatteIds::default(),
            eye: view.eye(),
            forward: view.forward(),
            is_parallel: !view.projection().is_perspective(),
            channels,
            own_light: &sight.own_light,
        }
    }

    /// Whether an entry of a light, which brings these channels, counts for what is in a box.
    pub(crate) fn counts(&self, channels: Vec3, occasion: Occasion, origin: Origin, receivers: Box3) -> bool {
        let on_occasion = match occasion {
            Occasion::Always => true,
            Occasion::Untinted => !self.clear.may_tint(origin, receivers),
            Occasion::Tinted => self.clear.may_tint(origin, receivers),
        };
        channels * self.channels != Vec3::ZERO && on_occasion
    }

    /// Unit vector from a place towards the eye.
    pub(crate) fn to_eye(&self, position: DVec3) -> Vec3 {
        match self.is_parallel {
            true => -self.forward.as_vec3(),
            false => (self.eye - position).normalize_or_zero().as_vec3(),
        }
    }

    /// Unit normals of a face's corners, if it has them, on the side that is seen.
    pub(crate) fn corner_normals(&self, face: &Face) -> Option<[Vec3; 3]> {
        let (triangle, corners) = match self.surfaces.other_side(face.id) {
            Some(side) if !face.front => (face.id + side.ahead, side.corners),
            _ => (face.id, [0, 1, 2]),
        };
        let normals = self.scene.mesh.corner_normals(triangle)?;
        Some(corners.map(|k| normals[k]))
    }

    /// The triangle whose front or back is seen: of two that coincide, the one that is turned this way.
    pub(crate) fn seen_triangle(&self, face: &Face) -> u32 {
        match self.surfaces.other_side(face.id) {
            Some(side) if !face.front => face.id + side.ahead,
            _ => face.id,
        }
    }

    /// Whether a surface's back is seen, which is not the front of another one.
    pub(crate) fn shows_back(&self, face: &Face) -> bool {
        !face.front && self.surfaces.other_side(face.id).is_none()
    }
}
