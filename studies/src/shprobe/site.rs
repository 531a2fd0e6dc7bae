//! Scenes in which probes are placed, and what is right and wrong in them.

use std::fmt::Write as _;

use glam::{DVec3, Vec3, dvec3};
use pointillist_radiosity::{Scene as Patches, SceneOptions, SolveOptions};
use pointillist_render::{
    Ambient, AmbientLight, CaptureOptions, Lamps, Lightmap, Prepared, RenderError, Scene, Unbaked,
    scene_surfaces, with_lamps,
};
use pointillist_sh::{CubeMap, CubeProjector, Sh, Weights};
use pointillist_shade::face_normal;
use pointillist_shprobe::{DEFAULT_DISTANCE_SIZE, DistanceMap, Field, ProbeError, place};
use rayon::prelude::*;

use crate::common::data;
use crate::common::ray_reference::Tree;
use crate::common::rooms::{ROOMS, THIN_WALL, WALL, basic, thin_wall_rooms, two_rooms};
use crate::common::scene_text::read_text;
use crate::common::scenes::corners;
use crate::shprobe::rays::{Look, look_by_rays};

/// How light is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Eye {
    /// By `Prepared::capture`, as `pointillist probe bake` does.
    Pictures,
    /// By one ray a texel: [`look_by_rays`].
    Rays,
}

/// A scene, and the box in it that objects move in.
pub(crate) struct Site {
    pub(crate) name: &'static str,
    pub(crate) scene: Scene,
    pub(crate) low: DVec3,
    pub(crate) high: DVec3,
    /// From where on along x it is the dark room.
    pub(crate) dark_from: Option<f64>,
    /// Grids of as many probes as are asked for; the last is the one that others are measured by.
    pub(crate) grids: &'static [[usize; 3]],
    /// Grid of candidates for adaptive placement.
    pub(crate) candidates: [usize; 3],
    /// How much errors in the dark count in choosing.
    pub(crate) balance: f64,
    /// Whether pictures are drawn to see light, or rays cast: these see one bounce.
    pub(crate) eye: Eye,
    /// Pixels on a side of what probes see, and of what is true.
    pub(crate) probe_px: u32,
    pub(crate) truth_px: u32,
    /// How many positions are compared.
    pub(crate) queries: usize,
}

impl Site {
    pub(crate) fn two_rooms() -> Self {
        Self {
            name: "two rooms",
            scene: two_rooms(),
            low: DVec3::ZERO,
            high: ROOMS,
            dark_from: Some(WALL[1]),
            grids: &[[4, 2, 3], [6, 2, 4], [7, 3, 4], [8, 3, 4], [8, 4, 6], [12, 6, 6]],
            candidates: [28, 11, 14],
            balance: 0.5,
            eye: Eye::Pictures,
            probe_px: 32,
            truth_px: 64,
            queries: 400,
        }
    }

    /// The same with a wall of 10 cm.
    pub(crate) fn thin_wall() -> Self {
        Self {
            name: "two rooms, wall of 10 cm",
            scene: thin_wall_rooms(),
            dark_from: Some(THIN_WALL[1]),
            grids: &[[12, 6, 6]],
            candidates: [20, 8, 10],
            eye: Eye::Rays,
            probe_px: 24,
            truth_px: 40,
            queries: 300,
            ..Self::two_rooms()
        }
    }

    pub(crate) fn basic() -> Self {
        Self {
            name: "Basic",
            scene: basic(),
            low: DVec3::ZERO,
            high: dvec3(4.0, 3.0, 4.0),
            dark_from: None,
            grids: &[[4, 4, 4]],
            candidates: [10, 8, 10],
            balance: 0.0,
            eye: Eye::Pictures,
            probe_px: 32,
            truth_px: 64,
            queries: 300,
        }
    }

