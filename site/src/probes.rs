//! Probes in two rooms: `rooms WIDTH HEIGHT` makes them, with a plan of the floor as a picture; `ball X Y Z SIGHT SIDE PAPER` lights a ball.
//!
//! Facts of `rooms`: `plan` (the size along X and Z), `wall` (both faces along X), `door` (along Z), `patches`, `probes` (three numbers each), `edges`
//! (two probes each), `colors` (of what arrives at each probe, three bytes each).
//!
//! Facts of `ball`, with sight `seen` or `blind` (whether probes know what walls hide): `shares` (a probe and its weight, each), `cell` (the
//! corners of the tetrahedron that holds the ball), `light` (mean irradiance, red, green, blue).

use crate::SiteError;
use crate::paper::Paper;
use crate::rays::{Panel, first};
use crate::reply::Reply;
use crate::request::Request;
use crate::rooms::{self, DOOR, HEIGHT, PLAN, WALL};
use glam::{DVec2, DVec3, Vec3, dvec2, dvec3};
use pointillist_shprobe::delaunay::Partition;
use pointillist_shprobe::sh::{CubeMap, CubeProjector, Sh, Weights};
use pointillist_shprobe::{DEFAULT_DISTANCE_SIZE, DistanceMap, Field, Hint};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Texels along a face of what a probe sees.
const CUBE: usize = 32;
/// Bands of the probes' functions: the nine coefficients of irradiance.
const ORDER: usize = 2;
/// Farther than anything in the rooms.
const FAR: f32 = 20.0;
/// Irradiance that is shown as half of white.
const EXPOSURE: f64 = 1.5;
const LARGEST_BALL: u32 = 1024;

pub(crate) struct Probes {
    panels: Vec<Panel>,
    patches: usize,
    positions: Vec<DVec3>,
    /// Without and with what probes see.
    blind: Field,
    seen: Field,
    /// What arrives at each, mean over all directions.
    means: Vec<DVec3>,
}

impl Probes {
    pub(crate) fn new() -> Result<Self, SiteError> {
        let (panels, patches) = rooms::lit()?;
        let positions = places();
        let projector = CubeProjector::new(CUBE, ORDER, Weights::Gregory)?;
        let capture = |&at: &DVec3| -> Result<Sh, SiteError> { Ok(projector.project(&sees(&panels, at)?)?) };
        let held: Vec<Sh> = positions.iter().map(capture).collect::<Result<_, _>>()?;
        let blind = Field::new(&positions, &held)?;
        let maps = positions.iter().map(|&at| distances(&panels, at)).collect::<Result<_, _>>()?;
        let seen = blind.clone().with_distances(maps)?;
        let means = held.iter().map(|sh| sh.mean() * PI).collect();
        Ok(Self { panels, patches, positions, blind, seen, means })
    }

    pub(crate) fn describe(&self, request: &mut Request<'_>) -> Result<Reply, SiteError> {
        let (width, height) = (request.count("width", 1, 2048)?, request.count("height", 1, 2048)?);
        let edges = edges(self.blind.partition());
        let paper = Paper::read(request)?;
        let colors = paper.under(&self.means.iter().map(|&m| exposed(m)).collect::<Vec<_>>());
        Ok(Reply::default()
            .with("plan", PLAN.to_array())
            .with("wall", WALL)
            .with("door", DOOR)
            .with("patches", [self.patches])
            .with("probes", self.positions.iter().flat_map(|p| p.to_array()))
            .with("edges", edges.into_iter().flatten())
            .with("colors", colors.chunks_exact(4).flat_map(|c| [c[0], c[1], c[2]]))
            .with_pixels(paper.under(&self.floor(width, height))))
    }

    /// What is seen of the floor from above, without ceiling; nothing where the wall stands.
    fn floor(&self, width: u32, height: u32) -> Vec<[f32; 4]> {
        let pixel = |i: u32| {
            let place =
                (dvec2((i % width).into(), (i / width).into()) + 0.5) / dvec2(width.into(), height.into());
            let DVec2 { x, y: z } = place * PLAN;
            if is_wall(x, z) {
                return [0.0; 4];
            }
            let met = first(&self.panels, dvec3(x, 0.01, z), DVec3::NEG_Y);
            met.map_or([0.0; 4], |met| exposed(met.panel.light(met.place)))
        };
        (0..width * height).map(pixel).collect()
    }

