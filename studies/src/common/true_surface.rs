//! The surface that scans are made of, and the picture that a perfect scan would give.

use glam::{DVec3, dvec2};
use pointillist_cli::mesh_io::read_ply;
use pointillist_ibpr::{Projection, View};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

use crate::common::data;
use crate::common::layers::Layers;
use crate::common::loop_subdivision::subdivided;
use crate::common::ray_reference::Tree;
use crate::common::scenes::{Sketch, unit_sphere};

/// A closed surface of fine triangles with smooth normals.
pub(crate) struct Surface {
    pub(crate) name: &'static str,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    tree: Tree,
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
}

/// Lengths of the waves of relief and root mean squares of their heights, in diagonals of the box.
const RELIEF: [[f64; 2]; 2] = [[0.06, 0.0014], [0.03, 0.0005]];

/// A wave through space.
struct Wave {
    /// 2π over its length, along its direction.
    vector: DVec3,
    phase: f64,
    height: f64,
}

/// Waves of one length in directions that are spread evenly over half a sphere: opposite ones are the same waves.
fn waves([length, height]: [f64; 2]) -> impl Iterator<Item = Wave> {
    const COUNT: u32 = 12;
    let golden = PI * (3.0 - 5f64.sqrt());
    (0..COUNT).map(move |i| {
        let z = (f64::from(i) + 0.5) / f64::from(COUNT);
        let (sin, cos) = (f64::from(i) * golden).sin_cos();
        let direction = DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z);
        let phase = TAU * (f64::from(i * i) * 0.37).fract();
        Wave { vector: direction * (TAU / length), phase, height: height * (2.0 / f64::from(COUNT)).sqrt() }
    })
}

/// Where a ray meets the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    /// In lengths of the ray's direction.
    pub(crate) distance: f64,
    /// Unit normal, outward.
    pub(crate) normal: DVec3,
}

impl Surface {
    /// The Stanford Bunny, Loop-subdivided twice so that facets are finer than scans; without the data a
    /// sphere with bumps.
    pub(crate) fn bunny_or_bumpy() -> Self {
        Self::bunny("the Stanford Bunny, Loop-subdivided twice", 2).unwrap_or_else(Self::bumpy)
    }

    /// The Stanford Bunny as in the reference pictures of points, Loop-subdivided once; without the data a sphere
    /// with bumps.
    pub(crate) fn coarse_bunny_or_bumpy() -> Self {
        Self::bunny("the Stanford Bunny, Loop-subdivided once", 1).unwrap_or_else(Self::bumpy)
    }

    /// The Stanford Bunny as it comes, facets and all; without the data a sphere with bumps.
    pub(crate) fn rough_bunny_or_bumpy() -> Self {
        Self::bunny("the Stanford Bunny", 0).unwrap_or_else(Self::bumpy)
    }

    fn bunny(name: &'static str, rounds: usize) -> Option<Self> {
        let path = data::folder()?.join("meshes/bunny/bun_zipper.ply");
        let mesh = read_ply("bun_zipper.ply", &std::fs::read(path).ok()?).ok()?;
        let finer = |(positions, triangles): (Vec<_>, Vec<_>), _| subdivided(&positions, &triangles);
        let (positions, triangles) = (0..rounds).fold((mesh.positions, mesh.triangles), finer);
        Some(Self::new(name, positions, triangles))
    }

    /// This surface with relief: waves of every direction along its normals, as steep as carving in stone.
    pub(crate) fn in_relief(&self, name: &'static str) -> Self {
        let waves: Vec<Wave> = RELIEF.into_iter().flat_map(waves).collect();
        let raised = |(p, n): (&DVec3, &DVec3)| {
            let at = *p / self.diagonal();
            let height: f64 = waves.iter().map(|w| w.height * (w.vector.dot(at) + w.phase).sin()).sum();
            *p + *n * (height * self.diagonal())
        };
        let positions = self.positions.iter().zip(&self.normals).map(raised).collect();
        Self::new(name, positions, self.triangles.clone())
    }

    fn bumpy() -> Self {
        let (sphere, triangles) = unit_sphere(8);
        let bump = |p: &DVec3| {
            let wave = |f: f64| (f * p.x + 0.3).sin() * (f * p.y + 1.1).sin() * (f * p.z + 2.3).sin();
            *p * (0.07 * (1.0 + 0.15 * wave(4.0) + 0.05 * wave(11.0)))
        };
        Self::new(
            "a sphere with bumps (the bunny's data are not there)",
            sphere.iter().map(bump).collect(),
            triangles,
        )
    }

    /// Normals are the means of those of the triangles around, by area.
    pub(crate) fn new(name: &'static str, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let mut normals = vec![DVec3::ZERO; positions.len()];
        for t in &triangles {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            t.iter().for_each(|&v| normals[v as usize] += (b - a).cross(c - a));
        }
        normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
        let mut sketch = Sketch::new(DVec3::Z, DVec3::ZERO, 40.0, 1);
        let matt = sketch.matt(0.8, 1.0);
        sketch.triangles(&positions, &triangles, matt);
        let used = triangles.iter().flatten().map(|&v| positions[v as usize]);
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (low, high) = used.fold(start, |(l, h), p| (l.min(p), h.max(p)));
        Self { name, low, high, tree: Tree::new(&sketch.scene), positions, triangles, normals }
    }

