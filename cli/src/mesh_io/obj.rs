//! OBJ.

use super::obj_index::Kinds;
use super::obj_lines::{LineFault, ObjLines};
use super::{FileMesh, triangulate};
use crate::coordinate::{LARGEST, is_usable};
use crate::input;
use crate::input_error::InputError;
use glam::{DVec2, DVec3, Vec3};
use pointillist_render::NONE;
use std::iter::repeat_n;
use tobj::{LoadError, LoadOptions};

/// Polygons with more corners than this are refused: cutting one that is not convex takes the square of the time.
const MOST_CORNERS: usize = 10_000;

/// Polygons stay polygons, and positions, coordinates and normals have indices of their own.
const OPTIONS: LoadOptions =
    LoadOptions { single_index: false, triangulate: false, ignore_points: true, ignore_lines: true };

/// Reads an OBJ; `name` is how messages call it.
///
/// # Errors
///
/// A line that cannot be read, an index out of range, a number that is not finite: with the line.
pub fn read_obj(name: &str, bytes: &[u8]) -> Result<FileMesh, InputError> {
    input::not_empty(name, bytes)?;
    // A second look finds the line of what is wrong.
    read_lines(name, bytes, ObjLines::new(bytes))
        .or_else(|_| read_lines(name, bytes, ObjLines::one_by_one(bytes)))
}

fn read_lines(name: &str, bytes: &[u8], mut lines: ObjLines) -> Result<FileMesh, InputError> {
    let result = tobj::load_obj_buf(&mut lines, &OPTIONS, |_| Ok(Default::default()));
    let models = match result {
        Ok((models, _)) => models,
        Err(error) => {
            let fault = lines.fault.take().unwrap_or_else(|| fault_of(&error, lines.line()));
            return Err(InputError::in_line(name, bytes, fault.line, fault.message).with_help(fault.help));
        }
    };
    let mut mesh = FileMesh {
        material_names: std::mem::take(&mut lines.material_names),
        material_files: std::mem::take(&mut lines.material_files),
        ..FileMesh::default()
    };
    for model in models {
        // A file without faces gives one group that nobody named.
        let Some((kinds, material)) = ObjLines::decode(&model.name) else { continue };
        append(&mut mesh, &model.mesh, kinds, material, name)?;
    }
    if mesh.positions.iter().all(|p| is_usable(*p))
        && mesh.uvs.iter().all(|p| is_usable(p.extend(0.0)))
        && mesh.normals.iter().all(|n| n.is_finite())
    {
        Ok(mesh)
    } else {
        Err(not_finite(name, bytes))
    }
}

fn fault_of(error: &LoadError, line: usize) -> LineFault {
    let message = match error {
        LoadError::PositionParseError => "not three numbers after `v`",
        LoadError::TexcoordParseError => "not two numbers after `vt`",
        LoadError::NormalParseError => "not three numbers after `vn`",
        _ => "this line cannot be read",
    };
    LineFault { line, message: message.to_owned(), help: "numbers are written like 1.5 or -2e-3" }
}

/// The line of the first number that is not finite.
fn not_finite(name: &str, bytes: &[u8]) -> InputError {
    let is_bad = |line: &[u8]| {
        let text = String::from_utf8_lossy(line);
        let mut words = text.split('#').next().unwrap_or_default().split_whitespace();
        let is_normal = match words.next() {
            Some("vn") => true,
            Some("v" | "vt") => false,
            _ => return false,
        };
        // Normals are kept in 32 bits.
        let fits = |n: f64| if is_normal { (n as f32).is_finite() } else { n.abs() <= LARGEST };
        words.take(3).any(|word| word.parse().is_ok_and(|number| !fits(number)))
    };
    let line = bytes.split(|&b| b == b'\n').position(is_bad);
    let message = format!("a number that is not finite, or beyond ±{LARGEST:e}");
    match line {
        Some(index) => InputError::in_line(name, bytes, index + 1, message),
        None => InputError::of_file(name, message),
    }
    .with_help("export the mesh again, or remove the faces of this vertex")
}

