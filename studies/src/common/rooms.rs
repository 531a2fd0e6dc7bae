//! Rooms made by code, to be lit by probes.

use glam::{DVec3, Vec3, dvec3, vec3};
use pointillist_render::Scene;
use pointillist_shade::{Falloff, Light, Material};

use crate::common::scenes::Sketch;

/// Length, height and depth of the two rooms together.
pub(crate) const ROOMS: DVec3 = dvec3(8.0, 3.0, 4.0);

/// Where the wall between them begins and ends.
pub(crate) const WALL: [f64; 2] = [3.9, 4.1];

/// Where the doorway begins and ends along z, and how high it is.
const DOOR: [f64; 2] = [1.5, 2.5];
const DOOR_HEIGHT: f64 = 2.1;

/// How far the wall reaches into floor, ceiling and side walls: closed bodies must not share edges.
const SUNK: f64 = 0.002;

const GREY: Vec3 = Vec3::splat(0.7);
const RED: Vec3 = vec3(0.8, 0.15, 0.1);
const GREEN: Vec3 = vec3(0.15, 0.7, 0.2);
const BLUE: Vec3 = vec3(0.1, 0.2, 0.8);

/// Length of the squares of which walls are made: probes are placed above their corners, too.
const SQUARE: f64 = 0.5;

/// The same of a wall of 10 cm. It begins where squares of floor and ceiling meet: no patch of light reaches below it
/// from the bright room into the dark one.
pub(crate) const THIN_WALL: [f64; 2] = [4.0, 4.1];

/// Two rooms with a doorway, and a lamp in the first. The end walls are coloured.
pub(crate) fn two_rooms() -> Scene {
    rooms_with(WALL)
}

/// Two rooms with a wall of 10 cm.
pub(crate) fn thin_wall_rooms() -> Scene {
    rooms_with(THIN_WALL)
}

fn rooms_with(wall: [f64; 2]) -> Scene {
    let mut sketch = Sketch::new(dvec3(0.4, 1.7, 0.4), dvec3(5.0, 1.2, 2.2), 75.0, 256);
    room(&mut sketch, ROOMS, [RED, BLUE]);
    dividing_wall(&mut sketch, wall);
    lamp(&mut sketch, dvec3(2.0, 1.8, 2.0), 10.0);
    sketch.scene
}

/// Length, height and depth of the closed box.
pub(crate) const BOX: DVec3 = dvec3(4.0, 3.0, 4.0);

/// One room without a way out, with coloured ends and a lamp.
pub(crate) fn closed_box() -> Scene {
    let mut sketch = Sketch::new(dvec3(0.4, 1.7, 0.4), dvec3(3.0, 1.2, 2.2), 75.0, 256);
    room(&mut sketch, BOX, [RED, BLUE]);
    lamp(&mut sketch, dvec3(1.5, 2.2, 1.8), 10.0);
    sketch.scene
}

/// The paper's *Basic*: red, green and blue walls on three sides of a floor, under a lamp.
pub(crate) fn basic() -> Scene {
    let mut sketch = Sketch::new(dvec3(2.0, 3.0, 9.0), dvec3(2.0, 1.0, 0.0), 45.0, 256);
    let size = dvec3(4.0, 3.0, 4.0);
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z);
    let walls = [
        ([DVec3::ZERO, z, x], GREY),
        ([DVec3::ZERO, y, z], RED),
        ([DVec3::ZERO, x, y], GREEN),
        ([x, z, y], BLUE),
    ];
    for ([origin, u, v], color) in walls {
        let material = sketch.material(Material::lambert(color), None);
        squares(&mut sketch, [origin, u, v], material);
    }
    lamp(&mut sketch, dvec3(2.0, 2.6, 2.4), 10.0);
    sketch.scene
}

fn lamp(sketch: &mut Sketch, position: DVec3, intensity: f32) {
    let intensity = Vec3::splat(intensity);
    sketch.light(Light::Point { position, intensity, falloff: Falloff::InverseSquare });
}

