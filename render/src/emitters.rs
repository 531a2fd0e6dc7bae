//! Surfaces that light others directly: the polygons of materials with [`Details::emits`](crate::Details::emits).
//!
//! Emitting triangles that share corners are one lamp. How finely its polygons are asked follows the lamp's width, not theirs: a shadow's outline
//! that passes over one of a hundred facets changes a hundredth of the light. Of a closed lamp, the inner sides light nothing outside.

use crate::joined::{joined_polygons, place};
use crate::scene::Scene;
use crate::surfaces::Surfaces;
use glam::{DVec2, DVec3, Vec3};
use pointillist_micropoint::{SurfacePoint, TexturedOpacity};
use std::collections::HashMap;

/// A convex polygon that shines.
#[derive(Clone, Debug)]
pub(crate) struct EmittingPolygon {
    /// Counter-clockwise as seen from the front.
    pub(crate) vertices: Vec<DVec3>,
    /// The triangles that it is.
    pub(crate) triangles: Vec<u32>,
    pub(crate) radiance: Vec3,
    pub(crate) front: Side,
    pub(crate) back: Side,
    /// Side of a square as large as its lamp looks.
    pub(crate) lamp_width: f64,
}

/// What a side of a polygon lights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Side {
    /// It is not drawn.
    Dark,
    /// Everything in front of it.
    Lights,
    /// What is in this box: it is an inner side of a closed lamp.
    LightsWithin(DVec3, DVec3),
}

/// The polygons of a scene that shine. `radiance_of` tells that of a triangle whose material emits.
pub(crate) fn emitting_polygons(scene: &Scene, radiance_of: impl Fn(u32) -> Vec3) -> Vec<EmittingPolygon> {
    let mesh = &scene.mesh;
    let material = |t: u32| &scene.materials[mesh.material(t) as usize];
    if !scene.materials.iter().any(|material| material.details.emits) {
        return vec![];
    }
    let mut emitting: Vec<u32> = mesh.numbers().filter(|&t| material(t).details.emits).collect();
    // By place: how triangles are joined does not depend on their order.
    emitting.sort_by_cached_key(|&t| scene.corners(t).map(place));
    if emitting.is_empty() {
        return vec![];
    }
    let lamps = Lamps::new(scene, &emitting);
    let of = |t: u32| (mesh.material(t), mesh.object(t));
    let alike = |a: u32, b: u32| of(a) == of(b);
    let polygons = joined_polygons(scene, &emitting, alike).into_iter();
    let shining = polygons.map(|polygon| {
        let first = polygon.triangles[0];
        let lamp = lamps.of(first);
        let two_sided =
            mesh.objects[mesh.object(first) as usize].two_sided && !material(first).details.one_sided;
        let inner = |side| lamp.inner_side() == Some(side);
        let side = |drawn: bool, is_inner: bool| match (drawn, is_inner) {
            (false, _) => Side::Dark,
            (true, false) => Side::Lights,
            (true, true) => Side::LightsWithin(lamp.low, lamp.high),
        };
        EmittingPolygon {
            radiance: mean_radiance(scene, &polygon.triangles, &radiance_of),
            front: side(true, inner(Inner::Front)),
            back: side(two_sided, inner(Inner::Back)),
            lamp_width: lamp.width(),
            vertices: polygon.vertices,
            triangles: polygon.triangles,
        }
    });
    shining.filter(|polygon| polygon.radiance != Vec3::ZERO).collect()
}

/// What a triangle sends out, its maps averaged over it: its emission times its opacity, each with the mean of its own map.
pub(crate) fn radiance_of_triangle(scene: &Scene, surfaces: &Surfaces, triangle: u32) -> Vec3 {
    let surface = &scene.materials[scene.mesh.material(triangle) as usize].surface;
    let [a, b, c] = scene.corners(triangle);
    // The triangle in its plane, as a picture of it from straight above.
    let along = (b - a).normalize_or_zero();
    let aside = (b - a).cross(c - a).normalize_or_zero().cross(along);
    let in_plane = |p: DVec3| DVec2::new(along.dot(p - a), aside.dot(p - a));
    let corner = |p: DVec3, barycentric: DVec3| SurfacePoint {
        grid: in_plane(p),
        nearness: 1.0,
        rational: 1.0,
        barycentric,
    };
    let polygon = [corner(a, DVec3::X), corner(b, DVec3::Y), corner(c, DVec3::Z)];
    let map = surfaces
        .details(triangle)
        .map_or(Vec3::ONE, |maps| maps.emission(surfaces.uvs(), triangle, &polygon));
    surface.emission * map * (surface.opacity * surfaces.mean_opacity(triangle, &polygon))
}

