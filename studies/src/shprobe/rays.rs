//! What a probe sees, by rays: an independent eye, and for scenes of many small triangles a cheaper one than pictures.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;
use pointillist_render::{Capture, Lightmap, Scene};
use pointillist_sh::{CubePoint, cube_direction};
use pointillist_shade::face_normal;

use crate::common::ray_reference::Tree;
use crate::common::scenes::{SurfaceSample, corners, radiance};

/// What is seen from a position: six faces, as [`Capture`] has them.
pub(crate) struct Look {
    pub(crate) size: usize,
    /// Linear radiance in planes.
    pub(crate) radiance: [Vec<f32>; 3],
    /// +∞ where nothing is.
    pub(crate) distance: Vec<f32>,
}

impl From<Capture> for Look {
    fn from(capture: Capture) -> Self {
        Self { size: capture.size, radiance: capture.radiance, distance: capture.distance }
    }
}

/// One ray through the middle of each texel; shading flat, glass opaque. What the lights shine on is seen, and what
/// surfaces without maps reflect of `sent_on`.
pub(crate) fn look_by_rays(
    scene: &Scene,
    tree: &Tree,
    sent_on: Option<&Lightmap>,
    from: DVec3,
    size: u32,
) -> Look {
    let n = size as usize;
    let middle = |i: usize| (2 * i + 1) as f64 / n as f64 - 1.0;
    let mut look = Look { size: n, radiance: Default::default(), distance: vec![] };
    for (face, y, x) in (0..6).flat_map(|f| (0..n).flat_map(move |y| (0..n).map(move |x| (f, y, x)))) {
        let way = cube_direction(CubePoint { face, s: middle(x), t: middle(y) }).normalize();
        let (light, distance) = arriving(scene, tree, sent_on, from, way);
        look.radiance.iter_mut().zip(light.to_array()).for_each(|(plane, v)| plane.push(v as f32));
        look.distance.push(distance as f32);
    }
    look
}

/// Radiance from a direction, and how far what it comes from is.
pub(crate) fn arriving(
    scene: &Scene,
    tree: &Tree,
    sent_on: Option<&Lightmap>,
    from: DVec3,
    way: DVec3,
) -> (DVec3, f64) {
    let Some((triangle, distance)) = tree.nearest(from, way, 0.0) else {
        return (scene.image.background.as_dvec3(), f64::INFINITY);
    };
    let at = SurfaceSample { triangle, position: from + way * distance, to_eye: -way };
    let visible = |at: &SurfaceSample, light: usize, sample: u32| {
        tree.transmittance(at, scene.lights[light].light.source(sample))
    };
    let ambient = sent_on.map_or(DVec3::ZERO, |light| {
        let [a, b, c] = corners(scene, triangle as usize);
        let front = face_normal(a, b, c).dot(way) < 0.0;
        let material = scene.mesh.material_of[triangle as usize] as usize;
        let albedo = scene.materials[material].surface.diffuse;
        (albedo * light.irradiance(triangle, front, at.position)).as_dvec3() * FRAC_1_PI
    });
    (radiance(scene, &at, &visible) + ambient, distance)
}