    pub(crate) fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    pub(crate) fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Unit normals of the vertices.
    pub(crate) fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    pub(crate) fn centre(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    pub(crate) fn diagonal(&self) -> f64 {
        self.low.distance(self.high)
    }

    /// The nearest hit of a ray.
    pub(crate) fn cast(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let (triangle, distance) = self.tree.nearest(origin, direction, 0.0)?;
        let t = self.triangles[triangle as usize];
        let [a, b, c] = t.map(|v| self.positions[v as usize]);
        let p = origin + direction * distance;
        let n = (b - a).cross(c - a);
        // Shares of the corners' normals: areas across from them.
        let share = |u: DVec3, v: DVec3| (v - u).cross(p - u).dot(n);
        let [na, nb, nc] = t.map(|v| self.normals[v as usize]);
        let normal = na * share(b, c) + nb * share(c, a) + nc * share(a, b);
        Some(Hit { distance, normal: normal.normalize_or(n.normalize_or_zero()) })
    }

    /// The camera of all pictures: the bunny's front, as in the reference data.
    pub(crate) fn view(&self, size: u32) -> View {
        let towards_eye = DVec3::new(0.2380, 0.1904, 0.9524).normalize();
        let eye = self.centre() + 1.55 * self.diagonal() * towards_eye;
        let projection = Projection::Perspective { fov_y_rad: FOV_Y_RAD };
        View::look_at(eye, self.centre(), DVec3::Y, projection, size, size).expect("the view is valid")
    }
}

const FOV_Y_RAD: f64 = 35.0 * std::f64::consts::PI / 180.0;

/// Towards the light of all pictures.
pub(crate) const LIGHT: DVec3 = DVec3::new(0.3718, 0.4771, 0.7963);

/// Share of the light that comes from everywhere, and the surface's colour.
pub(crate) const AMBIENT: f64 = 0.1;
pub(crate) const ALBEDO: f64 = 0.8;

/// Samples a side in pixels where the surface ends or jumps.
const FINE: u32 = 4;

/// What a frame must show.
pub(crate) struct Truth {
    pub(crate) size: usize,
    /// At pixel centres; +∞ where nothing is.
    pub(crate) depth: Vec<f64>,
    pub(crate) normal: Vec<DVec3>,
    /// Linear grey, with coverage: black where nothing is.
    pub(crate) grey: Vec<f64>,
    /// Share of each pixel that the surface covers.
    pub(crate) coverage: Vec<f64>,
}

impl Truth {
    pub(crate) fn new(surface: &Surface, view: &View) -> Self {
        let size = view.width() as usize;
        let ray = |x: f64, y: f64| view.ray(dvec2(x, y)).direction;
        let at = |x: f64, y: f64| surface.cast(view.eye(), ray(x, y));
        let centres: Vec<Option<Hit>> = (0..size * size)
            .into_par_iter()
            .map(|i| at((i % size) as f64 + 0.5, (i / size) as f64 + 0.5))
            .collect();
        let depth: Vec<f64> = centres.iter().map(|h| h.map_or(f64::INFINITY, |h| h.distance)).collect();
        let pixel = 2.0 * (0.5 * FOV_Y_RAD).tan() * 1.55 * surface.diagonal() / size as f64;
        let edge = |i: usize| {
            let around = [1, size - 1, size, size + 1];
            around.iter().any(|o| {
                let (before, after) = (depth[i.saturating_sub(*o)], depth[(i + o).min(depth.len() - 1)]);
                // Two infinite depths differ by NaN, which is not above anything.
                (before - after).abs() > 4.0 * pixel
            })
        };
        let shown = |i: usize| {
            let n = if edge(i) { FINE } else { 1 };
            let sample = |k: u32| {
                let p = dvec2(f64::from(k % n), f64::from(k / n)) + 0.5;
                let p = p / f64::from(n);
                at((i % size) as f64 + p.x, (i / size) as f64 + p.y)
                    .map_or((0.0, 0.0), |h| (shade(h.normal), 1.0))
            };
            let add = |sum: (f64, f64), s: (f64, f64)| (sum.0 + s.0, sum.1 + s.1);
            let (grey, coverage) = (0..n * n).map(sample).fold((0.0, 0.0), add);
            (grey / f64::from(n * n), coverage / f64::from(n * n))
        };
        let (grey, coverage) = (0..size * size).into_par_iter().map(shown).unzip();
        let normal = centres.iter().map(|h| h.map_or(DVec3::ZERO, |h| h.normal)).collect();
        Self { size, depth, normal, grey, coverage }
    }

    /// This truth as the layers of a frame: what the metrics must call perfect.
    pub(crate) fn as_layers(&self) -> Layers {
        let color = |(g, a): (&f64, &f64)| [*g as f32, *g as f32, *g as f32, *a as f32];
        Layers {
            color: self.grey.iter().zip(&self.coverage).map(color).collect(),
            depth: self.depth.iter().map(|d| *d as f32).collect(),
            normal: self.normal.iter().map(|n| n.as_vec3().to_array()).collect(),
        }
    }
}

/// The point that pixel `i` shows at its centre.
pub(crate) fn point_at(truth: &Truth, view: &View, i: usize) -> DVec3 {
    let (x, y) = ((i % truth.size) as f64 + 0.5, (i / truth.size) as f64 + 0.5);
    view.unproject(dvec2(x, y), truth.depth[i])
}

fn shade(normal: DVec3) -> f64 {
    ALBEDO * (AMBIENT + (1.0 - AMBIENT) * normal.dot(LIGHT.normalize()).max(0.0))
}