fn append(
    mesh: &mut FileMesh,
    model: &tobj::Mesh,
    kinds: Kinds,
    material: u32,
    name: &str,
) -> Result<(), InputError> {
    let bases = [mesh.positions.len(), mesh.uvs.len(), mesh.normals.len()].map(|n| n as u32);
    let total = mesh.positions.len() + model.positions.len() / 3;
    if u32::try_from(total).is_err() {
        return Err(InputError::of_file(name, format!("{total} vertices are more than can be numbered")));
    }
    let corners = model.indices.len();
    if u32::try_from(corners).is_err() {
        return Err(InputError::of_file(
            name,
            format!("{corners} corners of faces are more than can be numbered"),
        ));
    }
    // The parser leaves out what faces ask for before the file has any; a look at single lines then names the line.
    let has_all = |is_asked: bool, list: &[u32]| !is_asked || list.len() == corners;
    if !has_all(kinds.uv, &model.texcoord_indices) || !has_all(kinds.normal, &model.normal_indices) {
        let message = "faces use texture coordinates or normals that are defined after them".to_owned();
        return Err(InputError::of_file(name, message));
    }
    mesh.positions.extend(model.positions.chunks_exact(3).map(DVec3::from_slice));
    if kinds.uv {
        mesh.uvs.extend(model.texcoords.chunks_exact(2).map(DVec2::from_slice));
    }
    if kinds.normal {
        mesh.normals.extend(model.normals.chunks_exact(3).map(|n| DVec3::from_slice(n).as_vec3()));
    }
    let cut = cut_faces(model, &mesh.positions[bases[0] as usize..], name)?;
    mesh.triangles.extend(picked(&cut, bases[0], &model.indices));
    if kinds.uv {
        mesh.uv_of.extend(picked(&cut, bases[1], &model.texcoord_indices));
    } else {
        mesh.uv_of.extend(repeat_n([NONE; 3], cut.len()));
    }
    if kinds.normal {
        mesh.normal_of.extend(picked(&cut, bases[2], &model.normal_indices));
    } else {
        mesh.normal_of.extend(repeat_n([NONE; 3], cut.len()));
    }
    mesh.material_of.extend(repeat_n(material, cut.len()));
    Ok(())
}

/// What `list` has at the corners of triangles, counted from `base`.
fn picked(cut: &[[u32; 3]], base: u32, list: &[u32]) -> impl ExactSizeIterator<Item = [u32; 3]> {
    cut.iter().map(move |triangle| triangle.map(|corner| base + list[corner as usize]))
}

/// The triangles of all faces, as places in the lists of indices; `positions` are those of the model.
fn cut_faces(model: &tobj::Mesh, positions: &[DVec3], name: &str) -> Result<Vec<[u32; 3]>, InputError> {
    // Without arities all faces are triangles.
    if model.face_arities.is_empty() {
        return Ok((0..model.indices.len() as u32 / 3)
            .map(|face| [3 * face, 3 * face + 1, 3 * face + 2])
            .collect());
    }
    let mut cut = Vec::with_capacity(model.indices.len() - 2 * model.face_arities.len());
    let mut corners = Vec::new();
    let mut first = 0;
    for &arity in &model.face_arities {
        let count = arity as usize;
        if count > MOST_CORNERS {
            let message =
                format!("a face with {count} corners; at most {MOST_CORNERS} can be cut into triangles");
            return Err(InputError::of_file(name, message));
        }
        corners.clear();
        corners.extend(model.indices[first..first + count].iter().map(|&i| positions[i as usize]));
        triangulate(&corners, |triangle| cut.push(triangle.map(|corner| (first + corner) as u32)));
        first += count;
    }
    Ok(cut)
}

impl FileMesh {
    /// Whether any triangle has normals.
    pub fn has_normals(&self) -> bool {
        !self.normals.is_empty()
    }

    /// Normals from the file, one for each in the list, of unit length; zero where the file has zero.
    pub fn unit_normals(&self) -> impl Iterator<Item = Vec3> + '_ {
        self.normals.iter().map(|n| n.as_dvec3().normalize_or_zero().as_vec3())
    }
}

#[cfg(test)]
mod tests;
