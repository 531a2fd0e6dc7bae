//! The meshes of the built-in scene.

use crate::mesh_io::FileMesh;
use crate::scene::NONE;
use glam::{DVec2, DVec3, dvec2, dvec3};
use std::f64::consts::{PI, TAU};

/// Half the side of the floor; the horizon is then a third of a degree below the true one.
const FLOOR: f64 = 240.0;
/// Distance of the sky behind the scene: nearer than the far edge of the floor.
const SKY: f64 = 225.0;

/// The mesh of that name, if there is one.
pub(super) fn by_name(name: &str) -> Option<FileMesh> {
    let mut shape = Shape::default();
    match name {
        "floor" => shape.floor(),
        "sky" => shape.sky(),
        "sphere" => shape.surface([96, 48], |u, v| sphere(DVec3::ZERO, 1.0, u, v)),
        "torus" => shape.surface([128, 48], torus),
        "column" => shape.column(),
        "boxes" => shape.boxes(),
        "cage" => shape.cage(),
        "fence" => shape.fence(),
        "pane" => shape.pane(),
        _ => return None,
    }
    shape.mesh.material_names = vec![String::new()];
    Some(shape.mesh)
}

/// A point of a surface and its outward normal.
type Point = (DVec3, DVec3);

fn sphere(center: DVec3, radius: f64, u: f64, v: f64) -> Point {
    let (around, down) = (TAU * u, PI * v);
    let normal = dvec3(down.sin() * around.sin(), down.cos(), down.sin() * around.cos());
    (center + radius * normal, normal)
}

fn torus(u: f64, v: f64) -> Point {
    const RADIUS: f64 = 0.48;
    const TUBE: f64 = 0.155;
    let outward = dvec3((TAU * u).sin(), 0.0, (TAU * u).cos());
    let normal = (TAU * v).cos() * outward - (TAU * v).sin() * DVec3::Y;
    (RADIUS * outward + TUBE * normal, normal)
}

#[derive(Default)]
struct Shape {
    mesh: FileMesh,
}

impl Shape {
    fn triangle(&mut self, corners: [u32; 3], with_normals: bool, with_uvs: bool) {
        self.mesh.triangles.push(corners);
        self.mesh.normal_of.push(if with_normals { corners } else { [NONE; 3] });
        self.mesh.uv_of.push(if with_uvs { corners } else { [NONE; 3] });
        self.mesh.material_of.push(0);
    }

