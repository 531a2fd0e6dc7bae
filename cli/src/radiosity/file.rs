//! The baked file.

use crate::input;
use crate::input_error::InputError;
use crate::json_kind::JsonKind;
use crate::json_words;
use pointillist_radiosity::Baked;
use serde::{Deserialize, Serialize};
use std::io::{self, Write};
use std::path::Path;

/// Light of a scene's surfaces, vertex by vertex.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BakedFile {
    /// Stands for the scene's triangles: light of other triangles does not fit.
    pub geometry: String,
    /// Stands for materials and lights: with others, the light is out of date.
    pub light: String,
    /// Patches that were solved for.
    pub patches: usize,
    /// Bound on the error of any patch's radiosity, for the form factors there were.
    pub bound: f64,
    /// Vertices in world space.
    pub positions: Vec<[f64; 3]>,
    /// Unit normal of each vertex's surface.
    pub normals: Vec<[f32; 3]>,
    /// What arrives from surfaces, without the direct light of lights: power per area, red, green, blue.
    pub irradiance: Vec<[f32; 3]>,
    /// What leaves: emission and all that is reflected.
    pub radiosity: Vec<[f32; 3]>,
    /// Corners of triangles between the vertices, surface by surface.
    pub triangles: Vec<[u32; 3]>,
    /// Sides of surfaces.
    pub surfaces: Vec<SurfaceEntry>,
}

/// One side of one surface.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurfaceEntry {
    /// Triangles of the scene that it is.
    pub faces: Vec<u32>,
    /// Whether it is their back.
    pub back: bool,
    /// How many of [`BakedFile::triangles`] are its own, after those of the entries before.
    pub count: usize,
}

impl BakedFile {
    /// What was baked; `faces` are the scene's triangles of each surface.
    pub fn new(baked: &Baked, faces: &[Vec<u32>]) -> Self {
        let mut file = Self::default();
        let single = |v: [f64; 3]| v.map(|x| x as f32);
        for vertex in &baked.vertices {
            file.positions.push(vertex.position.to_array());
            file.normals.push(vertex.normal.as_vec3().to_array());
            file.irradiance.push(single(vertex.irradiance));
            file.radiosity.push(single(vertex.radiosity));
        }
        let mut last = None;
        for triangle in &baked.triangles {
            let side = (triangle.surface, triangle.back);
            if last != Some(side) {
                let faces = faces[triangle.surface as usize].clone();
                file.surfaces.push(SurfaceEntry { faces, back: triangle.back, count: 0 });
                last = Some(side);
            }
            if let Some(entry) = file.surfaces.last_mut() {
                entry.count += 1;
            }
            file.triangles.push(triangle.vertices);
        }
        file
    }

    /// Writes JSON.
    ///
    /// # Errors
    /// What `output` says.
    pub fn write_json(&self, output: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer(&mut *output, self)?;
        writeln!(output)
    }

    /// Writes PLY, ascii: position, normal and radiosity of vertices, and triangles. Not for `render`. Radiosity goes beyond 1, so it is no
    /// colour.
    ///
    /// # Errors
    /// What `output` says.
    pub fn write_ply(&self, output: &mut dyn Write) -> io::Result<()> {
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

    /// Whether lists fit one another and all numbers are finite.
    ///
    /// # Errors
    /// Names the field.
    pub fn check(&self, name: &str, triangles_of_scene: usize) -> Result<(), InputError> {
        let refused = |message: String| Err(InputError::of_file(name, message).with_help(BAKE));
        let count = self.positions.len();
        for (field, length) in [
            ("normals", self.normals.len()),
            ("irradiance", self.irradiance.len()),
            ("radiosity", self.radiosity.len()),
        ] {
            if length != count {
                return refused(format!("`{field}` has {length} entries for {count} positions"));
            }
        }
        if let Some(i) = self.positions.iter().position(|p| p.iter().any(|v| !v.is_finite())) {
            return refused(format!("`positions[{i}]` is not finite"));
        }
        if let Some(i) = self.irradiance.iter().position(|p| p.iter().any(|v| !v.is_finite())) {
            return refused(format!("`irradiance[{i}]` is not finite"));
        }
        if let Some(i) = self.triangles.iter().position(|t| t.iter().any(|&v| v as usize >= count)) {
            return refused(format!("`triangles[{i}]` names a vertex beyond the {count} there are"));
        }
        let total = self.surfaces.iter().try_fold(0_usize, |sum, s| sum.checked_add(s.count));
        if total != Some(self.triangles.len()) {
            return refused(format!("`surfaces` do not add up to the {} triangles", self.triangles.len()));
        }
        let beyond = |s: &SurfaceEntry| s.faces.iter().any(|&f| f as usize >= triangles_of_scene);
        match self.surfaces.iter().position(beyond) {
            Some(i) => {
                refused(format!("`surfaces[{i}].faces` names a triangle that the scene does not have"))
            }
            None => Ok(()),
        }
    }
}

/// The way out of a file that does not fit.
pub(super) const BAKE: &str = "bake it with `pointillist radiosity SCENE -o baked.json`";

/// Reads a baked file.
///
/// # Errors
/// A file that is missing or holds something else, with the field.
pub fn read_baked(path: &Path) -> Result<BakedFile, InputError> {
    let (name, bytes) = (input::name_of(path), input::read(path)?);
    json_words::parse(&name, &bytes, BAKE)
        .map_err(|error| JsonKind::explain(JsonKind::Radiosity, &name, &bytes, error))
}