    /// The atrium under sun and sky, if the data are there.
    pub(crate) fn sponza() -> Option<Self> {
        let lights = "[image]\nbackground = [0.4, 0.6, 0.9]\n[[light]]\ntype = \"directional\"\n\
                      direction = [0.25, -1, 0.15]\nirradiance = [8, 7.6, 6.8]\n";
        Some(Self {
            name: "Sponza",
            scene: from_data(
                "scenes/sponza-dabrovic/sponza.obj",
                1.0,
                "eye = [-11, 2.2, -0.8]\ntarget = [5, 4, 1]",
                lights,
            )?,
            low: dvec3(-14.0, 0.2, -6.2),
            high: dvec3(14.0, 10.5, 6.2),
            dark_from: None,
            grids: &[[5, 2, 4], [7, 3, 4], [8, 4, 6], [12, 6, 6]],
            candidates: [32, 13, 18],
            balance: 0.0,
            eye: Eye::Rays,
            probe_px: 32,
            truth_px: 48,
            queries: 300,
        })
    }

    /// The cathedral with two lamps, if the data are there; scaled to a length of 42.
    pub(crate) fn sibenik() -> Option<Self> {
        let camera = "eye = [-10, 3, 0]\ntarget = [10, 5, 0]";
        let lights = "[[light]]\ntype = \"point\"\nposition = [-4, 9, 0]\nintensity = [150, 140, 120]\n\
                      [[light]]\ntype = \"point\"\nposition = [20, 6, 0]\nintensity = [60, 60, 80]\n";
        Some(Self {
            name: "Sibenik",
            scene: from_data("scenes/sibenik/sibenik.obj", 0.05, camera, lights)?,
            low: dvec3(-11.5, 0.6, -6.0),
            high: dvec3(30.0, 12.5, 6.0),
            dark_from: None,
            grids: &[[12, 6, 6]],
            candidates: [24, 10, 12],
            balance: 0.0,
            eye: Eye::Rays,
            probe_px: 32,
            truth_px: 48,
            queries: 200,
        })
    }
}

impl Site {
    /// With fewer positions and coarser looks.
    pub(crate) fn for_a_trial(mut self) -> Self {
        self.probe_px /= 2;
        self.truth_px /= 2;
        self.queries /= 4;
        self.grids = &self.grids[self.grids.len() - 1..];
        self.candidates = self.candidates.map(|n| n.div_ceil(2));
        self
    }
}

/// A scene of the reference data; `None`, with a word about it, if it cannot be read.
pub(crate) fn from_data(mesh: &str, scale: f64, camera: &str, lights: &str) -> Option<Scene> {
    let path = data::folder()?.join(mesh).canonicalize().ok()?;
    let mut text = format!("[camera]\n{camera}\nup = [0, 1, 0]\nfov = 60\n{lights}");
    let _ = write!(
        text,
        "[ambient]\ncolor = [0, 0, 0]\n[[object]]\nscale = {scale}\nmesh = {:?}\n",
        path.display().to_string()
    );
    read_text(&text).map_err(|error| eprintln!("shprobe: {mesh}: {error}")).ok()
}

/// Probes with what they saw.
#[derive(Clone, Default)]
pub(crate) struct Baked {
    pub(crate) positions: Vec<DVec3>,
    pub(crate) radiance: Vec<Sh>,
    pub(crate) distances: Vec<DistanceMap>,
}

impl Baked {
    /// Some of them.
    pub(crate) fn pick(&self, indices: impl IntoIterator<Item = usize>) -> Self {
        let mut some = Self::default();
        for i in indices {
            some.positions.push(self.positions[i]);
            some.radiance.push(self.radiance[i].clone());
            some.distances.push(self.distances[i].clone());
        }
        some
    }

    /// Adds others after them.
    pub(crate) fn extend(&mut self, more: Self) {
        self.positions.extend(more.positions);
        self.radiance.extend(more.radiance);
        self.distances.extend(more.distances);
    }

    /// Ready to light objects.
    pub(crate) fn field(&self, distances: bool) -> Result<Field, ProbeError> {
        let field = Field::new(&self.positions, &self.radiance)?;
        if distances { field.with_distances(self.distances.clone()) } else { Ok(field) }
    }
}

