//! Two rooms with a door between them, and the light in them: a lamp on the ceiling of one, and what walls reflect of it again and again.
//!
//! Metres; +Y is up. The rooms lie side by side along X.

use crate::SiteError;
use crate::rays::Panel;
use glam::{DVec2, DVec3, dvec2, dvec3};
use pointillist_radiosity::{Baked, BakedTriangle, Scene, SceneOptions, SolveOptions, Surface};

/// The plan's size along X and Z.
pub(crate) const PLAN: DVec2 = dvec2(8.0, 4.0);
pub(crate) const HEIGHT: f64 = 2.6;
/// Both faces of the wall between the rooms.
pub(crate) const WALL: [f64; 2] = [3.9, 4.1];
/// The door in it, along Z.
pub(crate) const DOOR: [f64; 2] = [2.6, 3.5];
const DOOR_HEIGHT: f64 = 2.1;

/// Distance of the nodes at which light is kept, at most.
const NODE_SPACING: f64 = 0.1;
/// Sides of the largest patches, and the part of all light by which a link may be wrong: a percent at the walls.
const PATCH: f64 = 0.5;
const TOLERANCE: f64 = 0.02;

const WHITE: DVec3 = dvec3(0.75, 0.74, 0.72);
const RED: DVec3 = dvec3(0.70, 0.22, 0.16);
const BLUE: DVec3 = dvec3(0.20, 0.34, 0.62);
const WOOD: DVec3 = dvec3(0.52, 0.40, 0.30);
/// Exitance of the lamp.
const LAMP: DVec3 = dvec3(46.0, 41.0, 33.0);

/// A rectangle with its material.
struct Part {
    panel: Panel,
    reflectance: DVec3,
    emission: DVec3,
}

/// All surfaces, with the light that leaves them, and the number of patches that it was computed for.
pub(crate) fn lit() -> Result<(Vec<Panel>, usize), SiteError> {
    let parts = parts();
    let surface = |part: &Part| {
        let Panel { origin, sides: [u, v], .. } = part.panel;
        Surface::new(&[origin, origin + u, origin + u + v, origin + v], part.reflectance.to_array())
            .emitting(part.emission.to_array())
    };
    let surfaces: Vec<_> = parts.iter().map(surface).collect();
    let options = SceneOptions::DEFAULT.with_patch(PATCH).with_tolerance(Some(TOLERANCE));
    let transport = Scene::new(&surfaces, &options)?.transport(&[])?;
    let baked = transport.gauss_seidel(&SolveOptions::DEFAULT)?.bake();
    let panels = parts.into_iter().zip(0..).map(|(part, number)| with_light(part.panel, number, &baked));
    Ok((panels.collect(), transport.patch_count()))
}

/// The panel with light at its nodes, from the triangles of its patches.
fn with_light(mut panel: Panel, number: u32, baked: &Baked) -> Panel {
    let of_panel: Vec<_> = baked.triangles.iter().filter(|t| t.surface == number).collect();
    let [columns, rows] = panel.nodes;
    let place =
        |i: usize| [(i % columns) as f64 / (columns - 1) as f64, (i / columns) as f64 / (rows - 1) as f64];
    let light = |i: usize| radiosity_at(panel.at(place(i)), &of_panel, baked);
    panel.light = (0..columns * rows).map(light).collect();
    panel
}

/// The radiosity at a point of the triangle that holds it most clearly.
fn radiosity_at(point: DVec3, triangles: &[&BakedTriangle], baked: &Baked) -> DVec3 {
    let weights = |triangle: &&BakedTriangle| {
        let [a, b, c] = triangle.vertices.map(|v| baked.vertices[v as usize].position);
        let normal = (b - a).cross(c - a);
        let share =
            |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
        let weights = [share(b, c), share(c, a), share(a, b)];
        (weights, triangle.vertices, weights.into_iter().fold(f64::INFINITY, f64::min))
    };
    let best = triangles.iter().map(weights).max_by(|a, b| a.2.total_cmp(&b.2));
    best.map_or(DVec3::ZERO, |(weights, vertices, _)| {
        let of = |(v, w): (u32, f64)| w * DVec3::from_array(baked.vertices[v as usize].radiosity);
        vertices.into_iter().zip(weights).map(of).sum()
    })
}