    pub(crate) fn ball(&self, request: &mut Request<'_>) -> Result<Reply, SiteError> {
        let at = request.vector("position")?;
        let field =
            request.one_of("sight", "seen or blind", &[("seen", &self.seen), ("blind", &self.blind)])?;
        let side = request.count("side", 1, LARGEST_BALL)?;
        let paper = Paper::read(request)?;
        let mut hint = Hint::default();
        let light = field.light(at, &mut hint)?;
        let shares = field.shares(at, &mut hint)?;
        let cell = field.locator().locate(at, &mut hint)?;
        let corners = cell.parts().map(|(probe, _)| probe);
        let mean: Vec3 =
            DVec3::AXES.iter().flat_map(|&a| [a, -a]).map(|n| light.at(n.as_vec3())).sum::<Vec3>() / 6.0;
        let pixels = shaded(side, |normal| light.at(normal));
        Ok(Reply::default()
            .with("shares", shares.iter().flat_map(|&(probe, share)| [f64::from(probe), share]))
            .with("cell", corners)
            .with("light", mean.to_array())
            .with_pixels(paper.under(&pixels)))
    }
}

/// Where probes are: four by four in each room at two heights, and two in the door.
fn places() -> Vec<DVec3> {
    let rooms = [[0.0, WALL[0]], [WALL[1], PLAN.x]];
    let along = |[low, high]: [f64; 2], i: usize| low + (high - low) * [0.08, 0.36, 0.64, 0.92][i];
    let in_room = |room: [f64; 2]| {
        (0..32).map(move |i| {
            let y = [0.4, HEIGHT - 0.4][i / 16];
            dvec3(along(room, i % 4), y, along([0.0, PLAN.y], i / 4 % 4))
        })
    };
    let in_door = [0.5, 1.6].map(|y| dvec3(0.5 * (WALL[0] + WALL[1]), y, 0.5 * (DOOR[0] + DOOR[1])));
    rooms.into_iter().flat_map(in_room).chain(in_door).collect()
}

fn is_wall(x: f64, z: f64) -> bool {
    (WALL[0]..WALL[1]).contains(&x) && !(DOOR[0]..DOOR[1]).contains(&z)
}

/// Radiance from all directions: radiosity over π, of diffuse surfaces.
fn sees(panels: &[Panel], at: DVec3) -> Result<CubeMap, SiteError> {
    let from = |direction: DVec3| {
        first(panels, at, direction).map_or(DVec3::ZERO, |met| met.panel.light(met.place) / PI)
    };
    Ok(CubeMap::from_fn(CUBE, from)?)
}

fn distances(panels: &[Panel], at: DVec3) -> Result<DistanceMap, SiteError> {
    let cube = CubeMap::black(CUBE)?;
    let distance = |i: usize| {
        let (face, texel) = (i / (CUBE * CUBE), i % (CUBE * CUBE));
        let direction = cube.texel_direction(face, texel % CUBE, texel / CUBE);
        first(panels, at, direction).map_or(FAR, |met| met.distance as f32)
    };
    let distances: Vec<f32> = (0..6 * CUBE * CUBE).map(distance).collect();
    Ok(DistanceMap::from_cube(DEFAULT_DISTANCE_SIZE, CUBE, &distances, FAR)?)
}

/// Pairs of probes that an edge joins, each once.
fn edges(partition: &Partition) -> BTreeSet<[u32; 2]> {
    let mut edges = BTreeSet::new();
    if let Partition::Tetrahedra(cells) = partition {
        for corners in &cells.corners {
            for (i, &a) in corners.iter().enumerate() {
                edges.extend(corners[i + 1..].iter().map(|&b| [a.min(b), a.max(b)]));
            }
        }
    }
    edges
}

/// Irradiance as a picture has it: bright light is compressed, so that both rooms are seen at once.
fn exposed(irradiance: DVec3) -> [f32; 4] {
    let shown = irradiance.max(DVec3::ZERO) / EXPOSURE;
    let [r, g, b] = (shown / (DVec3::ONE + shown)).as_vec3().to_array();
    [r, g, b, 1.0]
}

/// A white ball in a square, seen from the south; the ball's rim covers pixels in part.
fn shaded(side: u32, irradiance: impl Fn(Vec3) -> Vec3) -> Vec<[f32; 4]> {
    let radius = 0.5 * f64::from(side) - 1.0;
    let pixel = |i: u32| {
        let offset = dvec2((i % side).into(), (i / side).into()) + 0.5 - 0.5 * f64::from(side);
        let distance = offset.length();
        let cover = (radius - distance + 0.5).clamp(0.0, 1.0);
        let flat = offset * (1.0 / distance.max(radius).max(1.0));
        let normal = dvec3(flat.x, -flat.y, (1.0 - flat.length_squared()).max(0.0).sqrt());
        let seen = exposed(irradiance(normal.as_vec3()).as_dvec3());
        seen.map(|channel| channel * cover as f32)
    };
    (0..side * side).map(pixel).collect()
}