/// A site with all that does not depend on probes.
pub(crate) struct Ground<'a> {
    pub(crate) site: &'a Site,
    pub(crate) prepared: Prepared<'a>,
    tree: Tree,
    /// Light that is sent on, on the surfaces, if it is looked at.
    sent_on: Option<Lightmap>,
}

/// Rays by which positions in walls are found, and the share of them that may meet the back of a surface.
const FEELERS: u32 = 96;
const BACKS: f64 = 0.1;

/// Side of the patches of light that is sent on.
const PATCH: f64 = 0.25;

/// Sight is not limited in any direction by anything closer than this share of the box's diagonal.
const CLOSE: f64 = 0.002;

/// Shares of the diagonal by which probes are moved out of solids.
const STEPS: [f64; 5] = [0.005, 0.01, 0.02, 0.04, 0.06];

impl<'a> Ground<'a> {
    pub(crate) fn new(site: &'a Site) -> Result<Self, RenderError> {
        Self::lit(site, None)
    }

    /// With light that is sent on from surface to surface: a radiosity solution.
    pub(crate) fn with_bounces(site: &'a Site) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let surfaces = scene_surfaces(&site.scene)?;
        let mut patches = Patches::new(&surfaces.surfaces, &SceneOptions::DEFAULT.with_patch(PATCH))?;
        let direct = with_lamps(&Lamps::new(&site.scene), |lamps| patches.direct(lamps))?;
        let solution = patches.transport(&direct)?.gauss_seidel(&SolveOptions::DEFAULT)?.bake();
        let lightmap = Lightmap::of_baked(&solution, &surfaces.faces, site.scene.mesh.triangles.len())?;
        Ok(Self::lit(site, Some(lightmap))?)
    }

    /// With this light that is sent on.
    pub(crate) fn lit(site: &'a Site, sent_on: Option<Lightmap>) -> Result<Self, RenderError> {
        let prepared = Prepared::new(&site.scene, &())?;
        Ok(Self { site, prepared, tree: Tree::new(&site.scene), sent_on })
    }

    /// What arrives from what the lights shine on, and with bounces from what these send on. Does not depend on other
    /// probes.
    pub(crate) fn look(&self, positions: &[DVec3]) -> Result<Baked, RenderError> {
        let size = self.site.probe_px;
        let projector = CubeProjector::new(size as usize, 2, Weights::Gregory)?;
        let far = (2.0 * (self.site.high - self.site.low).length()) as f32;
        let one = |&p: &DVec3| {
            let capture = self.capture(p, size, false)?;
            let map = DistanceMap::from_cube(DEFAULT_DISTANCE_SIZE, capture.size, &capture.distance, far)?;
            Ok((projector.project(&CubeMap::from_planes(capture.size, capture.radiance)?)?, map))
        };
        let seen: Result<Vec<_>, RenderError> = positions.par_iter().map(one).collect();
        let (radiance, distances) = seen?.into_iter().unzip();
        Ok(Baked { positions: positions.to_vec(), radiance, distances })
    }

    /// The light that is sent on, if it is looked at.
    pub(crate) const fn sent_on(&self) -> Option<&Lightmap> {
        self.sent_on.as_ref()
    }

    /// What is seen from a position, under no other light than that of the lights.
    pub(crate) fn capture(&self, p: DVec3, resolution: u32, thorough: bool) -> Result<Look, RenderError> {
        if self.site.eye == Eye::Rays {
            return Ok(look_by_rays(&self.site.scene, &self.tree, self.sent_on.as_ref(), p, resolution));
        }
        let options = CaptureOptions { resolution, thorough, ..CaptureOptions::DEFAULT };
        let ambient = self.sent_on.as_ref().map_or(Ambient::Color(Vec3::ZERO), Ambient::Radiosity);
        Ok(self.prepared.capture(p, options, ambient, &())?.into())
    }