/// Mean over triangles, by area.
fn mean_radiance(scene: &Scene, triangles: &[u32], radiance_of: impl Fn(u32) -> Vec3) -> Vec3 {
    let area = |t: u32| area_vector(scene.corners(t)).length();
    if let [only] = triangles {
        return radiance_of(*only);
    }
    let first = radiance_of(triangles[0]);
    if triangles.iter().all(|&t| radiance_of(t) == first) {
        return first;
    }
    let sum: glam::DVec3 = triangles.iter().map(|&t| radiance_of(t).as_dvec3() * area(t)).sum();
    (sum / triangles.iter().map(|&t| area(t)).sum::<f64>()).as_vec3()
}

fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a) * 0.5
}

/// Which sides of a closed lamp's triangles look inward.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Inner {
    Front,
    Back,
}

/// Emitting triangles that share corners.
#[derive(Clone, Debug)]
struct EmittingLamp {
    low: DVec3,
    high: DVec3,
    /// Sums of what triangles look like from +x, +y, +z and from −x, −y, −z.
    seen: [DVec3; 2],
    /// Six times the volume, relative to `low`, where every edge has its opposite.
    volume: Option<f64>,
}

impl EmittingLamp {
    fn width(&self) -> f64 {
        self.seen[0].max(self.seen[1]).max_element().sqrt()
    }

    fn inner_side(&self) -> Option<Inner> {
        let volume = self.volume.filter(|&v| v != 0.0)?;
        Some(if volume > 0.0 { Inner::Back } else { Inner::Front })
    }
}

/// The lamps of a scene, by triangle.
struct Lamps {
    of_triangle: HashMap<u32, usize>,
    list: Vec<EmittingLamp>,
}

impl Lamps {
    fn new(scene: &Scene, emitting: &[u32]) -> Self {
        let mut parents: Vec<usize> = (0..emitting.len()).collect();
        let mut at_corner = HashMap::new();
        for (i, &t) in emitting.iter().enumerate() {
            for corner in scene.corners(t) {
                let other = *at_corner.entry(place(corner)).or_insert(i);
                let (a, b) = (root(&mut parents, i), root(&mut parents, other));
                parents[a.max(b)] = a.min(b);
            }
        }
        let mut members: Vec<Vec<u32>> = vec![vec![]; emitting.len()];
        for (i, &t) in emitting.iter().enumerate() {
            members[root(&mut parents, i)].push(t);
        }
        members.retain(|m| !m.is_empty());
        let numbered = members.iter().enumerate();
        let of_triangle = numbered.flat_map(|(lamp, m)| m.iter().map(move |&t| (t, lamp))).collect();
        Self { of_triangle, list: members.iter().map(|m| lamp(scene, m)).collect() }
    }

    fn of(&self, triangle: u32) -> &EmittingLamp {
        &self.list[self.of_triangle[&triangle]]
    }
}

/// The first of a set, by parents that come before their children.
fn root(parents: &mut [usize], mut i: usize) -> usize {
    while parents[i] != i {
        parents[i] = parents[parents[i]];
        i = parents[i];
    }
    i
}

fn lamp(scene: &Scene, triangles: &[u32]) -> EmittingLamp {
    let corners = || triangles.iter().map(|&t| scene.corners(t));
    let (low, high) = corners()
        .flatten()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    let areas = || corners().map(area_vector);
    let seen = [areas().map(|a| a.max(DVec3::ZERO)).sum(), areas().map(|a| (-a).max(DVec3::ZERO)).sum()];
    let mut open: HashMap<[[u64; 3]; 2], i32> = HashMap::new();
    for ring in corners() {
        for k in 0..3 {
            let (a, b) = (place(ring[k]), place(ring[(k + 1) % 3]));
            // An edge without length has no direction, and none is needed.
            if a != b {
                *open.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
    }
    let is_closed = open.values().all(|&n| n == 0);
    let volume = || corners().map(|[a, b, c]| (a - low).dot((b - low).cross(c - low))).sum();
    EmittingLamp { low, high, seen, volume: is_closed.then(volume) }
}