fn parts() -> Vec<Part> {
    let mut parts = room(0.0, WALL[0], [RED, WHITE]);
    parts.extend(room(WALL[1], PLAN.x, [WHITE, BLUE]));
    parts.extend(door());
    // A panel just below the ceiling: nothing sees between them but at grazing angles.
    let lamp = part(dvec3(1.4, HEIGHT - 0.02, 1.4), DVec3::X * 1.2, DVec3::Z * 1.2, DVec3::ZERO);
    parts.push(Part { emission: LAMP, ..lamp });
    parts
}

/// A room between two coordinates along X, with the colours of the walls there; where the other room is, the wall has a door.
fn room(west: f64, east: f64, [west_color, east_color]: [DVec3; 2]) -> Vec<Part> {
    let (x, z) = (DVec3::X * (east - west), DVec3::Z * PLAN.y);
    let y = DVec3::Y * HEIGHT;
    let corner = DVec3::X * west;
    let mut parts = vec![
        part(corner, z, x, WOOD),
        part(corner + y, x, z, WHITE),
        part(corner, x, y, WHITE),
        part(corner + z, y, x, WHITE),
    ];
    if west == 0.0 {
        parts.push(part(corner, y, z, west_color));
        parts.extend(pierced(east).map(|[o, u, v]| part(o, v, u, east_color)));
    } else {
        parts.extend(pierced(west).map(|[o, u, v]| part(o, u, v, west_color)));
        parts.push(part(corner + x, z, y, east_color));
    }
    parts
}

/// The three rectangles of a wall around the door: their origins, and sides upwards and along Z.
fn pierced(x: f64) -> [[DVec3; 3]; 3] {
    let strip = |from: f64, to: f64, bottom: f64| {
        [dvec3(x, bottom, from), DVec3::Y * (HEIGHT - bottom), DVec3::Z * (to - from)]
    };
    [strip(0.0, DOOR[0], 0.0), strip(DOOR[1], PLAN.y, 0.0), strip(DOOR[0], DOOR[1], DOOR_HEIGHT)]
}

/// What the door is cut out of the wall: floor, jambs and lintel.
fn door() -> [Part; 4] {
    let x = DVec3::X * (WALL[1] - WALL[0]);
    let (y, z) = (DVec3::Y * DOOR_HEIGHT, DVec3::Z * (DOOR[1] - DOOR[0]));
    let corner = dvec3(WALL[0], 0.0, DOOR[0]);
    [
        part(corner, z, x, WOOD),
        part(corner + y, x, z, WHITE),
        part(corner, x, y, WHITE),
        part(corner + z, y, x, WHITE),
    ]
}

fn part(origin: DVec3, u: DVec3, v: DVec3, reflectance: DVec3) -> Part {
    let nodes = [u, v].map(|side| (side.length() / NODE_SPACING).ceil() as usize + 1);
    let panel = Panel { origin, sides: [u, v], nodes, light: vec![] };
    Part { panel, reflectance, emission: DVec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rays::first;

    #[test]
    fn the_rooms_are_closed_and_face_inwards() {
        let panels: Vec<Panel> = parts().into_iter().map(|part| part.panel).collect();
        for origin in [dvec3(1.0, 0.5, 1.0), dvec3(4.0, 1.0, 3.0), dvec3(7.0, 2.0, 2.0)] {
            for direction in
                (0..729).map(|i| dvec3((i % 9) as f64, (i / 9 % 9) as f64, (i / 81) as f64) - 4.03)
            {
                let met = first(&panels, origin, direction).expect("something is in every direction");
                let normal = met.panel.sides[0].cross(met.panel.sides[1]);
                assert!(normal.dot(direction) < 0.0, "{origin} {direction}: seen from behind");
            }
        }
    }
}