/// The inner sides of a box, with the two ends of x in colours.
fn room(sketch: &mut Sketch, size: DVec3, ends: [Vec3; 2]) {
    let (x, y, z) = (DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z);
    let walls = [
        ([DVec3::ZERO, y, z], ends[0]),
        ([x, z, y], ends[1]),
        ([DVec3::ZERO, z, x], GREY),
        ([y, x, z], GREY),
        ([DVec3::ZERO, x, y], GREY),
        ([z, y, x], GREY),
    ];
    for ([origin, u, v], color) in walls {
        let material = sketch.material(Material::lambert(color), None);
        squares(sketch, [origin, u, v], material);
    }
}

/// A rectangle of squares, whose normal is along u × v.
fn squares(sketch: &mut Sketch, [origin, u, v]: [DVec3; 3], material: u32) {
    let count = |side: DVec3| (side.length() / SQUARE).round().max(1.0) as u32;
    let (columns, rows) = (count(u), count(v));
    let at = |i: u32, j: u32| {
        origin + u * (f64::from(i) / f64::from(columns)) + v * (f64::from(j) / f64::from(rows))
    };
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        let corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        sketch.polygon(&corners, material);
    }
}

/// A closed body with a hole in it: cells of a grid across the room, of which the one of the doorway is left out.
fn dividing_wall(sketch: &mut Sketch, wall: [f64; 2]) {
    let material = sketch.material(Material::lambert(GREY), None);
    let z = [-SUNK, DOOR[0], DOOR[1], ROOMS.z + SUNK];
    let y = [-SUNK, DOOR_HEIGHT, ROOMS.y + SUNK];
    let is_wall = |i: i32, j: i32| (0..3).contains(&i) && (0..2).contains(&j) && (i, j) != (1, 0);
    let at = |side: usize, i: i32, j: i32| dvec3(wall[side], y[j as usize], z[i as usize]);
    for (i, j) in (0..2).flat_map(|j| (0..3).map(move |i| (i, j))).filter(|&(i, j)| is_wall(i, j)) {
        let face =
            |side: usize| [at(side, i, j), at(side, i + 1, j), at(side, i + 1, j + 1), at(side, i, j + 1)];
        sketch.polygon(&face(0), material);
        let [a, b, c, d] = face(1);
        sketch.polygon(&[d, c, b, a], material);
        // Where there is no neighbour, the side: from one corner to the next, counter-clockwise as seen from below x.
        let sides = [((i, j - 1), [i, j], [i + 1, j]), ((i + 1, j), [i + 1, j], [i + 1, j + 1])];
        let others = [((i, j + 1), [i + 1, j + 1], [i, j + 1]), ((i - 1, j), [i, j + 1], [i, j])];
        for ((ni, nj), from, to) in sides.into_iter().chain(others) {
            if !is_wall(ni, nj) {
                let [near, far] = [0, 1].map(|side| [at(side, from[0], from[1]), at(side, to[0], to[1])]);
                sketch.polygon(&[near[1], near[0], far[0], far[1]], material);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pointillist_render::Prepared;

    #[test]
    fn the_wall_is_solid_and_the_rooms_and_the_doorway_are_not() {
        let scene = two_rooms();
        let prepared = Prepared::new(&scene, &()).expect("the rooms are a valid scene");
        let solids = |x, y, z| prepared.geometry().solids_around(dvec3(x, y, z)).len();
        assert_eq!(solids(4.0, 1.0, 0.5), 1);
        assert_eq!(solids(4.0, 2.5, 2.0), 1);
        for free in [[2.0, 1.0, 1.0], [6.0, 1.0, 1.0], [4.0, 1.0, 2.0]] {
            assert_eq!(solids(free[0], free[1], free[2]), 0, "{free:?}");
        }
    }
}