    fn vertex(&mut self, position: DVec3, normal: DVec3, uv: DVec2) -> u32 {
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal.as_vec3());
        self.mesh.uvs.push(uv);
        self.mesh.positions.len() as u32 - 1
    }

    /// A smooth surface over the unit square, cut into cells; u turns left seen from outside, v goes down.
    fn surface(&mut self, cells: [u32; 2], point: impl Fn(f64, f64) -> Point) {
        let [columns, rows] = cells;
        let first = self.mesh.positions.len() as u32;
        for row in 0..=rows {
            for column in 0..=columns {
                let (u, v) = (f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows));
                let (position, normal) = point(u, v);
                self.vertex(position, normal, dvec2(u, 1.0 - v));
            }
        }
        for row in 0..rows {
            for column in 0..columns {
                let a = first + row * (columns + 1) + column;
                let [b, c, d] = [a + columns + 1, a + columns + 2, a + 1];
                self.triangle([a, b, c], true, true);
                self.triangle([a, c, d], true, true);
            }
        }
    }

    /// A flat polygon with its own normal.
    fn flat(&mut self, corners: &[(DVec3, DVec2)]) {
        let normal = (corners[1].0 - corners[0].0).cross(corners[2].0 - corners[0].0).normalize();
        let first = self.mesh.positions.len() as u32;
        for &(position, uv) in corners {
            self.vertex(position, normal, uv);
        }
        for i in 2..corners.len() as u32 {
            self.triangle([first, first + i - 1, first + i], true, true);
        }
    }

    /// One unit is one unit of texture: eight tiles a side.
    fn floor(&mut self) {
        const UNIT: f64 = 0.125;
        let corner = |x: f64, z: f64| (dvec3(x * FLOOR, 0.0, z * FLOOR), dvec2(x, -z) * FLOOR * UNIT);
        self.flat(&[corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)]);
    }

    /// A bent wall far behind everything, open towards the lights.
    fn sky(&mut self) {
        const HEIGHT: f64 = 110.0;
        // Beyond atan(0.66 / 0.48) = 0.942 the sun of the scene file would shine on its back, and it would cast a shadow.
        const HALF_ANGLE: f64 = 0.94;
        // The wall is seen from inside, so u runs the other way.
        self.surface([24, 1], |u, v| {
            let angle = HALF_ANGLE * (2.0 * u - 1.0);
            let outward = dvec3(angle.sin(), 0.0, -angle.cos());
            (SKY * outward + HEIGHT * (1.0 - v) * DVec3::Y, -outward)
        });
    }

    /// A column with a square section that turns on its way up, on a plinth and under a slab.
    fn column(&mut self) {
        const FROM: f64 = 0.18;
        const TO: f64 = 2.75;
        const TURN: f64 = 1.5 * PI;
        for side in 0..4 {
            let start = f64::from(side) * 0.25 * TAU;
            let position = |u: f64, v: f64| {
                let y = TO + (FROM - TO) * v;
                let angle = start + TURN * (y - FROM) / (TO - FROM);
                let narrow = 0.34 - 0.07 * (y - FROM) / (TO - FROM);
                let across = dvec2(narrow, narrow * (2.0 * u - 1.0));
                let turned = DVec2::from_angle(angle).rotate(across);
                dvec3(turned.y, y, turned.x)
            };
            // The normal by central differences of the heights; its closed form is long and no more accurate than the picture shows.
            let point = |u: f64, v: f64| {
                const STEP: f64 = 1e-5;
                let along_u = position(u + STEP, v) - position(u - STEP, v);
                let along_v = position(u, v + STEP) - position(u, v - STEP);
                (position(u, v), along_v.cross(along_u).normalize())
            };
            self.surface([6, 96], point);
        }
        self.cuboid(dvec3(-0.48, 0.0, -0.48), dvec3(0.48, FROM, 0.48));
        self.cuboid(dvec3(-0.42, TO, -0.42), dvec3(0.42, TO + 0.14, 0.42));
    }

    fn boxes(&mut self) {
        self.cuboid(dvec3(-0.75, 0.0, -0.55), dvec3(0.75, 0.5, 0.75));
        self.cuboid(dvec3(-0.5, 0.5, -0.5), dvec3(0.6, 0.95, 0.45));
        self.cuboid(dvec3(-0.1, 0.95, -0.4), dvec3(0.35, 2.1, 0.05));
    }

    fn cuboid(&mut self, low: DVec3, high: DVec3) {
        for axis in 0..3 {
            let [a, b, c] = [axis, (axis + 1) % 3, (axis + 2) % 3];
            for (at, order) in [(low, [0, 3, 2, 1]), (high, [0, 1, 2, 3])] {
                let corner = |index: usize| {
                    let mut p = at;
                    p[a] = at[a];
                    p[b] = if index == 1 || index == 2 { high[b] } else { low[b] };
                    p[c] = if index >= 2 { high[c] } else { low[c] };
                    (p, DVec2::ZERO)
                };
                self.flat(&order.map(corner));
            }
        }
    }

    /// A thin round bar.
    fn bar(&mut self, from: DVec3, to: DVec3, radius: f64) {
        let along = (to - from).normalize();
        let (right, up) = along.any_orthonormal_pair();
        self.surface([10, 1], |u, v| {
            let normal = (TAU * u).cos() * right + (TAU * u).sin() * up;
            (to + (from - to) * v + radius * normal, normal)
        });
    }

    /// A ball of thin bars: the edges of an icosahedron, each face cut once.
    fn cage(&mut self) {
        const RADIUS: f64 = 0.44;
        const WIRE: f64 = 0.0075;
        let points = icosahedron();
        let side = points[0].distance(points[1..].iter().copied().fold(-points[0], |best, p| {
            if p.distance(points[0]) < best.distance(points[0]) { p } else { best }
        }));
        let near = |a: DVec3, b: DVec3, length: f64| a.distance(b) < 1.01 * length;
        let mut middles = Vec::new();
        for (i, &a) in points.iter().enumerate() {
            for &b in points[i + 1..].iter().filter(|&&b| near(a, b, side)) {
                let middle = (a + b).normalize();
                self.bar(RADIUS * a, RADIUS * middle, WIRE);
                self.bar(RADIUS * middle, RADIUS * b, WIRE);
                middles.push(middle);
            }
        }
        for (i, &a) in middles.iter().enumerate() {
            // Middles of two edges of one face are about 0.62 apart; the next are 1 apart.
            for &b in middles[i + 1..].iter().filter(|&&b| near(a, b, 0.65)) {
                self.bar(RADIUS * a, RADIUS * b, WIRE);
            }
        }
    }

    /// Upright and slanted wires, thinner than a pixel, between posts.
    fn fence(&mut self) {
        const HALF: f64 = 6.0;
        const HEIGHT: f64 = 1.45;
        const MESH: f64 = 0.15;
        for post in -3..=3 {
            let x = 2.0 * f64::from(post);
            self.bar(dvec3(x, 0.0, 0.0), dvec3(x, HEIGHT + 0.12, 0.0), 0.03);
        }
        for y in [0.12, HEIGHT] {
            self.bar(dvec3(-HALF, y, 0.0), dvec3(HALF, y, 0.0), 0.012);
        }
        let drop = HEIGHT - 0.12;
        let count = ((2.0 * HALF + drop) / MESH) as i32;
        for slant in 0..count {
            // The wire x = start + (y − 0.12), cut at the posts' ends, and its mirror image.
            let start = -HALF - drop + MESH * f64::from(slant);
            let from = (-HALF - start).clamp(0.0, drop);
            let to = (HALF - start).clamp(0.0, drop);
            if to - from < MESH {
                continue;
            }
            for side in [1.0, -1.0] {
                let at = |t: f64| dvec3(side * (start + t), 0.12 + t, 0.0);
                self.bar(at(from), at(to), 0.0045);
            }
        }
    }

    /// A sheet of coloured glass on two feet.
    fn pane(&mut self) {
        let corner = |x: f64, y: f64| (dvec3(x, y, 0.0), DVec2::ZERO);
        self.flat(&[corner(-0.5, 0.06), corner(0.5, 0.06), corner(0.5, 1.3), corner(-0.5, 1.3)]);
    }
}

/// The corners of an icosahedron on the unit sphere.
fn icosahedron() -> Vec<DVec3> {
    let golden = 0.5 * (1.0 + 5f64.sqrt());
    let mut points = Vec::with_capacity(12);
    for a in [-1.0, 1.0] {
        for b in [-golden, golden] {
            points.extend([dvec3(0.0, a, b), dvec3(a, b, 0.0), dvec3(b, 0.0, a)].map(DVec3::normalize));
        }
    }
    points
}
