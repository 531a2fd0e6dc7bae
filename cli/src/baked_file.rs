//! Files of baked light: what `radiosity` writes and `[ambient] radiosity` reads.

use crate::baked_objects::{BakedObject, find_baked};
use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use crate::json_words;
use pointillist_radiosity::Baked;
use pointillist_render::{BakedLight, BakedSide, Lightmap, Mesh, Scene, Unbaked, baked_sides, fingerprint};
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;

/// Light of a scene's surfaces, vertex by vertex.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct BakedFile {
    /// Stands for the scene's triangles: light of other triangles does not fit.
    pub(crate) geometry: String,
    /// The scene's objects; files of before have none.
    #[serde(default)]
    pub(crate) objects: Vec<BakedObject>,
    /// Stands for materials and lights: with others, the light is out of date.
    pub(crate) light: String,
    /// Patches that were solved for.
    pub(crate) patches: usize,
    /// Bound on the error of any patch's radiosity, for the form factors there were.
    pub(crate) bound: f64,
    /// Vertices in world space.
    pub(crate) positions: Vec<[f64; 3]>,
    /// Unit normal of each vertex's surface.
    pub(crate) normals: Vec<[f32; 3]>,
    /// What arrives from surfaces, without the direct light of lights: power per area, red, green, blue.
    pub(crate) irradiance: Vec<[f32; 3]>,
    /// What leaves: emission and all that is reflected.
    pub(crate) radiosity: Vec<[f32; 3]>,
    /// Corners of triangles between the vertices, surface by surface.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Sides of surfaces.
    pub(crate) surfaces: Vec<SurfaceEntry>,
}

/// Which triangles of a scene those are that light was baked for.
#[derive(Debug, PartialEq)]
pub(crate) enum Fit {
    /// All, with the same numbers.
    All,
    /// Some; for each that light was baked for, its number in this scene. The others are of objects that were added.
    Some(Vec<u32>),
    /// Not all of them are there.
    Other,
}

impl Fit {
    /// The triangles that light was not baked for.
    pub(crate) fn unbaked(&self, mesh: &Mesh) -> Unbaked {
        match self {
            Self::Some(known) => Unbaked::all_but(known, mesh.triangle_count() as u32),
            Self::All | Self::Other => Unbaked::NONE,
        }
    }
}

/// One side of one surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct SurfaceEntry {
    /// Triangles of the scene that it is.
    pub(crate) faces: Vec<u32>,
    /// Whether it is their back.
    pub(crate) back: bool,
    /// How many of [`BakedFile::triangles`] are its own, after those of the entries before.
    pub(crate) count: usize,
}

impl BakedFile {
    /// What was baked; `faces` are the scene's triangles of each surface.
    pub(crate) fn new(baked: &Baked, faces: &[Vec<u32>]) -> Self {
        let mut file = Self::default();
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        for vertex in &baked.vertices {
            file.positions.push(vertex.position.to_array());
            file.normals.push(vertex.normal.as_vec3().to_array());
            file.irradiance.push(single(vertex.irradiance));
            file.radiosity.push(single(vertex.radiosity));
        }
        file.triangles.extend(baked.triangles.iter().map(|triangle| triangle.vertices));
        let entry = |s: BakedSide<'_>| SurfaceEntry { faces: s.faces.to_vec(), back: s.back, count: s.count };
        file.surfaces.extend(baked_sides(baked, faces).into_iter().map(entry));
        file
    }

    /// The same file, with what tells for which scene it is.
    pub(crate) fn of(mut self, scene: &Scene) -> Self {
        self.geometry = written(fingerprint::of_geometry(&scene.mesh));
        self.light = written(fingerprint::of_sources(scene));
        self.objects = BakedObject::all_of(&scene.mesh);
        self
    }

    /// Which triangles of a scene light was baked for.
    pub(crate) fn fit(&self, mesh: &Mesh) -> Fit {
        if self.geometry == written(fingerprint::of_geometry(mesh)) {
            return Fit::All;
        }
        find_baked(&self.objects, mesh).map_or(Fit::Other, Fit::Some)
    }

