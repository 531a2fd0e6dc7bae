//! OBJ.

use super::obj_lines::{Kinds, LineFault, ObjLines};
use super::{FileMesh, triangulate};
use crate::coordinate::{LARGEST, is_usable};
use crate::input_error::InputError;
use glam::{DVec2, DVec3, Vec3};
use pointillist_render::NONE;
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
    let mut lines = ObjLines::new(bytes);
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
    mesh.positions.extend(model.positions.chunks_exact(3).map(DVec3::from_slice));
    if kinds.uv {
        mesh.uvs.extend(model.texcoords.chunks_exact(2).map(DVec2::from_slice));
    }
    if kinds.normal {
        mesh.normals.extend(model.normals.chunks_exact(3).map(|n| DVec3::from_slice(n).as_vec3()));
    }
    let arity = |face: usize| model.face_arities.get(face).map_or(3, |&n| n as usize);
    let (mut first, mut face) = (0, 0);
    let mut corners = Vec::new();
    while first < model.indices.len() {
        let count = arity(face);
        if count > MOST_CORNERS {
            let message =
                format!("a face with {count} corners; at most {MOST_CORNERS} can be cut into triangles");
            return Err(InputError::of_file(name, message));
        }
        corners.clear();
        let indices = &model.indices[first..first + count];
        corners.extend(indices.iter().map(|&i| mesh.positions[(bases[0] + i) as usize]));
        triangulate(&corners, |triangle| {
            let pick = |has: bool, base: u32, list: &[u32]| {
                if has { triangle.map(|corner| base + list[first + corner]) } else { [NONE; 3] }
            };
            mesh.triangles.push(pick(true, bases[0], &model.indices));
            mesh.uv_of.push(pick(kinds.uv, bases[1], &model.texcoord_indices));
            mesh.normal_of.push(pick(kinds.normal, bases[2], &model.normal_indices));
            mesh.material_of.push(material);
        });
        first += count;
        face += 1;
    }
    Ok(())
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