    /// Whether a position is neither in a solid nor among the backs of surfaces that are not closed.
    pub(crate) fn is_free(&self, p: DVec3) -> bool {
        let diagonal = (self.site.high - self.site.low).length();
        if !self.prepared.geometry().solids_around(p).is_empty() {
            return false;
        }
        let mut backs = 0;
        for direction in directions(FEELERS) {
            let Some((distance, is_back)) = self.met(p, direction) else { continue };
            if distance < CLOSE * diagonal {
                return false;
            }
            backs += u32::from(is_back);
        }
        f64::from(backs) <= BACKS * f64::from(FEELERS)
    }

    /// Whether a position on a surface is neither in a solid nor among the backs of other surfaces.
    pub(crate) fn is_free_above(&self, p: DVec3, normal: DVec3) -> bool {
        if !self.prepared.geometry().solids_around(p).is_empty() {
            return false;
        }
        let (mut looks, mut backs) = (0, 0);
        for direction in directions(FEELERS).filter(|d| d.dot(normal) > 0.0) {
            looks += 1;
            backs += u32::from(self.met(p, direction).is_some_and(|(_, is_back)| is_back));
        }
        f64::from(backs) <= BACKS * f64::from(looks)
    }

    /// How far away something is met, and whether it is the back of a surface.
    fn met(&self, p: DVec3, direction: DVec3) -> Option<(f64, bool)> {
        let (triangle, distance) = self.tree.nearest(p, direction, 0.0)?;
        let [a, b, c] = corners(&self.site.scene, triangle as usize);
        Some((distance, face_normal(a, b, c).dot(direction) > 0.0))
    }

    /// Whether nothing is between two positions.
    pub(crate) fn is_open(&self, from: DVec3, to: DVec3) -> bool {
        self.tree.nearest(from, to - from, 0.0).is_none_or(|(_, t)| t > 1.0)
    }

    /// The position, or the nearest free one that is found; `None` if there is none around.
    pub(crate) fn settled(&self, p: DVec3) -> Option<DVec3> {
        let diagonal = (self.site.high - self.site.low).length();
        let steps = STEPS.iter().flat_map(|step| directions(26).map(move |d| p + d * (step * diagonal)));
        let is_inside = |p: &DVec3| p.cmpge(self.site.low).all() && p.cmple(self.site.high).all();
        std::iter::once(p).chain(steps.filter(is_inside)).find(|&p| self.is_free(p))
    }

    /// As many free positions anywhere in the box.
    pub(crate) fn random(&self, count: usize, seed: u64) -> Vec<DVec3> {
        let all = place::random(self.site.low, self.site.high, 8 * count, seed);
        all.into_iter().filter(|&p| self.is_free(p)).take(count).collect()
    }

    /// Positions above vertices, on the side that triangles face.
    pub(crate) fn above_vertices(&self) -> Vec<DVec3> {
        let (mesh, site) = (&self.site.scene.mesh, self.site);
        let lift = 0.02 * (site.high - site.low).length();
        let mut lifted = vec![None; mesh.positions.len()];
        for (t, vertices) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = corners(&site.scene, t);
            for &v in vertices {
                let place = &mut lifted[v as usize];
                *place = place.or_else(|| {
                    face_normal(a, b, c).try_normalize().map(|n| mesh.positions[v as usize] + n * lift)
                });
            }
        }
        let is_inside = |p: &DVec3| p.cmpge(site.low).all() && p.cmple(site.high).all();
        lifted.into_iter().flatten().filter(is_inside).collect()
    }
}

/// Evenly spread unit directions: a Fibonacci spiral.
pub(crate) fn directions(count: u32) -> impl Iterator<Item = DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |i| {
        let y = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let r = (1.0 - y * y).sqrt();
        dvec3(r * cos, y, r * sin)
    })
}

/// A scene whose ambient light is that of probes.
pub(crate) fn lit_by(
    scene: &Scene,
    baked: &Baked,
    distances: bool,
) -> Result<Scene, pointillist_shprobe::ProbeError> {
    let field = Box::new(baked.field(distances)?);
    let mut scene = scene.clone();
    scene.ambient = AmbientLight::Probes { field, unbaked: Unbaked::NONE, fingerprint: 0 };
    Ok(scene)
}