    /// Whether light of triangles with these numbers depends on other materials and lights now than when it was baked.
    pub(crate) fn is_outdated(&self, scene: &Scene, fit: &Fit) -> bool {
        let now = match fit {
            Fit::Some(numbers) => fingerprint::of_sources_for(scene, numbers.iter().copied()),
            Fit::All | Fit::Other => fingerprint::of_sources(scene),
        };
        self.light != written(now)
    }

    /// Writes JSON.
    ///
    /// # Errors
    /// What `output` says.
    pub(crate) fn write_json(&self, output: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer(&mut *output, self)?;
        writeln!(output)
    }

    /// Writes PLY, ascii: position, normal and radiosity of vertices, and triangles. Not for `render`. Radiosity goes beyond 1, so it is no
    /// colour.
    ///
    /// # Errors
    /// What `output` says.
    pub(crate) fn write_ply(&self, output: &mut dyn Write) -> io::Result<()> {
        writeln!(output, "ply\nformat ascii 1.0\ncomment radiosity: power per area that leaves, linear RGB")?;
        writeln!(output, "element vertex {}", self.positions.len())?;
        for name in ["x", "y", "z", "nx", "ny", "nz", "radiosity_red", "radiosity_green", "radiosity_blue"] {
            writeln!(output, "property float {name}")?;
        }
        writeln!(output, "element face {}", self.triangles.len())?;
        writeln!(output, "property list uchar int vertex_indices\nend_header")?;
        for ((p, n), r) in self.positions.iter().zip(&self.normals).zip(&self.radiosity) {
            let [x, y, z] = p.map(|v| v as f32);
            writeln!(output, "{x} {y} {z} {} {} {} {} {} {}", n[0], n[1], n[2], r[0], r[1], r[2])?;
        }
        self.triangles.iter().try_for_each(|[a, b, c]| writeln!(output, "3 {a} {b} {c}"))
    }

    /// The light, for a scene of so many triangles that it fits as `fit` says.
    ///
    /// # Errors
    /// Names the field that does not fit.
    pub(crate) fn lightmap(
        &self,
        name: &str,
        triangles_of_scene: usize,
        fit: &Fit,
    ) -> Result<Lightmap, InputError> {
        let refused = |message: String| InputError::of_file(name, message).with_help(BAKE);
        let (length, count) = (self.radiosity.len(), self.positions.len());
        if length != count {
            return Err(refused(format!("`radiosity` has {length} entries for {count} positions")));
        }
        let light = BakedLight {
            positions: &self.positions,
            normals: &self.normals,
            irradiance: &self.irradiance,
            triangles: &self.triangles,
        };
        // A number that no triangle had stays one that none has.
        let moved = |faces: &[u32]| match fit {
            Fit::Some(numbers) => {
                faces.iter().map(|&f| numbers.get(f as usize).copied().unwrap_or(u32::MAX)).collect()
            }
            Fit::All | Fit::Other => faces.to_vec(),
        };
        let faces: Vec<Vec<u32>> = self.surfaces.iter().map(|s| moved(&s.faces)).collect();
        let side = |(s, faces): (&SurfaceEntry, _)| BakedSide { faces, back: s.back, count: s.count };
        let sides: Vec<BakedSide<'_>> =
            self.surfaces.iter().zip(faces.iter().map(Vec::as_slice)).map(side).collect();
        Lightmap::new(&light, &sides, triangles_of_scene).map_err(|error| refused(error.to_string()))
    }
}

/// How fingerprints are written.
fn written(fingerprint: u64) -> String {
    format!("{fingerprint:016x}")
}

/// The way out of a file that does not fit.
const BAKE: &str = "bake it with `pointillist radiosity SCENE -o baked.json`";

/// Reads a baked file.
///
/// # Errors
/// A file that is missing or holds something else, with the field.
pub(crate) fn read_baked(path: &Path) -> Result<BakedFile, InputError> {
    let (name, bytes) = (input::name_of(path), input::read(path)?);
    json_words::parse(&name, &bytes, BAKE)
        .map_err(|error| JsonKind::explain(JsonKind::Radiosity, &name, &bytes, error))
}
